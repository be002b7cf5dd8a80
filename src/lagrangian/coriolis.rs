//! The rate of the mass matrix and the Coriolis matrix.

use super::Lagrangian;
use crate::error::EvalError;
use crate::matrix::Matrix;
use crate::scalar::Scalar;

impl<S: Scalar> Lagrangian<S> {
    /// `Mdot_ij = sum_k M_ij,k v_k`, n x n, symmetric (kg m^2/s, kg m/s, kg/s).
    ///
    /// # Errors
    /// See [`Lagrangian`].
    pub fn mass_matrix_rate(&mut self, q: &[S], v: &[S]) -> Result<&Matrix<S>, EvalError> {
        self.check_plain(q, &[("v", v)])?;
        self.set_state(q, v)?;
        self.along.differentiate(&self.tree, &self.kernel, v, &self.zero)?;
        Ok(self.along.mass_matrix())
    }

    /// `C = 1/2 (Mdot + P - P')`, `C_ij = 1/2 sum_k (M_ij,k + M_ik,j - M_jk,i) v_k`, n x n.
    ///
    /// This is the Coriolis matrix of the Christoffel symbols of M: `Mdot - 2 C = P' - P` is skew-symmetric.
    /// P is L_vq.
    ///
    /// # Errors
    /// See [`Lagrangian`].
    pub fn coriolis_matrix(&mut self, q: &[S], v: &[S]) -> Result<&Matrix<S>, EvalError> {
        self.mass_matrix_rate(q, v)?;
        let (rate, p) = (self.along.mass_matrix(), self.kernel.l_vq());
        for i in 0..self.tree.dof() {
            for j in 0..self.tree.dof() {
                self.coriolis[(i, j)] = (rate[(i, j)] + p[(i, j)] - p[(j, i)]).times(0.5);
            }
        }
        Ok(&self.coriolis)
    }

    /// All three stages of kernel one.
    fn set_state(&mut self, q: &[S], v: &[S]) -> Result<(), EvalError> {
        self.kernel.set_position(&self.tree, q)?;
        self.kernel.set_velocity(&self.tree, v)?;
        self.kernel.second_order(&self.tree);
        Ok(())
    }

    /// Kernel one at the position set last and v, kernel two along (v, a) computed last.
    #[inline(never)]
    pub(super) fn differentiate_flow(&mut self) -> Result<(), EvalError> {
        let (v, a) = self.rate.split_at(self.tree.dof());
        self.kernel.set_velocity(&self.tree, v)?;
        self.kernel.second_order(&self.tree);
        self.along.differentiate(&self.tree, &self.kernel, v, a)
    }
}
