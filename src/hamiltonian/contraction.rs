//! The contracted Hessian of the state equation at one state.

use super::linearisation::HamiltonianLinearisation;
use crate::matrix::{Block, Matrix};
use crate::scalar::Scalar;

/// F, F_x and y'F_xx at one state; borrowed from the workspace.
#[derive(Clone, Copy, Debug)]
pub struct HamiltonianContraction<'a, S> {
    pub(super) linearisation: HamiltonianLinearisation<'a, S>,
    pub(super) y_f_xx: &'a Matrix<S>,
}

impl<'a, S: Scalar> HamiltonianContraction<'a, S> {
    /// F and F_x.
    pub fn linearisation(&self) -> HamiltonianLinearisation<'a, S> {
        self.linearisation
    }

    /// `sum_k y_k d2 F_k / dx dx`, 2n x 2n, symmetric, rows and columns in the order (q, p).
    pub fn matrix(&self) -> Block<'a, S> {
        self.y_f_xx.view()
    }

    /// Its block in (q, q), n x n.
    pub fn qq(&self) -> Block<'a, S> {
        let n = self.y_f_xx.rows() / 2;
        self.y_f_xx.block(0, 0, n, n)
    }

    /// Its block in (q, p), n x n; that in (p, q) is the transpose.
    pub fn qp(&self) -> Block<'a, S> {
        let n = self.y_f_xx.rows() / 2;
        self.y_f_xx.block(0, n, n, n)
    }

    /// Its block in (p, p), n x n.
    pub fn pp(&self) -> Block<'a, S> {
        let n = self.y_f_xx.rows() / 2;
        self.y_f_xx.block(n, n, n, n)
    }
}
