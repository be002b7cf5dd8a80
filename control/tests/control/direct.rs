//! The direct method: values that other methods found, with hard limits and without.

use crate::sharp;
use costate::robot::{LoadOptions, Robot};
use costate::scalar::Scalar;
use costate_control::{
    Bounds, Cancel, FinalTime, Motion, MotionLimits, Objective, Phase, Polish, Problem, ProblemError,
    ProblemFile, RunningCost, Solution, Solver, SolverOptions, Status, UserTerm,
};
use std::f64::consts::{FRAC_PI_2, PI};
use std::ops::ControlFlow;
use std::time::Duration;

pub const INF: f64 = f64::INFINITY;

/// A problem of examples/problems, without the limits of its robot.
pub fn problem(name: &str) -> Problem {
    let file = ProblemFile::read(format!("../examples/problems/{name}.toml"), LoadOptions::default());
    file.unwrap().problem.with_limits(MotionLimits::none())
}

/// A robot of robots/.
pub fn robot(name: &str) -> Robot {
    Robot::from_file(format!("../robots/{name}.toml")).unwrap()
}

fn solve_with(problem: &Problem, options: SolverOptions) -> Solution {
    Solver::new(problem, options).unwrap().solve()
}

pub fn solve(problem: &Problem) -> Solution {
    solve_with(problem, SolverOptions::default().with_tolerance(1e-6).with_polish(Polish::Never))
}

/// Largest violation at the points among all kinds, each in parts of `ranges`: q, v, a, tau.
fn violation(solution: &Solution, ranges: [f64; 4]) -> f64 {
    let kinds = solution.limits.kinds().zip(ranges);
    kinds.filter_map(|((_, usage), range)| Some(usage?.at_points / range)).fold(0.0, f64::max)
}

/// Solved, with this cost up to a relative difference of 3e-6; the torques lead to the end.
fn check(problem: &Problem, solution: &Solution, value: f64, defect: f64) {
    let name = problem.robot.name();
    assert_eq!(solution.motion.status, Status::Converged, "{name}: {}", solution.motion.cost);
    let cost = solution.total();
    assert!((cost / value - 1.0).abs() < 3e-6, "{name}: {cost} instead of {value}");
    assert!(solution.end_defect < defect, "{name}: end defect {}", solution.end_defect);
    let Motion { duality_gap, newton_decrement, stationarity, .. } = solution.motion;
    let small = (0.0..1e-6).contains(&duality_gap) && (0.0..1e-6).contains(&newton_decrement);
    let small = small && (0.0..1e-3).contains(&stationarity);
    assert!(small || solution.polish.is_some(), "{name}: {duality_gap} {newton_decrement} {stationarity}");
    assert!(violation(solution, [1.0; 4]) < 1e-6, "{name}: {:?}", solution.limits);
}

#[test]
fn smooth_motions_have_the_cost_of_the_extremals() {
    for (name, value) in [
        ("two_link", 145.13113754),
        ("pendulum_swing_up", 74.0616592207),
        ("puma560_pick_and_place", 0.0560243685),
        ("ur5_reach", 0.0092904122),
    ] {
        let problem = problem(name);
        let solution = solve(&problem);
        check(&problem, &solution, value, 1e-7);
        assert!(solution.limits.is_empty());
    }
}

#[test]
fn bounded_motions_have_the_cost_of_the_extremals() {
    for (name, value) in [
        ("two_link_bounded", 18.5256788),
        ("two_link_least_time", 2.98227994),
        ("manutec_r3_least_energy", 20.4042467),
        ("puma560_least_time", 0.511448371),
    ] {
        let problem = problem(name);
        let solution = solve(&problem);
        check(&problem, &solution, value, 1e-3);
        // The trajectory keeps the bounds, and uses them.
        let Bounds { u_min, u_max, .. } = problem.bounds.as_ref().unwrap();
        for u in &solution.trajectory.u {
            assert!((0..u.len()).all(|i| (u_min[i]..=u_max[i]).contains(&u[i])), "{name}: {u:?}");
        }
        assert!(!solution.limits.torque.as_ref().unwrap().active.is_empty(), "{name}");
    }
}

