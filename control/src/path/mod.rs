//! Paths of low cost: guesses for extremals.
//!
//! A robot with an actuator at every joint can follow any smooth path; inverse dynamics gives the controls.
//! Cubic splines in the joint coordinates that meet the ends minimise
//!
//! $$ J(\theta, T) = c_t T + T \int_0^1 l(q, v, u) \thinspace ds, \qquad u = B^{-1} \tau(q, v, a) $$
//!
//! with exact second derivatives. An extremal near such a path is a local minimum of low cost.

mod band;
mod coefficients;
mod control_cost;
mod costates;
pub(crate) mod cubics;
mod expansion;
mod minimise;
mod motion;
mod objective;
mod spline;

pub(crate) use costates::Path;
pub(crate) use motion::PathMotion;

use crate::constants::attempts::PathAttempt;
use crate::constants::path::{INTERVALS, ROUNDS, Round};
use crate::extremal::ControlRange;
use crate::extremal::actuation::SmoothRange;
use crate::extremal::relaxation::smoothing_price;
use crate::problem::Problem;
use crate::progress::{Iteration, Phase};
use crate::solve::Recorder;
use coefficients::Unknowns;
use cubics::{Cubics, Disturbance};
use minimise::{Descent, minimise};
use objective::Objective;

/// A path of low cost near the disturbed cubics; `None` where their cost is undefined, or if the search was
/// stopped.
pub(crate) fn lowest_path(
    problem: &Problem,
    disturbance: &Disturbance,
    attempt: PathAttempt,
    recorder: &mut Recorder<'_>,
) -> Option<Path> {
    let n = problem.robot.dof();
    let mut objective = Objective::new(problem, INTERVALS);
    let weight = attempt.penalty * problem.penalty.as_ref().map_or(0.0, |penalty| penalty.weight);
    let limited = problem.bounds.is_some() || weight > 0.0;
    let cubics = Cubics { problem, disturbance, goal: 1.0 };
    let theta = objective.coefficients.unknowns(|place| {
        let s = objective.basis.place(place / n);
        cubics.at(place % n, s).q
    });
    let mut at = Unknowns { theta, time: problem.time.value() };
    let mut lowest = None;
    let rounds = if limited { &ROUNDS[..] } else { &ROUNDS[2..] };
    let halvings = (0..attempt.halvings).map(|_| (ROUNDS[2], true));
    for (Round { stiffness, penalty }, halved) in rounds.iter().map(|&round| (round, false)).chain(halvings) {
        if halved {
            (objective, at.theta) = objective.halved(problem, &at);
        }
        objective.penalties.set_weight(penalty * weight);
        objective.terms.factor = if problem.terms_may_be_weaker() { attempt.penalty } else { 1.0 };
        objective.set_control_costs(problem, attempt.smoothing, stiffness);
        let nodes = objective.basis.intervals + 1;
        let found = minimise(&mut objective, at, |Descent { number, at, gain, damping }| {
            recorder.record(Iteration {
                phase: Phase::Path,
                nodes,
                number,
                residual: gain / at.cost.abs(),
                step: 1.0 / (1.0 + damping),
                final_time: at.at.time,
                cost: at.cost,
            });
            recorder.interruption().is_none()
        })?;
        at = found.at.clone();
        lowest = Some(found);
    }
    Path::new(problem, objective, lowest?).ok()
}

impl Objective {
    /// Costs of the controls: `smoothing` for those without effort, and the stiffness of bounds.
    fn set_control_costs(&mut self, problem: &Problem, smoothing: f64, stiffness: f64) {
        let price = smoothing_price(problem.cost.time);
        for (cost, &effort) in self.controls.iter_mut().zip(&problem.cost.effort) {
            let ControlRange { low, high } = cost.bounds;
            let half = 0.5 * (high - low);
            let of_time = if half.is_finite() { 2.0 * price / (half * half) } else { 0.0 };
            if effort == 0.0 {
                cost.effort = smoothing * of_time;
                cost.smooth = Some(SmoothRange { middle: 0.5 * (low + high), width: half });
            }
            cost.stiffness = stiffness * if effort == 0.0 { of_time } else { effort };
        }
    }

    /// The same path on intervals half as long: objective and unknowns.
    fn halved(&mut self, problem: &Problem, at: &Unknowns) -> (Self, Vec<f64>) {
        let n = self.joints();
        let finer = Self::new(problem, 2 * self.basis.intervals);
        let unknowns = finer.coefficients.unknowns(|place| {
            let (k, joint) = (place / n, place % n);
            let s = finer.basis.middle(k);
            let interval = self.basis.interval(s);
            let value = |k: usize| self.coefficients.value((interval + k) * n + joint, &at.theta, at.time);
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
        let attempt = PathAttempt { smoothing: 0.0, penalty: 1.0, halvings: 0 };
        let mut path =
            lowest_path(&problem, &Disturbance::default(), attempt, &mut Recorder::default()).unwrap();
        let solution = crate::Solver::new(&problem, crate::SolverOptions::default()).unwrap().solve();
        assert!(
            (path.cost() - solution.motion.cost).abs() < 1e-3 * solution.motion.cost,
            "{} {}",
            path.cost(),
            solution.motion.cost
        );
        let trajectory = &solution.trajectory;
        // Means over intervals do not reach into the first and last half interval.
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
