//! What tools keep and cost, obstacles and pairs of bodies, limits of positions and all limits of an arm: the
//! costs that an independent program finds.
//!
//! The values are those of `bash benches/ocp/run --values` (`benches/ocp/harness/in_space.py`): direct
//! collocation on Radau's points in CasADi with IPOPT, the conditions written out for the arm (angles of
//! links as sums of joint angles, lines as differences of coordinates), 320 elements of three points each.
//! Values of 160 elements differ by less than a relative 2e-6, of the box in the way by 2e-5. Those of whole
//! arms are from 160 elements; 80 differ by 2e-8 and 1.2e-5.

use costate::robot::{LoadOptions, Placement, Robot};
use costate_control::{
    BodyPairs, Collision, Keep, Kept, LinkCapsule, MotionLimits, Objective, Obstacle, Polish, Problem,
    ProblemFile, Shape, Solution, Solver, SolverOptions, Status, Task, Tool, ToolCost, ToolPose,
};
use nalgebra::{Rotation3, Vector3};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

const FREE: f64 = f64::INFINITY;

/// The unit two-link arm, in 1 s, least squared torques.
fn arm(from: [f64; 2], to: [f64; 2], task: Task) -> Problem {
    let robot = Robot::from_file("../robots/two_link.toml").unwrap();
    Problem::rest_to_rest(robot, &from, &to, 1.0).with_limits(MotionLimits::none()).with_task(task)
}

fn quarter(task: Task) -> Problem {
    arm([0.0; 2], [FRAC_PI_2; 2], task)
}

/// The position with the tip there, bent to the right.
fn elbow([x, y]: [f64; 2]) -> [f64; 2] {
    let bend = ((x * x + y * y - 2.0) / 2.0).acos();
    [y.atan2(x) - bend.sin().atan2(1.0 + bend.cos()), bend]
}

/// The tip from one place to another one above it.
fn along(task: Task) -> Problem {
    arm(elbow([1.2, -0.6]), elbow([1.2, 0.6]), task)
}

fn tip() -> Tool {
    Tool::new("joint:elbow").with_offset([1.0, 0.0, 0.0])
}

/// A ball at the tip.
fn ball(radius: f64) -> LinkCapsule {
    LinkCapsule::sphere("joint:elbow", radius).with_from([1.0, 0.0, 0.0]).with_name("tip")
}

fn keeping(kept: Kept) -> Task {
    Task::default().with_keep(Keep::new(tip(), kept))
}

fn solve(problem: &Problem) -> Solution {
    Solver::new(problem, SolverOptions::default().with_tolerance(1e-6).with_polish(Polish::Never))
        .unwrap()
        .solve()
}

fn check(problem: &Problem, value: f64, part: f64) -> Solution {
    let solution = solve(problem);
    verdict(&solution, value, part);
    solution
}

/// Solved with this cost, at its limits for a while if it has any.
fn verdict(solution: &Solution, value: f64, part: f64) {
    let cost = solution.total();
    assert_eq!(solution.motion.status, Status::Converged, "{cost} {:?}", solution.limits);
    assert!((cost / value - 1.0).abs() < part, "{cost} instead of {value}");
    let task = solution.limits.task.as_ref();
    assert!(task.is_none_or(|usage| usage.at_points < 1e-7 && !usage.active.is_empty()), "{task:?}");
}

#[test]
fn a_cost_of_the_tip() {
    // Half of 2000 per squared metre.
    let pose = ToolPose::of(tip()).with_position([1.2, 1.2, FREE]);
    let task = Task::default().with_tool_cost(ToolCost::new(pose, 2000.0, 0.0));
    check(&quarter(task), 2007.524506, 1e-6);
}

