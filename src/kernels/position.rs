//! First stage of kernel one: transforms, composite inertias, mass matrix, potential.

use super::KernelOne;
use crate::error::{EvalError, check_length};
use crate::robot::{JointFrame, JointKind, Tree};
use crate::scalar::Scalar;
use crate::spatial::{Force, Inertia, JointPosition, Transform, Vec3};

/// The transform of a joint at position q.
#[inline(always)]
pub(super) fn transform<S: Scalar>(joint: &JointFrame, q: S) -> Transform<S> {
    let position = match joint.kind {
        JointKind::Revolute => {
            let angle = if joint.offset == 0.0 { q } else { q.plus(joint.offset) };
            let (sin, cos) = angle.sin_cos();
            JointPosition::Turned { sin, cos }
        }
        JointKind::Prismatic => JointPosition::Slid { distance: q },
    };
    Transform { fixed: joint.screw, joint: position }
}

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

/// `S . f`: the component of a force that the joint sees.
#[inline(always)]
pub(super) fn along_joint<S: Scalar>(kind: JointKind, force: &Force<S>) -> S {
    match kind {
        JointKind::Revolute => force.moment.z,
        JointKind::Prismatic => force.force.z,
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
            let here = tree.pairs_of(i);
            let (near, far) = self.carried.split_at_mut(here.end);
            let mut slots = near[here.clone()].iter_mut();
            if let Some(own) = slots.next() {
                *own = unit_momentum(joint.kind, &self.composites[i]);
            }
            for &child in tree.children(i) {
                let beyond = tree.pairs_of(child);
                let transform = self.transforms[child];
                let forces = &far[beyond.start - here.end..beyond.end - here.end];
                // The forces come first: a zip takes one of its first before it finds the second at its end.
                for (force, slot) in forces.iter().zip(slots.by_ref()) {
                    *slot = transform.force_up(*force);
                }
            }
            for (force, &j) in self.carried[here].iter().zip(tree.subtree(i)) {
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

    /// Transforms, gravity and composite inertias, each in its body frame.
    fn place(&mut self, tree: &Tree) {
        for (i, joint) in tree.joints().iter().enumerate() {
            self.transforms[i] = transform(joint, self.q[i]);
            let outer = joint.parent.map_or(Vec3::constant(tree.gravity()), |p| self.gravity[p]);
            self.gravity[i] = self.transforms[i].vector_down(outer);
            self.composites[i] = joint.inertia.lift();
            self.composites[i].mass = joint.subtree_mass;
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
        let mut potential = S::zero();
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
