//! What following a branch gives.

use super::Parameter;
use crate::result::solution::Solution;
use crate::status::Status;
use serde::{Deserialize, Serialize};

/// One solution of a branch.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
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
    /// How solving it ended.
    pub status: Status,
    /// Newton steps since the last point, failed attempts among them.
    pub newton_steps: usize,
}

/// Where a branch turns back: beyond it there is no solution on this branch, and two before it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
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

/// How the walk along a branch ended.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum BranchEnd {
    /// At the value asked for.
    Reached,
    /// Back at the value where it began, past a turning point, on another solution.
    TurnedBack,
    /// No step was small enough.
    Stuck,
    /// More points than allowed.
    TooManyPoints,
    /// The problem was not solved where the way begins.
    NotStarted,
}

/// What following a branch gave.
#[derive(Clone, Debug)]
pub struct Branch {
    /// The parameter.
    pub parameter: Parameter,
    /// Points in their order along the branch.
    pub points: Vec<BranchPoint>,
    /// Where it turned back.
    pub turning_points: Vec<TurningPoint>,
    /// How it ended.
    pub end: BranchEnd,
    /// The last point in full; where the walk got stuck, with the status [`Status::ContinuationFailed`].
    pub solution: Solution,
}
