//! Contracted Hessians of inverse and forward dynamics of robots with floating and spherical joints.

use super::free::Free;
use super::inverse::{torque, torque_jacobian};
use super::{
    InverseDynamicsContraction, InverseDynamicsLinearisation, Lagrangian, LagrangianContraction,
    LagrangianSecondOrder,
};
use crate::error::EvalError;
use crate::scalar::{Scalar, Tangent};

impl<S: Scalar> LagrangianSecondOrder<S> {
    /// tau with its derivatives at (q, v), at the acceleration nu', from one dual pass along `free.w`.
    fn differentiate_free(
        &mut self,
        free: &mut Free<S>,
        q: &[S],
        acceleration: Option<&[S]>,
    ) -> Result<(), EvalError> {
        free.set_acceleration(acceleration.unwrap_or_else(|| self.first.acceleration()));
        self.w.copy_from_slice(&free.w);
        free.outward(&mut self.w);
        let along = self.direction_v.iter_mut().zip(&free.a_chain);
        along.for_each(|(dual, &a)| *dual = Tangent::new(a, S::zero()));
        self.pass(q, &free.v_chain)?;
        free.set_mass_matrix(self.kernel.mass_matrix(), |entry| entry.re);
        let Lagrangian { tree, tau, tau_q, tau_v, .. } = &mut self.first;
        torque(tree, &self.kernel, |entry| entry.re, (&free.v_chain, &free.a_chain), tau);
        free.inward(tau);
        let kernels = (&self.kernel, &self.along);
        torque_jacobian(tree, kernels, |entry| entry.re, &free.v_chain, (&mut *tau_q, &mut *tau_v));
        free.finish_hessian(tau, [tau_q, tau_v], &mut self.w_tau_zz);
        Ok(())
    }

    #[inline(never)]
    pub(super) fn contract_inverse_dynamics_free(
        &mut self,
        [q, v, a, w]: [&[S]; 4],
    ) -> Result<InverseDynamicsContraction<'_, S>, EvalError> {
        self.first.check_free(q, &[("v", v), ("a", a), ("w", w)])?;
        if let Some(mut free) = self.first.free.take() {
            free.set_state(&self.first.tree, q, v);
            free.w.copy_from_slice(w);
            let outcome = self.differentiate_free(&mut free, q, Some(a));
            self.first.free = Some(free);
            outcome?;
        }
        let Lagrangian { tau, tau_q, tau_v, free, .. } = &self.first;
        let tau_a = free.as_ref().map_or(&self.tau_a, |free| &free.mass_matrix);
        let inverse_dynamics = InverseDynamicsLinearisation { tau, tau_q, tau_v, tau_a };
        Ok(InverseDynamicsContraction { inverse_dynamics, zz: &self.w_tau_zz })
    }

    #[inline(never)]
    pub(super) fn contract_forward_dynamics_free(
        &mut self,
        [q, v, u, y]: [&[S]; 4],
    ) -> Result<LagrangianContraction<'_, S>, EvalError> {
        self.first.check_free(q, &[("v", v), ("u", u), ("y", y)])?;
        if let Some(mut free) = self.first.free.take() {
            let outcome = self.solve_free(&mut free, [q, v, u, y]);
            self.first.free = Some(free);
            outcome?;
        }
        let (forward_dynamics, linearisation) = (self.first.forward_jacobian(), self.first.state());
        Ok(LagrangianContraction { forward_dynamics, linearisation, xx: &self.xx, uq: &self.uq })
    }

    /// As for robots without such joints: `y'a_zz` is minus the Hessian for `w = M^-1 y`, transformed.
    fn solve_free(&mut self, free: &mut Free<S>, [q, v, u, y]: [&[S]; 4]) -> Result<(), EvalError> {
        self.first.accelerate_free(free, [q, v, u])?;
        free.w.copy_from_slice(y);
        free.parts.iter().for_each(|part| part.frame.outward(&mut free.w));
        self.first.factor.solve(&mut free.w);
        free.parts.iter().for_each(|part| part.frame.inward(&mut free.w));
        self.differentiate_free(free, q, None)?;
        self.first.solve_jacobian_free(free);
        self.first.assemble();
        self.transform();
        Ok(())
    }
}
