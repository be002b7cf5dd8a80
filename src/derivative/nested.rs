//! Second derivatives by dual numbers in dual numbers.

use super::CHUNK;
use super::function::{DerivativeError, Function, InnerNumber, check_length};
use crate::matrix::{Matrix, filled};
use crate::scalar::Scalar;
use num_dual::{Dual, DualSVec};
use std::fmt;

/// Computes `sum_k y_k d2 f_k / dx dx` by differentiating the dual-number Jacobian with dual numbers.
///
/// The outer number carries direction i, the inner one `C` directions j. Each entry is computed in both
/// orders, so the result is symmetric only up to rounding, which also tests the symmetry. `T`: as for
/// [`Jacobian`](super::Jacobian).
pub struct NestedHessian<F: Function, const C: usize = CHUNK, T: InnerNumber = f64> {
    function: F,
    workspace: F::Workspace<Dual<DualSVec<T, C>>>,
    x: Vec<Dual<DualSVec<T, C>>>,
    y: Vec<Dual<DualSVec<T, C>>>,
    contracted: Matrix<T>,
}

impl<F: Function, const C: usize, T: InnerNumber> fmt::Debug for NestedHessian<F, C, T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("NestedHessian")
            .field("inputs", &self.x.len())
            .field("contracted", &self.contracted)
            .finish_non_exhaustive()
    }
}

impl<F: Function> NestedHessian<F> {
    /// Builds the buffers, for [`CHUNK`] derivatives at once.
    pub fn new(function: F) -> Self {
        Self::chunked(function)
    }
}

impl<F: Function, const C: usize> NestedHessian<F, C> {
    /// Builds the buffers, for `C` inner derivatives at once.
    pub fn chunked(function: F) -> Self {
        Self::over(function)
    }
}

impl<F: Function, const C: usize, T: InnerNumber> NestedHessian<F, C, T> {
    /// Builds the buffers, for `C` inner derivatives at once, over the numbers `T`.
    pub fn over(function: F) -> Self {
        let (n, m) = (function.inputs(), function.outputs());
        let zero = Dual::from_re(DualSVec::from_re(<T as Scalar>::zero()));
        Self {
            workspace: function.workspace(),
            x: filled(zero, n),
            y: filled(zero, m),
            contracted: Matrix::zeros(n, n),
            function,
        }
    }

    /// The function, to change its parameters (not its sizes).
    pub fn function_mut(&mut self) -> &mut F {
        &mut self.function
    }

    /// `sum_k y_k d2 f_k / dx dx` (n x n) at x (n) for the weights y (m).
    ///
    /// # Errors
    /// A wrong length, or the function's own error.
    pub fn contract(&mut self, x: &[T], y: &[T]) -> Result<&Matrix<T>, DerivativeError<F::Error>> {
        let n = self.x.len();
        check_length("x", x, n)?;
        check_length("y", y, self.y.len())?;
        let (zero, one): (T, T) = (Scalar::zero(), Scalar::one());
        for start in (0..n).step_by(C) {
            for (j, (dual, &x)) in self.x.iter_mut().zip(x).enumerate() {
                *dual = Dual::from_re(DualSVec::from_re(x));
                if (start..start + C).contains(&j) {
                    dual.re = dual.re.derivative(j - start);
                }
            }
            for i in 0..n {
                self.x[i].eps = DualSVec::from_re(one);
                self.function.evaluate(&mut self.workspace, &self.x, &mut self.y)?;
                self.x[i].eps = DualSVec::from_re(zero);
                for j in start..n.min(start + C) {
                    let second = |k: usize| self.y[k].eps.eps.0.map_or(zero, |eps| eps[j - start]);
                    self.contracted[(i, j)] = y.iter().enumerate().map(|(k, &y)| y * second(k)).sum();
                }
            }
        }
        Ok(&self.contracted)
    }
}
