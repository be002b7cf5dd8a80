//! Functions for automatic differentiation.

use crate::error::LengthError;
use crate::scalar::Scalar;
use num_dual::DualNum;

/// A function from n to m numbers, written once for any [`Scalar`].
///
/// The workspace holds the buffers of the function; `()` if it needs none. It is built once for each scalar
/// type, so that a function with buffers does not allocate when it is evaluated.
///
/// ```
/// use costate::derivative::{Function, Hessian, Jacobian};
/// use costate::scalar::Scalar;
/// use std::convert::Infallible;
///
/// /// x y^2 + sin x
/// struct Example;
///
/// impl Function for Example {
///     type Workspace<S: Scalar> = ();
///     type Error = Infallible;
///     fn inputs(&self) -> usize { 2 }
///     fn outputs(&self) -> usize { 1 }
///     fn workspace<S: Scalar>(&self) {}
///     fn evaluate<S: Scalar>(&self, _: &mut (), x: &[S], y: &mut [S]) -> Result<(), Infallible> {
///         let (sin, _) = x[0].sin_cos();
///         y[0] = x[0] * x[1] * x[1] + sin;
///         Ok(())
///     }
/// }
///
/// let mut hessian = Hessian::new(Example);
/// let second = hessian.hessian_tensor(&[0.0, 3.0])?;
/// assert_eq!(second.entry(0, 0, 1), 6.0);   // d2/dx dy = 2 y
/// assert_eq!(second.jacobian()[(0, 0)], 10.0); // d/dx = y^2 + cos x
/// let mut first: Jacobian<_> = Jacobian::new(Example);
/// assert_eq!(first.linearise(&[0.0, 3.0])?.gradient(), [10.0, 0.0]);
/// # Ok::<(), costate::derivative::DerivativeError<Infallible>>(())
/// ```
pub trait Function {
    /// Buffers for one scalar type.
    type Workspace<S: Scalar>;
    /// The error of an evaluation.
    type Error: std::error::Error;

    /// Number of inputs, n.
    fn inputs(&self) -> usize;

    /// Number of outputs, m.
    fn outputs(&self) -> usize;

    /// Builds the buffers.
    fn workspace<S: Scalar>(&self) -> Self::Workspace<S>;

    /// Evaluates the m outputs `y` at the n inputs `x`.
    ///
    /// # Errors
    /// The function's own error.
    fn evaluate<S: Scalar>(
        &self,
        workspace: &mut Self::Workspace<S>,
        x: &[S],
        y: &mut [S],
    ) -> Result<(), Self::Error>;
}

/// A number that can be the component type of dual numbers: `f64`, `f32`, [`Count`](crate::scalar::Count),
/// dual numbers themselves.
pub trait InnerNumber: DualNum + Scalar<Mask = bool> {}

impl<T: DualNum + Scalar<Mask = bool>> InnerNumber for T {}

/// Why a derivative could not be computed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum DerivativeError<E: std::error::Error> {
    /// An argument has the wrong length.
    #[error(transparent)]
    WrongLength(LengthError),
    /// An argument has an entry that is infinite or not a number.
    #[error("{what}[{index}] is not finite; check the computation that produced it")]
    NonFinite {
        /// The argument.
        what: &'static str,
        /// Index of the entry, from 0.
        index: usize,
    },
    /// The function itself failed.
    #[error(transparent)]
    Function(#[from] E),
}

/// `slice` must have `expected` entries.
pub(crate) fn check_length<T, E: std::error::Error>(
    what: &'static str,
    slice: &[T],
    expected: usize,
) -> Result<(), DerivativeError<E>> {
    LengthError::check(what, expected, slice.len()).map_err(DerivativeError::WrongLength)
}
