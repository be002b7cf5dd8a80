//! Derivative along one direction, by one dual number.

use super::function::{DerivativeError, Function, InnerNumber, check_length};
use crate::matrix::filled;
use crate::scalar::Scalar;
use num_dual::Dual;
use std::fmt;

/// Computes `f(x)` and `f_x d`; calls allocate only if the function does.
///
/// `T`: as for [`Jacobian`](super::Jacobian).
pub struct Directional<F: Function, T: InnerNumber = f64> {
    function: F,
    workspace: F::Workspace<Dual<T>>,
    x: Vec<Dual<T>>,
    y: Vec<Dual<T>>,
    value: Vec<T>,
    derivative: Vec<T>,
}

impl<F: Function, T: InnerNumber> fmt::Debug for Directional<F, T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Directional")
            .field("inputs", &self.x.len())
            .field("value", &self.value)
            .field("derivative", &self.derivative)
            .finish_non_exhaustive()
    }
}

/// Value and derivative along one direction; borrowed from the workspace.
#[derive(Clone, Copy, Debug)]
pub struct AlongDirection<'a, T = f64> {
    /// `f(x)`, m.
    pub value: &'a [T],
    /// `sum_j d_j df/dx_j`, m.
    pub derivative: &'a [T],
}

impl<F: Function> Directional<F> {
    /// Builds the buffers.
    pub fn new(function: F) -> Self {
        Self::over(function)
    }
}

impl<F: Function, T: InnerNumber> Directional<F, T> {
    /// Builds the buffers, over the numbers `T`.
    pub fn over(function: F) -> Self {
        let (n, m) = (function.inputs(), function.outputs());
        let zero: T = Scalar::zero();
        Self {
            workspace: function.workspace(),
            x: vec![Dual::from_re(zero); n],
            y: vec![Dual::from_re(zero); m],
            value: filled(zero, m),
            derivative: filled(zero, m),
            function,
        }
    }

    /// The function, to change its parameters (not its sizes).
    pub fn function_mut(&mut self) -> &mut F {
        &mut self.function
    }

    /// `f(x)` (m) and `sum_j d_j df/dx_j` (m) at x (n) along d (n).
    ///
    /// # Errors
    /// A wrong length, or the function's own error.
    pub fn jacobian_product(
        &mut self,
        x: &[T],
        d: &[T],
    ) -> Result<AlongDirection<'_, T>, DerivativeError<F::Error>> {
        check_length("x", x, self.x.len())?;
        check_length("d", d, self.x.len())?;
        for ((dual, &x), &d) in self.x.iter_mut().zip(x).zip(d) {
            *dual = Dual::new(x, d);
        }
        self.function.evaluate(&mut self.workspace, &self.x, &mut self.y)?;
        for (k, y) in self.y.iter().enumerate() {
            self.value[k] = y.re;
            self.derivative[k] = y.eps;
        }
        Ok(AlongDirection { value: &self.value, derivative: &self.derivative })
    }
}
