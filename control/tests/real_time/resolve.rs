//! Problems that are solved again and again.

use crate::solved::problem;
use costate::robot::Robot;
use costate_control::{
    Budget, FinalTime, MachineCode, MotionLimits, Objective, Polish, Problem, Resolve, ResolveError,
    ResolveStatus, Solver, SolverOptions,
};
use costate_test_support::allocations::allocations;
use std::f64::consts::PI;
use std::ops::ControlFlow;
use std::time::Duration;

pub fn options(intervals: usize, tolerance: f64) -> SolverOptions {
    let options = SolverOptions::default().with_tolerance(1e-6).with_machine_code(MachineCode::AtOnce);
    options.with_tolerance(tolerance).with_nodes(3 * intervals + 1)
}

/// The position of a joint that goes on at a rate.
fn later(q: &[f64], v: &[f64], t: f64) -> Vec<f64> {
    q.iter().zip(v).map(|(q, v)| q + t * v).collect()
}

#[test]
fn a_motion_is_the_one_that_the_solver_finds_from_scratch() {
    let arm = problem("ur5_limits");
    let mut motion = Resolve::new(&arm, options(20, 1e-7)).unwrap();
    let first = motion.solve().unwrap();
    assert_eq!((first.status, first.keeps_limits()), (ResolveStatus::Solved, true));
    let solved = Solver::new(&arm, SolverOptions::default().with_tolerance(1e-6).with_polish(Polish::Never))
        .unwrap()
        .solve();
    assert!((first.cost / solved.total() - 1.0).abs() < 1e-3, "{} {}", first.cost, solved.total());
    // Other ends, step by step: few Newton steps each, and the cost of solving from scratch.
    let (mut start, mut end) = (arm.start.clone(), arm.end.clone());
    let mut most = 0;
    for k in 0..10 {
        for i in 0..6 {
            start.q[i] += 0.004 * (1.0 + (i + k) as f64).sin();
            start.v[i] += 0.02 * (2.0 + (i + k) as f64).sin();
            end.q[i] += 0.01 * (3.0 + (i * k) as f64).sin();
        }
        motion.set_start(&start.q, &start.v).unwrap();
        motion.set_end(&end.q, &end.v).unwrap();
        let found = motion.solve_again(Budget::steps(60)).unwrap();
        assert_eq!((found.status, found.keeps_limits()), (ResolveStatus::Solved, true), "{k} {found:?}");
        most = most.max(found.iterations);
        let moved = arm.clone().with_start(start.clone()).with_end(end.clone());
        let mut fresh = Resolve::new(&moved, options(20, 1e-7)).unwrap();
        let fresh = fresh.solve().unwrap();
        assert!(found.iterations < fresh.iterations);
        assert!((found.cost / fresh.cost - 1.0).abs() < 1e-5, "{k}: {found:?} {fresh:?}");
        let mut z = [0.0; 18];
        motion.state_at(0.0, &mut z).unwrap();
        assert!(z[..6].iter().zip(&start.q).all(|(a, b)| (a - b).abs() < 1e-12));
        motion.state_at(motion.final_time().unwrap(), &mut z).unwrap();
        assert!(z[..6].iter().zip(&end.q).all(|(a, b)| (a - b).abs() < 1e-12));
    }
}

