//! The constrained state equation of robots with floating and spherical joints.
//!
//! H_c is a function of (q, p) like H, so that its state equation in the tangent space comes from that of the
//! chains of joints in the same way: see [`Free`]. mu is a function of (q, p), its Jacobian changes by the
//! columns alone.

use super::linearisation::{
    ConstrainedAdjoint, ConstrainedContraction, ConstrainedLinearisation, ConstrainedRate,
};
use super::{ConstrainedHamiltonian, ConstrainedHamiltonianSecondOrder};
use crate::error::EvalError;
use crate::hamiltonian::Free;
use crate::matrix::{Entry, Matrix, add_scaled, dot};
use crate::scalar::Scalar;

impl<S: Scalar> ConstrainedHamiltonian<S> {
    /// Runs a step with what the free joints need.
    fn with_free(
        &mut self,
        step: impl FnOnce(&mut Self, &mut Free<S>) -> Result<(), EvalError>,
    ) -> Result<(), EvalError> {
        let Some(mut free) = self.free.take() else { return Ok(()) };
        let outcome = step(self, &mut free);
        self.free = Some(free);
        outcome
    }

    pub(super) fn first_order_free(&mut self, q: &[S], p: &[S]) -> Result<(), EvalError> {
        self.with_free(|this, free| {
            free.set_configuration(q);
            free.set_momentum(p);
            this.first_order(q, &free.p)
        })
    }

    /// `p = M v`, in the place of v.
    pub(super) fn momentum_free(&mut self, q: &[S], v: &[S]) -> Result<&[S], EvalError> {
        self.with_free(|this, free| {
            free.set_configuration(q);
            free.set_momentum(v);
            this.kernel.set_position(&this.tree, q)?;
            this.kernel.set_velocity(&this.tree, &free.p)?;
            this.v.copy_from_slice(this.kernel.momentum());
            free.parts.iter().for_each(|part| part.frame.inward(&mut this.v));
            Ok(())
        })?;
        Ok(&self.v)
    }

    /// v and mu at (q, p).
    pub(super) fn velocity_free(&mut self, q: &[S], p: &[S]) -> Result<(), EvalError> {
        self.with_free(|this, free| {
            free.set_configuration(q);
            free.set_momentum(p);
            this.solve_velocity(q, &free.p)?;
            free.parts.iter().for_each(|part| part.frame.inward(&mut this.v));
            Ok(())
        })
    }

    #[inline(never)]
    pub(super) fn evaluate_free(
        &mut self,
        [q, p, u]: [&[S]; 3],
    ) -> Result<ConstrainedRate<'_, S>, EvalError> {
        self.with_free(|this, free| {
            free.set_state([q, p, u]);
            this.first_order(q, &free.p)?;
            this.rows.contract(&this.mu);
            let n = u.len();
            for i in 0..n {
                this.f[n + i] = this.kernel.l_q()[i] - dot(this.rows.contracted().row(i), &this.v);
            }
            this.add_outer_forces(q, &free.u);
            free.finish_rate(&mut this.f, u);
            Ok(())
        })?;
        Ok(ConstrainedRate { f: &self.f, mu: &self.mu })
    }

    #[inline(never)]
    pub(super) fn linearise_free(
        &mut self,
        [q, p, u]: [&[S]; 3],
    ) -> Result<ConstrainedLinearisation<'_, S>, EvalError> {
        self.with_free(|this, free| {
            if this.has_own_axes() {
                free.set_state_in_own_axes([p, u]);
            } else {
                free.set_state([q, p, u]);
            }
            this.prepare_alone(q, &free.p)?;
            this.assemble_chart(free, [q, u]);
            this.turn_jacobian(free, q);
            this.finish_jacobian(free);
            Ok(())
        })?;
        Ok(self.linearisation())
    }

    /// All blocks in the chart.
    fn prepare_free(&mut self, free: &mut Free<S>, [q, p, u]: [&[S]; 3]) -> Result<(), EvalError> {
        free.set_state([q, p, u]);
        self.prepare(q, &free.p)
    }

    /// F in the tangent space; F_x of the chart without friction and mu_x, by (xi, pi), in the axes of the
    /// chart.
    fn assemble_chart(&mut self, free: &mut Free<S>, [q, u]: [&[S]; 2]) {
        self.rate(q, &free.u);
        free.finish_rate(&mut self.f, u);
        let less = free.momentum_slope();
        match &mut self.world {
            Some(world) if self.in_world => world.l_vq_mut().subtract_entries(less),
            _ => {
                for &Entry { row, column, value } in less {
                    self.cross[(row, column)] -= value;
                }
            }
        }
        self.conservative();
    }

    /// F_x of the chart with friction and mu_x in the axes of the frames.
    fn turn_jacobian(&mut self, free: &Free<S>, q: &[S]) {
        free.prepare_jacobian(&mut self.f_x);
        free.prepare_rows(&mut self.mu_x);
        self.add_slopes(q);
    }

    /// F_x in the tangent space, accelerations and forces.
    fn finish_jacobian(&mut self, free: &Free<S>) {
        free.parts.iter().for_each(|part| part.finish_jacobian(&mut self.f_x));
        self.balance();
    }

    /// F and y'F_x, by F_x.
    #[inline(never)]
    pub(super) fn adjoint_free(
        &mut self,
        [q, p, u, y]: [&[S]; 4],
    ) -> Result<ConstrainedAdjoint<'_, S>, EvalError> {
        self.linearise_free([q, p, u])?;
        self.product.fill(S::zero());
        for (i, &y) in y.iter().enumerate() {
            add_scaled(&mut self.product, y, self.f_x.row(i));
        }
        Ok(ConstrainedAdjoint { f: &self.f, y_f_x: &self.product })
    }
}

