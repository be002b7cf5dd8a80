//! Kernel two: the scalar products of all pairs of joints on a branch.

use super::blocks::Source;
use super::position::{along_joint, put};
use super::two::moved;
use super::velocity::AxisRate;
use super::{KernelOne, KernelTwo, RootAxis};
use crate::robot::{JointKind, Tree};
use crate::scalar::{Pack, Scalar};
use crate::spatial::{Force, Motion, Vec3};

/// The linear part of `gamma = a_g x S` of a revolute joint, in its frame: its x and y components.
#[inline(always)]
fn gravity_of_axis<S: Scalar>(gravity: Vec3<S>) -> [S; 2] {
    [gravity.y, -gravity.x]
}

/// `gamma . f` of a revolute joint.
#[inline(always)]
fn weight<S: Scalar>([x, y]: [S; 2], force: &Force<S>) -> S {
    x.mul_add(force.force.x, y * force.force.y)
}

/// `m x (S dq)`: the change of a fixed motion in the frame of a joint that moves by S dq.
#[inline(always)]
fn left_behind<S: Scalar>(kind: JointKind, m: &Motion<S>, dq: S) -> Motion<S> {
    let across = |a: &Vec3<S>| Vec3::new(a.y * dq, -(a.x * dq), S::zero());
    match kind {
        JointKind::Revolute => Motion { angular: across(&m.angular), linear: across(&m.linear) },
        JointKind::Prismatic => Motion { angular: Vec3::zero(), linear: across(&m.angular) },
    }
}

impl<S: Scalar> KernelTwo<S> {
    /// Entries of D M, D P and D L_qq, from the tips inward.
    pub(super) fn pairs(&mut self, tree: &Tree, kernel: &KernelOne<S>) {
        for (i, joint) in tree.joints().iter().enumerate().rev() {
            let inherits = joint.parent.is_some();
            for block in kernel.blocks.of(i).filter(|_| inherits) {
                if let Source::Child(child, from) = kernel.blocks.source(block) {
                    self.carry(tree, kernel, child, (from, block));
                }
            }
            let [force, rate] = self.own(tree, kernel, i);
            put(&kernel.blocks, i, force, &mut self.forces);
            put(&kernel.blocks, i, rate, &mut self.rates);
            if !inherits {
                self.meet_root(tree, kernel, i);
                continue;
            }
            let kind = joint.kind;
            let (body, change) = (&kernel.bodies[i], &self.bodies[i]);
            let psi = AxisRate::new(kind, &body.velocity).splat();
            let dpsi = AxisRate::new(kind, &change.velocity).splat();
            let gamma = gravity_of_axis(body.gravity).map(S::Pack::splat);
            let dgamma = gravity_of_axis(change.gravity).map(S::Pack::splat);
            for block in kernel.blocks.of(i) {
                let (carried, rate) = (&kernel.carried[block], &kernel.rates[block]);
                let (dcarried, drate) = (&self.forces[block], &self.rates[block]);
                let mut entries = dpsi.power(rate) + psi.power(drate);
                if kind == JointKind::Revolute {
                    entries += weight(dgamma, carried) + weight(gamma, dcarried);
                }
                kernel.blocks.store_both(i, block, entries, &mut self.l_qq.all);
                let pair = [along_joint(kind, drate), dpsi.power(carried) + psi.power(dcarried)];
                kernel.blocks.store(i, block, pair, &mut self.l_vq.all);
                kernel.blocks.store_both(i, block, along_joint(kind, dcarried), &mut self.mass_matrix.all);
            }
        }
    }

    /// Transforms a block of dF_j and dG_j from the frame of `child` to that of its parent.
    #[inline(always)]
    fn carry(&mut self, tree: &Tree, kernel: &KernelOne<S>, child: usize, (from, to): (usize, usize)) {
        let (kind, dq) = (tree.joints()[child].kind, S::Pack::splat(self.bodies[child].dq));
        let transform = kernel.pack_transform(tree, child);
        let (force, rate) = (self.forces[from], self.rates[from]);
        self.forces[to] = transform.force_up(moved(kind, force, &kernel.carried[from], dq));
        self.rates[to] = transform.force_up(moved(kind, rate, &kernel.rates[from], dq));
    }

    /// Rows and columns of a joint on the fixed base, whose psi and dpsi are zero.
    fn meet_root(&mut self, tree: &Tree, kernel: &KernelOne<S>, i: usize) {
        let kind = tree.joints()[i].kind;
        let (gamma, dgamma) =
            (gravity_of_axis(kernel.bodies[i].gravity), gravity_of_axis(self.bodies[i].gravity));
        let (block, lane) = kernel.blocks.own(i);
        let (own, change) = (&kernel.carried[block], &self.forces[block]);
        self.mass_matrix.all[(i, i)] = along_joint(kind, change).lane(lane);
        self.l_vq.all[(i, i)] = S::zero();
        self.l_qq.all[(i, i)] = match kind {
            JointKind::Revolute => {
                let splat = |gamma: [S; 2]| gamma.map(S::Pack::splat);
                (weight(splat(dgamma), own) + weight(splat(gamma), change)).lane(lane)
            }
            JointKind::Prismatic => S::zero(),
        };
        for &child in tree.children(i) {
            let root = kernel.bodies[child].root.splat();
            let change = self.change_of_root(tree, kernel, i, child, dgamma).splat();
            for block in kernel.blocks.of(child) {
                let (carried, rate) = (&kernel.carried[block], &kernel.rates[block]);
                let (dcarried, drate) = (&self.forces[block], &self.rates[block]);
                let entries = carried.dot(change.motion) + dcarried.dot(root.motion);
                kernel.blocks.store_both(i, block, entries, &mut self.mass_matrix.all);
                let entries = rate.dot(change.motion) + drate.dot(root.motion);
                kernel.blocks.store(i, block, [entries, S::Pack::zero()], &mut self.l_vq.all);
                let entries = change.gravity.dot(carried.force) + root.gravity.dot(dcarried.force);
                kernel.blocks.store_both(i, block, entries, &mut self.l_qq.all);
            }
        }
    }

    /// Changes of S and gamma of joint i, on the fixed base, in the frame of `child`.
    fn change_of_root(
        &self,
        tree: &Tree,
        kernel: &KernelOne<S>,
        i: usize,
        child: usize,
        [x, y]: [S; 2],
    ) -> RootAxis<S> {
        let root = &kernel.bodies[child].root;
        let kind = tree.joints()[child].kind;
        let gamma = Motion { angular: Vec3::zero(), linear: root.gravity };
        let mut gravity = left_behind(kind, &gamma, self.bodies[child].dq).linear;
        if tree.joints()[i].kind == JointKind::Revolute {
            gravity = gravity + kernel.transform(tree, child).vector_down(Vec3::new(x, y, S::zero()));
        }
        RootAxis { motion: left_behind(kind, &root.motion, self.bodies[child].dq), gravity }
    }
}
