//! Branches of solutions: their points and how they ended.

use super::Parameter;
use crate::result::solution::Solution;
use crate::status::Status;
use serde::{Deserialize, Serialize};

/// One solution of a branch.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct BranchPoint {
    /// Value of the parameter.
    pub parameter: f64,
    /// `c_t T + integral of 1/2 sum r_i u_i^2`, without penalties.
    pub cost: f64,
    /// Integral of the penalties.
    pub penalty_cost: f64,
    /// T (s).
    pub final_time: f64,
    /// Mean of H*.
    pub hamiltonian: f64,
    /// How it ended.
    pub status: Status,
    /// Newton steps since the last point, failed attempts among them.
    pub newton_steps: usize,
}

/// Where a branch turns back: on one side of it the branch has no solution nearby, on the other it has two.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct TurningPoint {
    /// Value of the parameter.
    pub parameter: f64,
    /// Cost there, without penalties.
    pub cost: f64,
    /// T (s) there.
    pub final_time: f64,
    /// Number of points of the branch before it.
    pub after: usize,
}

/// How following a branch ended.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum BranchEnd {
    /// At the last value.
    Reached,
    /// Beyond a turning point, back at the first value with another solution.
    TurnedBack,
    /// The step became too small.
    Stuck,
    /// More points than allowed.
    TooManyPoints,
    /// The problem was not solved at the first value.
    NotStarted,
    /// Stopped by the caller or by the time limit.
    Interrupted,
}

/// A branch of solutions.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Branch {
    /// The parameter.
    pub parameter: Parameter,
    /// Points in order along the branch.
    pub points: Vec<BranchPoint>,
    /// Where the branch turns back.
    pub turning_points: Vec<TurningPoint>,
    /// How it ended.
    pub end: BranchEnd,
    /// The solution at the last point; with [`Status::ContinuationFailed`] if the last value was not reached.
    pub solution: Solution,
}
