//! Which of two algorithms computes a quantity: decided once for each tree.

use super::Lagrangian;
use crate::error::EvalError;
use crate::kernels::{ArticulatedBodies, TorqueDerivatives, WorldKernel, friction};
use crate::matrix::{Matrix, Panel};
use crate::robot::Tree;
use crate::scalar::Scalar;

/// From this number of joints on, articulated bodies take less time than M and its factors: with packs of
/// several lanes, and with numbers one by one.
const ARTICULATED_FROM: [usize; 2] = [6, 20];

/// The algorithms for one tree and number type.
#[derive(Clone, Copy, Debug)]
pub(super) struct Routes {
    /// M and the derivatives of inverse dynamics in the axes of the world.
    pub derivatives: bool,
    /// Forward dynamics by articulated bodies.
    pub bodies: bool,
}

impl Routes {
    /// For numbers of one lane or several.
    pub fn of(tree: &Tree, one_lane: bool) -> Self {
        let enough = tree.dof() >= ARTICULATED_FROM[usize::from(one_lane)];
        Self { derivatives: !one_lane, bodies: enough && ArticulatedBodies::<f64>::suit(tree) }
    }

    /// Whether any of them works in the axes of the world.
    pub fn world(self) -> bool {
        self.derivatives || self.bodies
    }
}

impl<S: Scalar> Lagrangian<S> {
    /// Fills (v, a), without M and its factors if articulated bodies do that faster.
    #[inline(never)]
    pub(super) fn accelerate_alone(&mut self, q: &[S], v: &[S], u: &[S]) -> Result<(), EvalError> {
        let (Some(world), Some(bodies)) = (&mut self.world, &mut self.bodies) else {
            return self.accelerate(q, v, u);
        };
        let (rate_q, rate_v) = self.rate.split_at_mut(self.tree.dof());
        rate_q.copy_from_slice(v);
        rate_v.copy_from_slice(u);
        for &i in self.tree.with_friction() {
            rate_v[i] += friction(&self.tree.joints()[i].friction, v[i]).value;
        }
        for &i in self.tree.with_spring() {
            let spring = self.tree.joints()[i].spring;
            rate_v[i] -= q[i].plus(-spring.rest).times(spring.stiffness);
        }
        world.set_position(&self.tree, q);
        world.set_motion(&self.tree, v, None);
        let singular = |k: usize| EvalError::SingularMassMatrix { joint: self.tree.name(k).into() };
        bodies.solve(&self.tree, world, q, rate_v).map_err(singular)
    }

    /// M(q) in the axes of the world, armature included.
    #[inline(never)]
    pub(super) fn mass_by_world(tree: &Tree, world: &mut WorldKernel<S>, q: &[S], mass: &mut Matrix<S>) {
        world.set_position(tree, q);
        world.compose(tree);
        world.mass_matrix(mass);
        for &(i, j, value) in tree.armature() {
            let on_one_branch = tree.subtree(j).contains(&i);
            let entry = if on_one_branch { mass[(i, j)].plus(value) } else { S::from_f64(value) };
            mass[(i, j)] = entry;
            mass[(j, i)] = entry;
        }
    }

    /// M(q), where it was computed last.
    pub(super) fn current_mass_matrix(&self) -> &Matrix<S> {
        if Panel::<S>::ONE_LANE { self.kernel.mass_matrix() } else { &self.mass }
    }

    /// Fills M for [`current_mass_matrix`](Self::current_mass_matrix).
    pub(super) fn place(&mut self, q: &[S]) -> Result<(), EvalError> {
        match &mut self.world {
            Some(world) if !Panel::<S>::ONE_LANE => {
                Self::mass_by_world(&self.tree, world, q, &mut self.mass);
                Ok(())
            }
            _ => self.kernel.set_position(&self.tree, q),
        }
    }

    /// Fills tau_q and tau_v at (q, v, a), where M has been computed last at the same q.
    #[inline(never)]
    pub(super) fn differentiate_torque(&mut self, q: &[S], v: &[S]) -> Result<(), EvalError> {
        let a = &self.rate[self.tree.dof()..];
        match &mut self.world {
            Some(world) if !Panel::<S>::ONE_LANE => {
                world.set_motion(&self.tree, v, Some(a));
                let (by_position, by_velocity) = (&mut self.tau_q, &mut self.tau_v);
                world.torque_derivatives(TorqueDerivatives { by_position, by_velocity });
                for &i in self.tree.with_friction() {
                    self.tau_v[(i, i)] -= friction(&self.tree.joints()[i].friction, v[i]).first;
                }
                for &i in self.tree.with_spring() {
                    self.tau_q[(i, i)] = self.tau_q[(i, i)].plus(self.tree.joints()[i].spring.stiffness);
                }
                Ok(())
            }
            _ => {
                debug_assert_eq!(q.len(), v.len());
                self.differentiate_flow()?;
                self.take_torque_jacobian(v);
                Ok(())
            }
        }
    }
}
