//! The tables of references over time.

use super::error::ProblemFileCause;
use super::fault::Fault;
use super::table::{Table, number};
use super::tools::tool;
use crate::problem::error::ProblemError;
use crate::problem::key::Key;
use crate::problem::references::{JointReference, Reference, ToolReference};
use crate::problem::task_error::TaskError;
use costate::robot::Placement;
use nalgebra::Rotation3;
use std::f64::consts::{FRAC_PI_2, PI};
use toml::de::DeValue;

/// A reference of joints, and one of a tool.
const JOINT_REFERENCE: &[&str] = &["times", "positions", "velocities", "weights"];
const TOOL_REFERENCE: &[&str] = &[
    "frame",
    "offset",
    "times",
    "positions",
    "velocities",
    "orientations",
    "position_weight",
    "orientation_weight",
];
const REFERENCE: &[&str] = &[
    "times",
    "positions",
    "velocities",
    "weights",
    "frame",
    "offset",
    "orientations",
    "position_weight",
    "orientation_weight",
];

/// Reads `[[cost.reference]]`.
pub(super) fn references(costs: &Table<'_>) -> Result<Vec<Reference>, Fault> {
    costs.tables("reference", REFERENCE)?.iter().map(reference).collect()
}

/// A reference of a tool if it has a frame, else one of joints.
pub(super) fn reference(table: &Table<'_>) -> Result<Reference, Fault> {
    table.only(REFERENCE)?;
    let times = table.need("times", table.numbers("times")?)?;
    if !table.has("frame") {
        table.only(JOINT_REFERENCE)?;
        let rows =
            |name: &str| table.list(name, "a list of lists of numbers, one list for each time", numbers);
        let positions = table.need("positions", rows("positions")?)?;
        let weights = table.need("weights", table.numbers("weights")?)?;
        let velocities = rows("velocities")?;
        return Ok(Reference::Joints(JointReference { times, positions, velocities, weights }));
    }
    table.only(TOOL_REFERENCE)?;
    let triples = |name: &str| {
        let read = |value: &DeValue<'_>| <[f64; 3]>::try_from(numbers(value)?).ok();
        table.list(name, "a list of lists of three numbers, one list for each time", read)
    };
    let weight = |name: &str, of: &str, message| match table.number(name)? {
        Some(weight) if weight > 0.0 && !table.has(of) => {
            Err(table.fault(name, ProblemFileCause::Conflict(message)))
        }
        weight => Ok(weight.unwrap_or(1.0)),
    };
    let orientations = triples("orientations")?;
    if let Some(k) = orientations.as_ref().and_then(|list| list.windows(2).position(turns_too_far)) {
        let cause = TaskError::HalfTurn { time: times.get(k).copied().unwrap_or_default() };
        let error = ProblemError::Task { key: Key::entry("cost.reference", "orientations", 0), cause };
        return Err(table.fault("orientations", ProblemFileCause::Problem(error)));
    }
    let orientations = orientations.map(|list| list.into_iter().map(turn).collect());
    Ok(Reference::Tool(ToolReference {
        tool: tool(table)?,
        times,
        positions: triples("positions")?,
        velocities: triples("velocities")?,
        orientations,
        position_weight: weight(
            "position_weight",
            "positions",
            "weighs nothing without positions; give them, or remove it",
        )?,
        orientation_weight: weight(
            "orientation_weight",
            "orientations",
            "weighs nothing without orientations; give them, or remove it",
        )?,
    }))
}

fn turn(rpy: [f64; 3]) -> Rotation3<f64> {
    Rotation3::from_matrix_unchecked(Placement::from_xyz_rpy([0.0; 3], rpy).rotation)
}

/// Whether two orientations are given by angles of which one turns by half a turn or more, and that way is
/// meant: not where all angles are of the range of one turn, which jump at its ends, and the rotation is
/// small.
fn turns_too_far(pair: &[[f64; 3]]) -> bool {
    let [from, to] = [pair[0], pair[1]];
    let most = (0..3).map(|k| (to[k] - from[k]).abs()).fold(0.0, f64::max);
    let in_range = from.iter().chain(&to).all(|angle| angle.abs() <= PI);
    let jumps = in_range && turn(from).angle_to(&turn(to)) < FRAC_PI_2;
    most >= PI && !jumps
}

/// A list of numbers.
fn numbers(value: &DeValue<'_>) -> Option<Vec<f64>> {
    let DeValue::Array(entries) = value else { return None };
    entries.iter().map(|entry| number(entry.get_ref())).collect()
}

#[cfg(test)]
mod tests {
    use super::turns_too_far;

    #[test]
    fn angles_that_jump_at_the_ends_of_their_range_are_no_turns() {
        for (from, to, too_far) in [
            ([0.0, 0.0, 0.0], [0.0, 0.0, 3.2], true),
            ([0.0, 0.0, 0.0], [0.0, 0.0, 6.3], true),
            ([0.0, 0.0, -1.6], [0.0, 0.0, 1.6], true),
            ([0.0, 0.0, 0.0], [0.0, 0.0, 3.1], false),
            ([3.1, 0.0, 0.0], [-3.1, 0.0, 0.0], false),
            ([0.0, 0.0, 3.0], [0.0, 0.0, 3.3], false),
            // Of one orientation but for 0.02 rad, at a pitch of nearly a right angle.
            ([3.1, 1.56, 3.1], [-0.05, 1.56, -0.05], false),
        ] {
            assert_eq!(turns_too_far(&[from, to]), too_far, "{from:?} {to:?}");
        }
    }
}
