//! All constants of a robot at once.

use crate::robot::armature::Armature;
use crate::robot::checks;
use crate::robot::error::RobotError;
use crate::robot::joint::{Joint, JointKind, JointSpec};
use crate::robot::model::Robot;
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
        let armature = Armature::from_matrix(armature)?;
        Self { joints, armature, ..self.clone() }.checked(self, Vec::new()).with_gravity(gravity.into())
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
