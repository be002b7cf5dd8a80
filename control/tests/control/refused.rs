//! Problems that no motion solves, or that no method solves, are refused before they are solved.

use costate::robot::{JointSpec, Limits, LinkInertia, Placement, Robot};
use costate_control::{
    BoundaryState, Collision, Continuation, ContinuationCause, EndError, FinalTime, JointReference, Method,
    MotionLimits, Objective, Obstacle, Parameter, Payload, Problem, ProblemError, Shape, Solver,
    SolverOptions, Task, TaskError, ToolPose, Via, ViaError,
};

const INF: f64 = f64::INFINITY;

fn arm() -> Problem {
    let robot = Robot::from_file("../robots/two_link.toml").unwrap();
    Problem::rest_to_rest(robot, &[0.0; 2], &[1.0, 0.5], 1.0)
}

fn none() -> MotionLimits {
    MotionLimits::none()
}

fn error_with(problem: &Problem, method: Method) -> Option<ProblemError> {
    problem.check_for(method).err()
}

fn error(problem: &Problem) -> Option<ProblemError> {
    error_with(problem, Method::Direct)
}

/// Limits of the robot that are asked for are limits.
#[test]
fn limits_of_the_robot_need_the_direct_method() {
    let asked = arm().with_limits(none().with_from_robot(true));
    for method in [Method::Collocation, Method::Shooting] {
        assert_eq!(error_with(&asked, method), Some(ProblemError::LimitsNeedDirect));
        for other in [arm(), arm().with_limits(none())] {
            assert_eq!(error_with(&other, method), None);
        }
    }
    let options = SolverOptions::default();
    let refused = Continuation::new(&asked, Parameter::FinalTime, 1.0, 1.1, options.clone()).unwrap_err();
    assert!(
        matches!(refused, ProblemError::Continuation { cause: ContinuationCause::Limits, .. }),
        "{refused}"
    );
    assert!(Continuation::new(&arm(), Parameter::FinalTime, 1.0, 1.1, options).is_ok());
}

/// What keeps them by default is told.
#[test]
fn the_key_that_has_limits_of_the_robot_kept_is_told() {
    let mut limited = arm();
    let slow = Limits { velocity: 3.0, ..Limits::default() };
    limited.robot = limited.robot.with_limits("elbow", slow).unwrap();
    let part = |problem: &Problem| problem.keeps_robot_limits_by().map(costate_control::Key::part);
    assert_eq!(part(&limited), None);
    let energy = Objective::new(0.0, vec![1.0; 2]).with_energy(vec![1.0; 2]);
    let costly = limited.clone().with_cost(energy);
    assert_eq!(part(&costly).as_deref(), Some("cost.energy"));
    assert!(costly.keeps_robot_limits());
    assert_eq!(part(&costly.clone().with_limits(none())), None);
    assert_eq!(part(&costly.with_limits(none().with_from_robot(true))), None);
    assert_eq!(part(&limited.clone().with_via(Via::at(&[0.5, 0.2]))).as_deref(), Some("via 1"));
    let reference = JointReference::new(vec![0.0], vec![vec![0.0; 2]], vec![1.0; 2]);
    let following = limited.with_task(Task::default().with_reference(reference));
    assert_eq!(part(&following).as_deref(), Some("cost.reference"));
}

/// Without a limit or a cost of what jumps, an optimal motion leaves a given acceleration by a jump.
#[test]
fn given_accelerations_need_what_keeps_them_from_jumping() {
    let given = |limits: MotionLimits| {
        let problem = arm().with_limits(limits);
        let end = BoundaryState::fixed(&[1.0, 0.5], &[0.0; 2]).with_a(&[0.0; 2]);
        problem.with_end(end)
    };
    let joint = |problem: &Problem| match error(problem) {
        Some(ProblemError::End { key, cause: EndError::AccelerationJumps { joint } }) => {
            assert_eq!(key.to_string(), "end.a");
            Some(joint)
        }
        Some(other) => panic!("{other}"),
        None => None,
    };
    assert_eq!(joint(&given(none())).as_deref(), Some("shoulder"));
    assert_eq!(joint(&given(none().with_jerk_max(vec![1e3, INF]))).as_deref(), Some("elbow"));
    assert_eq!(joint(&given(none().with_jerk_max(vec![1e3; 2]))), None);
    assert_eq!(joint(&given(none().with_torque_rate_max(vec![1e3; 2]))), None);
    // A jump of the elbow would be one of the torque of the shoulder.
    let both = none().with_jerk_max(vec![1e3, INF]).with_torque_rate_max(vec![1e3, INF]);
    assert_eq!(joint(&given(both)), None);
    let cost = |weights: [f64; 2]| Objective::new(0.0, vec![1.0; 2]).with_jerk(weights.to_vec());
    assert_eq!(joint(&given(none()).with_cost(cost([1e-3; 2]))), None);
    assert_eq!(joint(&given(none()).with_cost(cost([1e-3, 0.0]))).as_deref(), Some("elbow"));
}

