//! Configurations of a tree with floating and spherical joints.

use super::Tree;
use crate::error::{EvalError, PowerOfTen};
use crate::robot::free::{FreeJoint, of_position};
use crate::robot::free_frame::FreeFrame;
use crate::scalar::Scalar;

/// How far the squared length of a quaternion may be from 1: errors of results are of this size.
pub(crate) const UNIT: PowerOfTen = PowerOfTen(-9);

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
            Some(free) => Err(EvalError::free_joint(&free.joint.name, free.joint.kind.name())),
        }
    }

    /// [`EvalError::FreeJointAndWrench`] if there are any, and wrenches from outside.
    pub(crate) fn refuse_free_and_wrench(&self) -> Result<(), EvalError> {
        match self.free.first() {
            Some(FreeFrame { joint: FreeJoint { name, kind, .. }, .. }) if !self.wrenches.is_empty() => {
                Err(EvalError::FreeJointAndWrench { joint: name.clone(), kind: kind.name() })
            }
            _ => Ok(()),
        }
    }

    /// The name of the joint that an entry of q belongs to.
    pub(crate) fn joint_of_position(&self, index: usize) -> &str {
        match of_position(self.free.iter().map(|free| &free.joint), index) {
            Ok(free) => &free.name,
            Err(coordinate) => self.name(coordinate),
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
                return Err(EvalError::NotUnit { joint: free.joint.name.clone(), by: by.unwrap_or(UNIT) });
            }
        }
        Ok(())
    }

    /// The n coordinates of the chain of joints: positions of floating joints, angles of free ones zero.
    pub(crate) fn chart_coordinates<S: Scalar>(&self, q: &[S], chart: &mut [S]) {
        let (mut from, mut to) = (0, 0);
        for free in &self.free {
            let before = free.joint.coordinate + free.joint.kind.slides() - to;
            chart[to..to + before].copy_from_slice(&q[from..from + before]);
            chart[to + before..to + before + 3].fill(S::zero());
            (from, to) = (from + before + 4, to + before + 3);
        }
        chart[to..].copy_from_slice(&q[from..]);
    }
}
