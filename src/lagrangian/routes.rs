//! Which of two algorithms computes a quantity: decided once, when the workspace is built.
//!
//! | quantity | short chains, numbers of one lane | otherwise |
//! |---|---|---|
//! | a | M and its factors | articulated bodies, O(n) |
//! | M, tau_q, tau_v | kernels one and two in body frames | products of pairs in the axes of the world |
//!
//! Both are tested against each other.

use super::Lagrangian;
use crate::error::EvalError;
use crate::kernels::{ArticulatedBodies, KernelOne, WorldKernel, friction};
use crate::matrix::{Matrix, Panel};
use crate::robot::Tree;
use crate::scalar::Scalar;

/// From this number of joints on, articulated bodies take less time than M and its factors: with packs of
/// several lanes, and with numbers one by one.
const ARTICULATED_FROM: [usize; 2] = [16, 20];

/// The algorithms for one tree and number type.
#[derive(Clone, Copy, Debug)]
pub(super) struct Routes {
    /// M and the derivatives of inverse dynamics in the axes of the world.
    pub derivatives: bool,
    /// Forward dynamics by articulated bodies.
    pub bodies: bool,
}

impl Routes {
    /// For the numbers S.
    pub fn of<S: Scalar>(tree: &Tree) -> Self {
        let one_lane = Panel::<S>::ONE_LANE;
        let enough = tree.dof() >= ARTICULATED_FROM[usize::from(one_lane)];
        Self { derivatives: !one_lane, bodies: enough && ArticulatedBodies::<S>::suit(tree) }
    }

    /// Whether any of them works in the axes of the world.
    pub fn world(self) -> bool {
        self.derivatives || self.bodies
    }
}

/// M, where it was computed last.
pub(super) fn current_mass_matrix<'a, S: Scalar>(
    routes: Routes,
    kernel: &'a KernelOne<S>,
    world: Option<&'a WorldKernel<S>>,
) -> &'a Matrix<S> {
    match world {
        Some(world) if routes.derivatives => world.mass_matrix(),
        _ => kernel.mass_matrix(),
    }
}

impl<S: Scalar> Lagrangian<S> {
    /// Fills M(q) for [`current_mass_matrix`].
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

    /// `tau = C v + g - D`, n, where [`place`](Self::place) was called at the same q.
    pub(super) fn set_bias(&mut self, q: &[S], v: &[S]) {
        match &mut self.world {
            Some(world) if self.routes.derivatives => {
                world.set_motion(&self.tree, v, None);
                world.sum_forces(&mut self.tau);
                self.add_joint_forces(q, v);
            }
            _ => {
                self.newton_euler.solve(&self.tree, q, v, &self.zero);
                self.subtract_friction(v);
            }
        }
    }

    /// Adds springs to tau and subtracts friction.
    fn add_joint_forces(&mut self, q: &[S], v: &[S]) {
        for &i in self.tree.with_spring() {
            let spring = self.tree.joints()[i].spring;
            self.tau[i] += q[i].plus(-spring.rest).times(spring.stiffness);
        }
        for &i in self.tree.with_friction() {
            self.tau[i] -= friction(&self.tree.joints()[i].friction, v[i]).value;
        }
    }

    /// Fills (v, a), by articulated bodies if they take less time than M and its factors.
    #[inline(never)]
    pub(super) fn accelerate_alone(&mut self, q: &[S], v: &[S], u: &[S]) -> Result<(), EvalError> {
        if self.bodies.is_none() {
            return self.accelerate(q, v, u);
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

    /// Fills the panels of tau_q and tau_v at v and the acceleration computed last, where
    /// [`place`](Self::place) was called at the same q.
    #[inline(never)]
    pub(super) fn differentiate_torque(&mut self, v: &[S]) -> Result<(), EvalError> {
        let Some(world) = self.world.as_mut().filter(|_| self.routes.derivatives) else {
            self.differentiate_flow()?;
            self.take_torque_jacobian(v);
            self.pack_torque();
            return Ok(());
        };
        world.set_motion(&self.tree, v, Some(&self.rate[self.tree.dof()..]));
        world.torque_derivatives(&mut self.torque);
        let [in_q, in_v] = &mut self.torque;
        for &i in self.tree.with_friction() {
            let slope = friction(&self.tree.joints()[i].friction, v[i]).first;
            in_v.set(i, i, in_v.get(i, i) - slope);
        }
        for &i in self.tree.with_spring() {
            in_q.set(i, i, in_q.get(i, i).plus(self.tree.joints()[i].spring.stiffness));
        }
        Ok(())
    }

    /// Fills tau after [`differentiate_torque`](Self::differentiate_torque) at the same (q, v, a).
    pub(super) fn take_torques(&mut self, q: &[S], v: &[S], a: &[S]) {
        match &self.world {
            Some(world) if self.routes.derivatives => {
                world.torques(&mut self.tau);
                for &(i, j, value) in self.tree.armature() {
                    self.tau[i] += a[j].times(value);
                    if i != j {
                        self.tau[j] += a[i].times(value);
                    }
                }
                self.add_joint_forces(q, v);
            }
            _ => {
                self.newton_euler.solve(&self.tree, q, v, a);
                self.subtract_friction(v);
            }
        }
    }
}
