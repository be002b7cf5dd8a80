//! Whether the limits of the robot's joints are limits of a motion, and what has them kept.

use super::key::Key;
use super::{MotionLimits, Problem};
use costate::robot::{Joint, Limits};

impl Problem {
    /// Whether the limits of the robot's joints are limits of the motion, which the direct method keeps
    /// ([`MotionLimits::from_robot`]).
    pub fn keeps_robot_limits(&self) -> bool {
        let by_default = || self.needs_direct() || self.has_limits_of_a_product();
        self.limits.from_robot.unwrap_or_else(by_default)
    }

    /// Whether all joints of the robot have limits of rate and effort, as those of arms that are sold have,
    /// and the problem has no other way to limit them.
    fn has_limits_of_a_product(&self) -> bool {
        self.bounds.is_none() && self.penalty.is_none() && self.joint_without_limits().is_none()
    }

    /// The name of the first joint of the robot without a limit of rate or effort.
    pub fn joint_without_limits(&self) -> Option<&str> {
        let lacks = |joint: &&Joint| joint.limits.velocity.is_infinite() || joint.limits.effort.is_infinite();
        self.robot.independent_joints().find(lacks).map(|joint| joint.name.as_str())
    }

    /// Whether limits of the robot are left out since nothing is said about limits, and nothing else has them
    /// kept.
    pub fn leaves_out_robot_limits(&self) -> bool {
        let is_limited = self.robot.independent_joints().any(limited);
        self.limits == MotionLimits::unsaid() && !self.keeps_robot_limits() && is_limited
    }

    /// Whether there is anything that only the direct method takes, beside limits of the robot.
    pub(crate) fn needs_direct(&self) -> bool {
        self.limits.any_given() || self.first_for_direct().is_some() || self.is_closed()
    }

    /// What has the limits of the robot kept, where nothing is said about limits: the first of a cost of
    /// energy, rates, accelerations, tools, obstacles, vias and a period, which the direct method alone
    /// takes. `None` if they are not kept, if they are asked for, or if the robot has none.
    pub fn keeps_robot_limits_by(&self) -> Option<Key> {
        let unsaid = self.limits == MotionLimits::unsaid();
        self.first_for_direct().filter(|_| unsaid && self.robot.independent_joints().any(limited))
    }

    /// What the direct method alone takes, beside limits.
    fn first_for_direct(&self) -> Option<Key> {
        let energy = self.cost.has_energy().then_some(Key::ENERGY);
        let rates = || self.first_of_rates();
        let gait = || self.gait.as_ref().map(|_| Key::GAIT_STANCE);
        energy
            .or_else(rates)
            .or_else(|| self.task.first_key())
            .or_else(|| self.first_of_phases())
            .or_else(gait)
    }
}

/// Whether a joint has any limit.
fn limited(joint: &Joint) -> bool {
    let Limits { lower, upper, velocity, effort, .. } = joint.limits;
    lower.is_finite() || upper.is_finite() || velocity.is_finite() || effort.is_finite()
}
