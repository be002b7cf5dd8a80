//! Limits of the robot's joints that a motion exceeds.

use crate::problem::Problem;
use crate::problem::rounded::rounded_range;
use crate::result::trajectory::Trajectory;
use costate::robot::{JointKind, printable};

impl Problem {
    /// Where the motion exceeds the limits of the robot's joints; one sentence each. None if
    /// [`MotionLimits::from_robot`](crate::MotionLimits::from_robot) is false.
    pub fn limit_warnings(&self, trajectory: &Trajectory) -> Vec<String> {
        let range = |rows: &[Vec<f64>], i: usize, factor: f64| {
            let values = rows.iter().map(|row| factor * row[i]);
            values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)))
        };
        let mut warnings = Vec::new();
        if self.limits.from_robot == Some(false) {
            return warnings;
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
                ("position", range(&trajectory.q, entry, 1.0), (limits.lower, limits.upper)),
                ("velocity", range(&trajectory.v, i, 1.0), (-limits.velocity, limits.velocity)),
                ("effort", range(&trajectory.u, i, self.gain[i]), (-limits.effort, limits.effort)),
            ];
            for ((what, (low, high), (least, most)), unit) in ranges.into_iter().zip(units) {
                let slack = 1e-9 * (high - low).abs().max(high.abs());
                if low < least - slack || high > most + slack {
                    let ([low, high], [least, most]) =
                        (rounded_range([low, high]), rounded_range([least, most]));
                    let name = printable(&joint.name);
                    warnings.push(format!(
                        "{what} of joint '{name}' runs from {low} to {high} {unit}; its limits are {least} and {most}"
                    ));
                }
            }
        }
        warnings
    }
}
