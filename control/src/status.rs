//! How a solution ended.

use crate::problem::error::ProblemError;
use costate::EvalError;
use serde::{Deserialize, Serialize};
use std::fmt;

/// Why an evaluation failed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum EvaluationFailure {
    /// The dynamics could not be evaluated.
    #[error(transparent)]
    Dynamics(#[from] EvalError),
    /// A continuation led to a problem that cannot be posed.
    #[error(transparent)]
    Problem(#[from] ProblemError),
    /// The integration between two nodes took too many steps.
    #[error("the motion between two nodes cannot be integrated: it grows without bound; use more nodes")]
    Integration,
    /// As read from a file.
    #[error("{0}")]
    Saved(String),
}

/// Where a motion exceeds the bounds of a control most.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct BoundViolation {
    /// The control, counted from 0.
    pub control: usize,
    /// When (s).
    pub time: f64,
    /// Distance from the middle of the bounds, relative to half the distance between them: 1 at a bound, more
    /// beyond.
    pub factor: f64,
}

/// How solving ended; only [`Converged`](Self::Converged) is a solution.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(into = "String", from = "String")]
#[non_exhaustive]
pub enum Status {
    /// All conditions hold and the estimated error is below the tolerance; those of a smoothed problem where
    /// [`Solution::smoothing`](crate::Solution::smoothing) is not 0, whose cost is that of the problem itself
    /// to about 2e-5 of it.
    Converged,
    /// No damped Newton step made the correction shorter.
    NewtonFailed,
    /// Newton's method used up its steps.
    IterationLimit,
    /// The tolerance asks for more nodes than allowed.
    MeshLimit,
    /// The linearised equations are singular: at a conjugate point, or for a motion that is not determined.
    Singular,
    /// The dynamics could not be evaluated.
    EvaluationFailed(EvaluationFailure),
    /// A continuation (of the final time, the bounds or the smoothing) got stuck before its end.
    ContinuationFailed,
    /// The switching times are those of a smoothed problem: arcs read off from it did not solve the problem
    /// itself.
    SwitchesNotRefined,
    /// A motion was found with wider bounds only: they could not be tightened to those of the problem.
    BoundsNotReached(BoundViolation),
    /// Cancelled by the caller.
    Cancelled,
    /// The time limit was reached.
    TimeLimit,
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
            Self::BoundsNotReached(_) => "bounds_not_reached",
            Self::Cancelled => "cancelled",
            Self::TimeLimit => "time_limit",
        }
    }

    /// Whether the search was stopped by the caller or by the time limit.
    pub fn is_interruption(&self) -> bool {
        matches!(self, Self::Cancelled | Self::TimeLimit)
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
            Self::BoundsNotReached(BoundViolation { control, time, factor }) => write!(
                f,
                "no motion within the bounds was found: they would have to be {factor:.4} times as wide for control \
                 {control} (at {time:.4} s); widen the bounds or allow more time"
            ),
            Self::Cancelled => f.write_str("cancelled: this is the best iterate so far"),
            Self::TimeLimit => f.write_str("the time limit was reached: allow more time"),
        }
    }
}

impl From<Status> for String {
    fn from(status: Status) -> Self {
        match status {
            Status::EvaluationFailed(reason) => format!("evaluation_failed: {reason}"),
            Status::BoundsNotReached(BoundViolation { control, time, factor }) => {
                format!("bounds_not_reached: {control} {time} {factor}")
            }
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
            Self::Cancelled,
            Self::TimeLimit,
        ];
        if let Some(violation) = name.strip_prefix("bounds_not_reached: ").and_then(violation) {
            return Self::BoundsNotReached(violation);
        }
        let reason =
            EvaluationFailure::Saved(name.strip_prefix("evaluation_failed: ").unwrap_or(&name).into());
        all.into_iter().find(|status| status.name() == name).unwrap_or(Self::EvaluationFailed(reason))
    }
}

/// Control, time and factor, separated by spaces.
fn violation(text: &str) -> Option<BoundViolation> {
    let mut parts = text.split(' ');
    let control = parts.next()?.parse().ok()?;
    let (time, factor) = (parts.next()?.parse().ok()?, parts.next()?.parse().ok()?);
    Some(BoundViolation { control, time, factor })
}
