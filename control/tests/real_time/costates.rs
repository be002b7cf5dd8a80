//! H* and costates of the direct method, against differences of costs of solving again.

use costate::robot::Robot;
use costate_control::{
    BoundaryState, FinalTime, MotionLimits, Objective, Polish, Problem, Solution, Solver, SolverOptions, Via,
};
use std::f64::consts::PI;

/// Of the direct method.
fn solve(problem: &Problem, tolerance: f64) -> Solution {
    let options = SolverOptions::default().with_tolerance(tolerance).with_polish(Polish::Never);
    let solution = Solver::new(problem, options).unwrap().solve();
    assert!(solution.motion.status.is_solved(), "{}", solution.motion.status);
    solution
}

/// The central difference of the costs of problems around one.
fn slope(problem: impl Fn(f64) -> Problem, at: f64, step: f64, tolerance: f64) -> f64 {
    let cost = |value: f64| solve(&problem(value), tolerance).total();
    (cost(at + step) - cost(at - step)) / (2.0 * step)
}

fn close(found: f64, expected: f64, part: f64) {
    assert!((found / expected - 1.0).abs() < part, "{found} instead of {expected}");
}

/// The two-link arm from rest to rest.
fn arm(limits: MotionLimits) -> Problem {
    let robot = Robot::from_file("../robots/two_link.toml").unwrap();
    Problem::rest_to_rest(robot, &[0.0, 0.3], &[1.2, 0.9], 1.0).with_limits(limits)
}

/// The shoulder accelerates by at most so much (rad/s^2).
fn slow(most: f64) -> MotionLimits {
    MotionLimits::none().with_a_max(vec![most, f64::INFINITY])
}

#[test]
fn limits_of_accelerations_are_in_the_costates() {
    let arm = arm(slow(6.0));
    let solution = solve(&arm, 1e-7);
    let motion = &solution.motion;
    let at = |time: f64| arm.clone().with_time(FinalTime::Fixed(time));
    close(-motion.hamiltonian, slope(at, 1.0, 2e-3, 1e-7), 2e-4);
    assert!(motion.hamiltonian_drift < 1e-3, "{}", motion.hamiltonian_drift);
    // H* at the rows, from the costates there, and no jumps of y_q, which nothing here makes jump.
    let values = &solution.trajectory.hamiltonian;
    let off = values.iter().fold(0.0, |most: f64, value| most.max((value / motion.hamiltonian - 1.0).abs()));
    assert!(off < 1e-2, "{off}");
    let y_q = &solution.trajectory.y_q;
    let size = y_q.iter().flatten().fold(0.0, |most: f64, y| most.max(y.abs()));
    for rows in y_q.windows(2) {
        let jump = rows[0].iter().zip(&rows[1]).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
        assert!(jump < 0.2 * size, "{jump} of {size}");
    }
    // y(0) = -dJ/dx(0).
    for joint in 0..2 {
        let from = |change: f64| {
            let mut moved = arm.clone();
            moved.start.q[joint] += change;
            moved
        };
        close(-solution.costate_start().y_q[joint], slope(from, 0.0, 1e-3, 1e-7), 1e-3);
    }
}

#[test]
fn a_given_time_of_a_via_costs_what_h_jumps_by() {
    for limits in [slow(9.0), MotionLimits::none()] {
        let through = |time: f64, via: f64| {
            let via = Via::at(&[0.5, 0.9]).with_time(via);
            arm(limits.clone()).with_time(FinalTime::Fixed(time)).with_via(via)
        };
        let solution = solve(&through(1.0, 0.4), 1e-8);
        let [before, after] = solution.motion.phase_hamiltonians[..] else { panic!() };
        close(after - before, slope(|via| through(1.0, via), 0.4, 1e-3, 1e-8), 1e-3);
        close(-solution.motion.hamiltonian, slope(|time| through(time, 0.4), 1.0, 1e-3, 1e-8), 1e-3);
        assert_eq!(solution.motion.hamiltonian, after);
    }
}

#[test]
fn an_arc_at_the_limit_of_the_rate_hides_nothing() {
    let robot = Robot::from_file("../robots/pendulum.toml").unwrap();
    let start = BoundaryState::fixed(&[-3.0], &[0.0]).with_v_free(&[0]);
    let turn = |time: f64| {
        Problem::rest_to_rest(robot.clone(), &[-3.0], &[2.0 * PI - 3.0], time)
            .with_start(start.clone())
            .with_period(vec![2.0 * PI])
            .with_limits(MotionLimits::none().with_v_max(vec![6.0]))
    };
    for tolerance in [1e-4, 1e-6, 3e-8] {
        let motion = solve(&turn(2.0), tolerance).motion;
        let expected = slope(turn, 2.0, 1e-3, 3e-8);
        close(-motion.hamiltonian, expected, 20.0 * tolerance + 2e-4);
    }
}

/// The drift of H* that a tolerance of the cost leaves. A torque that is off by d on an interval of the width
/// w costs d^2 w, which is at most the tolerance times J, and changes H* at a limit by up to 2 |u| d:
/// relative to the largest u^2 that is 2 (tolerance T/w)^(1/2). Nodes where a power changes its sign are
/// close.
fn drift_allowed(solution: &Solution, tolerance: f64) -> f64 {
    // Of each interval both ends and three points.
    let rows = solution.trajectory.t.chunks_exact(5);
    let narrowest = rows.fold(f64::INFINITY, |least: f64, t| least.min(t[4] - t[0]));
    2.0 * (tolerance * solution.motion.final_time / narrowest).sqrt()
}

/// Energy depends on powers, and torque-speed limits on rates.
#[test]
fn energies_and_powers_are_in_the_costates() {
    let limits = MotionLimits::none().with_power_max(vec![20.0, 15.0]).with_a_max(vec![9.0, f64::INFINITY]);
    let problem = |time: f64| {
        let cost = Objective::new(0.0, vec![1.0; 2]).with_energy(vec![2.0; 2]);
        arm(limits.clone()).with_cost(cost).with_time(FinalTime::Fixed(time))
    };
    let solution = solve(&problem(1.5), 1e-7);
    close(-solution.motion.hamiltonian, slope(problem, 1.5, 2e-3, 1e-7), 1e-3);
    let (drift, allowed) = (solution.motion.hamiltonian_drift, drift_allowed(&solution, 1e-7));
    assert!(drift < allowed, "{drift} of {allowed}");
}
