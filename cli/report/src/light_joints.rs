//! Joints that are light without their rotors, in words.

use crate::numbers::short;
use costate::robot::printable;
use costate_control::{FastJoint, Problem};

/// Most joints in a sentence.
const MOST_JOINTS: usize = 3;

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
    let has_none = |&&i: &&usize| robot.armature_entry(i, i) == 0.0;
    let all = robot.independent_indices();
    let light: Vec<usize> = all.iter().filter(has_none).copied().collect();
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
