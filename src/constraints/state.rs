//! Momenta, velocities and energy of a state, and how well it keeps the constraints.

use super::ConstrainedHamiltonian;
use crate::error::EvalError;
use crate::hamiltonian::Energy;
use crate::matrix::{Block, dot};
use crate::scalar::Scalar;

impl<S: Scalar> ConstrainedHamiltonian<S> {
    /// `p = M v`, n: the momentum of a motion with mu = 0, if `J v = 0`.
    ///
    /// # Errors
    /// See [`ConstrainedHamiltonian`].
    pub fn momentum(&mut self, q: &[S], v: &[S]) -> Result<&[S], EvalError> {
        self.check(&[("q", q), ("v", v)])?;
        self.kernel.momentum(&self.tree, q, v, &mut self.v)?;
        Ok(&self.v)
    }

    /// v with `J v = 0` (n) and mu (k) at (q, p). For `p = M v-` with any v-, v is the velocity after the
    /// constraints have set in, without a rebound, and mu their impulse.
    ///
    /// # Errors
    /// See [`ConstrainedHamiltonian`].
    pub fn velocity(&mut self, q: &[S], p: &[S]) -> Result<(&[S], &[S]), EvalError> {
        self.check(&[("q", q), ("p", p)])?;
        self.solve_velocity(q, p)?;
        Ok((&self.v, &self.mu))
    }

    /// v, mu and their Jacobians v_x, mu_x at (q, p), to be read by [`velocity_x`](Self::velocity_x).
    pub(crate) fn linearise_velocity(&mut self, q: &[S], p: &[S]) -> Result<(), EvalError> {
        self.check(&[("q", q), ("p", p)])?;
        self.responses_at(q, p)
    }

    /// v_x, n x 2n, of the last call that computes it.
    pub(crate) fn velocity_x(&self) -> Block<'_, S> {
        let n = self.dof();
        self.f_x.block(0, 0, n, 2 * n)
    }

    /// Kinetic and potential energy (J); their sum is H_c.
    ///
    /// # Errors
    /// See [`ConstrainedHamiltonian`].
    pub fn energy(&mut self, q: &[S], p: &[S]) -> Result<Energy<S>, EvalError> {
        self.check(&[("q", q), ("p", p)])?;
        self.solve_velocity(q, p)?;
        // mu does no work.
        let kinetic = dot(&self.v, p).times(0.5);
        Ok(Energy { kinetic, potential: self.kernel.potential(&self.tree, q)? })
    }

    /// `g(q) - g(q_0)` (k), which is constant along exact motions: what the steps of an integrator have let
    /// drift. [`project`](Self::project) removes it.
    ///
    /// # Errors
    /// See [`ConstrainedHamiltonian`].
    pub fn drift(&mut self, q: &[S], q_0: &[S]) -> Result<&[S], EvalError> {
        self.check(&[("q", q), ("q_0", q_0)])?;
        self.rows.place(q_0);
        self.drift.copy_from_slice(self.rows.values());
        self.rows.place(q);
        for (drift, &g) in self.drift.iter_mut().zip(self.rows.values()) {
            *drift = g - *drift;
        }
        Ok(&self.drift)
    }

    /// `J v` (k): zero for a velocity that the constraints allow.
    ///
    /// # Errors
    /// See [`ConstrainedHamiltonian`].
    pub fn constraint_rate(&mut self, q: &[S], v: &[S]) -> Result<&[S], EvalError> {
        self.check(&[("q", q), ("v", v)])?;
        self.rows.place(q);
        for (i, rate) in self.drift.iter_mut().enumerate() {
            *rate = dot(self.rows.jacobian().row(i), v);
        }
        Ok(&self.drift)
    }

    /// 1 for each row that counts at the position of the last call, 0 for redundant ones (k).
    ///
    /// A row counts if its pivot in `J M^-1 J' = L D L'` exceeds 1e-10 of its diagonal entry. A redundant row
    /// is left out; its multiplier and force are zero. The forces of rows that depend on each other are not
    /// determined by the motion of rigid bodies: those of the first of them carry all.
    pub fn counted(&self) -> &[S] {
        &self.kkt.kept
    }
}
