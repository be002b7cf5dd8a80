//! Parts of the JSON form of a solution.

use super::start::{GuessKind, StartResult};
use super::trajectory_error::TrajectoryError;
use crate::status::{BoundViolation, Status};
use serde::{Deserialize, Serialize};

/// Units of the numbers in the file.
#[derive(Serialize)]
pub(super) struct Units {
    time: &'static str,
    revolute: &'static str,
    prismatic: &'static str,
}

pub(super) const UNITS: Units = Units { time: "s", revolute: "rad, rad/s, N m", prismatic: "m, m/s, N" };

/// A [`CostateStart`](super::solution::CostateStart).
#[derive(Default, Serialize, Deserialize)]
pub(super) struct SavedCostates {
    pub y_q: Vec<f64>,
    pub y_p: Vec<f64>,
}

/// A [`StartResult`].
#[derive(Serialize, Deserialize)]
pub(super) struct SavedStart {
    total: Option<f64>,
    status: Status,
    #[serde(default)]
    violation: f64,
    #[serde(default)]
    guess: GuessKind,
    #[serde(default = "one")]
    looks: usize,
}

/// A [`BoundViolation`], with its joint by name.
#[derive(Serialize, Deserialize)]
pub(super) struct SavedViolation {
    joint: String,
    time: f64,
    u: f64,
    bound: f64,
    factor: f64,
}

fn one() -> usize {
    1
}

impl From<&StartResult> for SavedStart {
    fn from(start: &StartResult) -> Self {
        let StartResult { total, status, violation, guess, looks } = start.clone();
        Self { total: finite(total), status, violation, guess, looks }
    }
}

impl From<SavedStart> for StartResult {
    fn from(start: SavedStart) -> Self {
        let SavedStart { total, status, violation, guess, looks } = start;
        Self { total: total.unwrap_or(f64::INFINITY), status, violation, guess, looks }
    }
}

impl SavedViolation {
    pub fn new(violation: BoundViolation, joints: &[String]) -> Self {
        let BoundViolation { control, time, u, bound, factor } = violation;
        Self { joint: joints.get(control).cloned().unwrap_or_default(), time, u, bound, factor }
    }

    pub fn into_violation(self, joints: &[String]) -> Result<BoundViolation, TrajectoryError> {
        let Self { joint, time, u, bound, factor } = self;
        match joints.iter().position(|name| *name == joint) {
            Some(control) => Ok(BoundViolation { control, time, u, bound, factor }),
            None => Err(TrajectoryError::UnknownJoint { joint, joints: joints.to_vec() }),
        }
    }
}

/// None for what is infinite or not a number.
pub(super) fn finite(x: f64) -> Option<f64> {
    x.is_finite().then_some(x)
}
