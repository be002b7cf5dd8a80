//! Joints that are light without their rotors, in words.

use crate::numbers::short;
use costate::robot::{JointKind, printable};
use costate_control::{FastJoint, Problem, Solution};

/// Most joints in a sentence.
const MOST_JOINTS: usize = 3;
/// Accelerations that no arm with gears has (rad/s^2).
const SUDDEN: f64 = 100.0;

/// The name of a joint by its number among those that mimic no other.
fn joint_name(problem: &Problem, joint: usize) -> String {
    problem
        .robot
        .independent_joints()
        .nth(joint)
        .map_or(String::new(), |joint| printable(&joint.name).to_string())
}

/// That a joint moves faster than the mesh follows.
pub fn too_fast(problem: &Problem, fast: &FastJoint) -> String {
    format!(
        "joint '{}' moves faster than the mesh follows: near the motion deviations change within {} s at t = {} s, and \
         intervals are {} s long",
        joint_name(problem, fast.joint),
        short(fast.time_constant, 2),
        short(fast.time, 4),
        short(fast.interval, 2)
    )
}

/// The inertia of a rotor that makes a joint as slow as the mesh.
pub fn with_rotor(problem: &Problem, fast: &FastJoint) -> Option<String> {
    let name = joint_name(problem, fast.joint);
    Some(match fast.armature {
        Some(inertia) => format!(
            "robot.armature = {{ {name} = {} }} (inertia of its rotor, with which the mesh would follow)",
            short(inertia, 2)
        ),
        None => {
            let rotors =
                without_rotors(problem).map_or(String::new(), |joints| format!(": {joints} without"));
            format!("robot.armature (the inertia of rotors, of '{name}' first{rotors})")
        }
    })
}

/// The joints without inertia of a rotor: "all joints are", "'a' and 'b' are".
pub fn without_rotors(problem: &Problem) -> Option<String> {
    let robot = &problem.robot;
    // Floating and spherical joints cannot have rotors.
    let may_have_one = |&&i: &&usize| robot.joints()[i].free.is_none();
    let all: Vec<usize> = robot.independent_indices().iter().filter(may_have_one).copied().collect();
    let light: Vec<usize> = all.iter().filter(|&&i| robot.armature_entry(i, i) == 0.0).copied().collect();
    let names: Vec<String> = light
        .iter()
        .take(MOST_JOINTS)
        .map(|&i| format!("'{}'", printable(&robot.joints()[i].name)))
        .collect();
    match light.len() {
        0 => None,
        count if count == all.len() => Some("all joints are".into()),
        1 => Some(format!("joint {} is", names.concat())),
        count if count > MOST_JOINTS => {
            Some(format!("joints {} and {} more are", names.join(", "), count - MOST_JOINTS))
        }
        _ => Some(format!("joints {} are", names.join(", "))),
    }
}

/// That a robot whose limits are kept accelerates as no arm with gears does, since its file has neither the
/// inertia of rotors nor limits of accelerations. Floating and spherical joints can have neither.
pub fn too_sudden(problem: &Problem, solution: &Solution) -> Option<String> {
    let robot = &problem.robot;
    let keeps_limits = solution.motion.status.is_solved() && problem.keeps_robot_limits();
    if !keeps_limits || problem.limits.a_max.is_some() || problem.limits.jerk_max.is_some() {
        return None;
    }
    let trajectory = &solution.trajectory;
    let times = trajectory.t.windows(2).zip(trajectory.v.windows(2));
    let joints = robot.independent_indices().iter().enumerate();
    let turning = joints.filter(|&(_, &i)| {
        let joint = &robot.joints()[i];
        joint.kind == JointKind::Revolute && joint.free.is_none() && robot.armature_entry(i, i) == 0.0
    });
    let peaks = turning.map(|(k, &i)| {
        let means =
            times.clone().filter(|(t, _)| t[1] > t[0]).map(|(t, v)| (v[1][k] - v[0][k]) / (t[1] - t[0]));
        (means.map(f64::abs).fold(0.0, f64::max), i)
    });
    let (peak, joint) = peaks.max_by(|a, b| a.0.total_cmp(&b.0)).filter(|&(peak, _)| peak > SUDDEN)?;
    // Robots that fly or turn freely take no limits of accelerations.
    let (unsaid, remedy) = match robot.free_joints().is_empty() {
        true => (", and the problem no limit of accelerations", "robot.armature or limits.a_max"),
        false => ("", "robot.armature"),
    };
    Some(format!(
        "joint '{}' reaches {} rad/s^2, more than arms with gears do: the robot has no inertia of rotors there{unsaid}; \
         give {remedy}",
        printable(&robot.joints()[joint].name),
        short(peak, 2)
    ))
}