/// With limits of rates.
pub fn limited(name: &str, v_max: &[f64]) -> Problem {
    problem(name).with_limits(MotionLimits::none().with_v_max(v_max.to_vec()))
}

/// With limits of positions, rates and torques that are all active; it costs 22.5760933.
pub fn arm_at_its_limits() -> Problem {
    let mut arm = Problem::rest_to_rest(robot("two_link"), &[0.0; 2], &[FRAC_PI_2; 2], 2.0);
    arm.bounds = Some(Bounds::symmetric(vec![12.0, 5.0]));
    arm.limits = MotionLimits::none().with_v_max(vec![INF, 3.0]).with_q_min(vec![-0.5, -INF]);
    arm
}

#[test]
fn limits_of_rates() {
    let problem = limited("two_link", &[INF, 7.0]);
    let solution = solve(&problem);
    check(&problem, &solution, 155.74483972, 1e-6);
    let rate = solution.limits.rate.as_ref().unwrap();
    assert!(rate.at_points <= 1e-8 * 14.0 && rate.between <= 1e-4 * 14.0, "{rate:?}");
    // Not at rest, and of the second joint: it turns at full speed.
    assert!(!rate.active.is_empty(), "{rate:?}");
    for span in &rate.active {
        assert_eq!(span.name, problem.robot.joints()[1].name);
        assert!(span.from > 0.01 && span.to > span.from && span.to < 0.99, "{span:?}");
    }
    assert!(solution.limits.position.is_none() && solution.limits.torque.is_none());
    let most = solution.trajectory.v.iter().map(|v| v[1].abs()).fold(0.0, f64::max);
    assert!((most - 7.0).abs() < 1e-6, "{most}");

    let problem = limited("two_link_least_time", &[0.35, 1.0]);
    let solution = solve(&problem);
    check(&problem, &solution, 3.2300988, 1e-3);
    assert!(violation(&solution, [INF, 0.7, INF, 1.0]) <= 1e-8, "{:?}", solution.limits);
    let mut problem = limited("manutec_r3_least_time", &[3.0, 1.5, 5.2]);
    problem.penalty = None;
    let solution = solve(&problem);
    check(&problem, &solution, 0.49518904, 1e-3);
    assert!(violation(&solution, [INF, 3.0, INF, 1.0]) <= 1e-8, "{:?}", solution.limits);
    // A tighter tolerance leads on from what was solved, on its mesh.
    let solution = solve_with(&problem, SolverOptions::default().with_tolerance(1e-7));
    assert_eq!(solution.motion.status, Status::Converged);
    assert!((solution.total() / 0.49518904 - 1.0).abs() < 1e-7, "{}", solution.total());
    assert!(violation(&solution, [INF, 3.0, INF, 100.0]) <= 1e-7, "{:?}", solution.limits);
}

#[test]
fn limits_of_positions_and_torques() {
    // A swing to the upright position in three seconds goes backwards first; the limit cuts that.
    let mut problem = Problem::rest_to_rest(robot("pendulum"), &[0.0], &[PI], 3.0)
        .with_limits(MotionLimits::none().with_q_min(vec![-0.7]));
    problem.cost = Objective::new(0.0, vec![1.0]);
    let solution = solve_with(&problem, SolverOptions::default().with_tolerance(1e-6).with_starts(4));
    let arm = arm_at_its_limits();
    let arm_solution = solve(&arm);
    check(&problem, &solution, 19.4870292, 1e-6);
    assert!(violation(&solution, [0.7, INF, INF, INF]) <= 1e-8, "{:?}", solution.limits);
    let active = &solution.limits.position.as_ref().unwrap().active;
    assert!(active.iter().all(|span| span.side == "min") && !active.is_empty(), "{active:?}");
    let totals: Vec<f64> = solution.starts.iter().map(|start| start.total).collect();
    // Starts beside the best one are as rough as their first stage.
    assert!(totals.len() == 4 && totals.contains(&solution.total()), "{totals:?}");
    assert!(totals.iter().all(|&total| (total / solution.total() - 1.0).abs() < 1e-4), "{totals:?}");

    check(&arm, &arm_solution, 22.5760933, 1e-4);
    assert!(violation(&arm_solution, [1.0, 6.0, INF, 10.0]) <= 1e-8, "{:?}", arm_solution.limits);
    for kind in ["position", "rate", "torque"] {
        let found = arm_solution.limits.kinds().find(|(name, _)| *name == kind).unwrap().1;
        assert!(found.is_some_and(|usage| !usage.active.is_empty()), "{kind}");
    }
}

