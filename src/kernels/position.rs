//! First stage of kernel one: transforms, composite inertias, mass matrix, potential.

use super::blocks::Blocks;
use super::coupling::positions;
use super::joint_positions::joint_positions;
use super::pass::{Inward, Outward};
use super::{KernelOne, RootAxis};
use crate::error::{EvalError, check_length};
use crate::robot::{JointKind, Tree};
use crate::scalar::{Pack, Scalar};
use crate::spatial::{Force, Inertia, JointPosition, Motion, Transform, Vec3};
use std::ops::Range;

/// `F = IC S`: momentum of the composite body at unit joint velocity.
#[inline(always)]
pub(crate) fn unit_momentum<S: Scalar>(kind: JointKind, composite: &Inertia<S>) -> Force<S> {
    let (h, j) = (composite.first_moment, &composite.matrix);
    match kind {
        JointKind::Revolute => {
            Force { moment: Vec3::new(j.xz, j.yz, j.zz), force: Vec3::new(-h.y, h.x, S::zero()) }
        }
        JointKind::Prismatic => Force {
            moment: Vec3::new(h.y, -h.x, S::zero()),
            force: Vec3::constant([0.0, 0.0, composite.mass]),
        },
    }
}

/// Puts the force `own` of joint i into its lane.
#[inline(always)]
pub(super) fn put<S: Scalar, P: Pack<S>>(blocks: &Blocks, i: usize, own: Force<S>, forces: &mut [Force<P>]) {
    let (block, lane) = blocks.own(i);
    let Force { moment: n, force: f } = forces[block];
    let put = |to: Vec3<P>, from: Vec3<S>| {
        Vec3::new(to.x.with_lane(lane, from.x), to.y.with_lane(lane, from.y), to.z.with_lane(lane, from.z))
    };
    forces[block] = Force { moment: put(n, own.moment), force: put(f, own.force) };
}

/// Transforms the forces of some blocks to the frame of the parent, into the blocks from `first` on, which
/// come before them.
#[inline(always)]
pub(super) fn carry<P: Scalar>(
    transform: &Transform<'_, P>,
    forces: &mut [Force<P>],
    beyond: Range<usize>,
    first: usize,
) {
    let (to, from) = forces.split_at_mut(beyond.start);
    for (to, &from) in to[first..].iter_mut().zip(&from[..beyond.len()]) {
        *to = transform.force_up(from);
    }
}

/// S in the frame of its joint.
#[inline(always)]
pub(super) fn unit_motion<S: Scalar>(kind: JointKind) -> Motion<S> {
    let (axis, none) = (Vec3::constant([0.0, 0.0, 1.0]), Vec3::zero());
    match kind {
        JointKind::Revolute => Motion { angular: axis, linear: none },
        JointKind::Prismatic => Motion { angular: none, linear: axis },
    }
}

/// `S . f`: the component of a force along the joint axis.
#[inline(always)]
pub(crate) fn along_joint<S: Scalar>(kind: JointKind, force: &Force<S>) -> S {
    match kind {
        JointKind::Revolute => force.moment.z,
        JointKind::Prismatic => force.force.z,
    }
}

/// `S x* f`: the change of a fixed force in the frame of a joint that moves backward.
#[inline(always)]
pub(super) fn across_joint<S: Scalar>(kind: JointKind, force: &Force<S>) -> Force<S> {
    let across = |a: &Vec3<S>| Vec3::new(-a.y, a.x, S::zero());
    match kind {
        JointKind::Revolute => Force { moment: across(&force.moment), force: across(&force.force) },
        JointKind::Prismatic => Force { moment: across(&force.force), force: Vec3::zero() },
    }
}

impl<S: Scalar> KernelOne<S> {
    /// Computes M at q (rad, m; length nq): `M_ij = S_i . F_j` (62), plus armature.
    ///
    /// # Errors
    /// [`EvalError::WrongLength`]. Values are not checked here.
    #[inline(never)]
    pub fn set_position(&mut self, tree: &Tree, q: &[S]) -> Result<(), EvalError> {
        check_length("q", q, tree.nq())?;
        if tree.free().is_empty() {
            positions(tree, q, &mut self.q);
        } else {
            tree.chart_coordinates(q, &mut self.chart);
            positions(tree, &self.chart, &mut self.q);
        }
        self.place(tree, q);
        for (i, joint) in tree.joints().iter().enumerate().rev() {
            if joint.parent.is_none() {
                self.meet_root(tree, i);
                continue;
            }
            for (child, beyond, first) in self.blocks.inherited(tree, i) {
                carry(&self.pack_transform(tree, child), &mut self.carried, beyond, first);
            }
            let own = unit_momentum(joint.kind, &self.bodies[i].composite);
            put(&self.blocks, i, own, &mut self.carried);
            for block in self.blocks.of(i) {
                let entries = along_joint(joint.kind, &self.carried[block]);
                self.blocks.store_both(i, block, entries, &mut self.mass_matrix.all);
            }
        }
        for &(i, j, value) in tree.armature() {
            let on_one_branch = tree.subtree(j).contains(&i);
            let entry =
                if on_one_branch { self.mass_matrix.all[(i, j)].plus(value) } else { S::from_f64(value) };
            self.mass_matrix.all[(i, j)] = entry;
            self.mass_matrix.all[(j, i)] = entry;
        }
        self.mass_matrix.sum_symmetric(tree);
        Ok(())
    }

