//! Floating and spherical joints in the frames of a tree.

use super::Tree;
use crate::error::{EvalError, PowerOfTen};
use crate::robot::free::{FreeJoint, FreeKind};
use crate::scalar::Scalar;
use crate::spatial::Quaternion;
use nalgebra::{Matrix3, Rotation3, UnitQuaternion};

/// How far the squared length of a quaternion may be from 1: errors of results are of this size.
pub(crate) const UNIT: PowerOfTen = PowerOfTen(-9);

/// A floating or spherical joint: which entries belong to it, and how its quaternion turns the frame of the
/// first of its revolute joints.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FreeFrame {
    pub name: String,
    pub kind: FreeKind,
    /// Its first entry of q.
    pub position: usize,
    /// Its first entry of v.
    pub coordinate: usize,
    /// Index of the joint that it turns.
    pub turned: usize,
    /// Quaternions before and after that of q.
    around: [[f64; 4]; 2],
}

impl FreeFrame {
    /// In axes that have not been chosen yet.
    pub fn new(free: &FreeJoint) -> Self {
        let FreeJoint { name, kind, position, coordinate, turned } = free.clone();
        Self { name, kind, position, coordinate, turned, around: [[0.0, 0.0, 0.0, 1.0]; 2] }
    }

    /// With the axes of the turned joint: `x_aligned = aligned x_original`, and the offset of its angle.
    ///
    /// With B = aligned', a rotation R before the joint becomes `Rz(offset) B' R B` after the constant part of
    /// its transform.
    pub fn aligned(self, aligned: &Matrix3<f64>, offset: f64) -> Self {
        let axes = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(*aligned));
        let turn = UnitQuaternion::from_axis_angle(&nalgebra::Vector3::z_axis(), offset);
        Self { around: [(turn * axes).coords.into(), axes.inverse().coords.into()], ..self }
    }

    /// Its quaternion in a configuration.
    pub fn quaternion<S: Scalar>(&self, q: &[S]) -> Quaternion<S> {
        let at = self.position + self.kind.slides();
        Quaternion::new([q[at], q[at + 1], q[at + 2], q[at + 3]])
    }

    /// How the frame of the turned joint is oriented.
    pub fn orientation<S: Scalar>(&self, q: &[S]) -> Quaternion<S> {
        let [before, after] = self.around.map(Quaternion::constant);
        before.then_after(self.quaternion(q)).then_after(after)
    }
}

impl Tree {
    /// Number of entries of q: n, and one more for each floating or spherical joint.
    pub fn nq(&self) -> usize {
        self.dof() + self.free.len()
    }

    /// The floating and spherical joints.
    pub(crate) fn free(&self) -> &[FreeFrame] {
        &self.free
    }

    /// [`EvalError::FreeJoint`] if there are any.
    pub(crate) fn refuse_free(&self) -> Result<(), EvalError> {
        match self.free.first() {
            None => Ok(()),
            Some(free) => Err(EvalError::free_joint(&free.name, free.kind.name())),
        }
    }

    /// [`EvalError::NotUnit`] for a quaternion whose length is not 1.
    pub(crate) fn check_unit<S: Scalar>(&self, q: &[S]) -> Result<(), EvalError> {
        if !S::CHECKED {
            return Ok(());
        }
        for free in &self.free {
            let error = free.quaternion(q).square().plus(-1.0).abs();
            let exceeds = |by: PowerOfTen| !S::all(error.less(S::from_f64(by.value())));
            if exceeds(UNIT) {
                let by = (UNIT.0..).map(PowerOfTen).take_while(|&by| by.0 < 16 && exceeds(by)).last();
                return Err(EvalError::NotUnit { joint: free.name.clone(), by: by.unwrap_or(UNIT) });
            }
        }
        Ok(())
    }

    /// The n coordinates of the chain of joints: positions of floating joints, angles of free ones zero.
    pub(crate) fn chart_coordinates<S: Scalar>(&self, q: &[S], chart: &mut [S]) {
        let (mut from, mut to) = (0, 0);
        for free in &self.free {
            let before = free.coordinate + free.kind.slides() - to;
            chart[to..to + before].copy_from_slice(&q[from..from + before]);
            chart[to + before..to + before + 3].fill(S::zero());
            (from, to) = (from + before + 4, to + before + 3);
        }
        chart[to..].copy_from_slice(&q[from..]);
    }
}
