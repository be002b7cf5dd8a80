//! Errors of a step.

use crate::error::LengthError;
use crate::scalar::Scalar;

/// Why a step could not be computed. The workspace stays usable.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StepError<E: std::error::Error> {
    /// The model could not be evaluated.
    #[error(transparent)]
    Dynamics(#[from] E),
    /// An argument has the wrong length.
    #[error("{0}; the model of the step fixes the length")]
    WrongLength(#[source] LengthError),
    /// The duration is infinite or not a number.
    #[error("the duration h of the step is not finite; check the computation that produced it")]
    NonFiniteDuration,
    /// Newton's method did not solve the implicit equation of the step.
    #[error(
        "the implicit equation of the step was not solved: after {iterations} iterations of Newton's method the last \
         correction is up to {change:.0e} of the state; take a shorter step"
    )]
    NotConverged {
        /// Number of iterations.
        iterations: usize,
        /// The smallest power of ten above the last correction, relative to max(1, its half of the state);
        /// infinite where there is none.
        change: f64,
    },
    /// Newton's method stopped early: the momenta or velocities of the joints differ by many orders of
    /// magnitude, and the small ones are not solved to rounding.
    #[error(
        "the implicit equation of a {scheme} step was solved to {difference:.0e} of the state only: the joints' masses \
         differ by many orders of magnitude"
    )]
    Inaccurate {
        /// Which step.
        scheme: &'static str,
        /// Difference to the solution after more iterations, relative to the largest scaled entry.
        difference: f64,
    },
}

/// x, u and y (if given) have the lengths of the model, and h is finite.
pub(super) fn check<S: Scalar, E: std::error::Error>(
    [states, controls]: [usize; 2],
    [x, u]: [&[S]; 2],
    h: S,
    y: Option<&[S]>,
) -> Result<(), StepError<E>> {
    let expected = [("x", x, states), ("u", u, controls), ("y", y.unwrap_or(x), states)];
    for (what, slice, expected) in expected {
        LengthError::check(what, expected, slice.len()).map_err(StepError::WrongLength)?;
    }
    if S::CHECKED && !h.is_finite() {
        return Err(StepError::NonFiniteDuration);
    }
    Ok(())
}
