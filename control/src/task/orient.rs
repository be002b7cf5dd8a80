//! Orientations that tools shall have.

use super::functions::TaskFunctions;
use super::given::{Given, direction};
use super::tool::Quantity;
use crate::problem::error::ProblemError;
use crate::problem::task_error::TaskError;
use crate::problem::tools::ToolOrientation;
use std::mem::discriminant;

/// The function that is zero at an orientation.
pub(super) fn oriented(at: Given, orientation: &ToolOrientation) -> Result<Quantity, ProblemError> {
    match orientation {
        ToolOrientation::Full(rotation) if rotation.matrix().iter().all(|entry| entry.is_finite()) => {
            Ok(Quantity::Orientation(*rotation))
        }
        ToolOrientation::Full(_) => Err(TaskError::NotARotation.at(at.key("rotation"))),
        ToolOrientation::Yaw(yaw) if yaw.is_finite() => Ok(Quantity::yaw(*yaw)),
        ToolOrientation::Yaw(_) => Err(TaskError::NotFinite.at(at.key("yaw"))),
        ToolOrientation::Axis { axis, along } => {
            Ok(Quantity::direction(direction(at.key("axis"), *axis)?, direction(at.key("along"), *along)?))
        }
    }
}

/// Gives the tool whose orientation has its first row at `row` another one of the same kind. Nothing is
/// allocated.
///
/// # Errors
/// The cause: an orientation that is none, or of the other kind.
pub(crate) fn orient(
    functions: &mut TaskFunctions,
    row: usize,
    to: &ToolOrientation,
) -> Result<(), TaskError> {
    let quantity = match oriented(Given { table: "tool", entry: 0 }, to) {
        Ok(quantity) => quantity,
        Err(ProblemError::Task { cause, .. }) => return Err(cause),
        // What is wrong with an orientation is wrong with the task.
        Err(_) => return Err(TaskError::NotARotation),
    };
    match functions.tool_at(row) {
        Some(tool) if discriminant(&tool.quantity) == discriminant(&quantity) => {
            tool.quantity = quantity;
            Ok(())
        }
        _ => Err(TaskError::OtherOrientation),
    }
}
