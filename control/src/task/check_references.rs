//! Whether references over time are well formed.

use super::turns::log;
use crate::constants::checks::references::NEAR_HALF_TURN;
use crate::constants::task::CLOSEST_KNOTS;
use crate::problem::references::{JointReference, Reference, ToolReference};
use crate::problem::task_error::TaskError;
use std::f64::consts::PI;

/// A key of a reference and what is wrong with it.
type Fault = (&'static str, TaskError);

/// Checks times, lengths, numbers and weights of a reference for n joints.
pub(crate) fn check_reference(reference: &Reference, n: usize) -> Result<(), Fault> {
    let times = reference.times();
    if times.is_empty() {
        return Err(("times", TaskError::WrongCount { what: "knot", expected: 1, found: 0 }));
    }
    finite("times", times)?;
    if let Some(pair) = times.windows(2).find(|pair| pair[1] <= pair[0]) {
        return Err(("times", TaskError::NotLater { time: pair[1], before: pair[0] }));
    }
    let least = CLOSEST_KNOTS * times.iter().fold(1.0, |most: f64, time| most.max(time.abs()));
    if let Some(pair) = times.windows(2).find(|pair| pair[1] - pair[0] < least) {
        return Err(("times", TaskError::TooClose { time: pair[1], before: pair[0], least }));
    }
    match reference {
        Reference::Joints(reference) => check_joints(reference, n),
        Reference::Tool(reference) => check_tool(reference),
    }
}

fn check_joints(reference: &JointReference, n: usize) -> Result<(), Fault> {
    let JointReference { times, positions, velocities, weights } = reference;
    for (key, rows) in [("positions", Some(positions)), ("velocities", velocities.as_ref())] {
        let Some(rows) = rows else { continue };
        count(key, "time", times.len(), rows.len())?;
        for row in rows {
            count(key, "joint", n, row.len())?;
            finite(key, row)?;
        }
    }
    count("weights", "joint", n, weights.len())?;
    weights.iter().try_for_each(|&value| weight("weights", value))
}

fn check_tool(reference: &ToolReference) -> Result<(), Fault> {
    let ToolReference { tool, times, positions, velocities, orientations, .. } = reference;
    weight("position_weight", reference.position_weight)?;
    weight("orientation_weight", reference.orientation_weight)?;
    let asked = given(reference);
    if let Some(rows) = positions {
        count("positions", "time", times.len(), rows.len())?;
        // Free is what is infinite at each knot.
        let good =
            |row: &[f64; 3]| (0..3).all(|k| row[k].is_finite() == asked[k] && row[k] > f64::NEG_INFINITY);
        if !rows.iter().all(good) {
            return Err(("positions", TaskError::NotFinite));
        }
    }
    if let Some(rows) = velocities {
        if positions.is_none() {
            return Err(("velocities", TaskError::NoPositions));
        }
        count("velocities", "time", times.len(), rows.len())?;
        rows.iter().try_for_each(|row| finite("velocities", row))?;
    }
    if let Some(rotations) = orientations {
        count("orientations", "time", times.len(), rotations.len())?;
        rotations.iter().try_for_each(|rotation| finite("orientations", rotation.matrix().as_slice()))?;
        for (pair, &time) in rotations.windows(2).zip(times) {
            if log(&(pair[0].inverse() * pair[1])).norm() > PI - NEAR_HALF_TURN {
                return Err(("orientations", TaskError::HalfTurn { time }));
            }
        }
    }
    if !asked.contains(&true) && orientations.is_none() {
        return Err((
            "positions",
            TaskError::NothingAsked { frame: tool.frame.clone(), remedy: "positions or orientations" },
        ));
    }
    Ok(())
}

/// Which coordinates of the position of a tool follow a reference.
pub(super) fn given(reference: &ToolReference) -> [bool; 3] {
    let first = reference.positions.as_ref().and_then(|rows| rows.first());
    first.map_or([false; 3], |row| row.map(f64::is_finite))
}

fn count(key: &'static str, what: &'static str, expected: usize, found: usize) -> Result<(), Fault> {
    if found == expected { Ok(()) } else { Err((key, TaskError::WrongCount { what, expected, found })) }
}

fn finite(key: &'static str, values: &[f64]) -> Result<(), Fault> {
    if values.iter().all(|value| value.is_finite()) { Ok(()) } else { Err((key, TaskError::NotFinite)) }
}

fn weight(key: &'static str, value: f64) -> Result<(), Fault> {
    if value >= 0.0 && value.is_finite() {
        return Ok(());
    }
    Err((key, TaskError::OutOfRange { value, remedy: "must be neither negative nor infinite" }))
}
