//! The state equation of robots with floating and spherical joints.

use super::free::Free;
use super::{
    AdjointProduct, Energy, Hamiltonian, HamiltonianContraction, HamiltonianLinearisation,
    HamiltonianSecondOrder,
};
use crate::error::EvalError;
use crate::kernels::{LagrangianHessian, Route, check_entries};
use crate::matrix::{Matrix, add_scaled, dot};
use crate::scalar::Scalar;

impl<S: Scalar, R: Route> Hamiltonian<S, R> {
    /// Arguments of a robot with free joints: q of nq entries, the others of n.
    pub(super) fn check_free(&self, q: &[S], others: &[(&'static str, &[S])]) -> Result<(), EvalError> {
        if !R::Hessian::<S>::FREE_JOINTS {
            self.tree.refuse_free()?;
        }
        self.tree.refuse_free_and_wrench()?;
        self.tree.check_configuration(q)?;
        let n = self.tree.dof();
        others.iter().try_for_each(|&(what, values)| check_entries(&self.tree, what, values, n))
    }

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

    /// F of the chart, for displacements along the axes of the moved frames in the kernel of the world.
    fn first_order_of_chart(
        &mut self,
        free: &mut Free<S>,
        [q, p, u]: [&[S]; 3],
        second_order: bool,
    ) -> Result<(), EvalError> {
        if self.flow.has_world() {
            free.set_state_in_own_axes([p, u]);
        } else {
            free.set_state([q, p, u]);
        }
        self.flow.first_order_alone(&self.tree, [q, &free.p], second_order)
    }

    #[inline(never)]
    pub(super) fn evaluate_free(&mut self, [q, p, u]: [&[S]; 3]) -> Result<&[S], EvalError> {
        self.check_free(q, &[("p", p), ("u", u)])?;
        self.with_free(|this, free| {
            this.first_order_of_chart(free, [q, p, u], false)?;
            this.state.rate_of_change(&this.tree, &this.flow.v, this.flow.l_q(), &free.u);
            free.finish_rate(&mut this.state.f, u);
            Ok(())
        })?;
        Ok(&self.state.f)
    }

    /// F of the chart, and its derivative by (xi, pi) in the axes of the frames, after the first order.
    fn linearise_chart(&mut self, free: &mut Free<S>) {
        self.flow.second_order(&self.tree, free.momentum_slope());
        self.state.rate_of_change(&self.tree, &self.flow.v, self.flow.l_q(), &free.u);
        self.assemble();
        free.prepare_jacobian(&mut self.state.f_x);
        self.state.add_slopes(&self.tree);
    }

    #[inline(never)]
    pub(super) fn linearise_free(
        &mut self,
        [q, p, u]: [&[S]; 3],
    ) -> Result<HamiltonianLinearisation<'_, S>, EvalError> {
        self.check_free(q, &[("p", p), ("u", u)])?;
        self.with_free(|this, free| {
            this.first_order_of_chart(free, [q, p, u], true)?;
            this.linearise_chart(free);
            free.finish_rate(&mut this.state.f, u);
            free.parts.iter().for_each(|part| part.finish_jacobian(&mut this.state.f_x));
            if !this.flow.is_in_world() {
                free.set_mass_matrix(this.flow.kernel.mass_matrix());
            }
            Ok(())
        })?;
        Ok(self.state.linearisation(self.mass_matrix_of_free()))
    }

    fn mass_matrix_of_free(&self) -> &Matrix<S> {
        match &self.free {
            Some(free) if !self.flow.is_in_world() => &free.mass_matrix,
            _ => self.flow.mass_matrix(),
        }
    }

    /// F and y'F_x, by F_x.
    #[inline(never)]
    pub(super) fn adjoint_free(
        &mut self,
        [q, p, u, y]: [&[S]; 4],
    ) -> Result<AdjointProduct<'_, S>, EvalError> {
        self.check_free(q, &[])?;
        check_entries(&self.tree, "y", y, 2 * self.tree.dof())?;
        self.linearise_free([q, p, u])?;
        self.product.fill(S::zero());
        for (i, &y) in y.iter().enumerate() {
            add_scaled(&mut self.product, y, self.state.f_x.row(i));
        }
        Ok(AdjointProduct { f: &self.state.f, y_f_x: &self.product })
    }

    pub(super) fn mass_matrix_free(&mut self, q: &[S]) -> Result<&Matrix<S>, EvalError> {
        self.check_free(q, &[])?;
        self.with_free(|this, free| {
            free.set_configuration(q);
            this.flow.kernel.set_mass_matrix(&this.tree, q)?;
            free.set_mass_matrix(this.flow.kernel.mass_matrix());
            Ok(())
        })?;
        Ok(self.free.as_ref().map_or(self.flow.kernel.mass_matrix(), |free| &free.mass_matrix))
    }

    pub(super) fn inverse_free(&mut self, q: &[S]) -> Result<&Matrix<S>, EvalError> {
        self.check_free(q, &[])?;
        self.with_free(|this, free| {
            free.set_configuration(q);
            this.flow.factor_alone(&this.tree, q)?;
            this.flow.factor.inverse(&mut this.inverse);
            free.turn_symmetric(&mut this.inverse);
            Ok(())
        })?;
        Ok(&self.inverse)
    }