/// At a tight tolerance costs have the first eight digits of the values.
#[test]
fn limits_to_eight_digits() {
    let swing = Problem::rest_to_rest(robot("pendulum"), &[0.0], &[PI], 3.0)
        .with_limits(MotionLimits::none().with_q_min(vec![-0.7]));
    for (problem, value, digits) in [
        (limited("two_link", &[INF, 7.0]), 155.74483972, 1e-8),
        (limited("two_link_least_time", &[0.35, 1.0]), 3.2300988, 2e-8),
        (swing, 19.4870292, 1e-8),
    ] {
        let options = SolverOptions::default().with_tolerance(1e-6).with_polish(Polish::Never).with_starts(4);
        let solution = solve_with(&problem, options.with_tolerance(1e-8));
        assert_eq!(solution.motion.status, Status::Converged, "{value}");
        assert!((solution.total() / value - 1.0).abs() < digits, "{value}: {}", solution.total());
    }
}

#[test]
fn limits_of_accelerations_and_torques() {
    // From 0 to 1 in T with |a| <= A: the bang-bang time 2 / sqrt(A); torque and effort of a unit mass are
    // the same.
    let time = |limits: MotionLimits| {
        let mut problem = Problem::rest_to_rest(crate::sledge(), &[0.0], &[1.0], 3.0).with_limits(limits);
        problem.time = FinalTime::Free { guess: 3.0 };
        problem.cost = Objective::new(1.0, vec![0.0]);
        problem.bounds = None;
        Solver::new(&problem, SolverOptions::default().with_tolerance(1e-6)).map(Solver::solve)
    };
    let limits = MotionLimits::none();
    // Nothing bounds the control.
    assert!(matches!(time(limits.clone().with_a_max(vec![4.0])), Err(ProblemError::UnboundedEffort { .. })));
    for (limits, value) in [
        (limits.clone().with_torque_max(vec![4.0]), 1.0),
        (limits.clone().with_torque_max(vec![9.0]).with_a_max(vec![4.0]), 1.0),
        // Up to v = 1 in 1/4 s, and as long down: 1/4 m; the rest takes 3/4 s.
        (limits.with_torque_max(vec![4.0]).with_v_max(vec![1.0]), 1.25),
    ] {
        let solution = time(limits.clone()).unwrap();

        assert_eq!(solution.motion.status, Status::Converged, "{limits:?}");
        assert!(
            (solution.motion.final_time - value).abs() < 3e-6,
            "{} {limits:?}",
            solution.motion.final_time
        );
    }
}

#[test]
fn a_saved_motion_is_a_start() {
    let problem = limited("two_link", &[INF, 7.0]);
    let solution = solve(&problem);
    let saved: Solution = serde_json::from_str(&serde_json::to_string(&solution).unwrap()).unwrap();
    assert_eq!(saved.limits, solution.limits);
    assert_eq!(saved.motion.status, Status::Converged);
    let solver = Solver::new(&problem, SolverOptions::default().with_tolerance(1e-6)).unwrap();
    let again = solver.with_start(&saved.trajectory).unwrap().solve();
    check(&problem, &again, 155.74483972, 1e-6);
    // The pendulum keeps the side from which it starts: the worse motion stays what it is.
    let mut swing = Problem::rest_to_rest(robot("pendulum"), &[0.0], &[PI], 3.0)
        .with_limits(MotionLimits::none().with_q_min(vec![-0.7]));
    let back = solve_with(&swing, SolverOptions::default().with_tolerance(1e-6).with_starts(4));
    swing.limits = MotionLimits::none().with_q_min(vec![-0.6]);
    let solver = Solver::new(&swing, SolverOptions::default().with_tolerance(1e-6)).unwrap();
    let warm = solver.with_start(&back.trajectory).unwrap().solve();
    assert_eq!(warm.motion.status, Status::Converged);
    assert!(warm.total() > back.total() && warm.total() < 1.1 * back.total(), "{}", warm.total());
}

