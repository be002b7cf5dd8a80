//! Why a step was not made.

/// Why a step was not made. The workspace stays usable.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StepError<E: std::error::Error> {
    /// The model could not be evaluated.
    #[error(transparent)]
    Dynamics(#[from] E),
    /// Newton's method did not solve the implicit equation of the step.
    #[error(
        "the implicit equation of the step was not solved: after {iterations} iterations of Newton's method the last \
         change is {change:.1e} of the state; take a shorter step"
    )]
    NotConverged {
        /// Iterations made.
        iterations: usize,
        /// Size of the last change relative to the state.
        change: f64,
    },
}
