//! Plots of the forces that hold the robot: those of the ground on feet, and those of closed loops.

use crate::motion::Motion;
use crate::plot::{Curve, Group, Look, Plot};

/// Name of the plot.
pub const FORCES: &str = "constraint_forces";

/// Components that are smaller than this part of the largest one are not drawn: those across a plane.
const SMALL: f64 = 1e-6;

/// The forces of all constraints over time (N), one curve for each component that is not zero; without curves
/// where there is none.
pub fn forces(motion: &Motion<'_>) -> (String, Plot) {
    let solution = motion.solution;
    let (title, axes) = match solution.gait {
        Some(_) => ("Forces of the ground", ["ahead", "to the left", "up"]),
        None => ("Forces of the constraints", ["x", "y", "z"]),
    };
    let mut plot = Plot::over_time(title, "f", Group::Actuation);
    plot.unit = "N".into();
    let all = || solution.constraints.iter().flat_map(|one| &one.force).flatten();
    let most = all().fold(0.0_f64, |most, force| most.max(force.abs()));
    for one in &solution.constraints {
        for (axis, name) in axes.iter().enumerate() {
            if one.force.iter().all(|force| force[axis].abs() <= SMALL * most) {
                continue;
            }
            let points = solution.trajectory.t.iter().copied().zip(one.force.iter().map(|force| force[axis]));
            plot.curves.push(Curve {
                name: format!("{} {name}", one.name),
                color: plot.curves.len(),
                points: points.collect(),
                look: Look::Line,
            });
        }
    }
    (FORCES.into(), plot)
}
