//! Why a step was not made.

use crate::scalar::Scalar;

/// Why a step was not made. The workspace stays usable.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StepError<E: std::error::Error> {
    /// The model could not be evaluated.
    #[error(transparent)]
    Dynamics(#[from] E),
    /// An argument of the wrong length.
    #[error("{what} has {found} entries, not {expected}; the model of the step fixes the length")]
    WrongLength {
        /// The argument.
        what: &'static str,
        /// Length it must have.
        expected: usize,
        /// Length it has.
        found: usize,
    },
    /// The duration is infinite or undefined.
    #[error("the duration h of the step is not finite; check what produced it")]
    NonFiniteDuration,
    /// Newton's method did not solve the implicit equation of the step.
    #[error(
        "the implicit equation of the step was not solved: after {iterations} iterations of Newton's method the last \
         change is up to {change:.0e} of the state; take a shorter step"
    )]
    NotConverged {
        /// Iterations made.
        iterations: usize,
        /// The least power of ten above the last change, relative to its half of the state and 1; infinite where there is none.
        change: f64,
    },
    /// Newton's method stopped early: the momenta or velocities of the joints differ by many orders of magnitude, and the
    /// small ones are not solved to rounding.
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

/// x, u and, where there is one, y have the lengths that the model asks for, and h is finite.
pub(super) fn check<S: Scalar, E: std::error::Error>(
    [states, controls]: [usize; 2],
    [x, u]: [&[S]; 2],
    h: S,
    y: Option<&[S]>,
) -> Result<(), StepError<E>> {
    let expected = [("x", x, states), ("u", u, controls), ("y", y.unwrap_or(x), states)];
    for (what, slice, expected) in expected {
        if slice.len() != expected {
            return Err(StepError::WrongLength { what, expected, found: slice.len() });
        }
    }
    if S::CHECKED && !h.is_finite() {
        return Err(StepError::NonFiniteDuration);
    }
    Ok(())
}
