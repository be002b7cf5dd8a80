//! What keeps a motion from being begun.

use crate::direct_states::problem::DirectDynamicsError;
use crate::problem::error::ProblemError;
use crate::status::Status;
use costate::EvalError;

/// Why a problem that was checked could not be begun all the same.
#[derive(Debug)]
pub(super) enum Unsolved {
    Problem(ProblemError),
    States(DirectDynamicsError),
    Evaluation(EvalError),
}

impl From<ProblemError> for Unsolved {
    fn from(error: ProblemError) -> Self {
        Self::Problem(error)
    }
}

impl From<DirectDynamicsError> for Unsolved {
    fn from(error: DirectDynamicsError) -> Self {
        Self::States(error)
    }
}

impl From<EvalError> for Unsolved {
    fn from(error: EvalError) -> Self {
        Self::Evaluation(error)
    }
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
