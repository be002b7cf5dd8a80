//! The robot as a JSON object.

use super::closing::Loops;
use super::frames::{axes, carrier, kind};
use super::rows::{Row, mass, rows};
use costate::constraints::ConstraintError;
use costate::robot::{AppliedWrench, Constraint, Frame, Robot};
use costate_control::FreeEntries;
use serde_json::{Value, json};
use std::ops::Index;

/// Infinite limits are null.
pub fn of(robot: &Robot, with_frames: bool) -> Value {
    let joint = |row: &Row<'_>| {
        let joint = row.moved;
        let (link, limits) = (&joint.inertia, joint.limits);
        let [q, v] = [&row.q, &row.v].map(|entries| entries.as_ref().map(|all| [all.start, all.end]));
        json!({
            "index": v.map(|[first, _]| first),
            "q": q,
            "v": v,
            "name": joint.name,
            "type": row.kind(),
            "parent": row.parent(robot),
            "axis": row.axis(),
            "placement": {
                "xyz": row.first.placement.translation.as_slice(),
                "rotation": matrix(&row.first.placement.rotation),
            },
            "link": joint.link,
            "mass": link.mass,
            "com": link.com.as_slice(),
            "inertia": matrix(&link.inertia),
            "mimic": joint.mimic.map(|mimic| {
                json!({ "joint": robot.joints()[mimic.joint].name, "ratio": mimic.ratio, "offset": mimic.offset })
            }),
            "armature": row.armature(robot),
            "spring": { "stiffness": joint.spring.stiffness, "rest": joint.spring.rest },
            "friction": {
                "viscous": joint.friction.viscous,
                "coulomb": joint.friction.coulomb,
                "coulomb_velocity": joint.friction.coulomb_velocity,
            },
            "limits": {
                "lower": limits.lower, "upper": limits.upper, "velocity": limits.velocity, "effort": limits.effort,
            },
        })
    };
    let mut value = json!({
        "robot": robot.name(),
        "n": robot.dof(),
        "nq": robot.nq(),
        "gravity": robot.gravity().as_slice(),
        "mass": mass(robot),
        "joints": rows(robot).iter().map(joint).collect::<Vec<_>>(),
        "free_joints": robot.free_joints().iter().map(FreeEntries::from).collect::<Vec<_>>(),
        "armature_couplings": couplings(robot),
        "warnings": robot.warnings().iter().map(ToString::to_string).collect::<Vec<_>>(),
    });
    if let (false, Value::Object(fields)) = (robot.constraints().is_empty(), &mut value) {
        let loops = Loops::of(robot);
        let one = |(k, constraint): (usize, &Constraint)| {
            let mut one = json!({ "name": constraint.name, "rows": constraint.kind.rows() });
            if let Loops::Closed { redundant, .. } = &loops
                && !redundant[k].is_empty()
            {
                one["redundant"] = json!(redundant[k]);
            }
            one
        };
        fields.insert("constraints".into(), robot.constraints().iter().enumerate().map(one).collect());
        match &loops {
            Loops::Closed { rank, .. } => fields.insert("rank".into(), json!(rank)),
            Loops::Open(cause) => fields.insert("unsatisfied".into(), unsatisfied(cause)),
            Loops::Unknown => None,
        };
    }
    if let (true, Value::Object(fields)) = (with_frames, &mut value) {
        fields.insert(
            "frames".into(),
            robot.frames().iter().map(|frame| frame_as_json(robot, frame)).collect(),
        );
        fields.insert(
            "wrenches".into(),
            robot.wrenches().iter().map(|one| wrench_as_json(robot, one)).collect(),
        );
    }
    value
}

fn wrench_as_json(robot: &Robot, applied: &AppliedWrench) -> Value {
    let AppliedWrench { frame, wrench, .. } = applied;
    json!({
        "frame": robot.frames()[*frame].name,
        "axes": axes(wrench.axes),
        "force": wrench.force,
        "moment": wrench.moment,
    })
}

/// The constraint that no position near q = 0 satisfies, by how much it misses (m, rad), whether that is
/// since it contradicts something that no motion changes, and all of it in words.
fn unsatisfied(cause: &ConstraintError) -> Value {
    match cause {
        ConstraintError::CannotClose { constraint, miss } => {
            json!({ "constraint": constraint, "miss": miss, "contradiction": false, "message": cause.to_string() })
        }
        ConstraintError::Contradiction { constraint, miss, .. } => {
            json!({ "constraint": constraint, "miss": miss, "contradiction": true, "message": cause.to_string() })
        }
        _ => Value::Null,
    }
}

fn frame_as_json(robot: &Robot, frame: &Frame) -> Value {
    json!({
        "name": frame.name,
        "kind": kind(frame),
        "joint": carrier(robot, frame),
        "placement": {
            "xyz": frame.placement.translation.as_slice(),
            "rotation": matrix(&frame.placement.rotation),
        },
    })
}

/// A 3 x 3 matrix as nested arrays.
fn matrix(matrix: &impl Index<(usize, usize), Output = f64>) -> [[f64; 3]; 3] {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| matrix[(i, j)]))
}

/// The entries of the armature matrix above its diagonal that are not zero.
fn couplings(robot: &Robot) -> Vec<Value> {
    let joints = robot.joints();
    let above = robot.armature().iter().filter(|(i, j, _)| i > j);
    above
        .map(|&(j, i, entry)| json!({ "joints": [joints[i].name, joints[j].name], "armature": entry }))
        .collect()
}
