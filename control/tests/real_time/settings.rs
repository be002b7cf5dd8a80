//! What changes between two solves beside ends and places: orientations, limits; and solves that are stopped.

use crate::solved::problem;
use costate::kinematics::Kinematics;
use costate::robot::Robot;
use costate_control::{
    Budget, Cancel, MachineCode, MotionLimits, MotionParameter, Objective, Payload, Problem, Resolve,
    ResolveError, ResolveStatus, SolverOptions, Task, TaskError, ToolCost, ToolOrientation, ToolPose,
};
use costate_test_support::allocations::allocations;
use nalgebra::{Matrix3, Rotation3, Vector3};
use std::ops::ControlFlow;

const FREE: f64 = f64::INFINITY;
/// Where the arm begins.
const AT: [f64; 6] = [0.4, -1.3, 1.6, -1.8, -1.57, 0.3];

fn options(intervals: usize, tolerance: f64) -> SolverOptions {
    let options = SolverOptions::default().with_tolerance(1e-6).with_machine_code(MachineCode::AtOnce);
    options.with_tolerance(tolerance).with_nodes(3 * intervals + 1)
}

/// A UR5 with rotors, whose motions have few minima.
fn ur5() -> Robot {
    let robot = Robot::from_file("../robots/ur5.urdf").unwrap();
    let joints: Vec<String> = robot.joints().iter().map(|joint| joint.name.clone()).collect();
    joints.iter().fold(robot, |robot, joint| robot.with_joint_armature(joint, 1.0).unwrap())
}

/// The direction of the tool at the end, and how the camera on the wrist looks.
fn looking(end: &ToolOrientation, cost: &ToolOrientation) -> Problem {
    let mut arm = Problem::rest_to_rest(ur5(), &AT, &AT, 1.0).with_limits(MotionLimits::none());
    arm.cost = Objective::new(0.0, vec![1e-4, 1e-4, 1e-4, 1e-3, 1e-3, 1e-3]);
    arm.end.q_free = (0..6).collect();
    let pose = |frame: &str, to: &ToolOrientation| match to {
        ToolOrientation::Axis { axis, along } => ToolPose::of(frame).with_axis(*axis, *along),
        ToolOrientation::Full(rotation) => ToolPose::of(frame).with_rotation(*rotation),
        other => panic!("{other:?}"),
    };
    arm.task = Task::default()
        .with_end_tool(pose("tool0", end).with_position([0.5, 0.2, FREE]))
        .with_tool_cost(ToolCost::new(pose("forearm_link", cost), 0.0, 1.0));
    arm
}

#[test]
fn orientations_of_tools_change() {
    let axis = |along: [f64; 3]| ToolOrientation::Axis { axis: [0.0, 0.0, 1.0], along };
    let robot = ur5();
    let mut kinematics = Kinematics::<f64>::new(&robot);
    kinematics.set_state(&AT, &[0.0; 6]).unwrap();
    let own = kinematics.pose(robot.frame_index("forearm_link").unwrap()).unwrap().rotation;
    let own = Rotation3::from_matrix_unchecked(Matrix3::from_fn(|i, j| own[i][j]));
    let turned = |angle: f64| {
        let about = Vector3::new(1.0, 0.2, -0.3).normalize();
        ToolOrientation::Full(Rotation3::new(about * angle) * own)
    };
    let goals = [0.0, 0.15, 0.3].map(|k| (axis([k, -k, -1.0]), turned(0.1 + k)));
    let mut motion = Resolve::new(&looking(&goals[0].0, &goals[0].1), options(12, 1e-7)).unwrap();
    let first = motion.solve().unwrap();
    assert_eq!(first.status, ResolveStatus::Solved);
    let mut costs = Vec::new();
    let mut again = |(end, cost): &(ToolOrientation, ToolOrientation)| {
        motion.set_end_orientation(0, end).unwrap();
        motion.set_tool_cost_orientation(0, cost).unwrap();
        let mut found = None;
        let allocated = allocations(|| found = Some(motion.solve_again(Budget::steps(80)).unwrap()));
        let mut z = [0.0; 18];
        motion.state_at(1.0, &mut z).unwrap();
        (found.unwrap(), allocated, z)
    };
    for goal in [&goals[1], &goals[2], &goals[0]] {
        let (found, allocated, z) = again(goal);
        assert_eq!((found.status, allocated), (ResolveStatus::Solved, 0), "{found:?}");
        // From scratch another minimum may be nearer, which costs more.
        let fresh = Resolve::new(&looking(&goal.0, &goal.1), options(12, 1e-7)).unwrap().solve().unwrap();
        assert!(found.cost < fresh.cost * (1.0 + 1e-5), "{found:?} {fresh:?}");
        costs.push(found.cost);
        kinematics.set_state(&z[..6], &z[6..12]).unwrap();
        let pose = kinematics.pose(robot.frame_index("tool0").unwrap()).unwrap();
        let ToolOrientation::Axis { along, .. } = &goal.0 else { panic!() };
        let along = Vector3::from(*along).normalize();
        let reached = Vector3::from(pose.rotation.map(|row| row[2]));
        assert!((reached - along).norm() < 1e-7, "{reached} {along}");
    }
    // There and back again: the same motion.
    assert!(
        (costs[2] / first.cost - 1.0).abs() < 1e-5 && (costs[0] / costs[2] - 1.0).abs() > 1e-3,
        "{costs:?}"
    );
    let other = ResolveError::Task { table: "end.tool", entry: 0, cause: TaskError::OtherOrientation };
    assert_eq!(motion.set_end_orientation(0, &turned(0.1)), Err(other));
    let nowhere = ResolveError::Task { table: "end.tool", entry: 0, cause: TaskError::NoDirection };
    assert_eq!(motion.set_end_orientation(0, &axis([0.0; 3])), Err(nowhere));
    let none = ResolveError::NoOrientation { table: "start.tool", entry: 0 };
    assert_eq!(motion.set_start_orientation(0, &turned(0.1)), Err(none));
}

