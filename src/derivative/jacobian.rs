//! Jacobian by dual numbers that carry several derivatives at once.

use super::CHUNK;
use super::function::{DerivativeError, Function, InnerNumber, check_length};
use crate::matrix::{Matrix, filled};
use crate::scalar::Scalar;
use num_dual::DualSVec;
use std::fmt;

/// Computes `f(x)` and `f_x` by dual numbers with `C` derivatives; calls allocate only if the function does.
///
/// For a function with one output, [`gradient`](FirstDerivatives::gradient) is its gradient. Values and
/// derivatives have the type `T`, `f64` by default.
pub struct Jacobian<F: Function, const C: usize = CHUNK, T: InnerNumber = f64> {
    function: F,
    workspace: F::Workspace<DualSVec<T, C>>,
    x: Vec<DualSVec<T, C>>,
    y: Vec<DualSVec<T, C>>,
    value: Vec<T>,
    jacobian: Matrix<T>,
}

impl<F: Function, const C: usize, T: InnerNumber> fmt::Debug for Jacobian<F, C, T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Jacobian")
            .field("inputs", &self.x.len())
            .field("value", &self.value)
            .field("jacobian", &self.jacobian)
            .finish_non_exhaustive()
    }
}

/// Value and Jacobian at one point; borrowed from the workspace.
#[derive(Clone, Copy, Debug)]
pub struct FirstDerivatives<'a, T = f64> {
    /// `f(x)`, m.
    pub value: &'a [T],
    /// `df_k/dx_j`, m x n.
    pub jacobian: &'a Matrix<T>,
}

impl<'a, T: Scalar> FirstDerivatives<'a, T> {
    /// `df_0/dx_j`, n: the gradient of the first output.
    pub fn gradient(&self) -> &'a [T] {
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
        Self::over(function)
    }
}

impl<F: Function, const C: usize, T: InnerNumber> Jacobian<F, C, T> {
    /// Builds the buffers, for `C` derivatives at once, over the numbers `T`.
    ///
    /// ```
    /// # use costate::{derivative::{Jacobian, PhaseVelocity}, robot::Robot, scalar::{Count, count}};
    /// # std::env::set_current_dir(env!("CARGO_MANIFEST_DIR"))?;
    /// let robot = Robot::from_file("robots/two_link.toml")?;
    /// let mut counting = Jacobian::<_, 4, Count>::over(PhaseVelocity::new(&robot));
    /// let x = [0.1, 0.2, 0.3, 0.4].map(Count::variable);
    /// let (_, operations) = count(|| counting.linearise(&x).map(|first| first.value[0]));
    /// assert_eq!(operations.sincos, 2);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn over(function: F) -> Self {
        let (n, m) = (function.inputs(), function.outputs());
        let zero: T = Scalar::zero();
        Self {
            workspace: function.workspace(),
            x: vec![DualSVec::from_re(zero); n],
            y: vec![DualSVec::from_re(zero); m],
            value: filled(zero, m),
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
    pub fn linearise(&mut self, x: &[T]) -> Result<FirstDerivatives<'_, T>, DerivativeError<F::Error>> {
        let n = self.x.len();
        check_length("x", x, n)?;
        for start in (0..n).step_by(C) {
            for (j, (dual, &x)) in self.x.iter_mut().zip(x).enumerate() {
                *dual = DualSVec::from_re(x);
                if (start..start + C).contains(&j) {
                    *dual = dual.derivative(j - start);
                }
            }
            self.function.evaluate(&mut self.workspace, &self.x, &mut self.y)?;
            for (k, y) in self.y.iter().enumerate() {
                self.value[k] = y.re;
                for j in start..n.min(start + C) {
                    self.jacobian[(k, j)] = y.eps.0.map_or_else(Scalar::zero, |eps| eps[j - start]);
                }
            }
        }
        Ok(FirstDerivatives { value: &self.value, jacobian: &self.jacobian })
    }
}
