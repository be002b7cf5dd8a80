//! Third stage of kernel one: the mixed and the position block of the Hessian of the Lagrangian.

use super::KernelOne;
use super::blocks::Source;
use super::position::{across_joint, along_joint, put};
use super::velocity::AxisRate;
use crate::robot::{JointKind, Tree};
use crate::scalar::{Pack, Scalar};
use crate::spatial::{Force, Vec3};

impl<S: Scalar> KernelOne<S> {
    /// Computes P = L_vq and L_qq at the position and velocity set last.
    ///
    /// With `G_j = IC_j psi_j + S_j x* H_j`: `P_ij = S_i . G_j`, `P_ji = psi_i . F_j`,
    /// `L_qq,ij = psi_i . G_j + gamma_i . F_j` for i <= j in tree order.
    #[inline(never)]
    pub fn second_order(&mut self, tree: &Tree) {
        for (i, joint) in tree.joints().iter().enumerate().rev() {
            if joint.parent.is_none() {
                self.meet_root_again(tree, i);
                continue;
            }
            let (kind, body) = (joint.kind, &self.bodies[i]);
            let psi = AxisRate::new(kind, &body.velocity);
            for block in self.blocks.of(i) {
                if let Source::Child(child, from) = self.blocks.source(block) {
                    self.rates[block] = self.pack_transform(tree, child).force_up(self.rates[from]);
                }
            }
            let own = psi.momentum(&body.composite) + across_joint(kind, &body.momentum);
            put(&self.blocks, i, own, &mut self.rates);
            let (psi, gravity) = (psi.splat(), body.gravity.splat());
            for block in self.blocks.of(i) {
                let (carried, rate) = (&self.carried[block], &self.rates[block]);
                let mut entries = psi.power(rate);
                if kind == JointKind::Revolute {
                    entries += gravity_power(gravity, carried);
                }
                self.blocks.store_both(i, block, entries, &mut self.l_qq.all);
                let pair = [along_joint(kind, rate), psi.power(carried)];
                self.blocks.store(i, block, pair, &mut self.l_vq.all);
            }
        }
        for &i in tree.with_spring() {
            self.l_qq.all[(i, i)] = self.l_qq.all[(i, i)].plus(-tree.joints()[i].spring.stiffness);
        }
        self.l_vq.sum(tree);
        self.l_qq.sum_symmetric(tree);
    }

    /// Row and column i of P and L_qq for a joint on the fixed base, where `psi_i = 0`.
    fn meet_root_again(&mut self, tree: &Tree, i: usize) {
        self.l_vq.all[(i, i)] = S::zero();
        self.l_qq.all[(i, i)] = match tree.joints()[i].kind {
            JointKind::Revolute => {
                let (block, lane) = self.blocks.own(i);
                gravity_power(self.bodies[i].gravity.splat(), &self.carried[block]).lane(lane)
            }
            JointKind::Prismatic => S::zero(),
        };
        for &child in tree.children(i) {
            let root = self.bodies[child].root;
            let (motion, gravity) = (root.motion.splat(), root.gravity.splat());
            for block in self.blocks.of(child) {
                let (carried, rate) = (&self.carried[block], &self.rates[block]);
                self.blocks.store_both(i, block, gravity.dot(carried.force), &mut self.l_qq.all);
                self.blocks.store(i, block, [rate.dot(motion), S::Pack::zero()], &mut self.l_vq.all);
            }
        }
    }
}

/// `gamma . f` of a revolute joint, with gravity in its frame.
#[inline(always)]
fn gravity_power<S: Scalar>(gravity: Vec3<S>, f: &Force<S>) -> S {
    f.force.x.mul_add(gravity.y, -(f.force.y * gravity.x))
}
