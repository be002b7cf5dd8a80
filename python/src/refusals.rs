//! Robots that are not taken.

use crate::errors::{self, argument};
use costate::robot::{self, RobotFormat};
use pyo3::prelude::*;

/// Refuses a robot with floating or spherical joints where they are not taken, saying what it cannot.
///
/// # Errors
/// `RobotError` with the first such joint.
pub fn refuse_free_joints(py: Python<'_>, robot: &robot::Robot, what: &'static str) -> PyResult<()> {
    let Some(free) = robot.free_joints().first() else { return Ok(()) };
    let (joint, kind) = (free.name.clone(), free.kind.name());
    Err(errors::robot(py, &robot::RobotError::FreeJoint { joint, kind, what }))
}

/// A robot in TOML has the joints that it describes, that of its base among them.
///
/// # Errors
/// `ArgumentError` where a floating base is asked for all the same.
pub fn refuse_floating_base(py: Python<'_>, asked: bool, format: RobotFormat) -> PyResult<()> {
    if !asked || format != RobotFormat::Toml {
        return Ok(());
    }
    let message = "a robot in TOML names the joint of its base itself: give that joint type = \"floating\" \
                   there, and leave floating_base out";
    Err(argument(py, "floating_base", message.into()))
}
