//! Joints that are light without their rotors, in words.

use super::numbers::short;
use super::remark::{Remark, RemarkKey, Severity};
use crate::problem::Problem;
use crate::result::fast_joint::FastJoint;
use crate::result::solution::Solution;
use costate::robot::{Friction, JointKind, printable};

/// Most joints in a sentence.
const MOST_JOINTS: usize = 3;
/// Transition velocities of friction below this part of the largest rate are narrow.
const NARROW: f64 = 0.1;
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
pub(super) fn too_fast(problem: &Problem, fast: &FastJoint) -> String {
    if fast.coulomb_velocity.is_some() {
        return format!(
            "the dry friction of joint '{}' is narrower than the mesh resolves: near rest it changes the motion within \
             {} s at t = {} s, and intervals are {} s long",
            joint_name(problem, fast.joint),
            short(fast.time_constant, 2),
            short(fast.time, 4),
            short(fast.interval, 2)
        );
    }
    format!(
        "joint '{}' moves faster than the mesh follows: near the motion deviations change within {} s at t = {} s, and \
         intervals are {} s long",
        joint_name(problem, fast.joint),
        short(fast.time_constant, 2),
        short(fast.time, 4),
        short(fast.interval, 2)
    )
}

/// That the inertia of its rotor would slow a joint down, if it has none, or a wider transition of its dry
/// friction. How large these are only its data sheet says: with a number that is made up another robot is
/// solved.
pub(super) fn with_rotor(problem: &Problem, fast: &FastJoint) -> Option<String> {
    if fast.coulomb_velocity.is_some() {
        let name = joint_name(problem, fast.joint);
        return Some(format!(
            "more solver.nodes; a larger solver.max_nodes; a larger coulomb_velocity of '{name}' (robot.friction) if its \
             drive allows that"
        ));
    }
    let joint = *problem.robot.independent_indices().get(fast.joint)?;
    let has_rotor = problem.robot.armature_entry(joint, joint) > 0.0;
    let rotors = without_rotors(problem)?;
    let first = match has_rotor {
        true => String::new(),
        false => format!(", of '{}' first", joint_name(problem, fast.joint)),
    };
    Some(format!("robot.armature (rotor inertia{first}; {rotors} without)"))
}

/// The joints with dry friction whose transition is not wider than this part of the largest rate along a
/// motion.
pub(super) fn with_narrow_friction(problem: &Problem, solution: &Solution) -> Option<String> {
    let largest = solution.trajectory.v.iter().flatten().fold(0.0_f64, |most, v| most.max(v.abs()));
    let joints = problem.robot.joints();
    let narrow = |friction: &Friction| friction.coulomb > 0.0 && friction.coulomb_velocity < NARROW * largest;
    let found = joints.iter().find(|joint| narrow(&joint.friction))?;
    Some(format!(
        "a larger coulomb_velocity of dry friction (robot.friction, of '{}' first), more solver.nodes",
        printable(&found.name)
    ))
}

/// The joints without inertia of a rotor: "all joints are", "'a' and 'b' are".
pub(super) fn without_rotors(problem: &Problem) -> Option<String> {
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
pub(super) fn too_sudden(problem: &Problem, solution: &Solution) -> Option<Remark> {
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
    let name = &robot.joints()[joint].name;
    let text = format!(
        "joint '{}' reaches {} rad/s^2, more than arms with gears do: the robot has no inertia of rotors there{unsaid}; \
         give {remedy}",
        printable(name),
        short(peak, 2)
    );
    Some(Remark {
        name: Some(name.clone()),
        kind: Some("acceleration".into()),
        unit: Some("rad/s^2".into()),
        ..Remark::new(RemarkKey::SuddenAcceleration, Severity::Warning, text).comparing(peak, SUDDEN)
    })
}
