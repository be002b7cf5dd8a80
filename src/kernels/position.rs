//! First stage of kernel one: transforms, composite inertias, mass matrix, potential.

use super::{KernelOne, RootAxis};
use crate::error::{EvalError, check_length};
use crate::robot::{JointKind, Tree};
use crate::scalar::Scalar;
use crate::spatial::{Force, Inertia, Motion, Transform, Vec3};

/// `F = IC S`: momentum of the composite body for unit velocity of its joint.
#[inline(always)]
pub(super) fn unit_momentum<S: Scalar>(kind: JointKind, composite: &Inertia<S>) -> Force<S> {
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

/// Fills the forces of the pairs (i, j), one for each j beyond i, in frame i: that of i itself is `own`, the others come
/// from the frames of the children of i.
#[inline(always)]
pub(super) fn carry<S: Scalar>(
    tree: &Tree,
    transforms: &[Transform<S>],
    i: usize,
    own: Force<S>,
    forces: &mut [Force<S>],
) {
    let here = tree.pairs_of(i);
    let (near, far) = forces.split_at_mut(here.end);
    let mut slots = near[here.clone()].iter_mut();
    if let Some(slot) = slots.next() {
        *slot = own;
    }
    for &child in tree.children(i) {
        let beyond = tree.pairs_of(child);
        let transform = transforms[child];
        let forces = &far[beyond.start - here.end..beyond.end - here.end];
        // The forces come first: a zip takes one of its first before it finds the second at its end.
        for (force, slot) in forces.iter().zip(slots.by_ref()) {
            *slot = transform.force_up(*force);
        }
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

/// `S . f`: the component of a force that the joint sees.
#[inline(always)]
pub(crate) fn along_joint<S: Scalar>(kind: JointKind, force: &Force<S>) -> S {
    match kind {
        JointKind::Revolute => force.moment.z,
        JointKind::Prismatic => force.force.z,
    }
}

/// `S x* f`: how a force that does not move changes in the frame of a joint that moves back.
#[inline(always)]
pub(super) fn across_joint<S: Scalar>(kind: JointKind, force: &Force<S>) -> Force<S> {
    let across = |a: &Vec3<S>| Vec3::new(-a.y, a.x, S::zero());
    match kind {
        JointKind::Revolute => Force { moment: across(&force.moment), force: across(&force.force) },
        JointKind::Prismatic => Force { moment: across(&force.force), force: Vec3::zero() },
    }
}

impl<S: Scalar> KernelOne<S> {
    /// Computes M at q (rad, m; length n): `M_ij = S_i . F_j` (62), plus armature.
    ///
    /// # Errors
    /// [`EvalError::WrongLength`]. Values are not checked here.
    pub fn set_position(&mut self, tree: &Tree, q: &[S]) -> Result<(), EvalError> {
        check_length("q", q, tree.len())?;
        self.q.copy_from_slice(q);
        self.place(tree);
        for (i, joint) in tree.joints().iter().enumerate().rev() {
            if joint.parent.is_none() {
                self.meet_root(tree, i);
                continue;
            }
            let own = unit_momentum(joint.kind, &self.composites[i]);
            carry(tree, &self.transforms, i, own, &mut self.carried);
            for (force, &j) in self.carried[tree.pairs_of(i)].iter().zip(tree.subtree(i)) {
                let entry = along_joint(joint.kind, force);
                self.mass_matrix[(i, j)] = entry;
                self.mass_matrix[(j, i)] = entry;
            }
        }
        for &(i, j, value) in tree.armature() {
            let on_one_branch = tree.subtree(j).contains(&i);
            let entry = if on_one_branch { self.mass_matrix[(i, j)].plus(value) } else { S::from_f64(value) };
            self.mass_matrix[(i, j)] = entry;
            self.mass_matrix[(j, i)] = entry;
        }
        Ok(())
    }

    /// Row i of M for a joint on the world.
    ///
    /// Such a joint moves like its axis alone: S_i and gamma_i go one frame up, instead of all F_j and G_j one down.
    fn meet_root(&mut self, tree: &Tree, i: usize) {
        let kind = tree.joints()[i].kind;
        let own = unit_momentum(kind, &self.composites[i]);
        self.carried[tree.pairs_of(i).start] = own;
        self.mass_matrix[(i, i)] = along_joint(kind, &own);
        for &child in tree.children(i) {
            let transform = &self.transforms[child];
            let gravity = self.gravity[i];
            let root = RootAxis {
                motion: transform.motion_down(unit_motion(kind)),
                gravity: match kind {
                    JointKind::Revolute => transform.vector_down(Vec3::new(gravity.y, -gravity.x, S::zero())),
                    JointKind::Prismatic => Vec3::zero(),
                },
            };
            for (force, &j) in self.carried[tree.pairs_of(child)].iter().zip(tree.subtree(child)) {
                let entry = force.dot(root.motion);
                self.mass_matrix[(i, j)] = entry;
                self.mass_matrix[(j, i)] = entry;
            }
            self.roots[child] = root;
        }
    }

    /// Transforms, gravity and composite inertias, each in its body frame.
    fn place(&mut self, tree: &Tree) {
        for (i, joint) in tree.joints().iter().enumerate() {
            self.transforms[i] = joint.transform(self.q[i]);
            let outer = joint.parent.map_or(Vec3::constant(tree.gravity()), |p| self.gravity[p]);
            self.gravity[i] = self.transforms[i].vector_down(outer);
            self.composites[i] = joint.lumped.lift();
            self.composites[i].mass = joint.lumped_mass;
        }
        for (i, joint) in tree.joints().iter().enumerate().rev() {
            if let Some(parent) = joint.parent {
                let moved = self.transforms[i].inertia_up(&self.composites[i]);
                self.composites[parent].add_moments(&moved);
            }
        }
    }

    /// Potential energy V (J) at the position set last: weight (zero at the origin of the world) and springs.
    pub fn potential(&self, tree: &Tree) -> S {
        let gravity = Vec3::constant(tree.gravity());
        let mut potential = S::from_f64(tree.fixed_potential());
        for (i, joint) in tree.joints().iter().enumerate() {
            if joint.parent.is_none() {
                potential -= gravity.dot(self.transforms[i].inertia_up(&self.composites[i]).first_moment);
            }
            if joint.spring.stiffness != 0.0 {
                let stretch = self.q[i].plus(-joint.spring.rest);
                potential += (stretch * stretch).times(0.5 * joint.spring.stiffness);
            }
        }
        potential
    }
}
