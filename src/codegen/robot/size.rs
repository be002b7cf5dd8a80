//! Robots that are too large for a program, refused before the quantity is recorded.
//!
//! A recording that was stopped at its limit still runs the generic code to its end, which takes n^3
//! operations. The mass matrix is part of every quantity that is as expensive, and takes n^2.

use super::quantity::{Coordinates, Quantity};
use crate::codegen::error::CodegenError;
use crate::codegen::record::{OPERATIONS_PER_STEP, RecordingLimit, record};
use crate::kernels::KernelOne;
use crate::robot::{Robot, Tree};

/// Robots with more joints have their mass matrix recorded first.
const MANY_JOINTS: usize = 48;

/// Refuses a robot whose mass matrix alone is too long for a program called `name`: by the number of its
/// entries, and, for robots of many joints, by recording it.
///
/// An entry belongs to each pair of joints of which one carries the other, so their number is the sum of the
/// depths of all joints.
///
/// # Errors
/// [`CodegenError::LargeRobot`], [`CodegenError::LongRecording`].
pub(super) fn check_size(
    robot: &Robot,
    quantity: Quantity,
    coordinates: Coordinates,
    name: &str,
    limit: usize,
) -> Result<(), CodegenError> {
    if limit == usize::MAX || !quantity.contains_mass_matrix(coordinates) {
        return Ok(());
    }
    let mut depths: Vec<usize> = Vec::with_capacity(robot.joints().len());
    for joint in robot.joints() {
        let carrier = joint.parent.and_then(|parent| depths.get(parent));
        depths.push(1 + carrier.copied().unwrap_or(0));
    }
    let (joints, entries) = (depths.len(), depths.iter().sum());
    if entries > limit.saturating_mul(OPERATIONS_PER_STEP) {
        return Err(CodegenError::LargeRobot { robot: robot.name().into(), joints, entries, limit });
    }
    if joints <= MANY_JOINTS {
        return Ok(());
    }
    let tree = Tree::from(robot);
    let (outcome, _) = record(robot.nq(), RecordingLimit { name, steps: limit }, |q| {
        let mut kernel = KernelOne::new(&tree);
        let outcome = kernel.set_position(&tree, q);
        (outcome, kernel.mass_matrix().as_slice().to_vec())
    })?;
    Ok(outcome?)
}
