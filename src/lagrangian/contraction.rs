//! First and second derivatives of inverse and forward dynamics at one state, borrowed from their workspace.

use super::{ForwardDynamicsLinearisation, InverseDynamicsLinearisation, StateLinearisation};
use crate::matrix::{Block, Matrix};
use crate::scalar::Scalar;

/// Inverse dynamics, its Jacobian and its contracted Hessian at one state, z = (q, v, a); borrowed from the
/// workspace.
#[derive(Clone, Copy, Debug)]
pub struct InverseDynamicsContraction<'a, S> {
    pub(super) inverse_dynamics: InverseDynamicsLinearisation<'a, S>,
    pub(super) zz: &'a Matrix<S>,
}

impl<'a, S: Scalar> InverseDynamicsContraction<'a, S> {
    /// tau and its Jacobian in z.
    pub fn inverse_dynamics(&self) -> InverseDynamicsLinearisation<'a, S> {
        self.inverse_dynamics
    }

    /// `sum_k w_k d2 tau_k / dz dz`, 3n x 3n, symmetric.
    pub fn zz(&self) -> &'a Matrix<S> {
        self.zz
    }

    /// `sum_k w_k d2 tau_k / dx dx`, x = (q, v), 2n x 2n, symmetric.
    pub fn xx(&self) -> Block<'a, S> {
        let n = self.inverse_dynamics.tau.len();
        self.zz.block(0, 0, 2 * n, 2 * n)
    }

    /// `sum_k w_k d2 tau_k / da dq`, n x n: all other blocks in a are zero by structure.
    pub fn aq(&self) -> Block<'a, S> {
        let n = self.inverse_dynamics.tau.len();
        self.zz.block(2 * n, 0, n, n)
    }
}

/// Forward dynamics, its Jacobian and its contracted Hessian at one state; borrowed from the workspace.
#[derive(Clone, Copy, Debug)]
pub struct LagrangianContraction<'a, S> {
    pub(super) forward_dynamics: ForwardDynamicsLinearisation<'a, S>,
    pub(super) linearisation: StateLinearisation<'a, S>,
    pub(super) xx: &'a Matrix<S>,
    pub(super) uq: &'a Matrix<S>,
}

impl<'a, S: Scalar> LagrangianContraction<'a, S> {
    /// a and its Jacobian in z = (q, v, u).
    pub fn forward_dynamics(&self) -> ForwardDynamicsLinearisation<'a, S> {
        self.forward_dynamics
    }

    /// dx/dt = (v, a) and its Jacobians in x = (q, v) and u.
    pub fn linearisation(&self) -> StateLinearisation<'a, S> {
        self.linearisation
    }

    /// `sum_k y_k d2 a_k / dx dx`, x = (q, v), 2n x 2n, symmetric.
    pub fn xx(&self) -> Block<'a, S> {
        self.xx.view()
    }

    /// `sum_k y_k d2 a_k / du dq`, n x n: all other blocks in u are zero by structure.
    pub fn uq(&self) -> Block<'a, S> {
        self.uq.view()
    }

    /// A copy as a full symmetric 3n x 3n matrix, in the order z = (q, v, u).
    pub fn to_matrix(&self) -> Matrix<S> {
        whole_hessian(self.xx(), self.uq())
    }
}

/// The contracted Hessian of forward dynamics in z = (q, v, u) from its blocks
/// [`xx`](LagrangianContraction::xx), 2n x 2n, and [`uq`](LagrangianContraction::uq), n x n, as a full
/// symmetric 3n x 3n matrix.
pub fn whole_hessian<S: Scalar>(xx: Block<'_, S>, uq: Block<'_, S>) -> Matrix<S> {
    let n = uq.rows();
    let mut whole = Matrix::zeros(3 * n, 3 * n);
    for i in 0..2 * n {
        whole.row_mut(i)[..2 * n].copy_from_slice(xx.row(i));
    }
    for i in 0..n {
        for j in 0..n {
            whole[(2 * n + i, j)] = uq[(i, j)];
            whole[(j, 2 * n + i)] = uq[(i, j)];
        }
    }
    whole
}
