//! Motions of robots with floating and spherical joints that are refused, by name and with the remedy.

use super::free_joints::{INF, flyer, turned};
use costate::robot::ConstraintSpec;
use costate_control::{
    BoundaryState, FinalTime, FreeMotionError, Gait, Method, MotionLimits, Objective, Problem, ProblemError,
    Resolve, SolverOptions,
};

#[test]
fn what_is_not_taken_is_named() {
    let start = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.5];
    let end = [&[0.0; 3][..], &turned([0.0, 0.0, 0.3]), &[1.5, -0.8]].concat();
    let base = || {
        let free = [0, 1, 2];
        let problem = Problem::rest_to_rest(flyer([0.0; 3]), &start, &end, 1.0);
        let end = problem.end.clone().with_q_free(&free);
        problem.with_end(end)
    };
    let refused = |problem: Problem| problem.check_for(Method::Direct).unwrap_err();
    base().check_for(Method::Direct).unwrap();
    let limits = MotionLimits::none;
    let not_taken = [
        (base().with_limits(limits().with_v_max(vec![1.0; 8])), "limits.v_max"),
        (base().with_limits(limits().with_a_max(vec![1.0; 8])), "limits.a_max"),
        (base().with_limits(limits().with_jerk_max(vec![1.0; 8])), "limits.jerk_max"),
        (base().with_limits(limits().with_power_max(vec![1.0; 8])), "limits.power_max"),
        (base().with_limits(limits().with_total_power_max(1.0)), "limits.total_power_max"),
        (base().with_cost(Objective::new(0.0, vec![1.0; 8]).with_energy(vec![1.0; 8])), "cost.energy"),
        (base().with_period(vec![0.0; 8]), "periodic.shift"),
        (base().with_start(BoundaryState::fixed(&start, &[0.0; 8]).with_q_free(&[7])), "start.q_free"),
        (base().with_start(BoundaryState::fixed(&start, &[0.0; 8]).with_v_free(&[7])), "start.v_free"),
    ];
    for (problem, key) in not_taken {
        let error = refused(problem);
        let ProblemError::Free { cause: FreeMotionError::NotTaken { joint, .. } } = &error else {
            panic!("{key}: {error}")
        };
        assert_eq!((joint.as_str(), error.key().unwrap().to_string()), ("root", key.to_owned()));
    }
    // A gait whose feet do not exist: they are not looked for.
    let error = refused(base().with_gait(Gait::new(&["nonsense"], &["foot"], "root_x", 0.3)));
    assert!(
        matches!(&error, ProblemError::Free { cause: FreeMotionError::Gait { joint } } if joint == "root")
    );
    assert_eq!(error.key().unwrap().to_string(), "gait.stance");
    assert!(error.to_string().contains("prismatic and revolute joints"), "{error}");
    let gear = ConstraintSpec::coupling("gear", &[("a", 1.0), ("b", -1.0)], 0.5);
    let mut geared = base();
    geared.robot = geared.robot.with_constraint(gear).unwrap();
    let error = refused(geared);
    let ProblemError::Free { cause: FreeMotionError::Constraint { constraint, joint } } = &error else {
        panic!("{error}")
    };
    assert_eq!((constraint.as_str(), joint.as_str()), ("gear", "root"));
    assert!(error.to_string().contains("the first of which is 'gear'"), "{error}");
    let mut wrong = start;
    wrong[6] = 1.1;
    let error = refused(base().with_start(BoundaryState::fixed(&wrong, &[0.0; 8])));
    assert!(error.to_string().contains("q[3] to q[6], has length 1.1"), "{error}");
    let error = refused(base().with_start(BoundaryState::fixed(&start[..8], &[0.0; 8])));
    assert!(error.to_string().contains("has 8 entries, and the robot 9 positions"), "{error}");
    let error = refused(base().with_limits(limits().with_torque_max(vec![0.0; 8])));
    assert!(error.to_string().contains("nothing drives the robot"), "{error}");
    let lower = [&[-1.0][..], &[-INF; 7]].concat();
    let error = refused(base().with_limits(limits().with_q_min(lower)));
    assert!(error.to_string().contains("'root_x'"), "{error}");
    // Other methods, and what solves again.
    for method in [Method::Collocation, Method::Shooting] {
        assert!(matches!(base().check_for(method), Err(ProblemError::FreeJoint { .. })));
    }
    let again = Resolve::new(&base(), SolverOptions::default());
    assert!(matches!(again, Err(ProblemError::FreeJoint { joint, .. }) if joint == "root"));
}

#[test]
fn ends_that_no_motion_meets_are_named() {
    let start = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.5];
    let place = [&[0.3, 0.0, 0.0][..], &turned([0.0, 0.0, 0.3]), &[1.5, -0.8]].concat();
    let problem = |end: BoundaryState| {
        let problem = Problem::rest_to_rest(flyer([0.0; 3]), &start, &place, 1.0).with_end(end);
        problem.check_for(Method::Direct).map(drop)
    };
    let end = |v: &[f64]| BoundaryState::fixed(&place, v);
    let Err(ProblemError::Free { cause: FreeMotionError::CentreOfMass { position, joint } }) =
        problem(end(&[0.0; 8]))
    else {
        panic!()
    };
    assert_eq!(joint, "root");
    // With the position that it tells the end is met.
    let mut there = place.clone();
    there[..3].copy_from_slice(&position);
    problem(BoundaryState::fixed(&there, &[0.0; 8])).unwrap();
    let moving = [&[0.0; 6][..], &[1.0, 0.0]].concat();
    let free = [0, 1, 2];
    let error = problem(BoundaryState::fixed(&there, &moving)).unwrap_err();
    assert!(error.to_string().contains("the momentum of what it carries is known"), "{error}");
    let error = problem(end(&moving).with_q_free(&free)).unwrap_err();
    assert!(error.to_string().contains("with the position of 'root_x' free"), "{error}");
    let error = problem(end(&[0.0; 8]).with_q_free(&[0, 1, 2, 3, 4])).unwrap_err();
    assert!(error.to_string().contains("two angles of joint 'root' are free"), "{error}");
    let error = problem(BoundaryState::fixed(&there, &[0.0; 8]).with_v_free(&[7])).unwrap_err();
    assert!(error.to_string().contains("2 rates are left to choose, but 7 are given"), "{error}");
    // What falls is somewhere at one time only.
    let falling = Problem::rest_to_rest(flyer([0.0, 0.0, -3.0]), &start, &place, 1.0)
        .with_cost(Objective::new(1.0, vec![1.0; 8]))
        .with_time(FinalTime::Free { guess: 1.0 });
    let error = falling.check_for(Method::Direct).unwrap_err();
    assert!(error.to_string().contains("give time.final"), "{error}");
    assert_eq!(error.key().unwrap().to_string(), "time.free");
}
