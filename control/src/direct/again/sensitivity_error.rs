//! Why a cost has no derivative by parameters of the robot.

use crate::problem::error::ProblemError;
use crate::status::Status;
use costate::EvalError;

/// Why the cost of a motion cannot be differentiated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SensitivityError {
    /// The motion is not optimal, so its cost does not tell that of the optimal motion nearby.
    #[error("the motion is not optimal, its status is {}; only an optimal motion has this derivative", .0.name())]
    NotOptimal(Status),
    /// The motion, or the parameters, are those of another robot.
    #[error("the {what} of another robot; give what belongs to the robot of the problem")]
    OtherRobot {
        /// What belongs to another robot.
        what: &'static str,
    },
    /// An end whose positions are given keeps an equation that depends on this parameter: with another value
    /// no motion keeps it.
    #[error(
        "the {row} holds at given positions with this '{name}' alone, and no motion is near with another one; \
         leave the parameter out, or free positions at the end of the phase"
    )]
    GivenEnd {
        /// The parameter.
        name: String,
        /// What shall hold.
        row: String,
    },
    /// The robot cannot have a value of this parameter near its own, or what tools keep is another list then.
    #[error("parameter '{name}' cannot change by {step}: {cause}; leave it out")]
    Displaced {
        /// The parameter.
        name: String,
        /// The change (m, rad).
        step: f64,
        /// What does not go.
        cause: String,
    },
    /// The motion is a step of a gait.
    #[error(
        "the cost of a step of a gait has no derivative by the robot here, as feet and landing depend on it too; \
         solve again with another robot"
    )]
    Gait,
    /// The motion was not found again on its mesh, where its multipliers are looked for.
    #[error("the motion is not solved on its mesh once more; try another tolerance or more nodes")]
    NotSolved,
    /// The problem is one that is not solved again.
    #[error(transparent)]
    Problem(Box<ProblemError>),
    /// The dynamics cannot be evaluated along the motion.
    #[error(transparent)]
    Evaluation(#[from] EvalError),
}

impl From<ProblemError> for SensitivityError {
    fn from(error: ProblemError) -> Self {
        Self::Problem(Box::new(error))
    }
}
