//! What keeps a motion from being begun.

use crate::direct_states::problem::DirectDynamicsError;
use crate::problem::error::ProblemError;
use crate::status::Status;
use costate::EvalError;

/// Why a problem that was checked could not be begun all the same.
#[derive(Debug, thiserror::Error)]
pub(super) enum Unsolved {
    #[error(transparent)]
    Problem(#[from] ProblemError),
    #[error(transparent)]
    States(#[from] DirectDynamicsError),
    #[error(transparent)]
    Evaluation(#[from] EvalError),
}

impl From<Unsolved> for Status {
    fn from(unsolved: Unsolved) -> Self {
        match unsolved {
            Unsolved::Problem(error) => Self::EvaluationFailed(error.into()),
            Unsolved::States(error) => {
                let reason = error.to_string();
                Self::EvaluationFailed(EvalError::Model { reason }.into())
            }
            Unsolved::Evaluation(error) => Self::EvaluationFailed(error.into()),
        }
    }
}