#[test]
fn robots_need_masses() {
    let joint = |name: &str, mass: f64| {
        let link = LinkInertia::point(mass, [1.0, 0.0, 0.0]);
        JointSpec::revolute(name).axis([0.0, 1.0, 0.0]).carrying(link)
    };
    let robot = |masses: [f64; 2]| {
        let second = joint("second", masses[1]).on("first");
        Robot::builder("arm").joint(joint("first", masses[0])).joint(second).build().unwrap()
    };
    let refused = |robot: Robot, method| {
        let problem = Problem::rest_to_rest(robot, &[0.0; 2], &[1.0; 2], 1.0);
        match error_with(&problem, method) {
            Some(ProblemError::NoMass { joint }) => Some(joint),
            Some(other) => panic!("{other}"),
            None => None,
        }
    };
    for method in [Method::Direct, Method::Collocation] {
        assert_eq!(refused(robot([0.0, 0.0]), method).as_deref(), Some("first"));
        assert_eq!(refused(robot([1.0, 0.0]), method).as_deref(), Some("second"));
        assert_eq!(refused(robot([0.0, 1.0]), method), None);
        let rotors = robot([1.0, 0.0]).with_joint_armature("second", 0.1).unwrap();
        assert_eq!(refused(rotors, method), None);
    }
}

/// A via with a free time that asks nothing else than its neighbour would move there.
#[test]
fn phases_have_a_length() {
    let place = || Via::at(&[0.4, 0.2]);
    let [start, end] = [Via::at(&[0.0; 2]), Via::at(&[1.0, 0.5])];
    let refused = |problem: &Problem| match error(problem) {
        Some(ProblemError::Via { key, cause: ViaError::NoWay { other, .. } }) => {
            Some((key.to_string(), other))
        }
        Some(other) => panic!("{other}"),
        None => None,
    };
    let same = |problem: &Problem, via: &str, other: &str| {
        assert_eq!(refused(problem), Some((format!("{via}, q"), other.to_owned())));
    };
    for time in [FinalTime::Fixed(1.0), FinalTime::Free { guess: 1.0 }] {
        let arm = || arm().with_cost(Objective::new(1.0, vec![1.0; 2])).with_time(time);
        same(&arm().with_via(start.clone().stopping()), "via 1", "the start");
        same(&arm().with_via(start.clone()), "via 1", "the start");
        same(&arm().with_via(end.clone().stopping()), "via 1", "the end");
        same(&arm().with_via(place()).with_via(place()), "via 1", "via 2");
        same(&arm().with_via(place().stopping()).with_via(place().stopping()), "via 1", "via 2");
        // The first one moves to the second one, whenever that is passed.
        same(&arm().with_via(place()).with_via(place().stopping().with_time(0.5)), "via 1", "via 2");
        for legal in [
            arm().with_via(start.clone().stopping().with_time(0.2)),
            arm().with_via(end.clone().stopping().with_time(0.8)),
            arm().with_via(place().stopping().with_time(0.3)).with_via(place().stopping().with_time(0.5)),
            arm().with_via(place()).with_via(Via::at(&[0.4, 0.3])),
            arm().with_via(start.clone().with_v(&[0.1, 0.0])),
            arm().with_via(place().stopping()).with_via(end.clone()).with_via(place().stopping()),
        ] {
            assert_eq!(refused(&legal), None);
        }
    }
    // Waiting before something is loaded costs less than after it; not if time itself is what costs.
    let load = || start.clone().stopping().with_payload(Payload::point("joint:elbow", 1.0, [1.0, 0.0, 0.0]));
    assert_eq!(refused(&arm().with_via(load())), None);
    let free = arm().with_cost(Objective::new(1.0, vec![1.0; 2])).with_time(FinalTime::Free { guess: 1.0 });
    same(&free.with_via(load()), "via 1", "the start");
    // Something that moves may be worth waiting for.
    let reference = JointReference::new(vec![0.0, 1.0], vec![vec![0.0; 2], vec![1.0; 2]], vec![1.0; 2]);
    let following = arm().with_via(start).with_task(Task::default().with_reference(reference));
    assert_eq!(refused(&following), None);
}

