//! Third stage of kernel one: the mixed and the position block of the Hessian of the Lagrangian.

use super::KernelOne;
use super::position::along_joint;
use super::velocity::axis_rate;
use crate::robot::{JointKind, Tree};
use crate::scalar::Scalar;
use crate::spatial::{Force, Vec3};

impl<S: Scalar> KernelOne<S> {
    /// Computes P = L_vq and L_qq at the position and velocity set last.
    ///
    /// `P_ij = S_i . G_j`, `P_ji = psi_i . F_j`, `L_qq,ij = psi_i . G_j + gamma_i . F_j` for i <= j in tree order.
    pub fn second_order(&mut self, tree: &Tree) {
        for j in 0..tree.len() {
            let path = tree.path(j);
            let carried = &self.carried[tree.path_start(j)..][..path.len()];
            let mut rate = self.momentum_rate(tree, j);
            for (k, &i) in path.iter().enumerate() {
                let kind = tree.joints()[i].kind;
                let psi = axis_rate(kind, &self.velocities[i]);
                self.coupling[(i, j)] = along_joint(kind, &rate);
                if i != j {
                    self.coupling[(j, i)] = carried[k].dot(psi);
                }
                let mut entry = rate.dot(psi);
                if kind == JointKind::Revolute {
                    entry += carried[k].force.dot(self.gravity[i].cross_ez());
                }
                self.stiffness[(i, j)] = entry;
                self.stiffness[(j, i)] = entry;
                if k + 1 < path.len() {
                    rate = self.transforms[i].force_up(rate);
                }
            }
        }
        for (i, joint) in tree.joints().iter().enumerate() {
            if joint.spring.stiffness != 0.0 {
                self.stiffness[(i, i)] = self.stiffness[(i, i)].plus(-joint.spring.stiffness);
            }
        }
    }

    /// `G_j = IC_j psi_j + S_j x* H_j`.
    #[inline(always)]
    fn momentum_rate(&self, tree: &Tree, j: usize) -> Force<S> {
        let kind = tree.joints()[j].kind;
        let carried_along = self.composites[j].apply(axis_rate(kind, &self.velocities[j]));
        let momentum = &self.momenta[j];
        let turned = match kind {
            JointKind::Revolute => {
                Force { moment: momentum.moment.ez_cross(), force: momentum.force.ez_cross() }
            }
            JointKind::Prismatic => Force { moment: momentum.force.ez_cross(), force: Vec3::zero() },
        };
        carried_along + turned
    }
}
