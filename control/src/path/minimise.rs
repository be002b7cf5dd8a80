//! Damped Newton descent.
//!
//! A step d solves, with the Hessian H and the diagonal D of its positive semidefinite part,
//!
//! $$ (H + \lambda D) \thinspace d = -\nabla J $$
//!
//! (Levenberg, Marquardt). H is exact where it is positive definite, else its positive semidefinite part is
//! used. Source: J. Nocedal, S. J. Wright, *Numerical Optimization*, Springer 2006, sections 3.4 and 10.3.

use super::band::Band;
use super::coefficients::Unknowns;
use super::expansion::Expansion;
use super::objective::Objective;
use crate::constants::path::{
    FIRST_DAMPING, LARGEST_STRETCH, LEAST_DAMPING, LEAST_GAIN, MOST_DAMPING, MOST_STEPS, SUFFICIENT_DECREASE,
};

/// A path and its cost.
#[derive(Clone, Debug)]
pub(crate) struct Lowest {
    pub at: Unknowns,
    pub cost: f64,
}

/// One step.
pub(crate) struct Descent<'a> {
    pub number: usize,
    pub at: &'a Lowest,
    /// Decrease of the cost.
    pub gain: f64,
    /// lambda.
    pub damping: f64,
}

/// Descends until steps gain nothing. `None` if the cost is undefined at the start, or if `listen` says not
/// to go on.
pub(crate) fn minimise(
    objective: &mut Objective,
    from: Unknowns,
    mut listen: impl FnMut(Descent<'_>) -> bool,
) -> Option<Lowest> {
    let mut at = Lowest { cost: objective.value(&from.theta, from.time).ok()?, at: from };
    if !at.cost.is_finite() {
        return None;
    }
    let (mut exact, mut convex) = (objective.expansion(), objective.expansion());
    let mut solver = StepSolver::new(&exact);
    let mut damping = FIRST_DAMPING;
    for number in 1..=MOST_STEPS {
        objective.expand(&at.at, true, &mut exact).ok()?;
        objective.expand(&at.at, false, &mut convex).ok()?;
        let mut gain = 0.0;
        while damping < MOST_DAMPING {
            let solved = solver.solve(&exact, &convex, damping, objective.time_is_free)
                || solver.solve(&convex, &convex, damping, objective.time_is_free);
            if solved {
                let trial = at.at.moved(&solver.step);
                let cost = objective.value(&trial.theta, trial.time).unwrap_or(f64::INFINITY);
                if cost < at.cost - SUFFICIENT_DECREASE * solver.predicted {
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
                    .max(LEAST_DAMPING);
                    at = Lowest { at: trial, cost };
                    break;
                }
                if solver.predicted <= LEAST_GAIN * at.cost.abs() {
                    return Some(at);
                }
            }
            damping = (10.0 * damping).max(1e-6);
        }
        if !listen(Descent { number, at: &at, gain, damping }) {
            return None;
        }
        if gain <= LEAST_GAIN * at.cost.abs() {
            break;
        }
    }
    Some(at)
}

impl Unknowns {
    /// A step away; one that changes T too much is shortened.
    fn moved(&self, step: &[f64]) -> Self {
        let (last, of_theta) = step.split_last().unwrap_or((&0.0, &[]));
        let factor = (LARGEST_STRETCH / last.abs()).min(1.0);
        let theta = self.theta.iter().zip(of_theta).map(|(theta, step)| theta + factor * step).collect();
        Self { theta, time: self.time * (factor * last).exp() }
    }
}

/// Solves for steps.
struct StepSolver {
    matrix: Band,
    /// H^-1 border.
    border: Vec<f64>,
    pub step: Vec<f64>,
    /// Decrease of the quadratic model.
    pub predicted: f64,
}

impl StepSolver {
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
            // With negative curvature in T, a descent step as long as the gradient is steep.
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
