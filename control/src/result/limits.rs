//! Limits of the robot's joints that a motion exceeds.

use crate::problem::Problem;
use crate::problem::rounded::rounded_range;
use crate::result::trajectory::Trajectory;
use costate::robot::{JointKind, printable};
use std::fmt;

/// The range of a quantity of a joint that exceeds a limit of the robot.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct RobotExcess {
    pub joint: String,
    /// "position", "rate" or "torque".
    pub kind: &'static str,
    pub range: [f64; 2],
    pub limits: [f64; 2],
    pub unit: &'static str,
}

impl RobotExcess {
    /// The end of the range that is farther beyond its limit, and this limit.
    pub fn worst(&self) -> (f64, f64) {
        let ([low, high], [least, most]) = (self.range, self.limits);
        if least - low > high - most { (low, least) } else { (high, most) }
    }
}

impl fmt::Display for RobotExcess {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let what = match self.kind {
            "rate" => "velocity",
            "torque" => "effort",
            kind => kind,
        };
        let ([low, high], [least, most]) = (rounded_range(self.range), rounded_range(self.limits));
        let (name, unit) = (printable(&self.joint), self.unit);
        write!(
            f,
            "{what} of joint '{name}' runs from {low} to {high} {unit}; its limits are {least} and {most}"
        )
    }
}

impl Problem {
    /// Where the motion exceeds the limits of the robot's joints; one sentence each. None if
    /// [`MotionLimits::from_robot`](crate::MotionLimits::from_robot) is false.
    pub fn limit_warnings(&self, trajectory: &Trajectory) -> Vec<String> {
        self.robot_excesses(trajectory).iter().map(ToString::to_string).collect()
    }

    /// The same with its numbers.
    pub(crate) fn robot_excesses(&self, trajectory: &Trajectory) -> Vec<RobotExcess> {
        let range = |rows: &[Vec<f64>], i: usize, factor: f64| {
            let values = rows.iter().map(|row| factor * row[i]);
            values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)])
        };
        let mut found = Vec::new();
        if self.limits.from_robot == Some(false) {
            return found;
        }
        // Floating and spherical joints have no limits.
        for (entry, i) in self.robot.plain_entries() {
            let joint = &self.robot.joints()[self.robot.independent_indices()[i]];
            let limits = &joint.limits;
            let units = match joint.kind {
                JointKind::Revolute => ["rad", "rad/s", "N m"],
                JointKind::Prismatic => ["m", "m/s", "N"],
            };
            let ranges = [
                ("position", range(&trajectory.q, entry, 1.0), [limits.lower, limits.upper]),
                ("rate", range(&trajectory.v, i, 1.0), [-limits.velocity, limits.velocity]),
                ("torque", range(&trajectory.u, i, self.gain[i]), [-limits.effort, limits.effort]),
            ];
            for ((kind, [low, high], [least, most]), unit) in ranges.into_iter().zip(units) {
                let slack = 1e-9 * (high - low).abs().max(high.abs());
                if low < least - slack || high > most + slack {
                    let (range, limits, joint) = ([low, high], [least, most], joint.name.clone());
                    found.push(RobotExcess { joint, kind, range, limits, unit });
                }
            }
        }
        found
    }
}
