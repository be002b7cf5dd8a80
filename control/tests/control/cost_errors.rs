//! The error of the cost that is stated, against that of known values with limits that are active.

use crate::direct::{INF, arm_at_its_limits, limited, robot};
use crate::tasks::around_a_disc;
use costate_control::{MotionLimits, Polish, Problem, Solver, SolverOptions, Status};
use std::f64::consts::PI;

fn swing(least: f64) -> Problem {
    Problem::rest_to_rest(robot("pendulum"), &[0.0], &[PI], 3.0)
        .with_limits(MotionLimits::none().with_q_min(vec![least]))
}

/// Solved from so many starts to each tolerance from the loosest to the tightest one. The value, by other
/// methods and on finer and finer meshes, is known to `digits`.
fn is_told(problem: &Problem, value: f64, digits: f64, (starts, tolerances): (usize, &[f64])) {
    for &tolerance in tolerances {
        let options = SolverOptions::default().with_polish(Polish::Never).with_starts(starts);
        let solution = Solver::new(problem, options.with_tolerance(tolerance)).unwrap().solve();
        let (error, stated) = ((solution.total() / value - 1.0).abs(), solution.cost_error().unwrap());
        println!(
            "{value} at {tolerance:.0e}: {} nodes, error {error:.2e} stated {stated:.2e}",
            solution.nodes()
        );
        assert_eq!(solution.motion.status, Status::Converged, "{value} at {tolerance}");
        // The gap of the maximum principle may be ten times the tolerance, all else that is stated one.
        let gap = solution.verified.as_ref().and_then(|verified| verified.optimality.value).unwrap_or(0.0);
        let most = if stated <= gap { 10.0 * tolerance } else { tolerance };
        assert!(stated <= most, "{value} at {tolerance}: {stated}, gap {gap}");
        assert!(error <= 2.0 * stated + digits, "{value} at {tolerance}: {error}, stated {stated}");
    }
}

const TOLERANCES: [f64; 5] = [1e-4, 1e-5, 1e-6, 1e-7, 1e-8];

/// It touches its limit, or stays at it for a while.
#[test]
fn of_a_position_at_its_limit() {
    is_told(&swing(-0.7), 19.4870292, 5e-9, (4, &TOLERANCES));
    is_told(&swing(-0.2), 27.844211, 4e-8, (4, &TOLERANCES));
}

#[test]
fn of_a_rate_at_its_limit() {
    is_told(&limited("two_link", &[INF, 7.0]), 155.74483972, 1e-10, (4, &TOLERANCES));
}

/// Positions, rates and torques at once.
#[test]
fn of_an_arm_at_all_its_limits() {
    is_told(&arm_at_its_limits(), 22.5760933, 5e-9, (4, &TOLERANCES[..4]));
}

/// A clearance is no polynomial.
#[test]
fn of_a_clearance() {
    is_told(&around_a_disc(), 170.506985, 5e-9, (4, &TOLERANCES[..4]));
}

/// From one limit to the other within 0.05 s, between two points of a wide interval: multipliers of either
/// sign made such a jump the best one, and half of the interval shows nothing.
#[test]
fn of_an_acceleration_at_its_limits() {
    let limits = MotionLimits::none().with_a_max(vec![0.859]);
    let problem = Problem::rest_to_rest(robot("pendulum"), &[-0.14], &[0.987], 3.223).with_limits(limits);
    is_told(&problem, 25.22941483, 1e-9, (1, &TOLERANCES));
}
