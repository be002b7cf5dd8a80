//! Derivatives of the cost by parameters of the robot where a solution does not tell all multipliers: tools,
//! bodies, vias, periodic motions, continuous accelerations; against solving again.

use crate::kinds::{arm, at_rest, periodic, with_vias};
use crate::sensitivity::{check_against_slopes, direct, solve, two_link};
use costate_control::{
    Collision, Keep, Kept, LinkCapsule, MotionLimits, Objective, Obstacle, Problem, Resolve, ResolveStatus,
    SensitivityError, Shape, Solution, Task, Tool, ToolCost, ToolPose, cost_by_parameters,
};
use std::f64::consts::PI;

const FREE: f64 = f64::INFINITY;
/// A mass, an inertia, a length.
const NAMES: [&str; 3] = ["elbow.mass", "shoulder.J_zz", "elbow.x"];

#[test]
fn lengths_move_tools() {
    let (arm, _) = two_link();
    let mut reach = arm
        .clone()
        .with_task(Task::default().with_end_tool(ToolPose::of("tip").with_position([FREE, 1.2, FREE])));
    reach.end.q_free = vec![0, 1];
    check_against_slopes(&reach, &NAMES, &direct(1e-8), 1e-4);
    let pose = ToolPose::of("tip").with_position([0.5, 1.5, FREE]);
    let costly = arm.clone().with_task(Task::default().with_tool_cost(ToolCost::new(pose, 200.0, 0.0)));
    check_against_slopes(&costly, &NAMES, &direct(1e-8), 1e-4);
    let plane = Kept::Plane { through: [1.0, 0.0, 0.0], normal: [1.0, 0.0, 0.0], distance: 1.2 };
    for kept in [Kept::Speed { max: 5.0 }, Kept::Acceleration { max: 26.0 }, plane] {
        let tip = Tool::new("elbow").with_offset([1.0, 0.0, 0.0]);
        let mut keeping = arm.clone().with_task(Task::default().with_keep(Keep::new(tip, kept.clone())));
        if matches!(kept, Kept::Plane { .. }) {
            (keeping.start.q, keeping.end.q) = (vec![0.3, 0.4], vec![1.4, -0.6]);
        }
        check_against_slopes(&keeping, &NAMES, &direct(1e-8), 1e-3);
    }
}

#[test]
fn lengths_move_bodies() {
    let along = |z: f64| [0.34, 0.59, z];
    let disc = Obstacle::new("disc", Shape::Capsule { from: along(-1.0), to: along(1.0), radius: 0.25 });
    let body = LinkCapsule::sphere("joint:elbow", 0.0).with_from([1.0, 0.0, 0.0]).with_name("tip");
    let task = Task::default().with_obstacle(disc).with_collision(Collision::of(vec![body]));
    let solution = check_on_mesh(&two_link().0.with_task(task), 1e-6, 5e-3);
    assert!(!solution.limits.task.unwrap().active.is_empty(), "the disc is in the way");
}

#[test]
fn vias_are_no_obstacle() {
    let none = MotionLimits::none;
    for problem in [with_vias(none(), false), with_vias(none(), true)] {
        check_against_slopes(&problem, &NAMES, &direct(1e-5), 2e-3);
    }
}

#[test]
fn periods_are_no_obstacle() {
    let mut turn = periodic(MotionLimits::none(), true);
    turn.robot = turn.robot.with_gravity([0.0, -9.81, 0.0]).unwrap();
    check_on_mesh(&turn, 1e-5, 1e-3);
}

/// Against solving again on the mesh of the solution.
fn check_on_mesh(problem: &Problem, tolerance: f64, within: f64) -> Solution {
    let set = problem.parameters();
    let solution = solve(problem, direct(tolerance));
    let found = cost_by_parameters(problem, &solution, &set).unwrap();
    for name in NAMES {
        let at = set.names().iter().position(|one| one == name).unwrap();
        let cost = |step: f64| {
            let (mut values, mut changed) = (set.values().to_vec(), problem.clone());
            values[at] += step;
            changed.robot = set.robot_with(&values).unwrap();
            let mut motion = Resolve::near(&changed, direct(1e-7), &solution.trajectory).unwrap();
            let found = motion.solve().unwrap();
            assert_eq!(found.status, ResolveStatus::Solved, "{name} {step}");
            found.cost
        };
        let expected = (cost(1e-3) - cost(-1e-3)) / 2e-3;
        let found = found[at].derivative;
        assert!(expected.abs() > 1e-2 * solution.total(), "{name}: {expected}");
        assert!((found - expected).abs() < within * expected.abs(), "{name}: {found} {expected}");
    }
    solution
}

#[test]
fn continuous_accelerations_are_no_obstacle() {
    let none = MotionLimits::none;
    let costly = |time: f64| {
        Objective::new(time, vec![1.0; 2]).with_jerk(vec![1e-2; 2]).with_torque_rate(vec![1e-3; 2])
    };
    let limited = none().with_torque_rate_max(vec![FREE, 90.0]).with_jerk_max(vec![200.0, FREE]);
    let with_vias = with_vias(none(), true).with_cost(costly(60.0));
    for problem in [arm(none()).with_cost(costly(0.0)), with_vias] {
        check_against_slopes(&problem, &NAMES, &direct(1e-6), 1e-3);
    }
    // Polynomials overshoot where the jerk jumps from one limit to the other: with a tolerance of 1e-6, one
    // in eight motions that differ by rounding errors does not keep its limits between the points.
    check_on_mesh(&at_rest(arm(limited)), 1e-5, 1e-3);
}

/// Both ends are given on a line that the tip keeps: with another length they are not.
#[test]
fn ends_that_leave_an_equation_are_named() {
    let (mut arm, set) = two_link();
    let line = Kept::Plane { through: [0.0, 1.0, 0.0], normal: [0.0, 1.0, 0.0], distance: 0.0 };
    // sin q1 + sin (q1 + q2) = 1.
    (arm.start.q, arm.end.q) = (vec![PI / 6.0, 0.0], vec![PI / 2.0, PI / 2.0]);
    let held = arm.with_task(Task::default().with_keep(Keep::new("tip", line)));
    let solution = solve(&held, direct(1e-6));
    let error = cost_by_parameters(&held, &solution, &set).unwrap_err();
    let SensitivityError::GivenEnd { name, row } = &error else { panic!("{error}") };
    assert_eq!((name.as_str(), row.as_str()), ("elbow.x", "distance from the plane of the tool 'tip'"));
}