#[test]
fn nothing_is_allocated_after_the_first_solve() {
    let mut arm = problem("ur5_limits");
    for free in [false, true] {
        if free {
            arm.time = FinalTime::Free { guess: 1.0 };
            arm.cost = Objective::new(1.0, arm.cost.effort.clone());
        }
        let mut motion = Resolve::new(&arm, options(20, 1e-4)).unwrap();
        motion.solve().unwrap();
        motion.feedback().unwrap().unwrap();
        let mut again = |dt: f64| {
            let (mut z, mut tau, mut gain) = ([0.0; 18], [0.0; 6], [0.0; 72]);
            motion.state_at(dt, &mut z).unwrap();
            motion.advance(dt);
            // Between the points of so few intervals a rate may exceed its limit.
            z[6..12].iter_mut().for_each(|v| *v = v.clamp(-PI, PI));
            motion.set_start(&z[..6], &z[6..12]).unwrap();
            motion.set_end(&arm.end.q, &arm.end.v).unwrap();
            let found = motion.solve_again(Budget::steps(10).within(Duration::from_secs(9))).unwrap();
            motion.torques_at(0.0, &mut tau).unwrap();
            motion.feedback().unwrap().unwrap().gain(0.0, &mut gain);
            found.iterations
        };
        again(0.001);
        let mut steps = 0;
        let found = allocations(|| (0..20).for_each(|_| steps += again(0.004)));
        assert!(found == 0 && steps >= 20, "{found} allocations in {steps} steps");
    }
}

#[test]
fn nothing_is_allocated_where_the_first_solve_was_easy_and_the_next_is_not() {
    let arm = problem("ur5_limits");
    let mut motion = Resolve::new(&arm, options(20, 1e-4)).unwrap();
    let easy = motion.solve().unwrap();
    // Fast, away from the end.
    let far = later(&arm.start.q, &[0.8, -0.6, 0.9, 0.5, -0.7, 1.0], -1.0);
    let fast = [-2.0, 1.5, -2.0, 1.0, 2.0, -2.5];
    let mut hard = None;
    let found = allocations(|| {
        motion.advance(0.1);
        motion.set_start(&far, &fast).unwrap();
        hard = Some(motion.solve_again(Budget::steps(200)).unwrap());
    });
    let hard = hard.unwrap();
    assert!(found == 0 && hard.iterations > easy.iterations, "{found} allocations: {easy:?} {hard:?}");
}

#[test]
fn budgets_are_kept_and_the_best_motion_is_shown() {
    let arm = problem("ur5_limits");
    let mut motion = Resolve::new(&arm, options(20, 1e-6)).unwrap();
    motion.solve().unwrap();
    let far = later(&arm.end.q, &[0.3; 6], 1.0);
    motion.set_end(&far, &[0.0; 6]).unwrap();
    let one = motion.solve_again(Budget::steps(1)).unwrap();
    assert_eq!((one.status, one.iterations), (ResolveStatus::Iterations, 1));
    // Whatever is shown meets the new ends.
    let mut z = [0.0; 18];
    motion.state_at(9.0, &mut z).unwrap();
    assert!(z[..6].iter().zip(&far).all(|(a, b)| (a - b).abs() < 1e-12));
    motion.set_end(&later(&arm.end.q, &[0.15; 6], 1.0), &[0.0; 6]).unwrap();
    let none = motion.solve_again(Budget::steps(50).within(Duration::ZERO)).unwrap();
    assert_eq!((none.status, none.iterations), (ResolveStatus::OutOfTime, 1));
    // A listener ends it too, and nothing is allocated for that.
    motion.set_end(&far, &[0.0; 6]).unwrap();
    let (mut steps, mut stopped) = (0, None);
    let found = allocations(|| {
        let stop = || {
            steps += 1;
            if steps == 2 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        };
        stopped = Some(motion.solve_until(Budget::steps(50), stop).unwrap());
    });
    let stopped = stopped.unwrap();
    assert_eq!((found, stopped.status, stopped.iterations), (0, ResolveStatus::Cancelled, 2));
    motion.set_end(&arm.end.q, &[0.0; 6]).unwrap();
    let rest = motion.solve_again(Budget::steps(50)).unwrap();
    assert_eq!((rest.status, rest.keeps_limits()), (ResolveStatus::Solved, true));
}