#[test]
fn the_tip_near_a_plane_on_a_line_in_a_box_and_beyond_a_wall() {
    let (through, normal, up) = ([1.2, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
    let wall = Obstacle::new("wall", Shape::HalfSpace { through: [1.1, 0.0, 0.0], normal });
    for task in [
        keeping(Kept::Plane { through, normal, distance: 0.05 }),
        keeping(Kept::Line { through, along: up, distance: 0.05 }),
        keeping(Kept::Box { min: [1.15, -FREE, -FREE], max: [1.25, 0.7, FREE] }),
        Task::default().with_obstacle(wall).with_collision(Collision::of(vec![ball(0.05)])),
    ] {
        check(&along(task), 50.334388, 2e-6);
    }
    // An equation: by inverse kinematics a motion of one number.
    let exact = along(keeping(Kept::Plane { through, normal, distance: 0.0 }));
    let solution = solve(&exact);
    assert!((solution.total() / 53.7038197 - 1.0).abs() < 1e-6, "{}", solution.total());
}

#[test]
fn a_direction_and_an_orientation_within_an_angle() {
    let turned = |angle: f64| Rotation3::from_axis_angle(&Vector3::z_axis(), angle);
    let (axis, along) = ([1.0, 0.0, 0.0], [1.0, 1.0, 0.0]);
    for kept in [
        Kept::Axis { axis, along, angle: 1.2 },
        Kept::Orientation { rotation: turned(FRAC_PI_4), angle: 1.2 },
    ] {
        // From the straight way a minimum of 585.99 is nearest.
        let problem = arm([0.0, 0.0], [FRAC_PI_2, 0.0], keeping(kept));
        let options = SolverOptions::default().with_tolerance(1e-6).with_polish(Polish::Never).with_starts(4);
        verdict(&Solver::new(&problem, options).unwrap().solve(), 292.1224, 3e-6);
    }
}

#[test]
fn the_speed_of_the_tip() {
    check(&quarter(keeping(Kept::Speed { max: 4.0 })), 157.542706, 2e-6);
}

#[test]
fn a_box_in_the_way() {
    let placement = Placement::from_xyz_rpy([0.9, 0.0, 0.0], [0.0; 3]);
    let shape = Shape::Box { placement, size: [0.5, 0.4, 1.0] };
    let task = Task::default()
        .with_obstacle(Obstacle::new("box", shape))
        .with_collision(Collision::of(vec![ball(0.05)]));
    let solution = check(&along(task), 53.55413, 2e-5);
    let usage = solution.limits.task.unwrap();
    assert!(usage.active.iter().all(|span| span.name.contains("box")), "{usage:?}");
}

#[test]
fn two_bodies_of_the_robot() {
    let pair = BodyPairs::These(vec![["tip".into(), "base".into()]]);
    let base = LinkCapsule::sphere("world", 0.5).with_name("base");
    let task = Task::default().with_collision(Collision::of(vec![ball(0.3), base]).with_pairs(pair));
    check(&arm([0.0, 2.2], [1.5, 2.2], task), 46.009469, 2e-6);
}

/// The value is that of `values.py`, by the same command.
#[test]
fn a_pendulum_with_little_room_behind() {
    let robot = Robot::from_file("../robots/pendulum.toml").unwrap();
    let swing = Problem::rest_to_rest(robot, &[0.0], &[PI], 3.0)
        .with_limits(MotionLimits::none().with_q_min(vec![-0.2]));
    let options = SolverOptions::default().with_tolerance(1e-6).with_polish(Polish::Never).with_starts(4);
    let solution = Solver::new(&swing, options).unwrap().solve();
    verdict(&solution, 27.844211, 1e-6);
    let position = solution.limits.position.unwrap();
    assert!(position.at_points < 1e-9 && position.active.iter().all(|span| span.side == "min"));
    assert!(!position.active.is_empty());
}

/// The values are those of 80 elements in `benches/ocp/harness/in_space.py`, that of the UR5 another local
/// minimum, with its last wrist elsewhere. Without rotors the wrists are faster than these elements resolve.
/// The motions here cost 1.2e-5 (UR5) and 5e-6 (Panda) less, with tolerances of 1e-6 and of 1e-7; limits that
/// are exceeded between points save much less.
#[test]
fn all_limits_of_arms() {
    let file = ProblemFile::read("../examples/problems/ur5_limits.toml", LoadOptions::default());
    let ur5 = file.unwrap().problem;
    let (from, to) = ([0.0, -0.5, 0.0, -2.2, 0.0, 1.7, 0.8], [1.2, 0.3, -0.4, -1.6, 0.5, 2.2, 0.2]);
    let mut panda = Problem::rest_to_rest(Robot::from_file("../robots/panda.urdf").unwrap(), &from, &to, 1.0);
    let (arm, wrist) = (1.3211785e-4, 6.9444444e-3);
    panda.limits = MotionLimits::default().with_from_robot(true);
    panda.cost = Objective::new(0.0, vec![arm, arm, arm, arm, wrist, wrist, wrist]);
    for (problem, value, joints) in [(ur5, 0.01226014, 5), (panda, 0.04458063, 6)] {
        let solution = check(&problem, value, 3e-5);
        assert!(solution.total() < value, "{}", solution.total());
        let rate = solution.limits.rate.unwrap();
        assert!(rate.at_points < 1e-8 && rate.between < 6e-4, "{rate:?}");
        let mut names: Vec<_> = rate.active.iter().map(|span| &span.name).collect();
        names.sort();
        names.dedup();
        assert_eq!(names.len(), joints, "{names:?}");
    }
}
