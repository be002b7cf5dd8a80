//! Third stage of kernel one: the mixed and the position block of the Hessian of the Lagrangian.

use super::KernelOne;
use super::position::along_joint;
use super::velocity::AxisRate;
use crate::robot::{JointKind, Tree};
use crate::scalar::Scalar;
use crate::spatial::{Force, Vec3};

impl<S: Scalar> KernelOne<S> {
    /// Computes P = L_vq and L_qq at the position and velocity set last.
    ///
    /// `P_ij = S_i . G_j`, `P_ji = psi_i . F_j`, `L_qq,ij = psi_i . G_j + gamma_i . F_j` for i <= j in tree order.
    pub fn second_order(&mut self, tree: &Tree) {
        for (i, joint) in tree.joints().iter().enumerate().rev() {
            if joint.parent.is_none() {
                self.meet_root_again(tree, i);
                continue;
            }
            self.rates[i] = self.momentum_rate(joint.kind, i);
            for &child in tree.children(i) {
                let transform = self.transforms[child];
                for &j in tree.subtree(child) {
                    self.rates[j] = transform.force_up(self.rates[j]);
                }
            }
            let (kind, gravity) = (joint.kind, self.gravity[i]);
            let psi = AxisRate::new(kind, &self.velocities[i]);
            for (carried, &j) in self.carried[tree.pairs_of(i)].iter().zip(tree.subtree(i)) {
                let rate = &self.rates[j];
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
            for (carried, &j) in self.carried[tree.pairs_of(child)].iter().zip(tree.subtree(child)) {
                let entry = root.gravity.dot(carried.force);
                self.l_qq[(i, j)] = entry;
                self.l_qq[(j, i)] = entry;
                self.l_vq[(i, j)] = self.rates[j].dot(root.motion);
                self.l_vq[(j, i)] = S::zero();
            }
        }
    }

    /// `G_j = IC_j psi_j + S_j x* H_j`.
    #[inline(always)]
    fn momentum_rate(&self, kind: JointKind, j: usize) -> Force<S> {
        let (composite, momentum) = (&self.composites[j], &self.momenta[j]);
        let (h, i, mass) = (composite.first_moment, &composite.matrix, composite.mass);
        match AxisRate::new(kind, &self.velocities[j]) {
            AxisRate::Revolute { angular: [a, b], linear: [c, d] } => Force {
                moment: Vec3::new(
                    i.xx * a + i.xy * b - h.z * d - momentum.moment.y,
                    i.xy * a + i.yy * b + h.z * c + momentum.moment.x,
                    i.xz * a + i.yz * b + h.x * d - h.y * c,
                ),
                force: Vec3::new(
                    c.times(mass) + h.z * b - momentum.force.y,
                    d.times(mass) - h.z * a + momentum.force.x,
                    h.y * a - h.x * b,
                ),
            },
            AxisRate::Prismatic { linear: [c, d] } => Force {
                moment: Vec3::new(
                    -(h.z * d) - momentum.force.y,
                    h.z * c + momentum.force.x,
                    h.x * d - h.y * c,
                ),
                force: Vec3::new(c.times(mass), d.times(mass), S::zero()),
            },
        }
    }
}
