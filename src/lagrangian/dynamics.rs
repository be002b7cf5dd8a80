//! Inverse and forward dynamics, gravity and energy, without derivatives.

use super::Lagrangian;
use super::choice::current_mass_matrix;
use crate::error::EvalError;
use crate::hamiltonian::Energy;
use crate::kernels::friction_of;
use crate::matrix::{Matrix, dot};
use crate::scalar::Scalar;

impl<S: Scalar> Lagrangian<S> {
    /// `tau = M a + C v + g - D = d/dt L_v - L_q - D`, n (N m, N): the actuation that produces the
    /// acceleration a; O(n).
    ///
    /// # Errors
    /// See [`Lagrangian`].
    pub fn inverse_dynamics(&mut self, q: &[S], v: &[S], a: &[S]) -> Result<&[S], EvalError> {
        self.check(q, &[("v", v), ("a", a)])?;
        self.set_torque(q, v, a);
        Ok(&self.tau)
    }

    /// `a = M^-1 (u + D + Q - C v - g)` (9), n (rad/s^2, m/s^2).
    ///
    /// # Errors
    /// See [`Lagrangian`].
    pub fn forward_dynamics(&mut self, q: &[S], v: &[S], u: &[S]) -> Result<&[S], EvalError> {
        self.check(q, &[("v", v), ("u", u)])?;
        self.accelerate_alone(q, v, u)?;
        Ok(self.acceleration())
    }

    /// `dx/dt = (v, a)` for x = (q, v) (9); length 2n.
    ///
    /// # Errors
    /// See [`Lagrangian`].
    pub fn evaluate(&mut self, q: &[S], v: &[S], u: &[S]) -> Result<&[S], EvalError> {
        self.check(q, &[("v", v), ("u", u)])?;
        self.accelerate_alone(q, v, u)?;
        Ok(&self.rate)
    }

    /// `g(q) = V_q`, n (N m, N): the actuation that holds the robot at q against gravity and springs.
    ///
    /// # Errors
    /// See [`Lagrangian`].
    pub fn gravity(&mut self, q: &[S]) -> Result<&[S], EvalError> {
        self.check(q, &[])?;
        if self.tree.free().is_empty() {
            self.newton_euler.solve(&self.tree, q, &self.zero, &self.zero);
            return Ok(self.newton_euler.tau());
        }
        if let Some(world) = &mut self.world {
            world.set_position(&self.tree, q);
            world.set_motion(&self.tree, &self.zero, None);
            world.sum_forces(&mut self.tau);
        }
        self.add_springs(q);
        Ok(&self.tau)
    }

    /// Mass matrix M(q), armature included, n x n, symmetric (kg m^2, kg m, kg).
    ///
    /// # Errors
    /// See [`Lagrangian`].
    pub fn mass_matrix(&mut self, q: &[S]) -> Result<&Matrix<S>, EvalError> {
        self.check(q, &[])?;
        if !self.routes.values {
            self.kernel.set_position(&self.tree, q)?;
            return Ok(self.kernel.mass_matrix());
        }
        self.place(q)?;
        Ok(current_mass_matrix(self.routes, &self.kernel, self.world.as_ref()))
    }

    /// Kinetic energy `1/2 v' M v` and potential energy V (J); their difference is L(q, v).
    ///
    /// # Errors
    /// See [`Lagrangian`].
    pub fn energy(&mut self, q: &[S], v: &[S]) -> Result<Energy<S>, EvalError> {
        self.check(q, &[("v", v)])?;
        self.kernel.set_position(&self.tree, q)?;
        let twice = if self.tree.free().is_empty() {
            self.kernel.set_velocity(&self.tree, v)?;
            dot(self.kernel.momentum(), v)
        } else {
            // The kernel has other coordinates of these joints.
            self.place(q)?;
            let mass_matrix = current_mass_matrix(self.routes, &self.kernel, self.world.as_ref());
            (0..v.len()).fold(S::zero(), |sum, i| v[i].mul_add(dot(mass_matrix.row(i), v), sum))
        };
        Ok(Energy { kinetic: twice.times(0.5), potential: self.kernel.potential(&self.tree) })
    }