#[test]
fn a_search_that_is_stopped_keeps_its_motion() {
    let problem = limited("two_link", &[INF, 7.0]);
    let solver =
        || Solver::new(&problem, SolverOptions::default().with_tolerance(1e-6).with_starts(3)).unwrap();
    let cancel = Cancel::new();
    cancel.cancel();
    let stopped = solver().with_cancel(cancel).solve();
    assert_eq!(stopped.motion.status, Status::Cancelled);
    assert!(stopped.motion.iterations.is_empty() && stopped.starts.len() == 1);
    assert!(stopped.trajectory.t.len() > 1);
    let options =
        |threads| SolverOptions::default().with_tolerance(1e-6).with_starts(3).with_threads(threads);
    for threads in [1, 2] {
        let mut steps = 0;
        let solver = Solver::new(&problem, options(threads)).unwrap().on_iteration(|step| {
            assert_eq!(step.phase, Phase::Direct);
            steps += 1;
            if steps == 2 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        let stopped = solver.solve();
        assert_eq!(stopped.motion.status, Status::Cancelled);
        // Which of two threads makes the steps is left to chance; each of them may finish the step that it
        // is in. The last iteration on a mesh makes no step.
        let own = stopped.motion.iterations.len();
        assert!(if threads == 1 { own == 2 } else { own <= 2 }, "{own}");
        assert!((own..=2 * threads).contains(&stopped.newton_iterations), "{}", stopped.newton_iterations);
        assert!(stopped.trajectory.t.len() > 1 && stopped.total().is_finite());
    }
    let limited = SolverOptions::default().with_time_limit(Duration::from_nanos(1));
    let late = solve_with(&problem, limited);
    assert_eq!(late.motion.status, Status::TimeLimit);
    assert!(late.trajectory.t.len() > 1);
}

#[test]
fn motions_that_cost_nothing() {
    // At rest without gravity: nothing to do, with limits and without.
    let mut rest = problem("two_link");
    rest.end = rest.start.clone();
    for limits in [MotionLimits::none(), MotionLimits::none().with_v_max(vec![1.0, 1.0])] {
        let solution = solve(&rest.clone().with_limits(limits));
        assert_eq!(solution.motion.status, Status::Converged, "{}", solution.total());
        assert!(solution.total().abs() < 1e-9, "{}", solution.total());
    }
}

#[test]
fn a_free_end_and_terms_of_the_user() {
    let problem = problem("puma560_free_flange");
    let extremal = solve_with(&problem, sharp());
    let solution = solve(&problem);
    check(&problem, &solution, extremal.total(), 1e-6);
    // The joint that is free ends where the extremal ends, elsewhere than given.
    let end = |solution: &Solution| solution.trajectory.q.last().unwrap()[problem.end.q_free[0]];
    assert!((end(&solution) - end(&extremal)).abs() < 1e-3, "{} {}", end(&solution), end(&extremal));
    assert!((end(&solution) - problem.end.q[problem.end.q_free[0]]).abs() > 1e-2);

    /// Squares of positions and rates.
    struct Squares;
    impl RunningCost for Squares {
        fn evaluate<S: Scalar>(&self, q: &[S], v: &[S]) -> S {
            q.iter().chain(v).fold(S::zero(), |sum, &z| sum + z * z).times(0.5)
        }
    }
    let problem = self::problem("two_link").with_term(UserTerm::new(Squares));
    let extremal = solve_with(&problem, sharp());
    let solution = solve(&problem);
    check(&problem, &solution, extremal.total(), 1e-6);
    assert!(solution.total() > 146.0, "{}", solution.total());
}
