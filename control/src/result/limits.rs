//! Limits of the robot's joints that a motion exceeds.

use crate::problem::Problem;
use crate::result::trajectory::Trajectory;

impl Problem {
    /// Where the motion exceeds the limits of the robot's joints, which the solver does not enforce; one sentence each.
    pub fn limit_warnings(&self, trajectory: &Trajectory) -> Vec<String> {
        let range = |rows: &[Vec<f64>], i: usize, factor: f64| {
            let values = rows.iter().map(|row| factor * row[i]);
            values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)))
        };
        let mut warnings = Vec::new();
        for (i, joint) in self.robot.joints().iter().enumerate() {
            let limits = &joint.limits;
            let ranges = [
                ("position", range(&trajectory.q, i, 1.0), (limits.lower, limits.upper)),
                ("velocity", range(&trajectory.v, i, 1.0), (-limits.velocity, limits.velocity)),
                ("effort", range(&trajectory.u, i, self.gain[i]), (-limits.effort, limits.effort)),
            ];
            for (what, (low, high), (least, most)) in ranges {
                let slack = 1e-9 * (high - low).abs().max(high.abs());
                if low < least - slack || high > most + slack {
                    let name = &joint.name;
                    warnings.push(format!(
                        "{what} of joint '{name}' runs from {low:.4} to {high:.4}; its limits are {least} and {most}"
                    ));
                }
            }
        }
        warnings
    }
}
