//! The data of the stage: the tree of joints, bodies, tools, payloads.
//!
//! Poses are not written: the script computes them from q, as [`costate::robot::Robot::poses`] does, which is
//! exact and short.

use super::bodies::{Meshes, bodies};
use super::obstacles::obstacles;
use super::payloads::payloads;
use super::regions::regions;
use super::values::{placement, shown};
use crate::entries::{Mover, entries, movers};
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
    let numbers: Vec<usize> = entries(robot).into_iter().map(|entry| entry.number).collect();
    let joints = robot.joints().iter().zip(movers(robot));
    joints
        .map(|(joint, mover)| {
            let (kind, at, ratio, offset) = match mover {
                Mover::Position { at, ratio, offset } => (joint.kind.name(), Some(at), ratio, offset),
                Mover::Quaternion { at } => ("quaternion", Some(at), 1.0, 0.0),
                Mover::Nothing => ("fixed", None, 1.0, 0.0),
            };
            json!({
                "name": shown(&joint.name),
                "kind": kind,
                "parent": joint.parent,
                "at": placement(&joint.placement),
                "axis": joint.axis.as_slice(),
                "q": at,
                "number": at.and_then(|at| numbers.get(at)),
                "ratio": ratio,
                "offset": offset,
                "massless": joint.inertia.mass == 0.0,
                "free": joint.free.is_some(),
            })
        })
        .collect()
}
