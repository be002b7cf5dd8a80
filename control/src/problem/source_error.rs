//! Why equations of a problem were not recorded.

use super::error::ProblemError;
use costate::EvalError;
use costate::codegen::CodegenError;

/// Why the equations of a problem were not recorded, or not replaced by generated code.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SourceError {
    /// The problem is not valid.
    #[error(transparent)]
    Problem(#[from] ProblemError),
    /// The equations cannot be recorded.
    #[error(transparent)]
    Codegen(#[from] CodegenError),
    /// The dynamics cannot be evaluated at the start or the end.
    #[error(transparent)]
    Eval(#[from] EvalError),
}