    /// Fills tau of inverse dynamics, O(n).
    pub(super) fn set_torque(&mut self, q: &[S], v: &[S], a: &[S]) {
        if self.tree.free().is_empty() {
            self.newton_euler.solve(&self.tree, q, v, a);
            self.subtract_friction(v);
            return self.subtract_wrenches(q);
        }
        if let Some(world) = &mut self.world {
            world.set_position(&self.tree, q);
            world.set_motion(&self.tree, v, Some(a));
            world.sum_forces(&mut self.tau);
        }
        self.add_armature(a);
        self.add_joint_forces(q, v);
    }

    /// The acceleration computed last, n.
    pub(super) fn acceleration(&self) -> &[S] {
        &self.rate[self.tree.dof()..]
    }

    /// tau from the last sweep, with friction subtracted.
    pub(super) fn subtract_friction(&mut self, v: &[S]) {
        self.tau.copy_from_slice(self.newton_euler.tau());
        for &i in self.tree.with_friction() {
            self.tau[i] -= friction_of(&self.tree, i, v[i]).value;
        }
    }

    /// M(q) and its factors.
    #[inline(never)]
    pub(super) fn factor(&mut self, q: &[S]) -> Result<(), EvalError> {
        let Some(world) = self.world.as_mut().filter(|_| self.routes.derivatives) else {
            return self.factor_by_kernel(q);
        };
        world.set_position(&self.tree, q);
        world.compose(&self.tree);
        self.factor_placed(q)
    }

    /// The factors of M where it is computed in the axes of the world, at this q.
    pub(super) fn factor_placed(&mut self, q: &[S]) -> Result<(), EvalError> {
        let Self { tree, world: Some(world), factor, .. } = self else { return Ok(()) };
        world.set_reach(tree, q);
        let singular = |k: usize| EvalError::SingularMassMatrix { joint: tree.name(k).into() };
        factor.factor(world.mass_matrix(), |k| world.size_of_entry(tree, k)).map_err(singular)
    }

    /// The same by kernel one.
    pub(super) fn factor_by_kernel(&mut self, q: &[S]) -> Result<(), EvalError> {
        self.kernel.set_position(&self.tree, q)?;
        let size_of = |k| self.kernel.size_of_entry(&self.tree, k);
        let singular = |k: usize| EvalError::SingularMassMatrix { joint: self.tree.name(k).into() };
        self.factor.factor(self.kernel.mass_matrix(), size_of).map_err(singular)
    }

    /// Fills (v, a) by M in body frames and the recursion of inverse dynamics.
    pub(super) fn accelerate_by_kernel(&mut self, [q, v, u]: [&[S]; 3]) -> Result<(), EvalError> {
        self.factor_by_kernel(q)?;
        self.set_bias_by_recursion(q, v);
        self.accelerate_against(v, u);
        Ok(())
    }

    /// Factors M and fills (v, a); tau holds the inverse dynamics for a = 0.
    pub(super) fn accelerate(&mut self, q: &[S], v: &[S], u: &[S]) -> Result<(), EvalError> {
        self.factor(q)?;
        self.accelerate_factored(q, v, u);
        Ok(())
    }

    /// As [`accelerate`](Self::accelerate), where M(q) is factored already.
    #[inline(never)]
    pub(super) fn accelerate_factored(&mut self, q: &[S], v: &[S], u: &[S]) {
        self.set_bias(q, v);
        self.accelerate_against(v, u);
    }

    /// `a = M^-1 (u - tau)` with the factors of M.
    pub(super) fn accelerate_against(&mut self, v: &[S], u: &[S]) {
        let (rate_q, rate_v) = self.rate.split_at_mut(self.tree.dof());
        rate_q.copy_from_slice(v);
        for ((a, &u), &tau) in rate_v.iter_mut().zip(u).zip(&self.tau) {
            *a = u - tau;
        }
        self.factor.solve(rate_v);
    }
}