/// A quarter turn with limits of all kinds.
fn limited(torque: f64, power: f64, rate: f64, low: f64) -> Problem {
    let limits = MotionLimits::none()
        .with_torque_max(vec![30.0, torque])
        .with_total_power_max(power)
        .with_v_max(vec![20.0, rate])
        .with_q_min(vec![low, -4.0]);
    problem("two_link").with_limits(limits)
}

#[test]
fn limits_change() {
    use MotionParameter as Of;
    let at = |[torque, power, rate, low]: [f64; 4]| limited(torque, power, rate, low);
    let first = [22.0, 70.0, 7.0, -0.5];
    let mut motion = Resolve::new(&at(first), options(24, 1e-7)).unwrap();
    motion.solve().unwrap();
    let mut costs = Vec::new();
    for values in [first, [22.0, 65.0, 6.8, -0.45], [21.0, 68.0, 7.0, -0.5], first] {
        let set = [Of::TorqueMax(1), Of::TotalPowerMax, Of::VelocityMax(1), Of::PositionMin(0)];
        set.iter().zip(values).for_each(|(limit, value)| motion.set_limit(limit, value).unwrap());
        let mut found = None;
        let allocated = allocations(|| found = Some(motion.solve_again(Budget::steps(200)).unwrap()));
        let found = found.unwrap();
        assert_eq!(
            (found.status, found.keeps_limits(), allocated),
            (ResolveStatus::Solved, true, 0),
            "{found:?}"
        );
        let fresh = Resolve::new(&at(values), options(24, 1e-7)).unwrap().solve().unwrap();
        assert!((found.cost / fresh.cost - 1.0).abs() < 1e-5, "{values:?}: {found:?} {fresh:?}");
        costs.push(found.cost);
    }
    assert!(costs[1] > 1.001 * costs[0] && (costs[3] / costs[0] - 1.0).abs() < 1e-5, "{costs:?}");

    let says = |error: ResolveError, words: &str| assert!(error.to_string().contains(words), "{error}");
    says(
        motion.set_limit(&Of::VelocityMax(1), -1.0).unwrap_err(),
        "rate of joint 'elbow': -1 is not positive",
    );
    says(motion.set_limit(&Of::VelocityMax(1), f64::NAN).unwrap_err(), "NaN is not finite");
    says(motion.set_limit(&Of::PositionMin(0), 0.1).unwrap_err(), "q at the start of joint 'shoulder' is 0");
    says(
        motion.set_limit(&Of::PositionMax(0), 4.0).unwrap_err(),
        "position of joint 'shoulder': there is no",
    );
    says(motion.set_limit(&Of::PowerMax(0), 4.0).unwrap_err(), "power of joint 'shoulder': there is no");
    says(
        motion.set_limit(&Of::PayloadMass(Payload::point("elbow", 1.0, [0.0; 3])), 1.0).unwrap_err(),
        "payload",
    );
    // Ends are checked against the limits as they are now.
    motion.set_limit(&Of::VelocityMax(1), 3.0).unwrap();
    let error = motion.set_start(&[0.0; 2], &[0.0, 3.5]).unwrap_err();
    says(error, "v at the start of joint 'elbow' is 3.5, beyond its limits -3 and 3");
}

#[test]
fn the_power_of_all_joints_has_a_derivative() {
    let value = 65.0;
    let mut motion = Resolve::new(&limited(22.0, value, 7.0, -0.5), options(24, 1e-10)).unwrap();
    motion.solve().unwrap();
    let found = motion.derivative_by(&MotionParameter::TotalPowerMax).unwrap().unwrap();
    let mut cost = |value: f64| {
        motion.set_limit(&MotionParameter::TotalPowerMax, value).unwrap();
        motion.solve_again(Budget::steps(200)).unwrap().cost
    };
    let step = 0.05;
    let difference = (cost(value + step) - cost(value - step)) / (2.0 * step);
    assert!(found.cost < 0.0 && (found.cost / difference - 1.0).abs() < 1e-3, "{} {difference}", found.cost);
}

/// Another thread's handle stops a solve before its next step.
#[test]
fn a_solve_is_cancelled() {
    let mut motion = Resolve::new(&problem("ur5_limits"), options(20, 1e-6)).unwrap();
    let cancel = Cancel::new();
    cancel.cancel();
    let budget = motion.budget();
    let mut solve = |cancel: &Cancel| {
        let stop = || if cancel.is_cancelled() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
        motion.solve_until(budget, stop).unwrap()
    };
    let stopped = solve(&cancel);
    assert_eq!((stopped.status, stopped.iterations), (ResolveStatus::Cancelled, 1));
    assert_eq!(solve(&Cancel::new()).status, ResolveStatus::Solved);
}
