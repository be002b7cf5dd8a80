//! Jacobian by dual numbers that carry several derivatives at once.

use super::CHUNK;
use super::function::{DerivativeError, Function, check_length};
use crate::matrix::Matrix;
use num_dual::DualSVec64;

/// Computes `f(x)` and `f_x` by dual numbers with `C` derivatives; no call allocates but what the function does.
///
/// For a function with one output, [`gradient`](FirstDerivatives::gradient) is that of it.
pub struct Jacobian<F: Function, const C: usize = CHUNK> {
    function: F,
    workspace: F::Workspace<DualSVec64<C>>,
    x: Vec<DualSVec64<C>>,
    y: Vec<DualSVec64<C>>,
    value: Vec<f64>,
    jacobian: Matrix<f64>,
}

/// Value and Jacobian at one point; borrowed from the workspace.
#[derive(Clone, Copy, Debug)]
pub struct FirstDerivatives<'a> {
    /// `f(x)`, m.
    pub value: &'a [f64],
    /// `df_k/dx_j`, m x n.
    pub jacobian: &'a Matrix<f64>,
}

impl<'a> FirstDerivatives<'a> {
    /// `df_0/dx_j`, n: the gradient of the first, for a function with one output of the only one.
    pub fn gradient(&self) -> &'a [f64] {
        self.jacobian.row(0)
    }
}

impl<F: Function> Jacobian<F> {
    /// Builds the buffers, for [`CHUNK`] derivatives at once.
    pub fn new(function: F) -> Self {
        Self::chunked(function)
    }
}

impl<F: Function, const C: usize> Jacobian<F, C> {
    /// Builds the buffers, for `C` derivatives at once.
    pub fn chunked(function: F) -> Self {
        let (n, m) = (function.inputs(), function.outputs());
        Self {
            workspace: function.workspace(),
            x: vec![DualSVec64::from_re(0.0); n],
            y: vec![DualSVec64::from_re(0.0); m],
            value: vec![0.0; m],
            jacobian: Matrix::zeros(m, n),
            function,
        }
    }

    /// The function, to change its parameters (not its sizes).
    pub fn function_mut(&mut self) -> &mut F {
        &mut self.function
    }

    /// `f(x)` and `df/dx` at x (n).
    ///
    /// # Errors
    /// A wrong length, or the function's own error.
    pub fn evaluate(&mut self, x: &[f64]) -> Result<FirstDerivatives<'_>, DerivativeError<F::Error>> {
        let n = self.x.len();
        check_length("x", x, n)?;
        for start in (0..n).step_by(C) {
            for (j, (dual, &x)) in self.x.iter_mut().zip(x).enumerate() {
                *dual = DualSVec64::from_re(x);
                if (start..start + C).contains(&j) {
                    *dual = dual.derivative(j - start);
                }
            }
            self.function.evaluate(&mut self.workspace, &self.x, &mut self.y)?;
            for (k, y) in self.y.iter().enumerate() {
                self.value[k] = y.re;
                for j in start..n.min(start + C) {
                    self.jacobian[(k, j)] = y.eps.0.map_or(0.0, |eps| eps[j - start]);
                }
            }
        }
        Ok(FirstDerivatives { value: &self.value, jacobian: &self.jacobian })
    }
}
