//! Why a motion has no gains.

use crate::direct::ResolveError;
use crate::problem::error::ProblemError;
use costate::EvalError;

/// Why there are no gains.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GainError {
    /// The solution has no motion.
    #[error("there is no motion to feed back to")]
    NoMotion,
    /// The rate is not a positive number, or asks for too many times.
    #[error("a rate of {rate} Hz; give a positive number of samples in a second, for at most 1e5 of them")]
    Rate {
        /// The rate (Hz).
        rate: f64,
    },
    /// The problem is one that is not solved again.
    #[error(transparent)]
    Problem(#[from] ProblemError),
    /// The dynamics cannot be evaluated along the motion.
    #[error(transparent)]
    Evaluation(#[from] EvalError),
    /// Solving again was not possible.
    #[error(transparent)]
    Resolve(#[from] ResolveError),
    /// Solving again did not come to an end.
    #[error("the motion is not solved on a mesh of its own; try another tolerance or more nodes")]
    NotSolved,
    /// Accelerations are continuous, and the jerk of a joint costs nothing: it is at a limit, or the
    /// acceleration is what the rest of the state asks for, so that the law of jerks has no derivative.
    #[error(
        "accelerations are continuous, and neither the jerk nor the rate of the torque of joint '{joint}' costs \
         anything, so that jerks have no gains; give cost.jerk or cost.torque_rate for it, or solve the rest of \
         the motion by Resolve"
    )]
    FreeJerk {
        /// The name of the joint.
        joint: String,
    },
    /// Accelerations are continuous, and the final time or that of a via is free: gains of jerks are computed
    /// for given times alone.
    #[error(
        "accelerations are continuous, and gains of jerks are computed for given times alone: give the final time \
         and those of all vias, such as the ones that were found, or solve the rest of the motion by Resolve"
    )]
    FreeTime,
    /// The matrix of Newton's method is not positive definite.
    #[error("the motion is no strict minimum, so that there is no feedback")]
    NoMinimum,
}
