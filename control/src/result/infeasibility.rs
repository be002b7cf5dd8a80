//! What keeps a problem from having a solution.

use serde::{Deserialize, Serialize};

/// Why no motion keeps all limits, as far as that was found: a proof, or which limits are exceeded where
/// their violation has a local minimum.
///
/// At the motion that was found the sum of these amounts has a local minimum, each relative to its range, or
/// to what it lacks at the start of the search if that is more. Each limit is relaxed by the same amount all
/// along the motion.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Infeasibility {
    /// The limits that are relaxed, the one by the largest part of its range first, but before all the one
    /// that a proof is about. Those relaxed by less than a hundredth of that part are left out.
    pub limits: Vec<RelaxedLimit>,
    /// A final time (s) with which the problem was solved, if the time is fixed and a longer one helps.
    #[serde(default)]
    pub final_time: Option<f64>,
    /// A final time (s) below which no motion keeps the limits on rates and accelerations, whatever its
    /// torques are, if that is longer than the one that is given.
    #[serde(default)]
    pub least_time: Option<f64>,
    /// Whether it is proven that no motion keeps the limits, whatever is free takes as its value. Else
    /// another guess or a finer mesh may find one.
    pub is_global: bool,
    /// The proof, in words.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub proof: Option<String>,
}

/// A limit that has to give.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct RelaxedLimit {
    /// "position", "rate", "acceleration", "torque", "jerk", "torque_rate", "power", "torque_speed",
    /// "ground_force", "landing_impulse" or "task".
    pub kind: String,
    /// Name of the joint, "all joints", or the name of what a tool or a body shall keep.
    /// In JSON its key is `joint`.
    #[serde(rename = "joint")]
    pub name: String,
    /// "min" or "max"; "equal" for an equation.
    pub side: String,
    /// When the limit matters most (s).
    pub time: f64,
    /// By how much it has to give.
    pub amount: f64,
    /// The same in parts of its range, the distance between lower and upper limit.
    #[serde(default)]
    pub part: f64,
    /// The unit of `amount` and `limit`.
    pub unit: String,
    /// The limit; none for tools and bodies. That of a motor that drives fast depends on its rate: the one at
    /// `time`, 0 beyond the no-load speed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub limit: Option<f64>,
    /// The rate of the joint at `time`, where the torque of its motor is limited by it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rate: Option<f64>,
    /// With it, the speed from which on the motor has no torque.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub no_load_speed: Option<f64>,
}

impl Infeasibility {
    /// Whether a slower motion may need less.
    pub(crate) fn depends_on_time(&self) -> bool {
        self.limits.iter().all(|limit| !matches!(&limit.kind[..], "position" | "task"))
    }
}
