//! Paths of low cost, where a search for an extremal begins.
//!
//! A robot with an actuator at every joint can follow any path that is smooth enough, and inverse dynamics says at what
//! cost. Cubic splines in the joint coordinates that meet the ends are made cheaper, with exact second derivatives, until
//! they are near a minimum: an extremal found from there is one that costs least among those near by.

mod band;
mod coefficients;
mod control_cost;
mod costates;
mod expansion;
mod minimise;
mod objective;
mod spline;

pub(crate) use costates::Path;

use crate::extremal::relaxation::smoothing_price;
use crate::options::Iteration;
use crate::problem::Problem;
use crate::search::PATH;
use crate::search::guess::{Disturbance, disturbed_cubic};
use objective::Objective;

/// Intervals of the first splines.
pub(crate) const INTERVALS: usize = 24;

/// What stands for bounds and penalties, round by round: stiffness of bounds in parts of the weight of the effort, and part
/// of the penalties.
const ROUNDS: [(f64, f64); 3] = [(1.0, 1e-2), (10.0, 0.1), (100.0, 1.0)];

/// For what a path is looked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Wish {
    /// Weight of the effort of controls that cost nothing, as in [`Relaxation`](crate::Relaxation).
    pub smoothing: f64,
    /// Part of the penalties and of user terms.
    pub penalty: f64,
    /// How often the intervals of the splines are halved.
    pub halvings: usize,
}

/// A path of low cost near the disturbed cubics; `None` where the cost of the cubics is undefined.
pub(crate) fn lowest_path(
    problem: &Problem,
    disturbance: &Disturbance,
    wish: Wish,
    mut listen: impl FnMut(Iteration),
) -> Option<Path> {
    let n = problem.robot.len();
    let mut objective = Objective::new(problem, INTERVALS);
    let weight = wish.penalty * problem.penalty.as_ref().map_or(0.0, |penalty| penalty.weight);
    let limited = problem.bounds.is_some() || weight > 0.0;
    let theta = objective.coefficients.unknowns(|place| {
        let s = objective.basis.place(place / n);
        disturbed_cubic(problem, (disturbance, 1.0), place % n, s).0
    });
    let mut at = (theta, problem.time.value());
    let mut lowest = None;
    let rounds = if limited { &ROUNDS[..] } else { &ROUNDS[2..] };
    let halvings = (0..wish.halvings).map(|_| (ROUNDS[2], true));
    for ((stiffness, part), halved) in rounds.iter().map(|&round| (round, false)).chain(halvings) {
        if halved {
            (objective, at.0) = objective.halved(problem, &at.0, at.1);
        }
        objective.penalties.set_weight(part * weight);
        objective.terms.factor = if problem.terms_may_be_weaker() { wish.penalty } else { 1.0 };
        objective.set_control_costs(problem, wish.smoothing, stiffness);
        let nodes = objective.basis.intervals + 1;
        let found = minimise::minimise(&mut objective, at, |number, at, (gain, damping)| {
            listen(Iteration {
                phase: PATH.into(),
                nodes,
                number,
                residual: gain / at.cost.abs(),
                step: 1.0 / (1.0 + damping),
                final_time: at.time,
                cost: at.cost,
            });
        })?;
        at = (found.theta.clone(), found.time);
        lowest = Some(found);
    }
    Path::new(problem, objective, lowest?).ok()
}

impl Objective {
    /// Costs of the controls: those that cost nothing weighted by `smoothing`, bounds as stiff as said.
    fn set_control_costs(&mut self, problem: &Problem, smoothing: f64, stiffness: f64) {
        let price = smoothing_price(problem.cost.time);
        for (cost, &effort) in self.controls.iter_mut().zip(&problem.cost.effort) {
            let (low, high) = cost.bounds;
            let half = 0.5 * (high - low);
            let of_time = if half.is_finite() { 2.0 * price / (half * half) } else { 0.0 };
            if effort == 0.0 {
                cost.effort = smoothing * of_time;
                cost.smooth = Some((0.5 * (low + high), half));
            }
            cost.stiffness = stiffness * if effort == 0.0 { of_time } else { effort };
        }
    }

    /// The same path on intervals of half the length: objective and unknowns.
    fn halved(&mut self, problem: &Problem, theta: &[f64], time: f64) -> (Self, Vec<f64>) {
        let n = self.joints();
        let finer = Self::new(problem, 2 * self.basis.intervals);
        let unknowns = finer.coefficients.unknowns(|place| {
            let (k, joint) = (place / n, place % n);
            let s = finer.basis.middle(k);
            let interval = self.basis.interval(s);
            let value = |k: usize| self.coefficients.value((interval + k) * n + joint, theta, time);
            let sums = self.basis.at(interval, s).map(|of| (0..4).map(|k| of[k] * value(k)).sum());
            finer.basis.coefficient(k, s, sums)
        });
        (finer, unknowns)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use costate::robot::Robot;

    #[test]
    fn costates_along_a_path_are_near_those_of_the_extremal() {
        let robot = Robot::from_file("../robots/two_link.toml").unwrap();
        let problem = Problem::rest_to_rest(robot, &[0.0, 0.0], &[1.0, -0.5], 1.2);
        let wish = Wish { smoothing: 0.0, penalty: 1.0, halvings: 0 };
        let mut path = lowest_path(&problem, &Disturbance::default(), wish, |_| {}).unwrap();
        let solution = crate::Solver::new(&problem, crate::SolverOptions::default()).unwrap().solve();
        assert!(
            (path.cost() - solution.motion.cost).abs() < 1e-3 * solution.motion.cost,
            "{} {}",
            path.cost(),
            solution.motion.cost
        );
        let trajectory = &solution.trajectory;
        // Means over intervals do not reach the last half of one.
        for (i, t) in trajectory.t.iter().enumerate().filter(|(_, t)| (0.1..1.1).contains(*t)) {
            let mut z = [0.0; 8];
            path.sample(t / 1.2, &mut z).unwrap();
            let parts = [&trajectory.q[i], &trajectory.p[i], &trajectory.y_q[i], &trajectory.y_p[i]];
            for (part, (found, size)) in parts.into_iter().zip(z.chunks(2).zip([1.0, 5.0, 100.0, 20.0])) {
                assert!(
                    part.iter().zip(found).all(|(a, b)| (a - b).abs() < 0.08 * size),
                    "{t}: {part:?} {found:?}"
                );
            }
        }
    }
}