    /// Row i of M for a joint on the fixed base.
    ///
    /// S_i and gamma_i are transformed one frame outward, instead of all F_j and G_j one inward.
    fn meet_root(&mut self, tree: &Tree, i: usize) {
        let kind = tree.joints()[i].kind;
        let own = unit_momentum(kind, &self.bodies[i].composite);
        put(&self.blocks, i, own, &mut self.carried);
        self.mass_matrix.all[(i, i)] = along_joint(kind, &own);
        for &child in tree.children(i) {
            let transform = self.transform(tree, child);
            let gravity = self.bodies[i].gravity;
            let root = RootAxis {
                motion: transform.motion_down(unit_motion(kind)),
                gravity: match kind {
                    JointKind::Revolute => transform.vector_down(Vec3::new(gravity.y, -gravity.x, S::zero())),
                    JointKind::Prismatic => Vec3::zero(),
                },
            };
            let motion = root.motion.splat();
            for block in self.blocks.of(child) {
                let entries = self.carried[block].dot(motion);
                self.blocks.store_both(i, block, entries, &mut self.mass_matrix.all);
            }
            self.bodies[child].root = root;
        }
    }

    /// From frame i to that of the parent and back.
    #[inline(always)]
    pub(super) fn transform<'a>(&self, tree: &'a Tree, i: usize) -> Transform<'a, S> {
        tree.joints()[i].transform_at(self.bodies[i].position)
    }

    /// The same for all lanes of a block.
    #[inline(always)]
    pub(super) fn pack_transform<'a>(&self, tree: &'a Tree, i: usize) -> Transform<'a, S::Pack> {
        tree.joints()[i].transform_at(self.bodies[i].position.splat())
    }

    /// Transforms, gravity and composite inertias, each in its body frame.
    fn place(&mut self, tree: &Tree, q: &[S]) {
        joint_positions(tree, &self.q, |i, position| self.bodies[i].position = position);
        for free in tree.free() {
            self.bodies[free.joint.turned].position = JointPosition::Oriented(free.orientation(q));
        }
        let bodies = &mut self.bodies[..tree.joints().len()];
        let mut before = Outward::new();
        for (i, joint) in tree.joints().iter().enumerate() {
            let transform = joint.transform_at(bodies[i].position);
            let world = Vec3::constant(tree.gravity());
            let outer = joint.parent.map_or(world, |p| before.of(p, bodies, |body| body.gravity));
            let gravity = transform.vector_down(outer);
            before.leave(i, gravity);
            let body = &mut bodies[i];
            body.gravity = gravity;
            body.composite = joint.lumped.lift();
            body.composite.mass = joint.lumped_mass;
        }
        let mut inward = Inward::new();
        for (i, joint) in tree.joints().iter().enumerate().rev() {
            let total = inward.total(i, bodies, |body| &mut body.composite, Inertia::with_moments);
            bodies[i].composite = total;
            if let Some(parent) = joint.parent {
                inward.hand(parent, joint.transform_at(bodies[i].position).inertia_up(&total));
            }
        }
    }

    /// Potential energy V (J) at the position set last: gravity (zero at the origin of the world) and
    /// springs.
    #[inline(never)]
    pub fn potential(&self, tree: &Tree) -> S {
        let gravity = Vec3::constant(tree.gravity());
        let mut potential = S::from_f64(tree.fixed_potential());
        for (i, joint) in tree.joints().iter().enumerate() {
            if joint.parent.is_none() {
                let moved = self.transform(tree, i).inertia_up(&self.bodies[i].composite);
                potential -= gravity.dot(moved.first_moment);
            }
            if joint.spring.stiffness != 0.0 {
                let stretch = self.q[i].plus(-joint.spring.rest);
                potential += (stretch * stretch).times(0.5 * joint.spring.stiffness);
            }
        }
        potential
    }
}
