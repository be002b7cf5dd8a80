//! Solving again after a solve that failed, or after a wrong start.

use crate::solved::problem;
use costate::robot::Robot;
use costate_control::{
    BoundaryState, Budget, FinalTime, MotionLimits, Problem, Resolve, ResolveError, ResolveStatus,
    SolverOptions, Via,
};
use costate_test_support::allocations::allocations;

fn arm() -> Problem {
    let robot = Robot::from_file("../robots/two_link.toml").unwrap();
    let problem = Problem::rest_to_rest(robot, &[0.0, 0.0], &[1.0, 0.5], 1.0);
    problem.with_limits(MotionLimits::default().with_from_robot(false))
}

fn limited() -> Problem {
    let limits = MotionLimits::default().with_from_robot(false).with_torque_max(vec![40.0, 40.0]);
    arm().with_limits(limits)
}

/// Solves for a wrong start with a budget, then for the right one; what each solve gave until one is solved.
fn after(problem: &Problem, q: f64, v: f64, budget: Option<Budget>) -> (f64, Vec<(ResolveStatus, f64)>) {
    let mut motion =
        Resolve::new(problem, SolverOptions::default().with_tolerance(1e-6).with_nodes(31)).unwrap();
    let first = motion.solve().unwrap();
    assert_eq!(first.status, ResolveStatus::Solved);
    motion.set_start(&[0.0, q], &[v, 0.0]).unwrap();
    // Whether that can be solved does not matter.
    let _ = motion.solve_again(budget.unwrap_or_else(|| motion.budget()));
    motion.set_start(&[0.0, 0.0], &[0.0, 0.0]).unwrap();
    let mut found = Vec::new();
    for _ in 0..3 {
        let again = motion.solve().unwrap();
        found.push((again.status, again.cost));
        if again.status == ResolveStatus::Solved {
            break;
        }
    }
    (first.cost, found)
}

#[test]
fn one_wrong_measurement_is_forgotten_by_the_next_solve() {
    for (q, v) in [(0.0, 50.0), (5.0, 0.0), (10.0, 0.0), (30.0, 0.0), (3.0, 0.0), (4.0, 0.0), (6.3, 0.0)] {
        for problem in [limited(), arm()] {
            let (cost, found) = after(&problem, q, v, Some(Budget::steps(3)));
            let (status, again) = found[0];
            assert_eq!(status, ResolveStatus::Solved, "{q} {v}: {found:?}");
            assert!((again / cost - 1.0).abs() < 1e-5, "{q} {v}: {found:?}, not {cost}");
        }
    }
}

#[test]
fn a_solve_that_failed_is_no_start() {
    // A rate that the torques cannot stop in time: no motion keeps them.
    let (cost, found) = after(&limited(), 0.0, 50.0, None);
    let (status, again) = *found.last().unwrap();
    assert!(status == ResolveStatus::Solved && (again / cost - 1.0).abs() < 1e-5, "{found:?}, not {cost}");
    // Without a solved motion there is the first guess.
    let mut motion =
        Resolve::new(&limited(), SolverOptions::default().with_tolerance(1e-6).with_nodes(31)).unwrap();
    motion.set_start(&[0.0, 0.0], &[50.0, 0.0]).unwrap();
    for _ in 0..3 {
        assert_ne!(motion.solve().unwrap().status, ResolveStatus::Solved);
    }
    motion.set_start(&[0.0, 0.0], &[0.0, 0.0]).unwrap();
    let found: Vec<_> = (0..4).map(|_| motion.solve().unwrap()).collect();
    assert_eq!(found[3].status, ResolveStatus::Solved, "{found:?}");
    assert!((found[3].cost / cost - 1.0).abs() < 1e-5, "{found:?}, not {cost}");
}

