//! Third stage of kernel one: the mixed and the position block of the Hessian of the Lagrangian.

use super::KernelOne;
use super::position::{across_joint, along_joint, carry};
use super::velocity::AxisRate;
use crate::robot::{JointKind, Tree};
use crate::scalar::Scalar;

impl<S: Scalar> KernelOne<S> {
    /// Computes P = L_vq and L_qq at the position and velocity set last.
    ///
    /// With `G_j = IC_j psi_j + S_j x* H_j`: `P_ij = S_i . G_j`, `P_ji = psi_i . F_j`,
    /// `L_qq,ij = psi_i . G_j + gamma_i . F_j` for i <= j in tree order.
    pub fn second_order(&mut self, tree: &Tree) {
        for (i, joint) in tree.joints().iter().enumerate().rev() {
            if joint.parent.is_none() {
                self.meet_root_again(tree, i);
                continue;
            }
            let (kind, gravity) = (joint.kind, self.gravity[i]);
            let psi = AxisRate::new(kind, &self.velocities[i]);
            let own = psi.momentum(&self.composites[i]) + across_joint(kind, &self.momenta[i]);
            carry(tree, &self.transforms, i, own, &mut self.rates);
            let here = tree.pairs_of(i);
            let forces = self.carried[here.clone()].iter().zip(&self.rates[here]);
            for ((carried, rate), &j) in forces.zip(tree.subtree(i)) {
                let mut entry = psi.power(rate);
                if kind == JointKind::Revolute {
                    entry += carried.force.x * gravity.y - carried.force.y * gravity.x;
                }
                self.l_qq[(i, j)] = entry;
                self.l_qq[(j, i)] = entry;
                if i != j {
                    self.l_vq[(j, i)] = psi.power(carried);
                }
                self.l_vq[(i, j)] = along_joint(kind, rate);
            }
        }
        for (i, joint) in tree.joints().iter().enumerate() {
            if joint.spring.stiffness != 0.0 {
                self.l_qq[(i, i)] = self.l_qq[(i, i)].plus(-joint.spring.stiffness);
            }
        }
    }

    /// Row and column i of P and L_qq for a joint on the world, where `psi_i = 0`.
    fn meet_root_again(&mut self, tree: &Tree, i: usize) {
        self.l_vq[(i, i)] = S::zero();
        self.l_qq[(i, i)] = match tree.joints()[i].kind {
            JointKind::Revolute => {
                let (force, gravity) = (self.carried[tree.pairs_of(i).start].force, self.gravity[i]);
                force.x * gravity.y - force.y * gravity.x
            }
            JointKind::Prismatic => S::zero(),
        };
        for &child in tree.children(i) {
            let root = self.roots[child];
            let beyond = tree.pairs_of(child);
            let forces = self.carried[beyond.clone()].iter().zip(&self.rates[beyond]);
            for ((carried, rate), &j) in forces.zip(tree.subtree(child)) {
                let entry = root.gravity.dot(carried.force);
                self.l_qq[(i, j)] = entry;
                self.l_qq[(j, i)] = entry;
                self.l_vq[(i, j)] = rate.dot(root.motion);
                self.l_vq[(j, i)] = S::zero();
            }
        }
    }
}
