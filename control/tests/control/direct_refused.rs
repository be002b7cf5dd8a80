//! Problems that the direct method cannot solve, and those that only it can.

use crate::direct::{INF, limited, problem, robot, solve};
use costate::robot::LoadOptions;
use costate_control::{
    Continuation, Method, MotionLimits, Parameter, Problem, ProblemError, ProblemFile, Solution, Solver,
    SolverOptions, Status,
};
use std::f64::consts::FRAC_PI_2;

#[test]
fn limits_that_no_motion_can_keep_are_errors() {
    let arm = |limits| problem("two_link").with_limits(limits);
    let refused = |problem: &Problem| Solver::new(problem, SolverOptions::default()).unwrap_err().to_string();
    let names: Vec<_> = robot("two_link").joints().iter().map(|joint| joint.name.clone()).collect();
    let none = MotionLimits::none;
    for (limits, key, joint) in [
        (none().with_q_min(vec![0.1, -INF]), "start.q", 0),
        (none().with_q_max(vec![INF, 1.5]), "end.q", 1),
        (none().with_q_min(vec![-1.0, 3.0]).with_q_max(vec![2.0, 2.0]), "limits.q_min", 1),
        (none().with_v_max(vec![1.0, 0.0]), "limits.v_max", 1),
        (none().with_a_max(vec![-1.0, 1.0]), "limits.a_max", 0),
        (none().with_torque_max(vec![1.0, f64::NAN]), "limits.torque_max", 1),
    ] {
        let error = refused(&arm(limits));
        assert!(error.starts_with(key) && error.contains(&names[joint]), "{error}");
    }
    let mut fast = arm(none().with_v_max(vec![1.0, 1.0]));
    fast.start.v = vec![0.0, -1.2];
    assert!(refused(&fast).starts_with("start.v") && refused(&fast).contains("-1.2"), "{}", refused(&fast));
    let error = refused(&arm(none().with_q_min(vec![0.0])));
    assert!(error.starts_with("limits.q_min") && error.contains("1 entry"), "{error}");
    // Limits of the robot's own.
    let file = ProblemFile::read("../examples/problems/ur5_reach.toml", LoadOptions::default()).unwrap();
    let mut beyond = file.problem.with_limits(MotionLimits::default());
    beyond.end.q[3] = -6.5;
    let error = refused(&beyond);
    assert!(error.starts_with("end.q") && error.contains("wrist_1_joint"), "{error}");
    assert!(Solver::new(&beyond.with_limits(none()), SolverOptions::default()).is_ok());
}

#[test]
fn limits_need_the_direct_method() {
    let limited = limited("two_link", &[INF, 7.0]);
    let error = Solver::new(&limited, SolverOptions::of(Method::Collocation)).unwrap_err();
    assert_eq!(error, ProblemError::LimitsNeedDirect);
    assert!(error.to_string().starts_with("method"), "{error}");
    let options = SolverOptions::default();
    let error = Continuation::new(&limited, Parameter::FinalTime, 1.0, 2.0, options).unwrap_err();
    assert!(error.to_string().contains("no hard limits"), "{error}");
    // Files: the method follows from the limits.
    let file = |limits: &str, solver: &str| {
        let text = std::fs::read_to_string("../examples/problems/two_link.toml").unwrap();
        let (text, _) = text.split_once("[solver]").unwrap();
        let text = format!("{text}\n[limits]\n{limits}\n[solver]\n{solver}\n");
        ProblemFile::from_text(&text, "../examples/problems", LoadOptions::default())
    };
    assert_eq!(file("v_max = [inf, 7.0]", "").unwrap().options, SolverOptions::default());
    assert_eq!(file("from_robot = false", "").unwrap().options, SolverOptions::default());
    let error = file("v_max = [inf, 7.0]", "method = \"shooting\"").unwrap_err().to_string();
    assert!(error.contains("solver.method") && error.contains("direct"), "{error}");
    let error = file("v_max = [inf, 7.0]\nw_max = [1.0, 1.0]", "").unwrap_err().to_string();
    assert!(error.contains("w_max"), "{error}");
    let error = file("q_max = [1.0, 7.0]", "").unwrap_err().to_string();
    assert!(error.contains("end.q") && error.contains("shoulder"), "{error}");
}

#[test]
fn a_time_that_is_too_short_is_told() {
    // A quarter turn in one second needs more than 1 rad/s.
    let problem = limited("two_link", &[1.0, INF]);
    let solution = solve(&problem);
    assert_eq!(solution.motion.status, Status::Infeasible);
    assert!(!solution.motion.status.is_solved());
    let rate = solution.limits.rate.as_ref().unwrap();
    // On average it moves at pi/2.
    assert!(rate.at_points > FRAC_PI_2 - 1.0 - 1e-6, "{rate:?}");
    assert!(rate.active.iter().any(|span| span.name == "shoulder"), "{rate:?}");
    let worst = rate.worst.as_ref().unwrap();
    assert!(worst.name == "shoulder" && worst.limit == 1.0 && worst.time > 0.0, "{worst:?}");
    assert!((worst.value - 1.0 - rate.at_points).abs() < 1e-12, "{worst:?}");
    assert_eq!(solution.limits.violations().count(), 1);
    let saved: Solution = serde_json::from_value(serde_json::to_value(&solution).unwrap()).unwrap();
    assert_eq!(saved.limits, solution.limits);
}
