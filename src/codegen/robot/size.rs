//! Robots that are too large for a program, refused before anything is recorded.

use super::quantity::{Coordinates, Quantity};
use crate::codegen::error::CodegenError;
use crate::codegen::program::OPERATIONS_PER_STEP;
use crate::robot::Robot;

/// Refuses a robot whose mass matrix alone has more entries than operations may be recorded.
///
/// An entry belongs to each pair of joints of which one carries the other, so their number is the sum of the
/// depths of all joints.
///
/// # Errors
/// [`CodegenError::LargeRobot`].
pub(super) fn check_size(
    robot: &Robot,
    quantity: Quantity,
    coordinates: Coordinates,
    limit: usize,
) -> Result<(), CodegenError> {
    if quantity != Quantity::MassMatrix && !quantity.inverts(coordinates) {
        return Ok(());
    }
    let mut depths: Vec<usize> = Vec::with_capacity(robot.joints().len());
    for joint in robot.joints() {
        let carrier = joint.parent.and_then(|parent| depths.get(parent));
        depths.push(1 + carrier.copied().unwrap_or(0));
    }
    let entries: usize = depths.iter().sum();
    if entries <= limit.saturating_mul(OPERATIONS_PER_STEP) {
        return Ok(());
    }
    Err(CodegenError::LargeRobot { robot: robot.name().into(), joints: depths.len(), entries, limit })
}
