//! Figures of single joints.

use crate::robot::checks;
use crate::robot::error::RobotError;
use crate::robot::joint::{Friction, Limits};
use crate::robot::model::Robot;

impl Robot {
    /// The same robot with another armature of one joint: rotor inertia seen at the joint (kg m^2, kg).
    /// Entries between joints stay.
    ///
    /// # Errors
    /// [`RobotError::UnknownJoint`], [`RobotError::BadValue`] if it is negative or not finite,
    /// [`RobotError::BadArmature`] if the matrix is no longer positive semidefinite.
    pub fn with_joint_armature(&self, joint: &str, armature: f64) -> Result<Self, RobotError> {
        let index = self.single_index(joint, "have armature")?;
        let part = &self.joints[index];
        checks::figures(joint, armature, &part.spring, &part.friction, &part.limits)?;
        let armature = self.armature.with_diagonal(index, armature)?;
        Ok(Self { armature, ..self.clone() }.checked(self, Vec::new()))
    }

    /// The same robot with other friction of one joint.
    ///
    /// # Errors
    /// [`RobotError::UnknownJoint`], [`RobotError::BadValue`].
    pub fn with_friction(&self, joint: &str, friction: Friction) -> Result<Self, RobotError> {
        let index = self.single_index(joint, "have friction")?;
        let part = &self.joints[index];
        checks::figures(joint, 0.0, &part.spring, &friction, &part.limits)?;
        let mut robot = self.clone();
        robot.joints[index].friction = friction;
        Ok(robot)
    }

    /// The same robot with other limits of one independent joint; those of joints that mimic it no longer
    /// narrow them.
    ///
    /// # Errors
    /// [`RobotError::UnknownJoint`], [`RobotError::DependentJoint`], [`RobotError::BadValue`].
    pub fn with_limits(&self, joint: &str, limits: Limits) -> Result<Self, RobotError> {
        let index = self.independent_index(joint)?;
        let part = &self.joints[index];
        checks::figures(joint, 0.0, &part.spring, &part.friction, &limits)?;
        let mut robot = self.clone();
        robot.joints[index].limits = limits;
        let others = robot.warnings.into_iter().filter_map(|warning| warning.without_limits_of(joint));
        robot.warnings = others.collect();
        Ok(robot.checked(self, Vec::new()))
    }
}
