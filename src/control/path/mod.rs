//! Paths of low cost, where a search for an extremal begins.
//!
//! A robot with an actuator at every joint can follow any path that is smooth enough, and inverse dynamics says at what
//! cost. Cubic splines in the joint coordinates that meet the ends are made cheaper, with exact second derivatives, until
//! they are near a minimum: an extremal found from there is one that costs least among those near by.

mod band;
mod coefficients;
mod control_cost;
mod costates;
mod minimise;
mod objective;
mod spline;

pub(super) use costates::Path;

use super::guess::{Disturbance, disturbed_cubic};
use super::options::Iteration;
use super::problem::Problem;
use objective::Objective;

/// Intervals of the splines.
const INTERVALS: usize = 24;

/// What stands for bounds and penalties, round by round: stiffness of bounds in parts of the weight of the effort, and part
/// of the penalties.
const ROUNDS: [(f64, f64); 3] = [(1.0, 1e-2), (10.0, 0.1), (100.0, 1.0)];

/// A path of low cost near the disturbed cubics, with effort of controls that cost nothing weighted by `smoothing` (see
/// [`Ease`](super::Ease)); `None` where the cost of the cubics is undefined.
pub(super) fn lowest_path(
    problem: &Problem,
    disturbance: &Disturbance,
    smoothing: f64,
    mut listen: impl FnMut(Iteration),
) -> Option<Path> {
    let n = problem.robot.len();
    let mut objective = Objective::new(problem, INTERVALS);
    let weight = problem.penalty.as_ref().map_or(0.0, |penalty| penalty.weight);
    let price = if problem.cost.time > 0.0 { problem.cost.time } else { 1.0 };
    let mut time = problem.time.value();
    let theta = {
        let (basis, coefficients) = (&objective.basis, &objective.coefficients);
        coefficients.unknowns(|place| {
            let (k, joint) = (place / n, place % n);
            disturbed_cubic(problem, (disturbance, 1.0), joint, basis.place(k)).0
        })
    };
    let mut theta = theta;
    let bounded = problem.bounds.is_some();
    let mut lowest = None;
    for (round, (stiffness, part)) in ROUNDS.into_iter().enumerate() {
        if !bounded && weight == 0.0 && round + 1 < ROUNDS.len() {
            continue;
        }
        objective.penalties.set_weight(part * weight);
        for (cost, &effort) in objective.controls.iter_mut().zip(&problem.cost.effort) {
            let (low, high) = cost.bounds;
            let half = 0.5 * (high - low);
            let of_time = if half.is_finite() { 2.0 * price / (half * half) } else { 0.0 };
            if effort == 0.0 {
                cost.effort = smoothing * of_time;
                cost.smooth = Some((0.5 * (low + high), half));
            }
            cost.stiffness = stiffness * if effort == 0.0 { of_time } else { effort };
        }
        let from = (std::mem::take(&mut theta), time);
        let found = minimise::minimise(&mut objective, from, |number, at, (gain, damping)| {
            listen(Iteration {
                phase: "path".into(),
                nodes: INTERVALS + 1,
                number,
                residual: gain / at.cost.abs(),
                step: 1.0 / (1.0 + damping),
                final_time: at.time,
                cost: at.cost,
            });
        })?;
        (theta, time) = (found.theta.clone(), found.time);
        lowest = Some(found);
    }
    Path::new(problem, objective, lowest?).ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::Robot;

    #[test]
    fn costates_along_a_path_are_near_those_of_the_extremal() {
        let robot = Robot::from_file("robots/two_link.toml").unwrap();
        let problem = Problem::rest_to_rest(robot, &[0.0, 0.0], &[1.0, -0.5], 1.2);
        let mut path = lowest_path(&problem, &Disturbance::default(), 0.0, |_| {}).unwrap();
        let solution =
            crate::control::Solver::new(&problem, crate::control::Options::default()).unwrap().solve();
        assert!((path.cost() - solution.cost).abs() < 1e-3 * solution.cost, "{} {}", path.cost(), solution.cost);
        let trajectory = &solution.trajectory;
        for (i, t) in trajectory.t.iter().enumerate() {
            let mut z = [0.0; 8];
            path.sample(t / 1.2, &mut z).unwrap();
            let parts = [&trajectory.q[i], &trajectory.p[i], &trajectory.y_q[i], &trajectory.y_p[i]];
            for (part, (found, size)) in parts.into_iter().zip(z.chunks(2).zip([1.0, 5.0, 100.0, 20.0])) {
                assert!(part.iter().zip(found).all(|(a, b)| (a - b).abs() < 0.08 * size), "{t}: {part:?} {found:?}");
            }
        }
    }
}
