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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ReportOptions;
    use costate::robot::LoadOptions;
    use costate_control::{Polish, ProblemFile, Solver, Verify};

    /// The ground carries the weight in the mean, with the impulse of the landing at the start of each step,
    /// and nothing is drawn across the plane.
    #[test]
    fn the_ground_carries_the_weight() {
        let file =
            ProblemFile::read("../../examples/problems/rabbit_walk.toml", LoadOptions::default()).unwrap();
        let options = file.options.with_tolerance(1e-4).with_polish(Polish::Never).with_verify(Verify::None);
        let solution = Solver::new(&file.problem, options).unwrap().solve();
        let shown = ReportOptions::default();
        let motion = Motion::new(&file.problem, &solution, &shown);
        let (_, plot) = forces(&motion);
        let names: Vec<&str> = plot.curves.iter().map(|curve| &*curve.name).collect();
        assert_eq!(names, ["right_foot ahead", "right_foot up"]);
        let up = &plot.curves[1].points;
        let steps = up.windows(2);
        let impulse: f64 = steps.map(|ends| 0.5 * (ends[1].0 - ends[0].0) * (ends[0].1 + ends[1].1)).sum();
        let gait = solution.gait.as_ref().unwrap();
        let length = file.problem.gait.as_ref().unwrap().length;
        let weight = gait.weight_times_length / length * solution.motion.final_time;
        let found = impulse + gait.impulses[0][2];
        // By trapezia between the nodes.
        assert!((found / weight - 1.0).abs() < 1e-2, "{found} {weight}");
    }
}
