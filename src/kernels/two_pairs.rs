//! Kernel two, the scalar products of every pair of joints on a branch.

use super::position::along_joint;
use super::two::moved;
use super::velocity::AxisRate;
use super::{KernelOne, KernelTwo, RootAxis};
use crate::robot::{JointKind, Tree};
use crate::scalar::Scalar;
use crate::spatial::{Force, Motion, Vec3};

/// The linear part of `gamma = a_g x S` of a revolute joint, in its frame: its x and y components.
#[inline(always)]
fn turned_gravity<S: Scalar>(gravity: Vec3<S>) -> [S; 2] {
    [gravity.y, -gravity.x]
}

/// `gamma . f` of a revolute joint.
#[inline(always)]
fn weight<S: Scalar>([x, y]: [S; 2], force: &Force<S>) -> S {
    x * force.force.x + y * force.force.y
}

/// `m x (S dq)`: how a motion that does not move changes in the frame of a joint that moves by S dq.
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
            [self.forces[i], self.rates[i]] = self.own(tree, kernel, i);
            if joint.parent.is_none() {
                self.meet_root(tree, kernel, i);
                continue;
            }
            for &child in tree.children(i) {
                self.carry(tree, kernel, child);
            }
            let kind = joint.kind;
            let (psi, dpsi) =
                (AxisRate::new(kind, &kernel.velocities[i]), AxisRate::new(kind, &self.velocities[i]));
            let (gamma, dgamma) = (turned_gravity(kernel.gravity[i]), turned_gravity(self.gravity[i]));
            let here = tree.pairs_of(i);
            let before = kernel.carried[here.clone()].iter().zip(&kernel.rates[here]);
            for ((carried, rate), &j) in before.zip(tree.subtree(i)) {
                let (dcarried, drate) = (&self.forces[j], &self.rates[j]);
                let mut entry = dpsi.power(rate) + psi.power(drate);
                if kind == JointKind::Revolute {
                    entry += weight(dgamma, carried) + weight(gamma, dcarried);
                }
                self.l_qq[(i, j)] = entry;
                self.l_qq[(j, i)] = entry;
                if i != j {
                    self.l_vq[(j, i)] = dpsi.power(carried) + psi.power(dcarried);
                }
                self.l_vq[(i, j)] = along_joint(kind, drate);
                let entry = along_joint(kind, dcarried);
                self.mass_matrix[(i, j)] = entry;
                self.mass_matrix[(j, i)] = entry;
            }
        }
    }

    /// Brings all dF_j and dG_j beyond `child` from its frame to that of its parent.
    #[inline(always)]
    fn carry(&mut self, tree: &Tree, kernel: &KernelOne<S>, child: usize) {
        let (kind, dq, transform) = (tree.joints()[child].kind, self.dq[child], kernel.transforms[child]);
        let pairs = tree.pairs_of(child);
        let before = kernel.carried[pairs.clone()].iter().zip(&kernel.rates[pairs]);
        for ((carried, rate), &j) in before.zip(tree.subtree(child)) {
            self.forces[j] = transform.force_up(moved(kind, self.forces[j], carried, dq));
            self.rates[j] = transform.force_up(moved(kind, self.rates[j], rate, dq));
        }
    }

    /// Rows and columns of a joint on the world, whose psi and dpsi are zero.
    fn meet_root(&mut self, tree: &Tree, kernel: &KernelOne<S>, i: usize) {
        let kind = tree.joints()[i].kind;
        let (gamma, dgamma) = (turned_gravity(kernel.gravity[i]), turned_gravity(self.gravity[i]));
        let own = &kernel.carried[tree.pairs_of(i).start];
        self.mass_matrix[(i, i)] = along_joint(kind, &self.forces[i]);
        self.l_vq[(i, i)] = S::zero();
        self.l_qq[(i, i)] = match kind {
            JointKind::Revolute => weight(dgamma, own) + weight(gamma, &self.forces[i]),
            JointKind::Prismatic => S::zero(),
        };
        for &child in tree.children(i) {
            let root = kernel.roots[child];
            let change = self.change_of_root(tree, kernel, i, child, dgamma);
            let beyond = tree.pairs_of(child);
            let before = kernel.carried[beyond.clone()].iter().zip(&kernel.rates[beyond]);
            for ((carried, rate), &j) in before.zip(tree.subtree(child)) {
                let (dcarried, drate) = (&self.forces[j], &self.rates[j]);
                let entry = carried.dot(change.motion) + dcarried.dot(root.motion);
                self.mass_matrix[(i, j)] = entry;
                self.mass_matrix[(j, i)] = entry;
                self.l_vq[(i, j)] = rate.dot(change.motion) + drate.dot(root.motion);
                self.l_vq[(j, i)] = S::zero();
                let entry = change.gravity.dot(carried.force) + root.gravity.dot(dcarried.force);
                self.l_qq[(i, j)] = entry;
                self.l_qq[(j, i)] = entry;
            }
        }
    }

    /// How S and gamma of joint i, on the world, change as seen from the frame of `child`.
    fn change_of_root(
        &self,
        tree: &Tree,
        kernel: &KernelOne<S>,
        i: usize,
        child: usize,
        [x, y]: [S; 2],
    ) -> RootAxis<S> {
        let root = &kernel.roots[child];
        let kind = tree.joints()[child].kind;
        let gamma = Motion { angular: Vec3::zero(), linear: root.gravity };
        let mut gravity = left_behind(kind, &gamma, self.dq[child]).linear;
        if tree.joints()[i].kind == JointKind::Revolute {
            gravity = gravity + kernel.transforms[child].vector_down(Vec3::new(x, y, S::zero()));
        }
        RootAxis { motion: left_behind(kind, &root.motion, self.dq[child]), gravity }
    }
}
