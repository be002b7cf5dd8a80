//! Why a loop was not closed.

use crate::error::EvalError;
use crate::robot::printable;

/// Why constraints could not be satisfied. The workspace remains usable.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ConstraintError {
    /// The robot cannot be evaluated there.
    #[error(transparent)]
    Evaluation(#[from] EvalError),
    /// The loop cannot be closed, or not from this position.
    #[error(
        "constraint '{}' cannot be satisfied: at the nearest position that was found it misses by {miss:.3e} \
         (m, rad); correct its frames or lengths, release held joints, or start nearer to where it is closed",
        printable(constraint)
    )]
    CannotClose {
        /// The constraint with the row that misses most.
        constraint: String,
        /// By how much (m, rad).
        miss: f64,
    },
    /// Two constraints ask for different things.
    #[error(
        "constraint '{}' contradicts those before it: where they are satisfied it misses by {miss:.3e} (m, rad), \
         and no motion that they allow changes that; correct or remove one of them",
        printable(constraint)
    )]
    Contradiction {
        /// The constraint with the redundant row that misses most.
        constraint: String,
        /// By how much (m, rad).
        miss: f64,
    },
}