impl<S: Scalar> ConstrainedHamiltonianSecondOrder<S> {
    #[inline(never)]
    pub(super) fn contract_free(
        &mut self,
        state: [&[S]; 4],
    ) -> Result<ConstrainedContraction<'_, S>, EvalError> {
        if let Some(mut free) = self.first.free.take() {
            let outcome = self.contract_in_chart(&mut free, state);
            self.first.free = Some(free);
            outcome?;
        }
        Ok(ConstrainedContraction { linearisation: self.first.linearisation(), y_f_xx: &self.y_f_xx })
    }

    /// `y'F_xx d`, by the matrix.
    #[inline(never)]
    pub(super) fn hessian_product_free(&mut self, [q, p, y, d]: [&[S]; 4]) -> Result<&[S], EvalError> {
        // The actuation does not enter.
        let mut none = std::mem::take(&mut self.response[0]);
        none.fill(S::zero());
        let outcome = self.contract_free([q, p, &none, y]).map(drop);
        self.response[0] = none;
        outcome?;
        for (i, entry) in self.product.iter_mut().enumerate() {
            *entry = dot(self.y_f_xx.row(i), d);
        }
        Ok(&self.product)
    }

    /// See [`velocity_hessian`](Self::velocity_hessian).
    #[inline(never)]
    pub(super) fn velocity_hessian_free(
        &mut self,
        [q, p, y]: [&[S]; 3],
        c: &[S],
    ) -> Result<&Matrix<S>, EvalError> {
        if let Some(mut free) = self.first.free.take() {
            let mut padded = std::mem::take(&mut self.product);
            padded.fill(S::zero());
            let outcome = self.contract_velocity(&mut free, [q, p, y], c, &mut padded);
            self.product = padded;
            self.first.free = Some(free);
            outcome?;
        }
        Ok(&self.y_f_xx)
    }

    /// `y.v + c.mu`, with a costate (y, 0) in `padded`.
    fn contract_velocity(
        &mut self,
        free: &mut Free<S>,
        [q, p, y]: [&[S]; 3],
        c: &[S],
        padded: &mut [S],
    ) -> Result<(), EvalError> {
        let n = y.len();
        // The actuation does not enter.
        self.first.prepare_free(free, [q, p, &padded[n..]])?;
        self.first.assemble_chart(free, [q, &padded[n..]]);
        padded[..n].copy_from_slice(y);
        free.set_costate(padded);
        self.first.set_weights(&free.y_chart[..n], c);
        self.along_response(q)?;
        self.congruence();
        free.turn_hessian(&mut self.y_f_xx);
        self.first.turn_jacobian(free, q);
        free.curve(padded, &self.first.f_x, Some((c, &self.first.mu_x)), &mut self.y_f_xx);
        self.first.finish_jacobian(free);
        Ok(())
    }

    fn contract_in_chart(&mut self, free: &mut Free<S>, [q, p, u, y]: [&[S]; 4]) -> Result<(), EvalError> {
        let n = u.len();
        self.first.prepare_free(free, [q, p, u])?;
        free.set_costate(y);
        self.differentiate(q, &free.y_chart)?;
        self.first.assemble_chart(free, [q, u]);
        // By (xi, pi), as P has lost K.
        self.congruence();
        free.turn_hessian(&mut self.y_f_xx);
        self.first.turn_jacobian(free, q);
        self.add_friction(&free.y_chart[n..]);
        free.curve(y, &self.first.f_x, None, &mut self.y_f_xx);
        self.first.finish_jacobian(free);
        Ok(())
    }
}
