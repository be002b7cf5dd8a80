//! The data of the stage: the tree of joints, bodies, tools, payloads.
//!
//! Poses are not written: the script computes them from q, as [`costate::robot::Robot::poses`] does, which is
//! exact and short.

use super::bodies::{Meshes, bodies, obstacles};
use super::payloads::payloads;
use super::regions::regions;
use super::values::{placement, shown};
use crate::motion::Motion;
use crate::tools::tools;
use costate::robot::Robot;
use serde_json::{Value, json};

/// The whole stage.
pub fn stage(motion: &Motion<'_>) -> Value {
    let robot = motion.robot();
    let tools = tools(motion.problem);
    let mut meshes = Meshes::default();
    let bodies = bodies(motion, &tools, &mut meshes);
    json!({
        "joints": joints(robot),
        "bodies": bodies,
        "obstacles": obstacles(motion.problem),
        "regions": regions(motion.problem),
        "meshes": meshes.json(),
        "payloads": payloads(motion),
        "tools": tools.iter().map(|tool| json!({
            "name": shown(&tool.name),
            "joint": tool.joint,
            "at": placement(&tool.placement),
        })).collect::<Vec<_>>(),
    })
}

/// All joints, mimics included: `q = ratio q_independent + offset`.
fn joints(robot: &Robot) -> Vec<Value> {
    let independent = robot.independent_indices();
    let joints = robot.joints().iter().enumerate();
    joints
        .map(|(i, joint)| {
            let (of, ratio, offset) =
                joint.mimic.map_or((i, 1.0, 0.0), |mimic| (mimic.joint, mimic.ratio, mimic.offset));
            json!({
                "name": shown(&joint.name),
                "kind": joint.kind.name(),
                "parent": joint.parent,
                "at": placement(&joint.placement),
                "axis": joint.axis.as_slice(),
                "q": independent.iter().position(|&index| index == of),
                "ratio": ratio,
                "offset": offset,
                "massless": joint.inertia.mass == 0.0,
            })
        })
        .collect()
}
