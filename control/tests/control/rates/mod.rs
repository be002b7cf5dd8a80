//! Limits and costs of jerks and of rates of torques, accelerations that are given at the ends.
//!
//! The values are those of `bash benches/ocp/run --values in_phases` (`benches/ocp/harness/in_phases.py`):
//! direct collocation on Radau's points with the state (q, v, a), the jerk as the control and the exact rate
//! of the torques, in CasADi with IPOPT. Elements of four points are split until the cost changes by less
//! than a relative 1e-9.

mod refused;

use costate::robot::{LoadOptions, Robot};
use costate_control::{
    ActiveLimit, BoundaryState, FinalTime, LimitUse, Method, MotionLimits, Objective, Problem, ProblemFile,
    Solution, Solver, SolverOptions, Status,
};
use std::f64::consts::FRAC_PI_2;

const INF: f64 = f64::INFINITY;

/// The unit two-link arm with a quarter turn of both joints in 1 s, least squared torques.
fn arm(limits: MotionLimits) -> Problem {
    let robot = Robot::from_file("../robots/two_link.toml").unwrap();
    Problem::rest_to_rest(robot, &[0.0; 2], &[FRAC_PI_2; 2], 1.0).with_limits(limits)
}

/// Without accelerations at the ends.
fn at_rest(mut problem: Problem) -> Problem {
    for end in [&mut problem.start, &mut problem.end] {
        *end = BoundaryState::fixed(&end.q, &end.v).with_a(&[0.0; 2]);
    }
    problem
}

/// In least time.
fn in_least_time(mut problem: Problem) -> Problem {
    problem.time = FinalTime::Free { guess: 1.2 };
    problem.with_cost(Objective::new(1.0, vec![0.0; 2]))
}

fn none() -> MotionLimits {
    MotionLimits::none()
}

fn solve_to(problem: &Problem, tolerance: f64) -> Solution {
    Solver::new(problem, SolverOptions::default().with_tolerance(tolerance)).unwrap().solve()
}

fn solve(problem: &Problem) -> Solution {
    solve_to(problem, 1e-6)
}

/// Solved with this cost, and driven to the end by its torques.
fn check(solution: &Solution, value: f64, part: f64) {
    let cost = solution.total();
    assert_eq!(solution.motion.status, Status::Converged, "{cost}");
    assert!((cost / value - 1.0).abs() < part, "{cost} instead of {value}");
    assert!(solution.end_defect < 1e-3, "{}", solution.end_defect);
}

/// Kept at the points to 1e-7 of the range, and active for the joints of these names alone.
fn kept(usage: Option<&LimitUse>, range: f64, names: &[&str]) {
    let usage = usage.unwrap();
    assert!(usage.at_points <= 1e-7 * range && usage.worst.is_none(), "{usage:?}");
    let found = |ActiveLimit { name, .. }: &ActiveLimit| names.contains(&name.as_str());
    assert!(usage.active.iter().all(found), "{usage:?}");
    for name in names {
        let long = usage.active.iter().any(|span| span.name == *name && span.to - span.from > 0.02);
        assert!(long, "{name}: {usage:?}");
    }
}

/// Accelerations are continuous, and the torques of the trajectory are those of its states.
fn check_samples(solution: &Solution, problem: &Problem, jerk_max: [f64; 2]) {
    let samples = solution.sample(problem, 1000.0).unwrap();
    for (t, a) in samples.t.windows(2).zip(samples.a.windows(2)) {
        for i in 0..2 {
            let change = (a[1][i] - a[0][i]).abs();
            // The jerk may overshoot inside of the interval where it jumps.
            assert!(change <= 1.4 * jerk_max[i] * (t[1] - t[0]) + 1e-9, "{} {i}: {change}", t[0]);
        }
    }
}

#[test]
fn jerks_of_a_motion_at_rest() {
    let problem = at_rest(arm(none().with_jerk_max(vec![200.0, 300.0])));
    let solution = solve(&problem);
    check(&solution, 315.38594, 3e-6);
    kept(solution.limits.jerk.as_ref(), 400.0, &["shoulder", "elbow"]);
    assert!(solution.limits.torque_rate.is_none() && solution.limits.torque.is_none());
    check_samples(&solution, &problem, [200.0, 300.0]);
    let accelerations = solution.sample(&problem, 10.0).unwrap().a;
    for a in [&accelerations[0], &accelerations[10]] {
        assert!(a.iter().all(|a| a.abs() < 1e-9), "{a:?}");
    }
}

#[test]
fn jerks_with_free_accelerations_at_the_ends() {
    let problem = arm(none().with_jerk_max(vec![60.0, 120.0]));
    let solution = solve(&problem);
    check(&solution, 522.59880, 3e-6);
    check_samples(&solution, &problem, [60.0, 120.0]);
}

