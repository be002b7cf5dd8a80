//! Newton's method that only goes down.

use super::band::Band;
use super::expansion::Expansion;
use super::objective::Objective;

/// Most steps.
const STEPS: usize = 200;
/// Smallest step down, in parts of the cost.
const LEAST_GAIN: f64 = 1e-7;
/// Largest change of log T in a step.
const LARGEST_STRETCH: f64 = 0.7;

/// A path and its cost.
#[derive(Clone, Debug)]
pub(crate) struct Lowest {
    pub theta: Vec<f64>,
    pub time: f64,
    pub cost: f64,
}

/// Goes down from (theta, T) until steps gain nothing; `listen` hears what a step gained and its damping.
///
/// Steps solve `(H + damping D) d = -gradient` (Levenberg, Marquardt), D the diagonal of the positive semidefinite part of
/// the Hessian; H is exact where that is positive definite, else that part. `None` where the cost is undefined at the start.
pub(crate) fn minimise(
    objective: &mut Objective,
    (theta, time): (Vec<f64>, f64),
    mut listen: impl FnMut(usize, &Lowest, (f64, f64)),
) -> Option<Lowest> {
    let mut at = Lowest { cost: objective.value(&theta, time).ok()?, theta, time };
    if !at.cost.is_finite() {
        return None;
    }
    let (mut exact, mut convex) = (objective.expansion(), objective.expansion());
    let mut solver = Solver::new(&exact);
    let mut damping = 1e-3;
    for number in 1..=STEPS {
        objective.expand(&at.theta, at.time, true, &mut exact).ok()?;
        objective.expand(&at.theta, at.time, false, &mut convex).ok()?;
        let mut gain = 0.0;
        while damping < 1e12 {
            let solved = solver.solve(&exact, &convex, damping, objective.time_is_free)
                || solver.solve(&convex, &convex, damping, objective.time_is_free);
            if solved {
                let trial = at.moved(&solver.step);
                let cost = objective.value(&trial.0, trial.1).unwrap_or(f64::INFINITY);
                if cost < at.cost - 1e-4 * solver.predicted {
                    gain = at.cost - cost;
                    let ratio = gain / solver.predicted;
                    damping = (damping
                        * if ratio > 0.7 {
                            0.1
                        } else if ratio > 0.3 {
                            0.5
                        } else {
                            2.0
                        })
                    .max(1e-9);
                    (at.theta, at.time, at.cost) = (trial.0, trial.1, cost);
                    break;
                }
                if solver.predicted <= LEAST_GAIN * at.cost.abs() {
                    return Some(at);
                }
            }
            damping = (10.0 * damping).max(1e-6);
        }
        listen(number, &at, (gain, damping));
        if gain <= LEAST_GAIN * at.cost.abs() {
            break;
        }
    }
    Some(at)
}

impl Lowest {
    /// Unknowns and duration a step away; what would change T too much is shortened.
    fn moved(&self, step: &[f64]) -> (Vec<f64>, f64) {
        let (last, of_theta) = step.split_last().unwrap_or((&0.0, &[]));
        let factor = (LARGEST_STRETCH / last.abs()).min(1.0);
        let theta = self.theta.iter().zip(of_theta).map(|(theta, step)| theta + factor * step).collect();
        (theta, self.time * (factor * last).exp())
    }
}

/// Solves for steps.
struct Solver {
    matrix: Band,
    /// H^-1 border.
    border: Vec<f64>,
    pub step: Vec<f64>,
    /// How much the quadratic model falls.
    pub predicted: f64,
}

impl Solver {
    fn new(expansion: &Expansion) -> Self {
        let size = expansion.gradient.len();
        Self {
            matrix: expansion.hessian.clone(),
            border: vec![0.0; size - 1],
            step: vec![0.0; size],
            predicted: 0.0,
        }
    }

    /// False where the damped matrix is not positive definite.
    fn solve(&mut self, of: &Expansion, convex: &Expansion, damping: f64, time_is_free: bool) -> bool {
        let count = self.border.len();
        self.matrix.copy_from(&of.hessian);
        let largest = (0..count).map(|i| convex.hessian.diagonal(i)).fold(0.0, f64::max);
        let damp = |i: usize| damping * convex.hessian.diagonal(i).max(1e-9 * largest).max(f64::MIN_POSITIVE);
        for i in 0..count {
            *self.matrix.entry_mut(i, i) += damp(i);
        }
        if !self.matrix.factor() {
            return false;
        }
        let (of_theta, of_time) = self.step.split_at_mut(count);
        of_theta.iter_mut().zip(&of.gradient).for_each(|(step, gradient)| *step = -gradient);
        self.matrix.solve(of_theta);
        let mut curved = 0.0;
        of_time[0] = 0.0;
        if time_is_free {
            let (border, corner) = of.border.split_at(count);
            self.border.copy_from_slice(border);
            self.matrix.solve(&mut self.border);
            let pivot = corner[0] * (1.0 + damping) - costate::matrix::dot(border, &self.border);
            // Where T would go up the hill, as far down as it is steep.
            let pivot =
                if pivot > 1e-8 * corner[0].abs() { pivot } else { pivot.abs() + of.gradient[count].abs() };
            of_time[0] = (-of.gradient[count] - costate::matrix::dot(border, of_theta)) / pivot;
            of_theta.iter_mut().zip(&self.border).for_each(|(step, border)| *step -= of_time[0] * border);
            curved = damping * corner[0].abs() * of_time[0] * of_time[0];
        }
        if self.step.iter().any(|step| !step.is_finite()) {
            return false;
        }
        // The model falls by -g'd - 1/2 d'Hd, and (H + damping D) d = -g.
        let downhill: f64 = self.step.iter().zip(&of.gradient).map(|(step, gradient)| -step * gradient).sum();
        let damped: f64 = (0..count).map(|i| damp(i) * self.step[i] * self.step[i]).sum();
        self.predicted = 0.5 * (downhill + damped + curved);
        downhill > 0.0
    }
}
