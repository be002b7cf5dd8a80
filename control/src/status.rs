//! How a solution ended.

use serde::{Deserialize, Serialize};
use std::fmt;

/// How solving ended; only [`Converged`](Self::Converged) is a solution.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(into = "String", from = "String")]
#[non_exhaustive]
pub enum Status {
    /// All conditions hold and the estimated error is below the tolerance; those of a smoothed problem where
    /// [`Solution::smoothing`](crate::Solution::smoothing) is not 0, whose cost is that of the problem itself to about 2e-5 of it.
    Converged,
    /// No damped Newton step made the correction shorter.
    NewtonFailed,
    /// Newton's method used up its steps.
    IterationLimit,
    /// The tolerance asks for more nodes than allowed.
    MeshLimit,
    /// The linearised equations are singular: at a conjugate point, or for a motion that is not determined.
    Singular,
    /// The dynamics could not be evaluated; with the reason.
    EvaluationFailed(String),
    /// A continuation (of the final time, the bounds or the smoothing) got stuck before its end.
    ContinuationFailed,
    /// The switching times are those of a smoothed problem: arcs read off from it did not solve the problem itself.
    SwitchesNotRefined,
}

impl Status {
    /// A name for files: "converged", "newton_failed" and so on.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Converged => "converged",
            Self::NewtonFailed => "newton_failed",
            Self::IterationLimit => "iteration_limit",
            Self::MeshLimit => "mesh_limit",
            Self::Singular => "singular",
            Self::EvaluationFailed(_) => "evaluation_failed",
            Self::ContinuationFailed => "continuation_failed",
            Self::SwitchesNotRefined => "switches_not_refined",
        }
    }

    /// Whether it is [`Converged`](Self::Converged).
    pub fn is_converged(&self) -> bool {
        *self == Self::Converged
    }
}

impl fmt::Display for Status {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Converged => f.write_str("converged"),
            Self::NewtonFailed => f.write_str(
                "Newton's method found no step that helps: try another guess (starts), a longer time, or more nodes",
            ),
            Self::IterationLimit => f.write_str("Newton's method used up its steps: allow more of them"),
            Self::MeshLimit => f.write_str("the tolerance asks for more nodes than allowed: loosen one of them"),
            Self::Singular => f.write_str("the linearised equations are singular: a conjugate point, or undetermined"),
            Self::EvaluationFailed(reason) => write!(f, "the dynamics could not be evaluated: {reason}"),
            Self::ContinuationFailed => {
                f.write_str("the way from an easier problem got stuck: are the bounds wide enough for this time?")
            }
            Self::SwitchesNotRefined => {
                f.write_str("solved for a smoothed control only: the arcs read off from it were not confirmed")
            }
        }
    }
}

impl From<Status> for String {
    fn from(status: Status) -> Self {
        match status {
            Status::EvaluationFailed(reason) => format!("evaluation_failed: {reason}"),
            status => status.name().into(),
        }
    }
}

impl From<String> for Status {
    /// A name that is not known counts as a failure of evaluation with that name.
    fn from(name: String) -> Self {
        let all = [
            Self::Converged,
            Self::NewtonFailed,
            Self::IterationLimit,
            Self::MeshLimit,
            Self::Singular,
            Self::ContinuationFailed,
            Self::SwitchesNotRefined,
        ];
        let reason = name.strip_prefix("evaluation_failed: ").unwrap_or(&name).to_owned();
        all.into_iter().find(|status| status.name() == name).unwrap_or(Self::EvaluationFailed(reason))
    }
}
