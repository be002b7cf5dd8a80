//! Second derivatives by hyper-dual numbers.

use super::function::{DerivativeError, Function, InnerNumber, check_length};
use crate::matrix::{Matrix, filled};
use crate::scalar::Scalar;
use num_dual::HyperDual;
use std::fmt;

/// Computes `f(x)`, `f_x` and all second derivatives by one hyper-dual evaluation for each pair i <= j.
///
/// `T`: as for [`Jacobian`](super::Jacobian).
pub struct Hessian<F: Function, T: InnerNumber = f64> {
    function: F,
    workspace: F::Workspace<HyperDual<T>>,
    x: Vec<HyperDual<T>>,
    y: Vec<HyperDual<T>>,
    value: Vec<T>,
    jacobian: Matrix<T>,
    /// Row k: the pairs (i, j), i <= j, of output k at `j (j + 1) / 2 + i`.
    tensor: Matrix<T>,
    contracted: Matrix<T>,
}

impl<F: Function, T: InnerNumber> fmt::Debug for Hessian<F, T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Hessian")
            .field("inputs", &self.x.len())
            .field("value", &self.value)
            .field("jacobian", &self.jacobian)
            .field("contracted", &self.contracted)
            .finish_non_exhaustive()
    }
}

/// Value, Jacobian and second derivatives at one point; borrowed from the workspace.
#[derive(Clone, Copy, Debug)]
pub struct SecondDerivatives<'a, T = f64> {
    value: &'a [T],
    jacobian: &'a Matrix<T>,
    tensor: &'a Matrix<T>,
}

impl<'a, T: Scalar> SecondDerivatives<'a, T> {
    /// `f(x)`, m.
    pub fn value(&self) -> &'a [T] {
        self.value
    }

    /// `df_k/dx_j`, m x n.
    pub fn jacobian(&self) -> &'a Matrix<T> {
        self.jacobian
    }

    /// `d2 f_k / dx_i dx_j`, i and j in any order.
    pub fn entry(&self, k: usize, i: usize, j: usize) -> T {
        self.tensor[(k, pair(i.min(j), i.max(j)))]
    }
}

/// Position of the pair i <= j.
fn pair(i: usize, j: usize) -> usize {
    j * (j + 1) / 2 + i
}

impl<F: Function> Hessian<F> {
    /// Builds the buffers.
    pub fn new(function: F) -> Self {
        Self::over(function)
    }
}

impl<F: Function, T: InnerNumber> Hessian<F, T> {
    /// Builds the buffers, over the numbers `T`.
    pub fn over(function: F) -> Self {
        let (n, m) = (function.inputs(), function.outputs());
        let zero: T = Scalar::zero();
        Self {
            workspace: function.workspace(),
            x: vec![HyperDual::from_re(zero); n],
            y: vec![HyperDual::from_re(zero); m],
            value: filled(zero, m),
            jacobian: Matrix::zeros(m, n),
            tensor: Matrix::zeros(m, n * (n + 1) / 2),
            contracted: Matrix::zeros(n, n),
            function,
        }
    }

    /// The function, to change its parameters (not its sizes).
    pub fn function_mut(&mut self) -> &mut F {
        &mut self.function
    }

    /// Value, Jacobian and the whole tensor `d2 f_k / dx_i dx_j` at x (n).
    ///
    /// # Errors
    /// A wrong length, or the function's own error.
    pub fn hessian_tensor(&mut self, x: &[T]) -> Result<SecondDerivatives<'_, T>, DerivativeError<F::Error>> {
        let n = self.x.len();
        check_length("x", x, n)?;
        self.x.iter_mut().zip(x).for_each(|(number, &x)| *number = HyperDual::from_re(x));
        let (zero, one): (T, T) = (Scalar::zero(), Scalar::one());
        for j in 0..n {
            self.x[j].eps2 = one;
            for i in 0..=j {
                self.x[i].eps1 = one;
                self.function.evaluate(&mut self.workspace, &self.x, &mut self.y)?;
                self.x[i].eps1 = zero;
                for (k, y) in self.y.iter().enumerate() {
                    self.value[k] = y.re;
                    self.jacobian[(k, j)] = y.eps2;
                    self.tensor[(k, pair(i, j))] = y.eps1eps2;
                }
            }
            self.x[j].eps2 = zero;
        }
        Ok(SecondDerivatives { value: &self.value, jacobian: &self.jacobian, tensor: &self.tensor })
    }

    /// `sum_k y_k d2 f_k / dx dx` (n x n) at x (n) for the weights y (m); for one output and y = 1 its
    /// Hessian.
    ///
    /// # Errors
    /// A wrong length, or the function's own error.
    pub fn contract(&mut self, x: &[T], y: &[T]) -> Result<&Matrix<T>, DerivativeError<F::Error>> {
        check_length("y", y, self.y.len())?;
        self.hessian_tensor(x)?;
        for j in 0..self.x.len() {
            for i in 0..=j {
                let entry = y.iter().enumerate().map(|(k, &y)| y * self.tensor[(k, pair(i, j))]).sum();
                self.contracted[(i, j)] = entry;
                self.contracted[(j, i)] = entry;
            }
        }
        Ok(&self.contracted)
    }

    /// The matrix of the last call of [`contract`](Self::contract).
    pub fn last_contraction(&self) -> &Matrix<T> {
        &self.contracted
    }

    /// The derivatives of the last evaluation.
    pub fn last(&self) -> SecondDerivatives<'_, T> {
        SecondDerivatives { value: &self.value, jacobian: &self.jacobian, tensor: &self.tensor }
    }
}
