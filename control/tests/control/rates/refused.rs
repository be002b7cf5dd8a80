//! Limits, costs and accelerations that are refused, and what does not take them.

use super::{INF, arm, at_rest, none, solve};
use costate_control::{
    BoundaryState, Continuation, ContinuationCause, Method, MotionLimits, Objective, Parameter,
    PolishOutcome, Problem, ProblemError, Solver, SolverOptions,
};

#[test]
fn wrong_limits_costs_and_accelerations_are_refused() {
    let refused = |problem: &Problem| Solver::new(problem, SolverOptions::default()).unwrap_err().to_string();
    let cost = || Objective::new(0.0, vec![1.0; 2]);
    let from = |a: &[f64]| {
        let problem = arm(none().with_a_max(vec![5.0; 2]));
        let start = BoundaryState::fixed(&problem.start.q, &problem.start.v).with_a(a);
        problem.with_start(start)
    };
    for (problem, key, what) in [
        (arm(none().with_jerk_max(vec![1.0])), "limits.jerk_max", "1 entry"),
        (arm(none().with_jerk_max(vec![1.0, f64::NAN])), "limits.jerk_max", "elbow"),
        (arm(none().with_jerk_max(vec![0.0, 1.0])), "limits.jerk_max", "shoulder"),
        (arm(none().with_jerk_max(vec![1.0, -1.0])), "limits.jerk_max", "elbow"),
        (arm(none().with_torque_rate_max(vec![1.0; 3])), "limits.torque_rate_max", "3 entries"),
        (arm(none().with_torque_rate_max(vec![f64::NAN, 1.0])), "limits.torque_rate_max", "shoulder"),
        (arm(none().with_torque_rate_max(vec![1.0, 0.0])), "limits.torque_rate_max", "elbow"),
        (arm(none()).with_cost(cost().with_jerk(vec![1.0])), "cost.jerk", "1 entry"),
        (arm(none()).with_cost(cost().with_jerk(vec![1.0, -1.0])), "cost.jerk", "elbow"),
        (arm(none()).with_cost(cost().with_torque_rate(vec![INF, 1.0])), "cost.torque_rate", "shoulder"),
        (from(&[0.0]), "start.a", "1 entry"),
        (from(&[0.0, f64::NAN]), "start.a", "elbow"),
        (from(&[6.0, 0.0]), "start.a", "shoulder"),
    ] {
        let error = refused(&problem);
        assert!(error.starts_with(key) && error.contains(what), "{error}");
    }
    // A cost of jerks alone is one, and bounds a control that costs nothing.
    let mut only = arm(none()).with_cost(Objective::new(0.0, vec![0.0; 2]).with_jerk(vec![1.0; 2]));
    assert!(Solver::new(&only, SolverOptions::default()).is_ok());
    only.cost.jerk = Some(vec![1.0, 0.0]);
    assert!(refused(&only).contains("'elbow'"), "{}", refused(&only));
}

/// Where nothing is left to choose, torques and powers are checked before.
#[test]
fn ends_that_need_too_much_are_refused() {
    let refused = |limits: MotionLimits, v: [f64; 2]| {
        let mut problem = arm(limits.with_jerk_max(vec![1e3; 2]));
        // Of the unit arm stretched out: M = [[20/3, 17/6], [17/6, 4/3]].
        problem.start = BoundaryState::fixed(&[0.0; 2], &v).with_a(&[3.0, 0.0]);
        Solver::new(&problem, SolverOptions::default()).map_err(|error| error.to_string()).err()
    };
    let torque = |limit: f64| refused(none().with_torque_max(vec![30.0, limit]), [0.0; 2]);
    assert_eq!(torque(8.51), None);
    let error = torque(8.4).unwrap();
    assert!(error.starts_with("start.a") && error.contains("'elbow'") && error.contains("torque"), "{error}");
    assert!(error.contains("8.5") && error.contains("8.4"), "{error}");
    let power = |limit: f64| refused(none().with_power_max(vec![limit, INF]), [0.1, 0.0]);
    assert_eq!(power(2.01), None);
    assert!(power(1.99).unwrap().contains("power"));
    let total = |limit: f64| refused(none().with_total_power_max(limit), [0.1, 0.0]);
    assert_eq!(total(2.01), None);
    assert!(total(1.99).unwrap().contains("all joints"));
    // At 2 rad/s half of 30 N m is left.
    let speeds = none().with_torque_max(vec![30.0; 2]).with_torque_speed(vec![1.0; 2], vec![3.0; 2]);
    let error = refused(speeds.clone(), [2.0, 0.0]).unwrap();
    assert!(error.contains("'shoulder'") && error.contains("limit 15"), "{error}");
    assert_eq!(refused(speeds, [-2.0, 0.0]), None);
}

#[test]
fn what_does_not_take_jerks_refuses_them() {
    let costly = arm(none()).with_cost(Objective::new(0.0, vec![1.0; 2]).with_jerk(vec![1e-3; 2]));
    let limited = arm(none().with_torque_rate_max(vec![60.0, INF]));
    let given = at_rest(arm(none()));
    for method in [Method::Collocation, Method::Shooting] {
        let error = |problem: &Problem| {
            Solver::new(problem, SolverOptions::default().with_method(method)).unwrap_err()
        };
        assert_eq!(error(&limited), ProblemError::LimitsNeedDirect);
        assert!(error(&costly).to_string().starts_with("cost.jerk: "), "{}", error(&costly));
        assert!(error(&given).to_string().starts_with("start.a: "), "{}", error(&given));
        assert!(matches!(error(&given), ProblemError::RatesNeedDirect { .. }));
        let free = arm(none()).with_cost(Objective::new(0.0, vec![1.0; 2]).with_jerk(vec![0.0; 2]));
        assert!(Solver::new(&free, SolverOptions::default().with_method(method)).is_ok());
    }
    for problem in [&costly, &limited] {
        assert_eq!(solve(problem).polish.as_ref().unwrap().outcome, PolishOutcome::Limited);
    }
    let error =
        Continuation::new(&costly, Parameter::FinalTime, 1.0, 2.0, SolverOptions::default()).unwrap_err();
    let ProblemError::Continuation { cause, .. } = error else { panic!("{error}") };
    assert_eq!(cause, ContinuationCause::Rates);
}
