//! Floating and spherical joints in the frames of a tree.

use super::free::FreeJoint;
use crate::scalar::Scalar;
use crate::spatial::Quaternion;
use nalgebra::{Matrix3, Rotation3, UnitQuaternion};
use std::ops::Range;

/// How the quaternion of a floating or spherical joint turns the frame of the first of its revolute joints.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FreeFrame {
    pub joint: FreeJoint,
    /// Quaternions before and after that of q.
    around: [[f64; 4]; 2],
}

impl FreeFrame {
    /// In axes that have not been chosen yet.
    pub fn new(joint: &FreeJoint) -> Self {
        Self { joint: joint.clone(), around: [[0.0, 0.0, 0.0, 1.0]; 2] }
    }

    /// With the axes of the turned joint: `x_aligned = aligned x_original`, and the offset of its angle.
    ///
    /// With B = aligned', a rotation R before the joint becomes `Rz(offset) B' R B` after the constant part
    /// of its transform.
    pub fn aligned(self, aligned: &Matrix3<f64>, offset: f64) -> Self {
        let axes = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(*aligned));
        let turn = UnitQuaternion::from_axis_angle(&nalgebra::Vector3::z_axis(), offset);
        Self { around: [(turn * axes).coords.into(), axes.inverse().coords.into()], ..self }
    }

    /// The entries of its quaternion in q.
    pub fn quaternion_entries(&self) -> Range<usize> {
        let first = self.joint.quaternion();
        first..first + 4
    }

    /// Its quaternion in a configuration.
    pub fn quaternion<S: Scalar>(&self, q: &[S]) -> Quaternion<S> {
        self.joint.quaternion_in(q)
    }

    /// How the frame of the turned joint is oriented.
    pub fn orientation<S: Scalar>(&self, q: &[S]) -> Quaternion<S> {
        let [before, after] = self.around.map(Quaternion::constant);
        before.then_after(self.quaternion(q)).then_after(after)
    }
}
