//! The tables and keys of a problem file; unknown ones are errors.

use costate_control::{Coordinates, Jacobian, Method};
use serde::Deserialize;
use std::path::PathBuf;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ProblemFile {
    /// Relative to the problem file.
    pub robot: PathBuf,
    pub start: EndTable,
    pub end: EndTable,
    pub time: TimeTable,
    #[serde(default)]
    pub cost: CostTable,
    #[serde(default)]
    pub actuation: ActuationTable,
    pub bounds: Option<BoundsTable>,
    pub penalty: Option<PenaltyTable>,
    pub start_from: Option<StartFromTable>,
    #[serde(default)]
    pub solver: SolverTable,
}

/// State at the start or the end, rad or m, rad/s or m/s.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EndTable {
    pub q: Vec<f64>,
    pub v: Option<Vec<f64>>,
    #[serde(default)]
    pub q_free: Vec<JointName>,
    #[serde(default)]
    pub v_free: Vec<JointName>,
}

/// A joint, by its name or by its place in the lists, from 0.
#[derive(Deserialize)]
#[serde(untagged, expecting = "a joint is meant by its name or by its number, from 0")]
pub enum JointName {
    Place(usize),
    Name(String),
}

/// s.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TimeTable {
    #[serde(rename = "final")]
    pub last: Option<f64>,
    #[serde(default)]
    pub free: bool,
    pub guess: Option<f64>,
}

#[derive(Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CostTable {
    pub time: f64,
    pub effort: Option<Vec<f64>>,
}

#[derive(Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ActuationTable {
    pub gain: Option<Vec<f64>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BoundsTable {
    pub u_min: Vec<f64>,
    pub u_max: Vec<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PenaltyTable {
    pub weight: f64,
    pub q_min: Option<Vec<f64>>,
    pub q_max: Option<Vec<f64>>,
    pub v_max: Option<Vec<f64>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StartFromTable {
    /// Relative to the problem file.
    pub file: PathBuf,
}

#[derive(Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SolverTable {
    pub starts: Option<usize>,
    pub seed: Option<u64>,
    pub tolerance: Option<f64>,
    pub nodes: Option<usize>,
    pub jacobian: Option<Jacobian>,
    pub method: Option<Method>,
    pub coordinates: Option<Coordinates>,
}
