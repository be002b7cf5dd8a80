//! Values of joints: a list with one entry for each, or one number for all of them.

use super::fault::Fault;
use super::table::{Table, number};
use costate::robot::Robot;

/// Values of joints, before the robot is known.
#[derive(Clone)]
pub(super) enum PerJoint {
    /// The same for all joints.
    Each(f64),
    /// One entry for each joint.
    Of(Vec<f64>),
}

impl PerJoint {
    /// Those of n joints.
    pub fn of_joints(&self, n: usize) -> Vec<f64> {
        match self {
            Self::Each(value) => vec![*value; n],
            Self::Of(values) => values.clone(),
        }
    }

    /// Those of torques and forces: one number counts for the joints that may have a motor, which those of a
    /// body that flies or turns freely have not.
    pub fn of_motors(&self, robot: &Robot) -> Vec<f64> {
        let mut values = self.of_joints(robot.dof());
        if let Self::Each(_) = self {
            let mut has_motor = vec![false; values.len()];
            robot.plain_entries().for_each(|(_, rate)| has_motor[rate] = true);
            values.iter_mut().zip(has_motor).filter(|(_, has_motor)| !has_motor).for_each(|(v, _)| *v = 0.0);
        }
        values
    }
}

impl Table<'_> {
    /// A number for all joints, or a list with a number for each.
    pub(super) fn per_joint(&self, name: &str) -> Result<Option<PerJoint>, Fault> {
        let expected = "a number for all joints, or a list with one for each";
        if self.has_list(name) {
            return Ok(self.list(name, expected, number)?.map(PerJoint::Of));
        }
        Ok(self.value(name, expected, number)?.map(PerJoint::Each))
    }
}
