//! Inverse dynamics and its Jacobian, in body frames from kernel one and kernel two along (v, a).

use super::Lagrangian;
use super::choice::current_mass_matrix;
use crate::error::EvalError;
use crate::kernels::{KernelOne, KernelTwo, friction_of};
use crate::matrix::Matrix;
use crate::robot::Tree;
use crate::scalar::Scalar;

/// Inverse dynamics and its Jacobian in (q, v, a); borrowed from the workspace.
#[derive(Clone, Copy, Debug)]
pub struct InverseDynamicsLinearisation<'a, S> {
    /// `tau = M a + C v + g - D`, n (N m, N).
    pub tau: &'a [S],
    /// `dtau/dq = Pdot - L_qq`, n x n.
    pub tau_q: &'a Matrix<S>,
    /// `dtau/dv = Mdot + P - P' - D_v`, n x n.
    pub tau_v: &'a Matrix<S>,
    /// `dtau/da = M`, n x n.
    pub tau_a: &'a Matrix<S>,
}

/// `tau_q = Pdot - L_qq`, `tau_v = Mdot + P - P' - D_v` from kernel one at (q, v) and kernel two along (v,
/// a).
///
/// The kernels may compute with dual numbers; `value` returns the real part.
pub(super) fn torque_jacobian<S: Scalar, T: Scalar>(
    tree: &Tree,
    (kernel, along): (&KernelOne<T>, &KernelTwo<T>),
    value: impl Fn(T) -> S,
    v: &[S],
    (tau_q, tau_v): (&mut Matrix<S>, &mut Matrix<S>),
) {
    let (p, l_qq, m_rate, p_rate) = (kernel.l_vq(), kernel.l_qq(), along.mass_matrix(), along.l_vq());
    for i in 0..tree.dof() {
        for j in 0..tree.dof() {
            tau_q[(i, j)] = value(p_rate[(i, j)] - l_qq[(i, j)]);
            tau_v[(i, j)] = value(m_rate[(i, j)] + p[(i, j)] - p[(j, i)]);
        }
    }
    for &i in tree.with_friction() {
        tau_v[(i, i)] -= friction_of(tree, i, v[i]).first;
    }
}

/// `tau = M a + P v - L_q - D` from kernel one at (q, v), which may compute with dual numbers as above.
pub(super) fn torque<S: Scalar, T: Scalar>(
    tree: &Tree,
    kernel: &KernelOne<T>,
    value: impl Fn(T) -> S,
    (v, a): (&[S], &[S]),
    tau: &mut [S],
) {
    let (mass_matrix, p, l_q) = (kernel.mass_matrix(), kernel.l_vq(), kernel.l_q());
    for (i, tau) in tau.iter_mut().enumerate() {
        let rows = mass_matrix.row(i).iter().zip(a).chain(p.row(i).iter().zip(v));
        *tau = rows.fold(-value(l_q[i]), |sum, (&entry, &rate)| value(entry).mul_add(rate, sum));
    }
    for &i in tree.with_friction() {
        tau[i] -= friction_of(tree, i, v[i]).value;
    }
}

impl<S: Scalar> Lagrangian<S> {
    /// tau and its Jacobian in (q, v, a).
    ///
    /// # Errors
    /// See [`Lagrangian`]; a singular mass matrix is not an error here.
    pub fn linearise_inverse_dynamics(
        &mut self,
        q: &[S],
        v: &[S],
        a: &[S],
    ) -> Result<InverseDynamicsLinearisation<'_, S>, EvalError> {
        self.check(q, &[("v", v), ("a", a)])?;
        self.set_torque_jacobian(q, v, a)?;
        self.unpack_torque();
        Ok(self.inverse_jacobian())
    }

    /// Fills tau and the panels of tau_q and tau_v.
    pub(super) fn set_torque_jacobian(&mut self, q: &[S], v: &[S], a: &[S]) -> Result<(), EvalError> {
        self.place(q)?;
        let (rate_q, rate_v) = self.rate.split_at_mut(v.len());
        rate_q.copy_from_slice(v);
        rate_v.copy_from_slice(a);
        self.differentiate_torque(q, v)?;
        self.take_torques(q, v, a);
        Ok(())
    }

    /// The last inverse dynamics.
    pub(super) fn inverse_jacobian(&self) -> InverseDynamicsLinearisation<'_, S> {
        InverseDynamicsLinearisation {
            tau: &self.tau,
            tau_q: &self.tau_q,
            tau_v: &self.tau_v,
            tau_a: current_mass_matrix(self.routes, &self.kernel, self.world.as_ref()),
        }
    }

    /// Puts tau_q and tau_v into the panels.
    pub(super) fn pack_torque(&mut self) {
        let [in_q, in_v] = &mut self.torque;
        in_q.read::<0>(&self.tau_q);
        in_v.read::<0>(&self.tau_v);
    }

    /// Takes tau_q and tau_v from the panels.
    pub(super) fn unpack_torque(&mut self) {
        let both = self.torque.iter().zip([&mut self.tau_q, &mut self.tau_v]);
        match &self.world {
            Some(world) if self.routes.derivatives => both.for_each(|(from, to)| world.write_pairs(from, to)),
            _ => both.for_each(|(from, to)| from.write(to)),
        }
    }

    /// Fills tau_q and tau_v from the kernels.
    #[inline(never)]
    pub(super) fn take_torque_jacobian(&mut self, v: &[S]) {
        let kernels = (&self.kernel, &self.along);
        torque_jacobian(&self.tree, kernels, |entry| entry, v, (&mut self.tau_q, &mut self.tau_v));
    }
}
