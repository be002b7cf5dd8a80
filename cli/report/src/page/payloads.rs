//! What the robot carries, and when.

use super::values::{number, placement, shown};
use crate::motion::Motion;
use costate::robot::Placement;
use costate_control::Payload;
use serde_json::{Value, json};

/// Density from which the size of a payload is guessed (kg/m^3).
const DENSITY: f64 = 500.0;

/// Cubes in the place of payloads, each from the via that takes it up to the one that sets it down.
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
    carried.filter_map(|(from, to, part)| cube(motion, from, to, part)).collect()
}

fn cube(motion: &Motion<'_>, from: f64, to: f64, payload: &Payload) -> Option<Value> {
    let frame = motion.robot().frame(&payload.frame).ok()?;
    let centre = Placement { translation: payload.inertia.com, ..Placement::identity() };
    Some(json!({
        "name": shown(&payload.frame),
        "from": number(from),
        "to": number(to),
        "joint": frame.joint,
        "at": placement(&frame.placement.then(&centre)),
        "mass": number(payload.inertia.mass),
        "side": number((payload.inertia.mass / DENSITY).cbrt()),
    }))
}
