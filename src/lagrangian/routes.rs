//! Steps of inverse and forward dynamics, by the algorithm that [`Routes`](super::choice::Routes) has chosen.

use super::Lagrangian;
use crate::error::EvalError;
use crate::kernels::friction_of;
use crate::robot::{Row, Tree, scaled};
use crate::scalar::Scalar;

/// What springs and friction give the diagonals of tau_q and tau_v, some at a time: coordinate and entries.
pub(super) fn joint_slopes<S: Scalar>(tree: &Tree, v: &[S], mut take: impl FnMut(usize, S, S)) {
    for &i in tree.with_friction() {
        take(i, S::zero(), -friction_of(tree, i, v[i]).first);
    }
    for &joint in tree.with_spring() {
        let Row { coordinate, ratio, .. } = tree.row_of(joint);
        let stiffness = S::from_f64(tree.joints()[joint].spring.stiffness);
        take(coordinate, scaled(ratio, scaled(ratio, stiffness)), S::zero());
    }
}

impl<S: Scalar> Lagrangian<S> {
    /// Fills M(q) for [`current_mass_matrix`](super::choice::current_mass_matrix).
    pub(super) fn place(&mut self, q: &[S]) -> Result<(), EvalError> {
        match &mut self.world {
            Some(world) if self.routes.derivatives => {
                world.set_position(&self.tree, q);
                world.compose(&self.tree);
                Ok(())
            }
            _ => self.kernel.set_position(&self.tree, q),
        }
    }

    /// `tau = C v + g - D`, n, without wrenches from outside too, where [`place`](Self::place) was called at
    /// the same q.
    pub(super) fn set_bias(&mut self, q: &[S], v: &[S]) {
        match &mut self.world {
            Some(world) if self.routes.derivatives => {
                world.set_motion(&self.tree, v, None);
                world.sum_forces(&mut self.tau);
                self.add_joint_forces(q, v);
            }
            _ => self.set_bias_by_recursion(q, v),
        }
    }

    /// The same by the recursion of inverse dynamics.
    pub(super) fn set_bias_by_recursion(&mut self, q: &[S], v: &[S]) {
        self.newton_euler.solve(&self.tree, q, v, &self.zero);
        self.subtract_friction(v);
        self.subtract_wrenches(q);
    }

    /// Adds the torques that accelerate the armature to tau.
    pub(super) fn add_armature(&mut self, a: &[S]) {
        for &(i, j, value) in self.tree.armature() {
            let [row, column] = [i, j].map(|joint| self.tree.row_of(joint));
            self.tau[row.coordinate] += scaled(row.ratio, column.rate(a).times(value));
            if i != j {
                self.tau[column.coordinate] += scaled(column.ratio, row.rate(a).times(value));
            }
        }
    }

    /// Adds springs to tau.
    pub(super) fn add_springs(&mut self, q: &[S]) {
        for &joint in self.tree.with_spring() {
            let (spring, row) = (self.tree.joints()[joint].spring, self.tree.row_of(joint));
            let position = row.position_from(q[self.tree.entry_of(row.coordinate)]);
            let force = position.plus(-spring.rest).times(spring.stiffness);
            self.tau[row.coordinate] += scaled(row.ratio, force);
        }
    }

    /// Adds springs to tau, and subtracts friction and wrenches from outside.
    pub(super) fn add_joint_forces(&mut self, q: &[S], v: &[S]) {
        self.add_springs(q);
        for &i in self.tree.with_friction() {
            self.tau[i] -= friction_of(&self.tree, i, v[i]).value;
        }
        self.subtract_wrenches(q);
    }

    /// Fills (v, a), by articulated bodies if they take less time than M and its factors.
    #[inline(never)]
    pub(super) fn accelerate_alone(&mut self, q: &[S], v: &[S], u: &[S]) -> Result<(), EvalError> {
        if self.bodies.is_none() {
            let in_world = self.routes.values;
            return if in_world { self.accelerate(q, v, u) } else { self.accelerate_by_kernel([q, v, u]) };
        }
        self.tau.fill(S::zero());
        self.add_joint_forces(q, v);
        let (rate_q, rate_v) = self.rate.split_at_mut(self.tree.dof());
        rate_q.copy_from_slice(v);
        for ((a, &u), &tau) in rate_v.iter_mut().zip(u).zip(&self.tau) {
            *a = u - tau;
        }
        let (Some(world), Some(bodies)) = (&mut self.world, &mut self.bodies) else { return Ok(()) };
        world.set_position(&self.tree, q);
        world.set_motion(&self.tree, v, None);
        let singular = |k: usize| EvalError::SingularMassMatrix { joint: self.tree.name(k).into() };
        bodies.solve(&self.tree, world, rate_v).map_err(singular)
    }

    /// Fills the panels of tau_q and tau_v at (q, v) and the acceleration computed last, where
    /// [`place`](Self::place) was called at the same q.
    pub(super) fn differentiate_torque(&mut self, q: &[S], v: &[S]) -> Result<(), EvalError> {
        if let Some(world) = self.world.as_mut().filter(|_| self.routes.derivatives) {
            world.set_motion(&self.tree, v, Some(&self.rate[self.tree.dof()..]));
        }
        self.differentiate_torque_at_motion(q, v)
    }

    /// The same where [`set_bias`](Self::set_bias) was called last, at the same (q, v).
    pub(super) fn differentiate_torque_after_bias(&mut self, q: &[S], v: &[S]) -> Result<(), EvalError> {
        if let Some(world) = self.world.as_mut().filter(|_| self.routes.derivatives) {
            world.set_acceleration(&self.tree, v, &self.rate[self.tree.dof()..]);
        }
        self.differentiate_torque_at_motion(q, v)
    }

    /// The same where the motion of the links is known, if they move in the axes of the world.
    #[inline(never)]
    pub(super) fn differentiate_torque_at_motion(&mut self, q: &[S], v: &[S]) -> Result<(), EvalError> {
        let Some(world) = self.world.as_mut().filter(|_| self.routes.derivatives) else {
            return self.differentiate_torque_by_kernels(q, v);
        };
        world.torque_derivatives(&self.tree, &mut self.torque);
        let [in_q, in_v] = &mut self.torque;
        joint_slopes(&self.tree, v, |i, by_q, by_v| {
            in_q.set(i, i, in_q.get(i, i) + by_q);
            in_v.set(i, i, in_v.get(i, i) + by_v);
        });
        if let Some(external) = &mut self.external {
            let slopes = external.slopes(q);
            for i in 0..q.len() {
                for (j, &slope) in slopes.row(i).iter().enumerate() {
                    in_q.set(i, j, in_q.get(i, j) - slope);
                }
            }
        }
        Ok(())
    }

    /// The same by kernels one and two.
    pub(super) fn differentiate_torque_by_kernels(&mut self, q: &[S], v: &[S]) -> Result<(), EvalError> {
        self.differentiate_flow()?;
        self.take_torque_jacobian(v);
        self.subtract_wrench_slopes(q);
        self.pack_torque();
        Ok(())
    }

    /// Fills tau after [`differentiate_torque`](Self::differentiate_torque) at the same (q, v, a).
    pub(super) fn take_torques(&mut self, q: &[S], v: &[S], a: &[S]) {
        match &self.world {
            Some(world) if self.routes.derivatives => {
                world.torques(&mut self.tau);
                self.add_armature(a);
                self.add_joint_forces(q, v);
            }
            _ => {
                self.newton_euler.solve(&self.tree, q, v, a);
                self.subtract_friction(v);
                self.subtract_wrenches(q);
            }
        }
    }
}
