//! Constants of one joint and its link, in the frames of a [`Tree`](super::Tree).

use super::joint::{Friction, JointKind, Spring};
use crate::scalar::Scalar;
use crate::spatial::{ConstantInertia, FixedScrew, JointPosition, Transform, Turn};
use nalgebra::Vector3;

/// Constants of one joint and its link, in the frames of a [`Tree`](super::Tree).
#[derive(Clone, Debug, PartialEq)]
pub struct JointFrame {
    /// Revolute or prismatic.
    pub kind: JointKind,
    /// Index of the parent joint; `None` for the world.
    pub parent: Option<usize>,
    /// Placement in the parent's frame.
    pub screw: FixedScrew,
    /// Added to q (rad, m). The sum is rounded, so the joint is off by up to half a unit in the last place:
    /// by 6e-14 rad at 1000 rad and 6e-11 rad at 1e6 rad, as much as by the rounding of q itself.
    pub offset: f64,
    /// Inertia of the link about the origin of the frame.
    pub inertia: ConstantInertia,
    /// Mass of the link and everything it carries (kg).
    pub subtree_mass: f64,
    /// The inertia that the kernels use: regrouped, so that L(q, v) is the same and more entries are zero.
    pub lumped: ConstantInertia,
    /// The mass that the kernels use for the link and everything it carries (kg).
    pub lumped_mass: f64,
    /// Upper bound of the root of the integral of the squared distance from the origin over the mass of the
    /// link and all that it carries, prismatic joints at q + offset = 0 (kg^1/2 m).
    pub reach: f64,
    /// Whether a joint beyond this one is prismatic.
    pub carries_slides: bool,
    /// Joint spring.
    pub spring: Spring,
    /// Joint friction.
    pub friction: Friction,
}

impl JointFrame {
    /// To the frame of the parent and back, at position q (rad, m).
    #[inline(always)]
    pub fn transform<S: Scalar>(&self, q: S) -> Transform<'_, S> {
        self.transform_at(self.position(q))
    }

    /// To the frame of the parent and back, at a position of the joint.
    #[inline(always)]
    pub fn transform_at<S: Scalar>(&self, joint: JointPosition<S>) -> Transform<'_, S> {
        Transform { fixed: &self.screw, joint }
    }

    /// What the transform needs of q (rad, m).
    #[inline(always)]
    pub fn position<S: Scalar>(&self, q: S) -> JointPosition<S> {
        let q = self.shifted(q);
        match self.kind {
            JointKind::Revolute => JointPosition::Rotated(Turn::by(q)),
            JointKind::Prismatic => JointPosition::Translated(q),
        }
    }

    /// `q + offset`.
    #[inline(always)]
    pub(crate) fn shifted<S: Scalar>(&self, q: S) -> S {
        if self.offset == 0.0 { q } else { q.plus(self.offset) }
    }
}

/// Minkowski's inequality, from joint to joint: `reach_i^2 = link_i + sum_c (reach_c + sqrt(mass_c)
/// distance_c)^2`.
pub(super) fn set_reach(joints: &mut [JointFrame]) {
    for i in (0..joints.len()).rev() {
        let joint = &mut joints[i];
        let [xx, yy, zz, ..] = joint.inertia.matrix;
        joint.reach = (joint.reach + 0.5 * (xx + yy + zz).max(0.0)).sqrt();
        let distance = Vector3::from(joint.screw.translation).norm() + joint.screw.rise.abs();
        let reach = joint.reach + joint.subtree_mass.sqrt() * distance;
        let slides = joint.carries_slides || joint.kind == JointKind::Prismatic;
        if let Some(parent) = joint.parent {
            joints[parent].reach += reach * reach;
            joints[parent].carries_slides |= slides;
        }
    }
}
