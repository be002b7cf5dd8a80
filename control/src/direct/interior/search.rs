//! How far to go along a direction.

use super::filter::{Figure, is_better};
use super::iterate::Interior;
use crate::constants::direct as constants;
use crate::direct::limits::entries::{self, infeasibility, logarithms};
use crate::direct::points::values::PointDynamics;

impl<D: PointDynamics> Interior<D> {
    /// Tries shorter and shorter steps, from how far slacks and multipliers may go along
    /// [theirs](Self::steps_of). The part that was taken.
    pub(crate) fn search(&mut self, (primal, dual): (f64, f64)) -> Option<f64> {
        let mu = self.mu;
        // Slope of cost and barrier.
        let mut slope = 0.0;
        for i in 0..self.steps[0].len() {
            slope += self.system.gradient[0][i] * self.step(i);
        }
        for (i, gradient) in self.system.shared_gradient[0].iter().enumerate() {
            slope += gradient * self.shared_step(i);
        }
        slope += self.relaxation.slope(mu, false);
        let [zero, of_mu, more, _] = &self.changes;
        slope += entries::slope(&self.barrier, mu, [zero, of_mu, more], &self.trial.slack_step);
        let now = Figure {
            theta: self.noticed(infeasibility(&self.barrier, &self.barrier.distance, &self.barrier.slack)),
            cost: self.figures.cost,
            logarithms: logarithms(&self.barrier.slack, &self.barrier.weight),
        };
        let value = now.value(mu);
        let rounding = constants::ROUNDING * value.abs();
        let mut alpha = primal;
        loop {
            if self.evaluate_trial(alpha) {
                let trial = &self.trial;
                let cost = self.running.cost(&trial.spline, &trial.points) + self.relaxation.cost(alpha, mu);
                let new = Figure {
                    theta: self.noticed(infeasibility(&self.barrier, &trial.distance, &trial.slack)),
                    cost,
                    logarithms: logarithms(&trial.slack, &self.barrier.weight),
                };
                let promised = alpha * (-slope / self.figures.size).max(0.0).powf(constants::OF_DESCENT);
                let descends = promised > now.theta.powf(constants::OF_INFEASIBILITY);
                let fine = if descends {
                    new.value(mu) <= value + constants::ARMIJO * alpha * slope + rounding
                } else {
                    is_better(&new, &now, mu, rounding)
                };
                let sane = cost.is_finite() && new.theta <= constants::MOST_INFEASIBLE * now.theta.max(1.0);
                if fine && sane && self.filter.accepts(&new, mu, rounding) {
                    if !descends {
                        self.filter.add(now);
                    }
                    self.take(alpha, dual, cost);
                    self.taken = alpha / primal;
                    return Some(alpha);
                }
            }
            alpha *= 0.5;
            let long_enough = alpha >= constants::SHORTEST * primal && alpha > 0.0;
            if !long_enough {
                return None;
            }
        }
    }

    /// Spline, points, distances and slacks after the part `alpha` of the step. Whether it is a motion:
    /// one that goes forward in time and can be evaluated.
    fn evaluate_trial(&mut self, alpha: f64) -> bool {
        let mu = self.mu;
        self.trial.spline.copy_from(&self.spline);
        for phase in 0..self.spline.times.len() {
            self.trial.spline.times[phase] += alpha * self.time_step(phase);
        }
        let trial = &mut self.trial;
        for (i, unknown) in trial.spline.unknowns.iter_mut().enumerate() {
            *unknown += alpha * (self.steps[0][i] + mu * self.steps[1][i] + self.steps[2][i]);
        }
        let forward = trial.spline.times.iter().all(|time| *time > 0.0);
        if !forward {
            return false;
        }
        self.model.resize_values(&trial.spline, &mut trial.points);
        if self.model.evaluate(&trial.spline, &mut trial.points).is_err() {
            return false;
        }
        trial.distance.resize(self.barrier.count(), 0.0);
        self.barrier.measure(&trial.spline, &trial.points, &mut trial.distance);
        self.relaxation.add_step(alpha, mu, &self.barrier, &mut trial.distance);
        trial.slack.clone_from(&self.barrier.slack);
        entries::trial_slacks(&mut trial.slack, alpha, &trial.slack_step, &trial.distance);
        true
    }

    /// Takes the last step of a solved problem, which is known, if limits are kept after it: the error that
    /// is left is about its square.
    pub fn take_last_step(&mut self) {
        let (primal, dual) = self.steps_of(self.mu);
        if primal < 1.0 || !self.evaluate_trial(1.0) {
            return;
        }
        let cost = self.running.cost(&self.trial.spline, &self.trial.points);
        let mut beyond = (0..self.barrier.count()).filter(|&at| self.barrier.is_on(at)).map(|at| {
            let distance = self.trial.distance[at];
            self.barrier.unit[at] * if self.barrier.is_limit(at) { -distance } else { distance.abs() }
        });
        // Not true for NaN.
        if cost.is_finite() && beyond.all(|part| part <= constants::VIOLATION_AT_POINTS) {
            self.take(1.0, dual, cost);
        }
    }

    /// Makes the trial, which costs so much, the iterate; multipliers of equations go as far as the motion,
    /// the others this part.
    fn take(&mut self, alpha: f64, dual: f64, cost: f64) {
        std::mem::swap(&mut self.spline, &mut self.trial.spline);
        std::mem::swap(&mut self.points.z, &mut self.trial.points.z);
        std::mem::swap(&mut self.points.tau, &mut self.trial.points.tau);
        std::mem::swap(&mut self.points.g, &mut self.trial.points.g);
        std::mem::swap(&mut self.points.h, &mut self.trial.points.h);
        std::mem::swap(&mut self.points.rates.jerk, &mut self.trial.points.rates.jerk);
        std::mem::swap(&mut self.points.rates.torque, &mut self.trial.points.rates.torque);
        std::mem::swap(&mut self.points.ends.g, &mut self.trial.points.ends.g);
        std::mem::swap(&mut self.barrier.slack, &mut self.trial.slack);
        std::mem::swap(&mut self.barrier.distance, &mut self.trial.distance);
        let step = &self.trial.multiplier_step;
        entries::take_multipliers(&mut self.barrier, [alpha, dual], self.mu, step);
        if self.relaxation.is_on() {
            self.take_relief(alpha);
        }
        self.measure_figures_of(cost);
    }

    /// An infeasibility, or zero where it is rounding.
    fn noticed(&self, theta: f64) -> f64 {
        if theta <= self.least_violation { 0.0 } else { theta }
    }
}
