//! Second stage of kernel one: velocities, momenta, and the gradient of the Lagrangian.

use super::KernelOne;
use super::position::along_joint;
use crate::robot::{JointKind, Tree};
use crate::scalar::Scalar;
use crate::spatial::{Motion, Vec3};

/// `psi = v x S = dS/dt`: its parts have no z component.
#[inline(always)]
pub(super) fn axis_rate<S: Scalar>(kind: JointKind, velocity: &Motion<S>) -> Motion<S> {
    match kind {
        JointKind::Revolute => {
            Motion { angular: velocity.angular.cross_ez(), linear: velocity.linear.cross_ez() }
        }
        JointKind::Prismatic => Motion { angular: Vec3::zero(), linear: velocity.angular.cross_ez() },
    }
}

impl<S: Scalar> KernelOne<S> {
    /// Computes p = M v and L_q at the position set last and v (rad/s, m/s; length n).
    pub fn set_velocity(&mut self, tree: &Tree, v: &[S]) {
        for (i, joint) in tree.joints().iter().enumerate() {
            let mut velocity = match joint.parent {
                Some(parent) => self.transforms[i].motion_down(self.velocities[parent]),
                None => Motion::zero(),
            };
            match joint.kind {
                JointKind::Revolute => velocity.angular.z += v[i],
                JointKind::Prismatic => velocity.linear.z += v[i],
            }
            self.velocities[i] = velocity;
            self.momenta[i] = joint.inertia.apply(velocity);
        }
        for (i, joint) in tree.joints().iter().enumerate().rev() {
            if let Some(parent) = joint.parent {
                self.momenta[parent] = self.momenta[parent] + self.transforms[i].force_up(self.momenta[i]);
            }
        }
        self.first_derivatives(tree, v);
    }

    /// `p_i = S_i . H_i` (+ armature), `L_q,i = H_i . psi_i + F_i . a_g` (- spring force).
    fn first_derivatives(&mut self, tree: &Tree, v: &[S]) {
        for (i, joint) in tree.joints().iter().enumerate() {
            let momentum = self.momenta[i];
            self.momentum[i] = along_joint(joint.kind, &momentum);
            let weight = self.carried[tree.path_start(i)].force.dot(self.gravity[i]);
            let centrifugal = momentum.dot(axis_rate(joint.kind, &self.velocities[i]));
            let stretch = self.q[i].plus(-joint.spring.rest);
            self.gradient[i] = centrifugal + weight - stretch.times(joint.spring.stiffness);
        }
        for &(i, j, value) in tree.armature() {
            self.momentum[i] += v[j].times(value);
            if i != j {
                self.momentum[j] += v[i].times(value);
            }
        }
    }
}
