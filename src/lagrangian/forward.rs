//! The Jacobian of forward dynamics and of the state equation.

use super::Lagrangian;
use super::choice::current_mass_matrix;
use crate::error::EvalError;
use crate::matrix::{Block, Left, Matrix, Panel, Part, sized, write_packs};
use crate::scalar::Scalar;

/// Forward dynamics and its Jacobian in z = (q, v, u); borrowed from the workspace.
#[derive(Clone, Copy, Debug)]
pub struct ForwardDynamicsLinearisation<'a, S> {
    acceleration: &'a [S],
    a_z: &'a Matrix<S>,
    mass_matrix: &'a Matrix<S>,
}

impl<'a, S: Scalar> ForwardDynamicsLinearisation<'a, S> {
    fn square(&self, k: usize) -> Block<'a, S> {
        let n = self.a_z.rows();
        self.a_z.block(0, k * n, n, n)
    }

    /// `a = M^-1 (u + D + Q - C v - g)`, n (rad/s^2, m/s^2).
    pub fn acceleration(&self) -> &'a [S] {
        self.acceleration
    }

    /// Mass matrix M, n x n.
    pub fn mass_matrix(&self) -> &'a Matrix<S> {
        self.mass_matrix
    }

    /// `[a_q, a_v, a_u]`, n x 3n.
    pub fn matrix(&self) -> Block<'a, S> {
        self.a_z.view()
    }

    /// `da/dq = -M^-1 tau_q`, n x n.
    pub fn a_q(&self) -> Block<'a, S> {
        self.square(0)
    }

    /// `da/dv = -M^-1 tau_v`, n x n.
    pub fn a_v(&self) -> Block<'a, S> {
        self.square(1)
    }

    /// `da/du = M^-1`, n x n, exactly symmetric.
    pub fn a_u(&self) -> Block<'a, S> {
        self.square(2)
    }
}

/// The state equation and its Jacobians in x = (q, v) and u; borrowed from the workspace.
#[derive(Clone, Copy, Debug)]
pub struct StateLinearisation<'a, S> {
    /// `dx/dt = (v, a)`, 2n.
    pub f: &'a [S],
    /// `[0 1 ; a_q a_v]`, 2n x 2n.
    pub f_x: &'a Matrix<S>,
    /// `[0 ; M^-1]`, 2n x n.
    pub f_u: &'a Matrix<S>,
}

impl<S: Scalar> Lagrangian<S> {
    /// a and its Jacobian in z = (q, v, u) (9): `a_q = -M^-1 tau_q`, `a_v = -M^-1 tau_v`, `a_u = M^-1`.
    ///
    /// # Errors
    /// See [`Lagrangian`].
    pub fn linearise_forward_dynamics(
        &mut self,
        q: &[S],
        v: &[S],
        u: &[S],
    ) -> Result<ForwardDynamicsLinearisation<'_, S>, EvalError> {
        self.check(q, &[("v", v), ("u", u)])?;
        self.accelerate(q, v, u)?;
        self.differentiate_torque_after_bias(q, v)?;
        self.solve_jacobian();
        Ok(self.forward_jacobian())
    }

    /// `dx/dt = (v, a)` and its Jacobians in x = (q, v) and u.
    ///
    /// # Errors
    /// See [`Lagrangian`].
    pub fn linearise(&mut self, q: &[S], v: &[S], u: &[S]) -> Result<StateLinearisation<'_, S>, EvalError> {
        self.linearise_forward_dynamics(q, v, u)?;
        self.assemble();
        Ok(self.state())
    }

    /// The same by kernels one and two, which then hold P and the rates of M and P.
    pub(super) fn linearise_by_kernels(&mut self, q: &[S], v: &[S], u: &[S]) -> Result<(), EvalError> {
        self.check_plain(q, &[("v", v), ("u", u)])?;
        self.accelerate_by_kernel([q, v, u])?;
        self.differentiate_torque_by_kernels(q, v)?;
        self.solve_jacobian();
        self.assemble();
        Ok(())
    }

    /// f_x and f_u from a_z.
    pub(super) fn assemble(&mut self) {
        let n = self.tree.dof();
        for i in 0..n {
            self.f_x.row_mut(n + i).copy_from_slice(&self.a_z.row(i)[..2 * n]);
            self.f_u.row_mut(n + i).copy_from_slice(&self.a_z.row(i)[2 * n..]);
        }
    }

    /// The last assembled state equation.
    pub(super) fn state(&self) -> StateLinearisation<'_, S> {
        StateLinearisation { f: &self.rate, f_x: &self.f_x, f_u: &self.f_u }
    }

    /// The last forward dynamics.
    pub(super) fn forward_jacobian(&self) -> ForwardDynamicsLinearisation<'_, S> {
        ForwardDynamicsLinearisation {
            acceleration: self.acceleration(),
            a_z: &self.a_z,
            mass_matrix: current_mass_matrix(self.routes, &self.kernel, self.world.as_ref()),
        }
    }

    /// Fills `a_z = [-M^-1 tau_q, -M^-1 tau_v, M^-1]` from the panels of tau_q and tau_v; M is factored.
    ///
    /// Products with M^-1 where packs of its rows fit into registers, with the factors otherwise.
    #[inline(never)]
    pub(super) fn solve_jacobian(&mut self) {
        let (n, factor) = (self.tree.dof(), &mut self.factor);
        if !Panel::<S>::ONE_LANE
            && let Some(blocked) = &mut self.blocked
        {
            return blocked.solve(factor, &self.torque, &mut self.a_z);
        }
        sized!(S, n, factor.form_inverse(&mut self.inverse));
        for (solved, torque) in self.solved.iter_mut().zip(&self.torque) {
            if Panel::<S>::ONE_LANE {
                solved.copy_from::<0, 0>(torque);
                self.factor.solve_panel(solved);
            } else {
                sized!(S, n, solved.set_product(Left::Rows(&self.inverse), torque, Part::Whole));
            }
        }
        for i in 0..n {
            let (in_q, rest) = self.a_z.row_mut(i).split_at_mut(n);
            let (in_v, in_u) = rest.split_at_mut(n);
            let [by_q, by_v] = &self.solved;
            write_packs(by_q.row(i), in_q, |pack| -pack);
            write_packs(by_v.row(i), in_v, |pack| -pack);
            write_packs(self.inverse.row(i), in_u, |pack| pack);
        }
    }
}