#[test]
fn budgets_of_one_step_still_lead_to_the_motion() {
    let mut motion =
        Resolve::new(&limited(), SolverOptions::default().with_tolerance(1e-6).with_nodes(31)).unwrap();
    motion.solve().unwrap();
    // The start moves far from the solved motion, one step at a time: no way back to it.
    let mut last = motion.solve_again(Budget::steps(1)).unwrap();
    for k in 0..60 {
        let part = f64::from(k.min(40)) / 40.0;
        motion.set_start(&[-0.6 * part, 0.8 * part], &[0.0, 0.0]).unwrap();
        last = motion.solve_again(Budget::steps(1)).unwrap();
    }
    let there = limited().with_start(BoundaryState::fixed(&[-0.6, 0.8], &[0.0, 0.0]));
    let fresh = Resolve::new(&there, SolverOptions::default().with_tolerance(1e-6).with_nodes(31))
        .unwrap()
        .solve()
        .unwrap();
    assert!((last.cost / fresh.cost - 1.0).abs() < 1e-4, "{last:?}, not {fresh:?}");
}

#[test]
fn reset_begins_at_the_first_guess() {
    for problem in [limited(), limited().with_time(FinalTime::Fixed(1.2)), problem("ur5_limits")] {
        let mut motion =
            Resolve::new(&problem, SolverOptions::default().with_tolerance(1e-6).with_nodes(31)).unwrap();
        let first = motion.solve().unwrap();
        let (mut start, mut end) = (problem.start.clone(), problem.end.clone());
        (start.q[1], end.q[0]) = (start.q[1] + 0.1, end.q[0] - 0.1);
        motion.set_start(&start.q, &start.v).unwrap();
        motion.set_end(&end.q, &end.v).unwrap();
        motion.reset();
        let mut z = vec![0.0; 3 * motion.dof()];
        assert_eq!(motion.state_at(0.0, &mut z), Err(ResolveError::NotSolved));
        let moved = motion.solve().unwrap();
        // Another guess for the new ends: the same motion.
        let fresh = problem.clone().with_start(start).with_end(end);
        let fresh = Resolve::new(&fresh, SolverOptions::default().with_tolerance(1e-6).with_nodes(31))
            .unwrap()
            .solve()
            .unwrap();
        assert!((moved.cost / fresh.cost - 1.0).abs() < 1e-5, "{moved:?} {fresh:?}");
        motion.set_start(&problem.start.q, &problem.start.v).unwrap();
        motion.set_end(&problem.end.q, &problem.end.v).unwrap();
        motion.reset();
        let again = motion.solve().unwrap();
        assert_eq!(again.iterations, first.iterations);
        assert!((again.cost / first.cost - 1.0).abs() < 1e-9, "{again:?}, not {first:?}");
    }
}

#[test]
fn going_back_keeps_given_times_and_allocates_nothing() {
    let via = Via::at(&[0.4, 0.3]).with_time(0.5);
    for (problem, left) in [(limited().with_via(via), Some(0.9)), (limited(), None)] {
        let mut motion =
            Resolve::new(&problem, SolverOptions::default().with_tolerance(1e-6).with_nodes(31)).unwrap();
        assert_eq!(motion.solve().unwrap().status, ResolveStatus::Solved);
        motion.feedback().unwrap().unwrap();
        let mut z = [0.0; 6];
        motion.state_at(0.1, &mut z).unwrap();
        motion.advance(0.1);
        let mut last = None;
        let found = allocations(|| {
            for (wrong, steps) in [(50.0, 2), (50.0, 200), (40.0, 200), (-30.0, 200), (0.0, 200)] {
                motion.set_start(&z[..2], &[z[2] + wrong, z[3]]).unwrap();
                last = motion.solve_again(Budget::steps(steps)).ok();
            }
            let recovered = last.map(|last| last.status);
            motion.reset();
            last = motion
                .solve_again(Budget::steps(200))
                .ok()
                .filter(|_| recovered == Some(ResolveStatus::Solved));
        });
        assert_eq!((last.map(|last| last.status), found), (Some(ResolveStatus::Solved), 0), "{last:?}");
        if let Some(left) = left {
            assert!((motion.final_time().unwrap() - left).abs() < 1e-12);
        }
    }
}
