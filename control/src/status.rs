//! How a solve ended.

use crate::bvp::Failure;
use costate::EvalError;
use serde::{Deserialize, Serialize};
use std::fmt;

/// How a solve ended. [`Converged`](Self::Converged) and [`ConvergedSmoothed`](Self::ConvergedSmoothed) are solutions;
/// with any other status the motion is the best iterate.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(into = "String", from = "String")]
#[non_exhaustive]
pub enum Status {
    /// The conditions of the problem hold, the estimated error is below the tolerance, and integrating the motion again
    /// confirms it: the end defect and the shooting defect are below the
    /// [verification bound](crate::Motion::verification_bound).
    Converged,
    /// As [`Converged`](Self::Converged), but for a smoothed control: the motion has no isolated switching times. Its
    /// cost is that of the problem itself to a relative 2e-5, and it satisfies the conditions of the smoothed problem
    /// with the weight [`Motion::smoothing`](crate::Motion::smoothing). Only the end defect is verified.
    ConvergedSmoothed,
    /// The collocation equations are solved to the tolerance, but integrating the motion again misses: a defect is above
    /// the [verification bound](crate::Motion::verification_bound), or the integration stopped. Unstable motions end so.
    NotVerified,
    /// No damped Newton step reduced the correction.
    NewtonFailed,
    /// Newton's method used up its iterations.
    IterationLimit,
    /// The tolerance needs more nodes than allowed.
    MeshLimit,
    /// The linearised equations are singular: at a conjugate point, or where the motion is not determined.
    Singular,
    /// The dynamics could not be evaluated.
    EvaluationFailed {
        /// What the evaluation said.
        reason: String,
        /// The error itself; `None` for a solution that was read from a file.
        cause: Option<EvalError>,
    },
    /// A homotopy (in the final time, the bounds or the smoothing) stopped before its end.
    ContinuationFailed,
    /// The switching times belong to a smoothed problem: arcs read off from it did not solve the problem itself.
    SwitchesNotRefined,
}

impl Status {
    /// The dynamics could not be evaluated.
    pub fn evaluation_failed(error: EvalError) -> Self {
        Self::EvaluationFailed { reason: error.to_string(), cause: Some(error) }
    }

    /// A problem that cannot be evaluated for a reason other than the dynamics.
    pub(crate) fn refused(reason: impl fmt::Display) -> Self {
        Self::EvaluationFailed { reason: reason.to_string(), cause: None }
    }

    /// A name for files: "converged", "newton_failed" and so on.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Converged => "converged",
            Self::ConvergedSmoothed => "converged_smoothed",
            Self::NotVerified => "not_verified",
            Self::NewtonFailed => "newton_failed",
            Self::IterationLimit => "iteration_limit",
            Self::MeshLimit => "mesh_limit",
            Self::Singular => "singular",
            Self::EvaluationFailed { .. } => "evaluation_failed",
            Self::ContinuationFailed => "continuation_failed",
            Self::SwitchesNotRefined => "switches_not_refined",
        }
    }

    /// Whether it is [`Converged`](Self::Converged).
    pub fn is_converged(&self) -> bool {
        *self == Self::Converged
    }

    /// Whether the motion is a solution: of the problem, or of its smoothed form.
    pub fn is_solved(&self) -> bool {
        matches!(self, Self::Converged | Self::ConvergedSmoothed)
    }
}

impl fmt::Display for Status {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = match self {
            Self::Converged => "converged",
            Self::ConvergedSmoothed => {
                "converged, with a smoothed control: the motion has no isolated switching times"
            }
            Self::NotVerified => {
                "the equations are solved, but integrating the motion again misses its end; \
                 shorten the motion or tighten the tolerance"
            }
            Self::NewtonFailed => {
                "Newton's method found no step that reduces the error; \
                 try more guesses (starts), a longer time, or more nodes"
            }
            Self::IterationLimit => "Newton's method used up its iterations; allow more",
            Self::MeshLimit => {
                "the tolerance needs more nodes than allowed; loosen the tolerance or allow more nodes"
            }
            Self::Singular => {
                "the linearised equations are singular: a conjugate point, or a motion that is not determined"
            }
            Self::EvaluationFailed { reason, .. } => {
                return write!(f, "the dynamics could not be evaluated: {reason}");
            }
            Self::ContinuationFailed => {
                "the homotopy from an easier problem stopped; check that the bounds allow the motion in this time"
            }
            Self::SwitchesNotRefined => {
                "solved for a smoothed control only; the switching times read off from it were not confirmed"
            }
        };
        f.write_str(text)
    }
}

impl From<Failure> for Status {
    fn from(failure: Failure) -> Self {
        match failure {
            Failure::Singular(_) => Self::Singular,
            Failure::Evaluation(error) => Self::evaluation_failed(error),
            other => Self::refused(other),
        }
    }
}

impl From<Status> for String {
    fn from(status: Status) -> Self {
        match status {
            Status::EvaluationFailed { reason, .. } => format!("evaluation_failed: {reason}"),
            status => status.name().into(),
        }
    }
}

impl From<String> for Status {
    /// An unknown name counts as a failed evaluation with that reason.
    fn from(name: String) -> Self {
        let all = [
            Self::Converged,
            Self::ConvergedSmoothed,
            Self::NotVerified,
            Self::NewtonFailed,
            Self::IterationLimit,
            Self::MeshLimit,
            Self::Singular,
            Self::ContinuationFailed,
            Self::SwitchesNotRefined,
        ];
        let reason = name.strip_prefix("evaluation_failed: ").unwrap_or(&name).to_owned();
        let known = all.into_iter().find(|status| status.name() == name);
        known.unwrap_or(Self::EvaluationFailed { reason, cause: None })
    }
}
