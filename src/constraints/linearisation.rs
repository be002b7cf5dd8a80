//! Results of the constrained state equation.

use crate::matrix::{Block, Matrix};
use crate::scalar::Scalar;

/// F and mu at one state; borrowed from the workspace.
#[derive(Clone, Copy, Debug)]
pub struct ConstrainedRate<'a, S> {
    /// `dx/dt`, 2n: v, then dp/dt.
    pub f: &'a [S],
    /// The multipliers, k: impulses of the constraints since mu was zero, in axes of their second frames (N
    /// s, N m s).
    pub mu: &'a [S],
}

/// F and y'F_x at one state; borrowed from the workspace.
#[derive(Clone, Copy, Debug)]
pub struct ConstrainedAdjoint<'a, S> {
    /// `dx/dt`, 2n.
    pub f: &'a [S],
    /// `F_x' y`, 2n.
    pub y_f_x: &'a [S],
}

/// F, F_x, accelerations and forces at one state; borrowed from the workspace.
#[derive(Clone, Copy, Debug)]
pub struct ConstrainedLinearisation<'a, S> {
    pub(super) f: &'a [S],
    pub(super) f_x: &'a Matrix<S>,
    pub(super) f_u: &'a Matrix<S>,
    pub(super) mu: &'a [S],
    pub(super) mu_x: &'a Matrix<S>,
    pub(super) acceleration: &'a [S],
    pub(super) lambda: &'a [S],
}

impl<'a, S: Scalar> ConstrainedLinearisation<'a, S> {
    /// `dx/dt`, 2n.
    pub fn f(&self) -> &'a [S] {
        self.f
    }

    /// v, n, with `J v = 0`.
    pub fn velocity(&self) -> &'a [S] {
        &self.f[..self.f.len() / 2]
    }

    /// F_x, 2n x 2n, rows and columns in the order (q, p).
    pub fn matrix(&self) -> Block<'a, S> {
        self.f_x.view()
    }

    /// `F_u = (0; 1)`, 2n x n, constant.
    pub fn f_u(&self) -> Block<'a, S> {
        self.f_u.view()
    }

    /// The multipliers mu, k.
    pub fn mu(&self) -> &'a [S] {
        self.mu
    }

    /// mu_x, k x 2n.
    pub fn mu_x(&self) -> Block<'a, S> {
        self.mu_x.view()
    }

    /// Accelerations `v_x F`, n: those of `M a - J'lambda = u + D + ...`, `(J v)' = 0`.
    pub fn acceleration(&self) -> &'a [S] {
        self.acceleration
    }

    /// `lambda = mu_x F`, k: the forces that act on the joints as `J'lambda`. A row of a position is a force
    /// (N) on the link of the first frame, at its origin, along an axis of the second frame; a row of a
    /// distance a force (N) that pushes the points apart; a row of an orientation, where it is closed, a
    /// moment (N m) about an axis of the second frame; [`Constraints::wrench`](super::Constraints::wrench)
    /// gives both as vectors.
    pub fn lambda(&self) -> &'a [S] {
        self.lambda
    }
}

/// F, F_x and y'F_xx at one state; borrowed from the workspace.
#[derive(Clone, Copy, Debug)]
pub struct ConstrainedContraction<'a, S> {
    pub(super) linearisation: ConstrainedLinearisation<'a, S>,
    pub(super) y_f_xx: &'a Matrix<S>,
}

impl<'a, S: Scalar> ConstrainedContraction<'a, S> {
    /// F and F_x.
    pub fn linearisation(&self) -> ConstrainedLinearisation<'a, S> {
        self.linearisation
    }

    /// `sum_k y_k d2 F_k / dx dx`, 2n x 2n, symmetric, rows and columns in the order (q, p).
    pub fn matrix(&self) -> Block<'a, S> {
        self.y_f_xx.view()
    }
}
