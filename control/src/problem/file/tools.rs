//! Tools and where they are.

use super::error::ProblemFileCause;
use super::fault::Fault;
use super::nested::triple;
use super::table::{Table, number};
use crate::problem::tools::{self, Tool, ToolOrientation, ToolPose};
use costate::robot::Placement;
use nalgebra::Rotation3;
use toml::de::DeValue;

/// The keys of an orientation.
pub(super) const ORIENTATION: &[&str] = &["rpy", "rotation", "quaternion", "axis", "along", "yaw"];

const POSE: &[&str] = &["frame", "offset", "xyz", "rpy", "rotation", "quaternion", "axis", "along", "yaw"];

/// The tools of a state.
pub(super) fn tools(state: &Table<'_>) -> Result<Vec<ToolPose>, Fault> {
    state.tables("tool", POSE)?.iter().map(pose).collect()
}

/// A point of a frame.
pub(super) fn tool(table: &Table<'_>) -> Result<Tool, Fault> {
    let frame = table.need("frame", table.string("frame")?)?;
    Ok(Tool::new(frame).with_offset(triple(table, "offset")?.unwrap_or_default()))
}

/// Where a tool is, in the keys of a tool.
pub(super) fn pose(table: &Table<'_>) -> Result<ToolPose, Fault> {
    Ok(ToolPose { tool: tool(table)?, position: triple(table, "xyz")?, orientation: orientation(table)? })
}

/// The orientation of a tool, where it is given.
pub(super) fn orientation(table: &Table<'_>) -> Result<Option<ToolOrientation>, Fault> {
    let axis = triple(table, "axis")?;
    let along = triple(table, "along")?;
    let conflict = |key: &str, message| Err(table.fault(key, ProblemFileCause::Conflict(message)));
    let rotation = rotation(table)?;
    if let Some(yaw) = table.number("yaw")? {
        if rotation.is_some() || axis.is_some() || along.is_some() {
            return conflict("yaw", "the orientation is given by another key already; keep one of them");
        }
        return Ok(Some(ToolOrientation::Yaw(yaw)));
    }
    Ok(match (rotation, axis, along) {
        (Some(_), _, Some(_)) => {
            return conflict(
                "along",
                "the orientation is given by rpy, rotation or quaternion already; keep one of them",
            );
        }
        (_, Some(_), None) => {
            return conflict("axis", "needs `along`, the direction in the world that this axis shall have");
        }
        (Some(rotation), None, None) => Some(ToolOrientation::Full(rotation)),
        (None, axis, Some(along)) => Some(ToolOrientation::Axis { axis: axis.unwrap_or(Z), along }),
        (None, None, None) => None,
    })
}

/// The axis of a tool, if none is given.
pub(super) const Z: [f64; 3] = [0.0, 0.0, 1.0];

/// An orientation by roll, pitch and yaw, by three rows, or by a quaternion.
pub(super) fn rotation(table: &Table<'_>) -> Result<Option<Rotation3<f64>>, Fault> {
    let rows = table.list("rotation", "three lists of three numbers", |row| match row {
        DeValue::Array(entries) => {
            let numbers: Option<Vec<f64>> = entries.iter().map(|entry| number(entry.get_ref())).collect();
            <[f64; 3]>::try_from(numbers?).ok()
        }
        _ => None,
    })?;
    if let Some(numbers) = table.numbers("quaternion")? {
        if rows.is_some() || table.has("rpy") {
            let message = "the orientation is given by rpy or rotation already; keep one of them";
            return Err(table.fault("quaternion", ProblemFileCause::Conflict(message)));
        }
        let wrong = "give [x, y, z, w] of length 1 to 1e-3";
        let found = <[f64; 4]>::try_from(numbers).ok().and_then(tools::rotation_of_quaternion);
        return found.map(Some).ok_or_else(|| table.fault("quaternion", ProblemFileCause::Conflict(wrong)));
    }
    match (triple(table, "rpy")?, rows) {
        (Some(_), Some(_)) => {
            let message = "the orientation is given by rpy already; keep one of the two";
            Err(table.fault("rotation", ProblemFileCause::Conflict(message)))
        }
        (Some(rpy), None) => {
            if !rpy.iter().all(|angle| angle.is_finite()) {
                return Err(table.fault("rpy", ProblemFileCause::Conflict("must be finite")));
            }
            Ok(Some(Rotation3::from_matrix_unchecked(Placement::from_xyz_rpy([0.0; 3], rpy).rotation)))
        }
        (None, Some(rows)) => {
            let wrong = "give three rows that are orthonormal and right-handed to 1e-6";
            let found = <[[f64; 3]; 3]>::try_from(rows).ok().and_then(tools::rotation);
            found.map(Some).ok_or_else(|| table.fault("rotation", ProblemFileCause::Conflict(wrong)))
        }
        (None, None) => Ok(None),
    }
}