/// The elbow starts on its limit and moves outwards, or comes from outside.
#[test]
fn states_at_a_limit_do_not_lead_beyond_it() {
    let limits = none().with_q_min(vec![0.0, -3.0]).with_q_max(vec![1.0, 3.0]);
    let refused = |start: [f64; 2], end: [f64; 2]| {
        let problem = arm().with_limits(limits.clone());
        let problem = problem.with_start(BoundaryState::fixed(&[0.0; 2], &start));
        match error(&problem.with_end(BoundaryState::fixed(&[1.0, 0.5], &end))) {
            Some(ProblemError::End { key, cause: EndError::Leaves { joint, .. } }) => {
                assert_eq!(joint, "shoulder");
                Some(key.to_string())
            }
            Some(other) => panic!("{other}"),
            None => None,
        }
    };
    assert_eq!(refused([-1.0, 0.0], [0.0; 2]).as_deref(), Some("start.v"));
    assert_eq!(refused([1.0, -1.0], [0.0; 2]), None);
    assert_eq!(refused([0.0; 2], [-0.5, 0.0]).as_deref(), Some("end.v"));
    assert_eq!(refused([0.0; 2], [0.5, 0.0]), None);
    // At the limit of a rate there is a way back.
    let fast = arm().with_limits(none().with_v_max(vec![2.0, 2.0]));
    let start = BoundaryState::fixed(&[0.0; 2], &[2.0, 0.0]);
    assert_eq!(error(&fast.clone().with_start(start.clone())), None);
    let fast = fast.with_cost(Objective::new(0.0, vec![1.0; 2]).with_jerk(vec![1e-3; 2]));
    let faster = error(&fast.clone().with_start(start.clone().with_a(&[1.0, 0.0]))).unwrap();
    assert!(faster.to_string().starts_with("start.a: the rate of joint 'shoulder'"), "{faster}");
    assert_eq!(error(&fast.with_start(start.with_a(&[-1.0, 0.0]))), None);
    let through = arm().with_limits(limits).with_via(Via::at(&[1.0, 0.2]).with_v(&[0.5, 0.0]));
    assert!(matches!(error(&through), Some(ProblemError::End { .. })));
}

/// A body of the link that holds the tool is in an obstacle, whatever the joints do.
#[test]
fn tools_whose_bodies_are_in_an_obstacle_are_refused() {
    let reaching = |xyz: [f64; 3], shape: Shape, except: bool| {
        let mut problem = Problem::rest_to_rest(
            Robot::from_file("../robots/ur5.urdf").unwrap(),
            &[0.0, -1.6, 1.8, -1.8, -1.57, 0.0],
            &[0.0, -1.6, 1.8, -1.8, -1.57, 0.0],
            1.5,
        );
        problem.end.q_free = (0..6).collect();
        let mut collision = Collision::default();
        collision.along_links = Some(0.05);
        if except {
            collision.except = vec![["wrist_3_link".into(), "floor".into()]];
        }
        let task = Task::default()
            .with_end_tool(ToolPose::of("tool0").with_position(xyz))
            .with_obstacle(Obstacle::new("floor", shape))
            .with_collision(collision);
        match error(&problem.with_task(task)) {
            Some(ProblemError::Task { key, cause: TaskError::InObstacle { by, what, .. } }) => {
                assert_eq!((key.to_string().as_str(), what.contains("'floor'")), ("end.tool.xyz", true));
                Some(by)
            }
            Some(other) => panic!("{other}"),
            None => None,
        }
    };
    let floor = || Shape::HalfSpace { through: [0.0, 0.0, -0.1], normal: [0.0, 0.0, 1.0] };
    // 0.2 m below the floor with a radius of 0.05 m; the core of the last body is the place of the tool.
    let by = reaching([0.4, 0.3, -0.3], floor(), false).unwrap();
    assert!((by - 0.25).abs() < 1e-12, "{by}");
    let by = reaching([INF, INF, -0.3], floor(), false).unwrap();
    assert!((by - 0.25).abs() < 1e-12, "{by}");
    assert_eq!(reaching([0.4, 0.3, -0.04], floor(), false), None);
    assert_eq!(reaching([0.4, 0.3, -0.3], floor(), true), None);
    let sphere = |radius: f64| Shape::Sphere { centre: [0.4, 0.3, 0.2], radius };
    let by = reaching([0.4, 0.3, 0.3], sphere(0.12), false).unwrap();
    assert!((by - 0.07).abs() < 1e-12, "{by}");
    assert_eq!(reaching([0.4, 0.3, 0.3], sphere(0.04), false), None);
    let case = |size: f64| Shape::Box {
        placement: Placement::from_xyz_rpy([0.4, 0.3, 0.3], [0.0; 3]),
        size: [size; 3],
    };
    let by = reaching([0.4, 0.3, 0.38], case(0.2), false).unwrap();
    assert!((by - 0.07).abs() < 1e-12, "{by}");
}

#[test]
fn knots_that_are_too_close_and_too_many_starts_are_refused() {
    let at = |second: f64| {
        let knots = vec![vec![0.0; 2], vec![0.1, 0.0], vec![0.2, 0.0]];
        let reference = JointReference::new(vec![0.0, second, 1.0], knots, vec![1.0; 2]);
        error(&arm().with_limits(none()).with_task(Task::default().with_reference(reference)))
    };
    let close = at(1e-12).unwrap().to_string();
    assert!(close.contains("times") && close.contains("too close"), "{close}");
    assert_eq!(at(1e-3), None);
    for (options, key) in [
        (SolverOptions::default().with_starts(usize::MAX), "starts"),
        (SolverOptions::default().with_threads(usize::MAX), "threads"),
    ] {
        let refused = Solver::new(&arm(), options).unwrap_err().to_string();
        assert!(refused.starts_with(key) && refused.contains("must be between 1 and"), "{refused}");
    }
}
