//! What the robot carries, and when.

use super::values::{number, placement, shown, vector};
use crate::motion::Motion;
use costate::robot::Placement;
use costate_control::{Payload, Shape};
use serde_json::{Value, json};

/// Density from which the size of a payload is guessed (kg/m^3).
const DENSITY: f64 = 500.0;

/// Payloads, each from the via that takes it up to the one that sets it down, and those with a body that are
/// carried from the start on. One without a body is drawn as a cube.
pub fn payloads(motion: &Motion<'_>) -> Vec<Value> {
    let end = motion.samples.t.last().copied().unwrap_or(0.0);
    let vias = motion.problem.vias.iter().zip(&motion.solution.trajectory.via_times);
    let changes: Vec<(f64, &Vec<Payload>)> =
        vias.filter_map(|(via, &time)| Some((time, via.payload.as_ref()?))).collect();
    let until = |k: usize| changes.get(k + 1).map_or(end, |change| change.0);
    let carried = changes
        .iter()
        .enumerate()
        .flat_map(|(k, &(from, payload))| payload.iter().map(move |part| (from, until(k), part)));
    let bodies = motion.problem.task.payloads.iter().filter(|payload| payload.shape.is_some());
    let always = bodies.map(|payload| (0.0, end, payload));
    always.chain(carried).filter_map(|(from, to, part)| drawn(motion, from, to, part)).collect()
}

fn drawn(motion: &Motion<'_>, from: f64, to: f64, payload: &Payload) -> Option<Value> {
    let frame = motion.robot().frame(&payload.frame).ok()?;
    let at = |xyz: [f64; 3]| Placement::from_xyz_rpy(xyz, [0.0; 3]);
    let (own, shape) = match &payload.shape {
        Some(Shape::Box { placement, size }) => (*placement, json!({ "kind": "box", "size": vector(*size) })),
        Some(Shape::Sphere { centre, radius }) => {
            (at(*centre), json!({ "kind": "sphere", "radius": number(*radius) }))
        }
        Some(Shape::Capsule { from, to, radius }) => {
            let shape = json!({
                "kind": "capsule", "from": vector(*from), "to": vector(*to), "radius": number(*radius)
            });
            (Placement::identity(), shape)
        }
        _ => {
            let side = (payload.inertia.mass / DENSITY).cbrt();
            (at(payload.inertia.com.into()), json!({ "kind": "box", "size": vector([side; 3]) }))
        }
    };
    Some(json!({
        "name": shown(&payload.frame),
        "from": number(from),
        "to": number(to),
        "joint": frame.joint,
        "at": placement(&frame.placement.then(&own)),
        "mass": number(payload.inertia.mass),
        "shape": shape,
    }))
}
