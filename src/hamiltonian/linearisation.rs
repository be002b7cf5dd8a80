//! The state equation and its Jacobian at one state.

use crate::matrix::{Block, Matrix};
use crate::scalar::Scalar;

/// F and F_x at one state; borrowed from the workspace.
#[derive(Clone, Copy, Debug)]
pub struct HamiltonianLinearisation<'a, S> {
    pub(super) f: &'a [S],
    pub(super) f_x: &'a Matrix<S>,
    pub(super) f_u: &'a Matrix<S>,
    pub(super) mass_matrix: &'a Matrix<S>,
}

impl<'a, S: Scalar> HamiltonianLinearisation<'a, S> {
    fn n(&self) -> usize {
        self.f.len() / 2
    }

    /// `dx/dt`, length 2n.
    pub fn f(&self) -> &'a [S] {
        self.f
    }

    /// `v = M^-1 p`, length n.
    pub fn velocity(&self) -> &'a [S] {
        &self.f[..self.n()]
    }

    /// Mass matrix M, n x n.
    pub fn mass_matrix(&self) -> &'a Matrix<S> {
        self.mass_matrix
    }

    /// F_x as one matrix, 2n x 2n, rows and columns in the order (q, p).
    pub fn matrix(&self) -> Block<'a, S> {
        self.f_x.view()
    }

    /// `F_u = (0; 1)`, 2n x n, constant.
    pub fn f_u(&self) -> Block<'a, S> {
        self.f_u.view()
    }

    /// `F^q,q = -M^-1 P` (21a), n x n.
    pub fn qq(&self) -> Block<'a, S> {
        self.f_x.block(0, 0, self.n(), self.n())
    }

    /// `F^q,p = M^-1` (21b), n x n.
    pub fn qp(&self) -> Block<'a, S> {
        self.f_x.block(0, self.n(), self.n(), self.n())
    }

    /// `F^p,q = L_qq - P' M^-1 P + D_v F^q,q` (21c), (22), n x n.
    pub fn pq(&self) -> Block<'a, S> {
        self.f_x.block(self.n(), 0, self.n(), self.n())
    }

    /// `F^p,p = (M^-1 P)' + D_v M^-1` (21d), n x n.
    pub fn pp(&self) -> Block<'a, S> {
        self.f_x.block(self.n(), self.n(), self.n(), self.n())
    }
}
