//! Solves with the mass matrix.

use super::mixed::Mixed;
use crate::error::EvalError;
use crate::kernels::Factor;
use crate::matrix::{Matrix, Panel};
use crate::scalar::Scalar;

/// M of the robot, factored, for products of `-M^-1` with a matrix that has a column for each parameter.
#[derive(Clone, Debug)]
pub(super) struct Response<S: Scalar> {
    factor: Factor<S>,
    mass_matrix: Matrix<S>,
    panel: Panel<S>,
}

impl<S: Scalar> Response<S> {
    pub fn new(mixed: &Mixed<S>) -> Self {
        let (n, len) = (mixed.layout.dof(), mixed.layout.len);
        Self {
            factor: Factor::new(&mixed.layout.tree),
            mass_matrix: Matrix::zeros(n, n),
            panel: Panel::zeros(n, len),
        }
    }

    /// Factors M at the position set last.
    #[inline(never)]
    pub fn factor(&mut self, mixed: &Mixed<S>) -> Result<(), EvalError> {
        let (layout, n) = (&mixed.layout, mixed.layout.dof());
        for i in 0..n {
            for j in 0..n {
                self.mass_matrix[(i, j)] = mixed.entry(mixed.one.mass_matrix(), i, j);
            }
        }
        let size_of = |k: usize| mixed.one.size_of_entry(&layout.extended, layout.kept[k]);
        let singular = |k: usize| EvalError::SingularMassMatrix { joint: layout.tree.name(k).into() };
        self.factor.factor(&self.mass_matrix, size_of).map_err(singular)
    }

    /// `x <- M^-1 x`, n.
    pub fn solve(&self, x: &mut [S]) {
        self.factor.solve(x);
    }

    /// `to = -M^-1 right`, n x n_theta.
    #[inline(never)]
    pub fn respond(&mut self, right: &Matrix<S>, to: &mut Matrix<S>) {
        self.panel.read::<0>(right);
        self.factor.solve_panel(&mut self.panel);
        for i in 0..right.rows() {
            self.panel.write_row::<0>(i, to.row_mut(i), |entry| -entry);
        }
    }
}
