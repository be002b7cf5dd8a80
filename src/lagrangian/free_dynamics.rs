//! Inverse and forward dynamics of robots with floating and spherical joints, by the algorithm that
//! [`Routes`](super::choice::Routes) has chosen.

use super::choice::current_mass_matrix;
use super::free::Free;
use super::inverse::{torque, torque_jacobian};
use super::{ForwardDynamicsLinearisation, InverseDynamicsLinearisation, Lagrangian};
use crate::error::EvalError;
use crate::hamiltonian::Energy;
use crate::kernels::check_entries;
use crate::matrix::{Matrix, add_scaled, dot};
use crate::scalar::Scalar;

impl<S: Scalar> Lagrangian<S> {
    /// Arguments of a robot with free joints: q of nq entries, the others of n.
    pub(super) fn check_free(&self, q: &[S], others: &[(&'static str, &[S])]) -> Result<(), EvalError> {
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

    /// Kernel one at (q, v), and M in the axes of the frames.
    fn set_kernel(&mut self, free: &mut Free<S>, q: &[S], v: &[S]) -> Result<(), EvalError> {
        free.set_state(&self.tree, q, v);
        self.kernel.set_position(&self.tree, q)?;
        self.kernel.set_velocity(&self.tree, &free.v_chain)?;
        self.kernel.second_order(&self.tree);
        free.set_mass_matrix(self.kernel.mass_matrix(), |entry| entry);
        Ok(())
    }

    /// tau at the acceleration of the chart, in the axes of the frames.
    fn take_torque_free(&mut self, free: &Free<S>) {
        torque(&self.tree, &self.kernel, |entry| entry, (&free.v_chain, &free.a_chain), &mut self.tau);
        free.inward(&mut self.tau);
    }

    /// tau_q and tau_v in the tangent space, after [`take_torque_free`](Self::take_torque_free).
    fn take_jacobian_free(&mut self, free: &Free<S>) -> Result<(), EvalError> {
        self.along.differentiate(&self.tree, &self.kernel, &free.v_chain, &free.a_chain)?;
        let kernels = (&self.kernel, &self.along);
        let slots = (&mut self.tau_q, &mut self.tau_v);
        torque_jacobian(&self.tree, kernels, |entry| entry, &free.v_chain, slots);
        free.finish_jacobian(&self.tau, [&mut self.tau_q, &mut self.tau_v]);
        Ok(())
    }

    /// tau, tau_q and tau_v in the axes of the world.
    fn linearise_torque_free(&mut self, free: &mut Free<S>, [q, v, a]: [&[S]; 3]) -> Result<(), EvalError> {
        free.set_state(&self.tree, q, v);
        free.set_acceleration(a);
        self.place(q)?;
        if let Some(world) = &mut self.world {
            world.set_motion(&self.tree, &free.v_chain, Some(&free.a_chain));
        }
        self.differentiate_torque_at_motion(&free.chart, &free.v_chain)?;
        self.unpack_torque();
        self.take_torques(&free.chart, &free.v_chain, &free.a_chain);
        free.inward(&mut self.tau);
        let mass_matrix = current_mass_matrix(self.routes, &self.kernel, self.world.as_ref());
        free.set_mass_matrix(mass_matrix, |entry| entry);
        free.finish_jacobian(&self.tau, [&mut self.tau_q, &mut self.tau_v]);
        Ok(())
    }

    /// Fills (v, nu') and factors M; a_chain is the acceleration of the chain.
    pub(super) fn accelerate_free(
        &mut self,
        free: &mut Free<S>,
        [q, v, u]: [&[S]; 3],
    ) -> Result<(), EvalError> {
        if self.routes.derivatives {
            free.set_state(&self.tree, q, v);
            self.place(q)?;
            self.factor_placed(&free.chart)?;
            self.set_bias(&free.chart, &free.v_chain);
            let mass_matrix = current_mass_matrix(self.routes, &self.kernel, self.world.as_ref());
            free.set_mass_matrix(mass_matrix, |entry| entry);
        } else {
            self.set_kernel(free, q, v)?;
            let size_of = |k| self.kernel.size_of_entry(&self.tree, k);
            let singular = |k: usize| EvalError::SingularMassMatrix { joint: self.tree.name(k).into() };
            self.factor.factor(self.kernel.mass_matrix(), size_of).map_err(singular)?;
            free.a_chain.fill(S::zero());
            torque(&self.tree, &self.kernel, |entry| entry, (&free.v_chain, &free.a_chain), &mut self.tau);
        }
        self.take_given_forces(free, [v, u]);
        let a = &mut self.rate[v.len()..];
        self.factor.solve(a);
        free.a_chain.copy_from_slice(a);
        free.finish_acceleration(a);
        Ok(())
    }

    /// Fills `(v, u - tau)`, with u in the axes of the chain.
    fn take_given_forces(&mut self, free: &Free<S>, [v, u]: [&[S]; 2]) {
        let (rate_q, forces) = self.rate.split_at_mut(v.len());
        rate_q.copy_from_slice(v);
        forces.copy_from_slice(u);
        free.outward(forces);
        forces.iter_mut().zip(&self.tau).for_each(|(force, &tau)| *force -= tau);
    }

    /// Fills (v, nu'), by articulated bodies if they take less time than M and its factors.
    fn accelerate_alone_free(&mut self, free: &mut Free<S>, [q, v, u]: [&[S]; 3]) -> Result<(), EvalError> {
        if self.bodies.is_none() {
            return self.accelerate_free(free, [q, v, u]);
        }
        free.set_state(&self.tree, q, v);
        self.tau.fill(S::zero());
        self.add_joint_forces(&free.chart, &free.v_chain);
        self.take_given_forces(free, [v, u]);
        let a = &mut self.rate[v.len()..];
        let (Some(world), Some(bodies)) = (&mut self.world, &mut self.bodies) else { return Ok(()) };
        world.set_position(&self.tree, q);
        world.set_motion(&self.tree, &free.v_chain, None);
        let singular = |k: usize| EvalError::SingularMassMatrix { joint: self.tree.name(k).into() };
        bodies.solve(&self.tree, world, a).map_err(singular)?;
        free.finish_acceleration(a);
        Ok(())
    }

    #[inline(never)]
    pub(super) fn inverse_dynamics_free(&mut self, [q, v, a]: [&[S]; 3]) -> Result<&[S], EvalError> {
        self.check_free(q, &[("v", v), ("a", a)])?;
        self.with_free(|this, free| {
            if !this.routes.derivatives {
                this.set_kernel(free, q, v)?;
                free.set_acceleration(a);
                this.take_torque_free(free);
                return Ok(());
            }
            free.set_state(&this.tree, q, v);
            free.set_acceleration(a);
            let Some(world) = &mut this.world else { return Ok(()) };
            world.set_position(&this.tree, q);
            world.set_motion(&this.tree, &free.v_chain, Some(&free.a_chain));
            world.sum_forces(&mut this.tau);
            this.add_armature(&free.a_chain);
            this.add_joint_forces(&free.chart, &free.v_chain);
            free.inward(&mut this.tau);
            Ok(())
        })?;
        Ok(&self.tau)
    }

    #[inline(never)]
    pub(super) fn linearise_inverse_dynamics_free(
        &mut self,
        [q, v, a]: [&[S]; 3],
    ) -> Result<InverseDynamicsLinearisation<'_, S>, EvalError> {
        self.check_free(q, &[("v", v), ("a", a)])?;
        self.with_free(|this, free| {
            if this.routes.derivatives {
                return this.linearise_torque_free(free, [q, v, a]);
            }
            this.set_kernel(free, q, v)?;
            free.set_acceleration(a);
            this.take_torque_free(free);
            this.take_jacobian_free(free)
        })?;
        let tau_a = self.free.as_ref().map_or(self.kernel.mass_matrix(), |free| &free.mass_matrix);
        Ok(InverseDynamicsLinearisation { tau: &self.tau, tau_q: &self.tau_q, tau_v: &self.tau_v, tau_a })
    }

    /// `(v, nu')`.
    #[inline(never)]
    pub(super) fn evaluate_free(&mut self, [q, v, u]: [&[S]; 3]) -> Result<&[S], EvalError> {
        self.check_free(q, &[("v", v), ("u", u)])?;
        self.with_free(|this, free| this.accelerate_alone_free(free, [q, v, u]))?;
        Ok(&self.rate)
    }

    #[inline(never)]
    pub(super) fn linearise_forward_dynamics_free(
        &mut self,
        [q, v, u]: [&[S]; 3],
    ) -> Result<ForwardDynamicsLinearisation<'_, S>, EvalError> {
        self.check_free(q, &[("v", v), ("u", u)])?;
        let n = v.len();
        self.with_free(|this, free| {
            this.accelerate_free(free, [q, v, u])?;
            free.set_acceleration(&this.rate[n..]);
            if this.routes.derivatives {
                return this.respond_free(free, u);
            }
            this.take_torque_free(free);
            this.take_jacobian_free(free)?;
            this.solve_jacobian_free(free);
            Ok(())
        })?;
        Ok(self.forward_jacobian())
    }

    /// Fills a_z in the axes of the world, where [`accelerate_free`](Self::accelerate_free) was called; the
    /// torque of the motion is u.
    fn respond_free(&mut self, free: &mut Free<S>, u: &[S]) -> Result<(), EvalError> {
        if let Some(world) = &mut self.world {
            world.set_acceleration(&self.tree, &free.v_chain, &free.a_chain);
        }
        self.differentiate_torque_at_motion(&free.chart, &free.v_chain)?;
        self.torque[0].subtract_entries(free.force_slope(u));
        self.solve_jacobian();
        free.finish_responses(&mut self.a_z);
        Ok(())
    }

    /// Fills a_z from tau_q and tau_v; M is factored.
    pub(super) fn solve_jacobian_free(&mut self, free: &mut Free<S>) {
        let n = self.tree.dof();
        self.factor.inverse(&mut free.inverse);
        free.parts.iter().for_each(|part| part.frame.turn_block(&mut free.inverse, [0, 0], n));
        for i in 0..n {
            let (weights, row) = (free.inverse.row(i), self.a_z.row_mut(i));
            row.fill(S::zero());
            let (in_q, rest) = row.split_at_mut(n);
            let (in_v, in_u) = rest.split_at_mut(n);
            for (k, &weight) in weights.iter().enumerate() {
                add_scaled(in_q, -weight, self.tau_q.row(k));
                add_scaled(in_v, -weight, self.tau_v.row(k));
            }
            in_u.copy_from_slice(weights);
        }
    }

    pub(super) fn energy_free(&mut self, q: &[S], v: &[S]) -> Result<Energy<S>, EvalError> {
        self.check_free(q, &[("v", v)])?;
        let mut twice = S::zero();
        self.with_free(|this, free| {
            free.set_state(&this.tree, q, v);
            this.kernel.set_position(&this.tree, q)?;
            this.kernel.set_velocity(&this.tree, &free.v_chain)?;
            twice = dot(this.kernel.momentum(), &free.v_chain);
            Ok(())
        })?;
        Ok(Energy { kinetic: twice.times(0.5), potential: self.kernel.potential(&self.tree) })
    }

    pub(super) fn mass_matrix_free(&mut self, q: &[S]) -> Result<&Matrix<S>, EvalError> {
        self.check_free(q, &[])?;
        self.with_free(|this, free| {
            free.set_configuration(q);
            this.kernel.set_position(&this.tree, q)?;
            free.set_mass_matrix(this.kernel.mass_matrix(), |entry| entry);
            Ok(())
        })?;
        Ok(self.free.as_ref().map_or(self.kernel.mass_matrix(), |free| &free.mass_matrix))
    }
}