    pub(super) fn solve_free(&mut self, q: &[S], x: &mut [S]) -> Result<(), EvalError> {
        self.check_free(q, &[("x", x)])?;
        self.with_free(|this, free| {
            free.set_configuration(q);
            this.flow.factor_alone(&this.tree, q)?;
            free.parts.iter().for_each(|part| part.frame.outward(x));
            this.flow.factor.solve(x);
            free.parts.iter().for_each(|part| part.frame.inward(x));
            Ok(())
        })
    }

    pub(super) fn energy_free(&mut self, q: &[S], p: &[S]) -> Result<Energy<S>, EvalError> {
        self.check_free(q, &[("p", p)])?;
        let mut twice = S::zero();
        self.with_free(|this, free| {
            free.set_configuration(q);
            free.set_momentum(p);
            this.flow.solve_velocity(&this.tree, q, &free.p)?;
            twice = this.flow.v.iter().zip(&free.p).fold(S::zero(), |sum, (&v, &p)| sum + v * p);
            Ok(())
        })?;
        Ok(Energy { kinetic: twice.times(0.5), potential: self.flow.kernel.potential(&self.tree) })
    }

    /// `p = M v`.
    pub(super) fn momentum_free(&mut self, q: &[S], v: &[S]) -> Result<&[S], EvalError> {
        self.check_free(q, &[("v", v)])?;
        self.with_free(|this, free| {
            free.set_configuration(q);
            free.set_momentum(v);
            this.flow.kernel.set_position(&this.tree, q)?;
            this.flow.kernel.set_velocity(&this.tree, &free.p)?;
            this.flow.v.copy_from_slice(this.flow.kernel.momentum());
            free.parts.iter().for_each(|part| part.frame.inward(&mut this.flow.v));
            Ok(())
        })?;
        Ok(&self.flow.v)
    }

    /// `v = M^-1 p`.
    pub(super) fn velocity_free(&mut self, q: &[S], p: &[S]) -> Result<&[S], EvalError> {
        self.check_free(q, &[("p", p)])?;
        self.with_free(|this, free| {
            free.set_configuration(q);
            free.set_momentum(p);
            this.flow.solve_velocity(&this.tree, q, &free.p)?;
            free.parts.iter().for_each(|part| part.frame.inward(&mut this.flow.v));
            Ok(())
        })?;
        Ok(&self.flow.v)
    }
}

impl<S: Scalar> HamiltonianSecondOrder<S> {
    #[inline(never)]
    pub(super) fn contract_free(
        &mut self,
        [q, p, u, y]: [&[S]; 4],
    ) -> Result<HamiltonianContraction<'_, S>, EvalError> {
        self.first.check_free(q, &[("p", p), ("u", u)])?;
        let n = self.first.tree.dof();
        check_entries(&self.first.tree, "y", y, 2 * n)?;
        let Some(mut free) = self.first.free.take() else {
            return Err(EvalError::Model { reason: "the robot has no floating joint".into() });
        };
        let outcome = self.contract_in_chart(&mut free, [q, p, u, y]);
        self.first.free = Some(free);
        outcome?;
        // In the axes of the moved frames, whichever kernel it comes from.
        let mass_matrix =
            self.first.free.as_ref().map_or(self.first.flow.mass_matrix(), |free| &free.mass_matrix);
        let linearisation = self.first.state.linearisation(mass_matrix);
        Ok(HamiltonianContraction { linearisation, y_f_xx: &self.y_f_xx })
    }

    /// `y'F_xx d`, by the matrix.
    #[inline(never)]
    pub(super) fn hessian_product_free(&mut self, [q, p, y, d]: [&[S]; 4]) -> Result<&[S], EvalError> {
        let n = self.first.tree.dof();
        self.first.check_free(q, &[("p", p)])?;
        check_entries(&self.first.tree, "d", d, 2 * n)?;
        // The actuation does not enter.
        let mut none = std::mem::take(&mut self.pull);
        none.fill(S::zero());
        let outcome = self.contract_free([q, p, &none, y]).map(drop);
        self.pull = none;
        outcome?;
        for (i, entry) in self.product.iter_mut().enumerate() {
            *entry = dot(self.y_f_xx.row(i), d);
        }
        Ok(&self.product)
    }

    fn contract_in_chart(&mut self, free: &mut Free<S>, [q, p, u, y]: [&[S]; 4]) -> Result<(), EvalError> {
        let n = u.len();
        free.set_state([q, p, u]);
        let Self { first, change, .. } = self;
        if let Some(change) = change {
            first.flow.set_own_axes(false);
            let outcome = first.flow.first_order_alone(&first.tree, [q, &free.p], true);
            first.flow.set_own_axes(true);
            outcome?;
            first.linearise_chart(free);
            free.set_costate(y);
            first.differentiate_in_world(change, &free.y_chart, Some(free));
        } else {
            first.flow.first_order(&first.tree, q, &free.p)?;
            first.linearise_chart(free);
            free.set_costate(y);
            self.differentiate(&free.y_chart)?;
        }
        // By (xi, pi), as P has lost K.
        self.apply_congruence();
        free.turn_hessian(&mut self.y_f_xx);
        let Hamiltonian { tree, flow, state, .. } = &mut self.first;
        state.add_curvature(tree, &free.y_chart[n..], &mut self.y_f_xx);
        free.finish_rate(&mut state.f, u);
        free.curve(y, &state.f_x, None, &mut self.y_f_xx);
        free.parts.iter().for_each(|part| part.finish_jacobian(&mut state.f_x));
        free.set_mass_matrix(flow.mass_matrix());
        Ok(())
    }
}