#[test]
fn rates_of_torques() {
    let solution = solve(&arm(none().with_torque_rate_max(vec![75.0, 120.0])));
    check(&solution, 146.15291, 1e-6);
    kept(solution.limits.torque_rate.as_ref(), 150.0, &["shoulder", "elbow"]);
    assert!(solution.limits.jerk.is_none());
}

#[test]
fn costs_of_jerks_and_of_rates_of_torques() {
    let cost = || Objective::new(0.0, vec![1.0; 2]);
    let jerk = solve(&arm(none()).with_cost(cost().with_jerk(vec![1e-3, 2e-3])));
    check(&jerk, 219.26025905, 1e-6);
    let rate = arm(none()).with_cost(cost().with_torque_rate(vec![1e-3, 5e-4]));
    check(&solve(&rate), 148.26055156, 1e-6);
    check(&solve(&at_rest(rate)), 172.08693898, 1e-6);
    // Jerks alone: quintics, 360 d^2/T^5 each.
    let alone = at_rest(arm(none())).with_cost(Objective::new(0.0, vec![0.0; 2]).with_jerk(vec![1.0; 2]));
    check(&solve(&alone), 720.0 * FRAC_PI_2 * FRAC_PI_2, 1e-9);
}

#[test]
fn least_time() {
    let jerk = none().with_jerk_max(vec![60.0, 80.0]);
    let solution = solve(&in_least_time(at_rest(arm(jerk.clone()))));
    check(&solution, 0.94269861, 1e-6);
    // Of the two joints the first one is slower: (32 d/j)^(1/3).
    assert!((solution.total() / (32.0 * FRAC_PI_2 / 60.0_f64).cbrt() - 1.0).abs() < 3e-6);
    let both = jerk.with_torque_rate_max(vec![150.0, 80.0]);
    let solution = solve(&in_least_time(at_rest(arm(both.clone()))));
    check(&solution, 1.27668027, 1e-5);
    kept(solution.limits.torque_rate.as_ref(), 300.0, &["shoulder", "elbow"]);
    let path = "../examples/problems/two_link_jerk.toml";
    let ProblemFile { problem, options, .. } = ProblemFile::read(path, LoadOptions::default()).unwrap();
    assert_eq!(options.method, Method::Direct);
    let solution = Solver::new(&problem, options).unwrap().solve();
    check(&solution, 1.44097521, 1e-5);
    kept(solution.limits.torque.as_ref(), 50.0, &["shoulder", "elbow"]);
}

/// H* is constant, and both H* and the costates are derivatives of the cost; that of time belongs to it.
#[test]
fn costates_and_hamiltonian_are_derivatives_of_the_cost() {
    let cost = Objective::new(80.0, vec![1.0; 2]).with_jerk(vec![1e-3; 2]);
    let problem = at_rest(arm(none())).with_cost(cost);
    let solution = solve_to(&problem, 1e-8);
    assert!(solution.motion.hamiltonian_drift < 1e-4, "{}", solution.motion.hamiltonian_drift);
    let cost = |change: &dyn Fn(&mut Problem, f64)| {
        let at = |step: f64| {
            let mut problem = problem.clone();
            change(&mut problem, step);
            solve_to(&problem, 1e-8).total()
        };
        (at(1e-3) - at(-1e-3)) / 2e-3
    };
    let by_time = cost(&|problem, step| problem.time = FinalTime::Fixed(1.0 + step));
    let hamiltonian = solution.motion.hamiltonian;
    assert!((by_time + hamiltonian).abs() < 1e-4 * hamiltonian.abs(), "{by_time} {hamiltonian}");
    let limits = none().with_torque_rate_max(vec![300.0, 150.0]);
    let limited = solve(&problem.clone().with_limits(limits));
    // The cost of time is that of a second.
    check(&limited, 380.05161, 3e-6);
    // Where rates of torques jump beside a node rather than at it, that interval has another H*.
    assert!(limited.motion.hamiltonian_drift < 2e-2, "{}", limited.motion.hamiltonian_drift);
    // At rest p = M v does not change with q, so y_q is the derivative by q.
    for joint in 0..2 {
        let by_position = cost(&|problem, step| problem.start.q[joint] += step);
        let costate = solution.trajectory.y_q[0][joint];
        assert!((by_position + costate).abs() < 1e-4 * costate.abs().max(1.0), "{by_position} {costate}");
    }
}

/// At the best final time H* is zero.
#[test]
fn the_hamiltonian_vanishes_at_the_best_time() {
    // Jerks alone: 720 d^2/T^5 + c T for both joints, least at T^6 = 3600 d^2/c.
    let cost = Objective::new(50.0, vec![0.0; 2]).with_jerk(vec![1.0; 2]);
    let mut problem = at_rest(arm(none())).with_cost(cost);
    problem.time = FinalTime::Free { guess: 1.5 };
    let solution = solve_to(&problem, 1e-9);
    let time = (3600.0 * FRAC_PI_2 * FRAC_PI_2 / 50.0).powf(1.0 / 6.0);
    assert!((solution.motion.final_time / time - 1.0).abs() < 1e-4, "{}", solution.motion.final_time);
    check(&solution, 1.2 * 50.0 * time, 1e-8);
    assert!(solution.motion.hamiltonian.abs() < 50.0 * 1e-3, "{}", solution.motion.hamiltonian);
}

