//! The Legendre map between (q, v) and (q, p).

use super::Hamiltonian;
use crate::error::EvalError;
use crate::matrix::Matrix;
use crate::scalar::Scalar;

/// Jacobian of one direction of the Legendre map; the q part of the map is the identity.
#[derive(Clone, Copy, Debug)]
pub struct LegendreJacobian<'a, S> {
    /// Derivative of the result in q, n x n.
    pub in_q: &'a Matrix<S>,
    /// Derivative of the result in the other argument, n x n.
    pub in_rate: &'a Matrix<S>,
}

impl<S: Scalar> Hamiltonian<S> {
    /// `p = M(q) v`, length n.
    ///
    /// # Errors
    /// See [`Hamiltonian`].
    pub fn momentum(&mut self, q: &[S], v: &[S]) -> Result<&[S], EvalError> {
        self.check(&[("q", q), ("v", v)])?;
        self.flow.kernel.set_position(&self.tree, q);
        self.flow.kernel.set_velocity(&self.tree, v);
        Ok(self.flow.kernel.momentum())
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

    /// `dp = P dq + M dv` at (q, v): `in_q` = P, `in_rate` = M.
    ///
    /// # Errors
    /// See [`Hamiltonian`].
    pub fn momentum_jacobian(&mut self, q: &[S], v: &[S]) -> Result<LegendreJacobian<'_, S>, EvalError> {
        self.momentum(q, v)?;
        self.flow.kernel.second_order(&self.tree);
        let kernel = &self.flow.kernel;
        Ok(LegendreJacobian { in_q: kernel.coupling(), in_rate: kernel.mass_matrix() })
    }

    /// `dv = -M^-1 P dq + M^-1 dp` at (q, p): `in_q` = -M^-1 P, `in_rate` = M^-1.
    ///
    /// # Errors
    /// See [`Hamiltonian`].
    pub fn velocity_jacobian(&mut self, q: &[S], p: &[S]) -> Result<LegendreJacobian<'_, S>, EvalError> {
        self.check(&[("q", q), ("p", p)])?;
        let flow = &mut self.flow;
        flow.first_order(&self.tree, q, p)?;
        flow.second_order(&self.tree);
        for i in 0..self.tree.len() {
            flow.w.row_mut(i).iter_mut().for_each(|entry| *entry = -*entry);
        }
        Ok(LegendreJacobian { in_q: &flow.w, in_rate: &flow.inverse })
    }
}