#[test]
fn motions_go_on_when_time_does() {
    // The rest of an optimal motion is optimal: nothing is left to do.
    let mut arm = problem("two_link").with_limits(MotionLimits::none().with_torque_max(vec![12.0, 5.0]));
    arm.time = FinalTime::Free { guess: 2.0 };
    arm.cost = Objective::new(20.0, vec![1.0; 2]);
    let mut motion = Resolve::new(&arm, options(24, 1e-6)).unwrap();
    motion.solve().unwrap();
    let whole = motion.final_time().unwrap();
    let mut z = [0.0; 6];
    for k in 1..=5 {
        let dt = 0.05;
        motion.state_at(dt, &mut z).unwrap();
        motion.advance(dt);
        motion.set_start(&z[..2], &z[2..4]).unwrap();
        let found = motion.solve_again(Budget::steps(10)).unwrap();
        assert_eq!((found.status, found.keeps_limits()), (ResolveStatus::Solved, true), "{k} {found:?}");
        let left = whole - f64::from(k) * dt;
        let time = motion.final_time().unwrap();
        assert!((time / left - 1.0).abs() < 2e-3, "{k}: {time} {left}");
    }
}

#[test]
fn a_start_that_cannot_be_evaluated_leaves_the_motion_as_it_was() {
    let arm = problem("two_link").with_limits(MotionLimits::none());
    let mut motion = Resolve::new(&arm, options(8, 1e-6)).unwrap();
    let first = motion.solve().unwrap();
    motion.set_start(&arm.start.q, &[f64::MAX; 2]).unwrap();
    motion.solve_again(Budget::steps(9)).unwrap_err();
    let mut z = [0.0; 6];
    motion.state_at(0.0, &mut z).unwrap();
    assert_eq!(z[2..4], arm.start.v);
    motion.set_start(&arm.start.q, &arm.start.v).unwrap();
    let found = motion.solve_again(Budget::steps(9)).unwrap();
    assert_eq!(found.status, ResolveStatus::Solved, "{found:?}");
    assert!((found.cost / first.cost - 1.0).abs() < 1e-5 && found.iterations < first.iterations);
}

#[test]
fn what_no_motion_can_meet_is_refused() {
    let robot = Robot::from_file("../robots/ur5.urdf").unwrap();
    let limits = MotionLimits::default().with_from_robot(true);
    let arm = Problem::rest_to_rest(robot, &[0.0; 6], &[0.5; 6], 1.0).with_limits(limits);
    let mut motion = Resolve::new(&arm, options(8, 1e-4)).unwrap();
    let says = |error: ResolveError, words: &str| assert!(error.to_string().contains(words), "{error}");
    says(motion.set_start(&[0.0; 5], &[0.0; 6]).unwrap_err(), "q at the start: 5 entries, not 6");
    says(
        motion.set_end(&[0.0; 6], &[0.0, f64::NAN, 0.0, 0.0, 0.0, 0.0]).unwrap_err(),
        "v at the end: entry 1",
    );
    says(
        motion.set_end(&[0.0, 0.0, 7.0, 0.0, 0.0, 0.0], &[0.0; 6]).unwrap_err(),
        "q at the end of joint 'elbow_joint' is 7",
    );
    says(
        motion.set_start(&[0.0; 6], &[4.0; 6]).unwrap_err(),
        "v at the start of joint 'shoulder_pan_joint' is 4",
    );
    assert!(motion.feedback().unwrap().is_none(), "nothing is solved yet");
    assert_eq!(motion.final_time(), None);
    assert_eq!(motion.torques_at(0.1, &mut [0.0; 6]), Err(ResolveError::NotSolved));
    says(motion.torques_at(0.1, &mut [0.0; 5]).unwrap_err(), "the torques: 5 entries, not 6");
    motion.solve().unwrap();
    assert!((motion.final_time().unwrap() - 1.0).abs() < 1e-12);
    assert_eq!(motion.torques_at(f64::NAN, &mut [0.0; 6]), Err(ResolveError::NotATime));
    assert_eq!(motion.state_at(f64::NAN, &mut [0.0; 18]), Err(ResolveError::NotATime));
    assert!(motion.state_at(-1.0, &mut [0.0; 18]).is_ok() && motion.torques_at(9.0, &mut [0.0; 6]).is_ok());
}