/// Torques of a joint without a motor stay zero, which takes continuous accelerations into account.
#[test]
fn a_joint_without_a_motor() {
    let robot = Robot::from_file("../robots/cart_pole.toml").unwrap();
    let problem = Problem::rest_to_rest(robot, &[0.0, 0.0], &[0.5, 0.0], 2.0);
    let limits = none().with_torque_max(vec![INF, 0.0]);
    let free = solve(&problem.clone().with_limits(limits.clone()));
    let smooth = solve(&problem.with_limits(limits.with_torque_rate_max(vec![1e4, INF])));
    for solution in [&free, &smooth] {
        assert_eq!(solution.motion.status, Status::Converged, "{:?}", solution.limits);
        assert!(solution.limits.torque.as_ref().unwrap().at_points < 1e-7);
    }
    let torque = smooth.trajectory.u.iter().map(|u| u[1].abs()).fold(0.0, f64::max);
    assert!(torque < 1e-3, "{torque}");
    assert!((smooth.total() / free.total() - 1.0).abs() < 1e-5, "{} {}", smooth.total(), free.total());
}

#[test]
fn a_limit_that_is_too_small_is_told() {
    // A limit of the elbow by which its torque rises within some intervals: beside faster jumps polynomials
    // overshoot, and no final time is told.
    let solution = solve(&at_rest(arm(none().with_jerk_max(vec![20.0, 200.0]))));
    assert_eq!(solution.motion.status, Status::Infeasible);
    let found = solution.limits.infeasible.as_ref().unwrap();
    // From bound to bound a quarter turn takes (32 d/j)^(1/3).
    let needed = 32.0 * FRAC_PI_2;
    let [limit] = &found.limits[..] else { panic!("{found:?}") };
    assert_eq!((&limit.kind[..], &limit.name[..], &limit.unit[..]), ("jerk", "shoulder", "rad/s^3"));
    assert!((limit.amount / (needed - 20.0) - 1.0).abs() < 1.5e-2, "{found:?}");
    assert_eq!(limit.limit.map(f64::abs), Some(20.0));
    let time = (needed / 20.0).cbrt();
    assert!((found.final_time.unwrap() / time - 1.0).abs() < 2e-2, "{found:?} {time}");
    let worst = solution.limits.jerk.as_ref().unwrap().worst.as_ref().unwrap();
    assert!(worst.name == "shoulder" && worst.unit == "rad/s^3" && worst.limit.abs() == 20.0, "{worst:?}");
}

#[test]
fn problem_files_choose_the_direct_method() {
    let file = |text: &str| {
        let start = "robot = \"../../robots/two_link.toml\"\n[start]\nq = [0, 0]\n";
        let end = "[end]\nq = [1, 1]\n[time]\nfinal = 1\n[cost]\neffort = [1, 1]\n";
        let text = text.replace("START", start).replace("END", end);
        ProblemFile::from_text(&text, "../examples/problems", LoadOptions::default()).unwrap()
    };
    let found = file("STARTa = [0.0, 0.1]\nENDjerk = [0.5, 0.5]\n");
    assert_eq!((found.options, found.problem.start.a), (SolverOptions::default(), Some(vec![0.0, 0.1])));
    let found = file("START ENDjerk = [0.5, 0]\ntorque_rate = [0, 2]\n");
    assert_eq!(found.options, SolverOptions::default());
    let expected =
        Objective::new(0.0, vec![1.0; 2]).with_jerk(vec![0.5, 0.0]).with_torque_rate(vec![0.0, 2.0]);
    assert_eq!(found.problem.cost, expected);
    let found = file("START END[limits]\njerk_max = [9, inf]\ntorque_rate_max = [inf, 8]\n");
    assert_eq!(found.options, SolverOptions::default());
    let limits = MotionLimits::default().with_jerk_max(vec![9.0, INF]).with_torque_rate_max(vec![INF, 8.0]);
    assert_eq!(found.problem.limits, limits);
}

/// A motion that is saved and read again has the same figures.
#[test]
fn a_saved_motion_is_a_guess() {
    let problem = at_rest(arm(none().with_jerk_max(vec![200.0, 300.0])));
    let solution = solve(&problem);
    let saved: Solution = serde_json::from_str(&serde_json::to_string(&solution).unwrap()).unwrap();
    assert_eq!(saved.limits, solution.limits);
    let solver = Solver::new(&problem, SolverOptions::default().with_tolerance(1e-6)).unwrap();
    let again = solver.with_start(&saved.trajectory).unwrap().solve();
    assert_eq!(again.motion.status, Status::Converged);
    assert!((again.total() / solution.total() - 1.0).abs() < 3e-6);
}
