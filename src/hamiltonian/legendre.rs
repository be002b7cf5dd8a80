//! The Legendre map between (q, v) and (q, p).

use super::Hamiltonian;
use crate::error::EvalError;
use crate::kernels::{LagrangianHessian, Route};
use crate::matrix::{Block, Matrix};
use crate::scalar::Scalar;

/// Jacobian of `p = M(q) v`; borrowed from the workspace.
#[derive(Clone, Copy, Debug)]
pub struct MomentumLinearisation<'a, S> {
    /// `dp/dq = P` at fixed v, n x n.
    pub dp_dq: &'a Matrix<S>,
    /// `dp/dv = M`, n x n.
    pub dp_dv: &'a Matrix<S>,
}

/// Jacobian of `v = M(q)^-1 p`; borrowed from the workspace.
#[derive(Clone, Copy, Debug)]
pub struct VelocityLinearisation<'a, S> {
    /// `dv/dq = -M^-1 P` at fixed p, n x n.
    pub dv_dq: Block<'a, S>,
    /// `dv/dp = M^-1`, n x n.
    pub dv_dp: Block<'a, S>,
}

impl<S: Scalar, R: Route> Hamiltonian<S, R> {
    /// `p = M(q) v`, length n.
    ///
    /// # Errors
    /// See [`Hamiltonian`].
    pub fn momentum(&mut self, q: &[S], v: &[S]) -> Result<&[S], EvalError> {
        self.check(&[("q", q), ("v", v)])?;
        let Self { tree, flow, .. } = self;
        flow.kernel.momentum(tree, q, v, &mut flow.v)?;
        Ok(&flow.v)
    }

    /// `v = M(q)^-1 p`, length n.
    ///
    /// # Errors
    /// See [`Hamiltonian`].
    pub fn velocity(&mut self, q: &[S], p: &[S]) -> Result<&[S], EvalError> {
        self.check(&[("q", q), ("p", p)])?;
        self.flow.solve_velocity(&self.tree, q, p)?;
        Ok(&self.flow.v)
    }

    /// `dp = P dq + M dv` at (q, v).
    ///
    /// # Errors
    /// See [`Hamiltonian`].
    pub fn linearise_momentum(
        &mut self,
        q: &[S],
        v: &[S],
    ) -> Result<MomentumLinearisation<'_, S>, EvalError> {
        self.tree.refuse_free()?;
        self.momentum(q, v)?;
        self.flow.kernel.second_order(&self.tree);
        let kernel = &self.flow.kernel.body;
        Ok(MomentumLinearisation { dp_dq: kernel.l_vq(), dp_dv: kernel.mass_matrix() })
    }

    /// `dv = -M^-1 P dq + M^-1 dp` at (q, p): the upper half of F_x.
    ///
    /// # Errors
    /// See [`Hamiltonian`].
    pub fn linearise_velocity(
        &mut self,
        q: &[S],
        p: &[S],
    ) -> Result<VelocityLinearisation<'_, S>, EvalError> {
        self.tree.refuse_free()?;
        self.check(&[("q", q), ("p", p)])?;
        self.flow.first_order_alone(&self.tree, [q, p], true)?;
        self.flow.second_order(&self.tree);
        self.assemble();
        let linear = self.state.linearisation(self.flow.mass_matrix());
        Ok(VelocityLinearisation { dv_dq: linear.qq(), dv_dp: linear.qp() })
    }
}
