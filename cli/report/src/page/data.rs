//! The data from which the script draws plots and stage.

use super::stage::stage;
use super::values::{list, number, shown};
use crate::entries::entries;
use crate::motion::Motion;
use crate::panels;
use crate::plot::{Curve, Group, Limit, Look, NEUTRAL, Panel};
use costate::robot::FreeJoint;
use serde_json::{Value, json};

/// All of it: stage, times, joints, plots. Angles in rad, lengths in m, times in s.
pub fn data(motion: &Motion<'_>) -> Value {
    let joints = motion.robot().independent_joints();
    let joints = joints.map(|joint| json!({ "name": shown(&joint.name), "kind": joint.kind.name() }));
    // Those that no coordinate has, the last entries of quaternions.
    let further = entries(motion.robot()).into_iter().filter(|entry| entry.number >= motion.robot().dof());
    let further = further.map(|entry| json!({ "name": shown(&entry.name), "kind": "quaternion" }));
    let residuals = panels::residuals(&motion.solution.motion.iterations);
    let plots = panels::along_the_motion(motion).into_iter().chain(residuals);
    let stem: String = motion
        .robot()
        .name()
        .chars()
        .map(|c| if c.is_ascii_alphanumeric() { c } else { '_' })
        .take(40)
        .collect();
    json!({
        "name": shown(motion.robot().name()),
        "stem": stem,
        "t": list(motion.samples.t.iter().copied()),
        "joints": joints.chain(further).collect::<Vec<_>>(),
        "free": motion.robot().free_joints().iter().map(free).collect::<Vec<_>>(),
        "vias": motion.solution.trajectory.via_times,
        "via_names": via_names(motion),
        "switches": motion.solution.motion.switches,
        "table": table(motion),
        "plots": plots.map(|panel| plot(motion, panel)).collect::<Vec<_>>(),
        "stage": stage(motion),
    })
}

/// Where the entries of a floating or spherical joint are in q and v.
fn free(joint: &FreeJoint) -> Value {
    json!({
        "slides": joint.kind.slides(),
        "position": joint.position,
        "coordinate": joint.coordinate,
    })
}

/// What the ends of phases are called.
fn via_names(motion: &Motion<'_>) -> Vec<String> {
    let name = |number: usize| match motion.solution.gait {
        Some(_) => "lift-off".to_owned(),
        None => format!("via {number}"),
    };
    (1..=motion.solution.trajectory.via_times.len()).map(name).collect()
}

/// Torques after the gain, where they differ from the controls: the table has them beside what is drawn.
fn table(motion: &Motion<'_>) -> Value {
    let tau = (0..motion.robot().dof())
        .map(|i| list(motion.samples.tau.iter().filter_map(|row| row.get(i).copied())));
    json!({ "tau": tau.collect::<Vec<_>>() })
}

fn plot(motion: &Motion<'_>, (id, plot): Panel) -> Value {
    let group = match plot.group {
        Group::Joints => "joints",
        Group::Actuation => "actuation",
        Group::Tools => "tools",
        Group::Solver => "solver",
    };
    let of_joints = plot.units != ["", ""] || (id == "controls");
    let t = &motion.samples.t;
    json!({
        "id": id,
        "title": plot.title,
        "symbol": plot.symbol,
        // Where joints differ in their units, and for angles that may be shown in degrees.
        "units": plot.units,
        "unitless": plot.unitless,
        "unit": plot.unit,
        "group": group,
        "ofJoints": of_joints,
        "logarithmic": plot.logarithmic,
        "overTime": plot.over_time,
        "xLabel": plot.x_label,
        "curves": plot.curves.iter().map(|each| curve(each, t)).collect::<Vec<_>>(),
        "limits": plot.limits.iter().map(limit).collect::<Vec<_>>(),
    })
}

fn curve(curve: &Curve, t: &[f64]) -> Value {
    let x = || curve.points.iter().map(|point| point.0);
    let is_sampled = curve.points.len() == t.len() && x().zip(t).all(|(x, t)| x == *t);
    json!({
        "name": shown(&curve.name),
        "color": color(curve.color),
        "dotted": curve.look == Look::Dotted,
        // Without times of its own it has those of the samples.
        "x": if is_sampled { Value::Null } else { list(x()) },
        "y": list(curve.points.iter().map(|point| point.1)),
    })
}

fn limit(limit: &Limit) -> Value {
    let values = match limit.constant() {
        Some(value) => number(value),
        None => list(limit.points.iter().map(|point| point.1)),
    };
    json!({ "color": color(limit.color), "upper": limit.is_upper, "kept": limit.is_kept, "value": values })
}

fn color(color: usize) -> Value {
    if color == NEUTRAL { Value::Null } else { json!(color) }
}
