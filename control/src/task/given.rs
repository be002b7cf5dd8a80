//! Numbers and names of a task, checked.

use crate::problem::error::ProblemError;
use crate::problem::key::Key;
use crate::problem::task_error::TaskError;
use costate::robot::{Robot, RobotError};
use nalgebra::Vector3;

/// Where a part of a task is given: a table of a problem file, the number of its entry.
#[derive(Clone, Copy, Debug)]
pub(super) struct Given {
    pub table: &'static str,
    pub entry: usize,
}

impl Given {
    /// One of its keys.
    pub fn key(self, name: &'static str) -> Key {
        Key::entry(self.table, name, self.entry)
    }
}

impl TaskError {
    /// As an error of a key.
    pub(super) fn at(self, key: Key) -> ProblemError {
        ProblemError::Task { key, cause: self }
    }
}

/// The number of a frame.
pub(super) fn frame_of(robot: &Robot, key: Key, name: &str) -> Result<usize, ProblemError> {
    robot.frame_index(name).map_err(|error| {
        let nearest = if let RobotError::UnknownFrame { nearest, .. } = error { nearest } else { Vec::new() };
        TaskError::UnknownFrame { frame: name.into(), nearest }.at(key)
    })
}

/// All entries are finite.
pub(super) fn finite(key: Key, values: &[f64]) -> Result<(), ProblemError> {
    if values.iter().all(|value| value.is_finite()) { Ok(()) } else { Err(TaskError::NotFinite.at(key)) }
}

/// The direction of a vector, with length one.
pub(super) fn direction(key: Key, vector: [f64; 3]) -> Result<Vector3<f64>, ProblemError> {
    let vector = Vector3::from(vector);
    let size = vector.amax();
    if !(size > 0.0 && size.is_finite()) {
        return Err(TaskError::NoDirection.at(key));
    }
    // By its largest entry first, so that no square over- or underflows.
    Ok((vector / size).normalize())
}

/// A number that is neither negative nor infinite.
pub(super) fn positive_or_zero(key: Key, value: f64) -> Result<(), ProblemError> {
    if value >= 0.0 && value.is_finite() {
        return Ok(());
    }
    Err(TaskError::OutOfRange { value, remedy: "must be neither negative nor infinite" }.at(key))
}

/// A length that is positive and finite.
pub(super) fn length(key: Key, value: f64) -> Result<(), ProblemError> {
    if value > 0.0 && value.is_finite() {
        return Ok(());
    }
    Err(TaskError::OutOfRange { value, remedy: "must be positive and finite" }.at(key))
}
