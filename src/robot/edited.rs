//! A robot with other constants.

use super::armature::Armature;
use super::checks;
use super::error::RobotError;
use super::joint::{Joint, JointKind, JointSpec};
use super::model::Robot;
use nalgebra::{DMatrix, Vector3};

impl Robot {
    /// The same robot with these constants of its joints, checked as those of a description are.
    pub(crate) fn with_constants(
        &self,
        joints: Vec<Joint>,
        armature: &DMatrix<f64>,
        gravity: Vector3<f64>,
    ) -> Result<Self, RobotError> {
        joints.iter().try_for_each(|joint| checks::joint(&described(joint)))?;
        if gravity.iter().any(|g| !g.is_finite()) {
            return Err(RobotError::BadGravity);
        }
        let armature = Armature::from_matrix(armature)?;
        checks::robot(&joints, &armature, &vec![true; joints.len()], &mut Vec::new())?;
        Ok(Self { joints, armature, gravity, ..self.clone() })
    }
}

/// What can be wrong about a joint by itself.
fn described(joint: &Joint) -> JointSpec {
    let spec = match joint.kind {
        JointKind::Revolute => JointSpec::revolute(&joint.name),
        JointKind::Prismatic => JointSpec::prismatic(&joint.name),
    };
    spec.placed(joint.placement)
        .axis(joint.axis.into())
        .link(&joint.link)
        .carrying(joint.inertia)
        .spring(joint.spring)
        .friction(joint.friction)
}
