//! How far to go along a direction.

use super::filter::{Figure, is_better};
use super::interior::Interior;
use super::points::PointDynamics;
use crate::constants::direct as constants;

impl<D: PointDynamics> Interior<D> {
    /// Tries shorter and shorter steps. The part that was taken.
    pub(super) fn search(&mut self) -> Option<f64> {
        let mu = self.mu;
        let (primal, dual) = self.steps_of(mu);
        // Slope of cost and barrier.
        let mut slope = 0.0;
        for i in 0..self.steps[0].len() {
            slope += self.system.gradient[0][i] * self.step(i);
        }
        slope += self.system.time_gradient[0] * self.time_step() + self.relaxation.slope(mu, false);
        for at in 0..self.barrier.slack.len() {
            if !self.barrier.is_on(at) {
                continue;
            }
            let (s, eta, d) =
                (self.barrier.slack[at], self.barrier.multiplier[at], self.barrier.distance[at]);
            let change = self.change(at, mu);
            slope += (eta - self.barrier.curvature(at) * d) * change;
            if s > 0.0 {
                slope -= mu * self.barrier.weight[at] * self.trial.slack_step[at] / s;
            }
        }
        let now = Figure {
            theta: self.noticed(self.infeasibility(&self.barrier.distance, &self.barrier.slack)),
            cost: self.figures.cost,
            logarithms: self.logarithms(&self.barrier.slack),
        };
        let value = now.value(mu);
        let rounding = constants::ROUNDING * value.abs();
        let mut alpha = primal;
        loop {
            if self.evaluate_trial(alpha) {
                let trial = &self.trial;
                let cost = self.running.cost(&trial.spline, &trial.points) + self.relaxation.cost(alpha, mu);
                let new = Figure {
                    theta: self.noticed(self.infeasibility(&trial.distance, &trial.slack)),
                    cost,
                    logarithms: self.logarithms(&trial.slack),
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
        let (mu, dt) = (self.mu, self.time_step());
        let trial = &mut self.trial;
        trial.spline.dof = self.spline.dof;
        trial.spline.mesh.clone_from(&self.spline.mesh);
        trial.spline.unknowns.clone_from(&self.spline.unknowns);
        trial.spline.time = self.spline.time;
        for (i, unknown) in trial.spline.unknowns.iter_mut().enumerate() {
            *unknown += alpha * (self.steps[0][i] + mu * self.steps[1][i] + self.steps[2][i]);
        }
        trial.spline.time += alpha * dt;
        let forward = trial.spline.time > 0.0;
        if !forward {
            return false;
        }
        self.ends.put_accelerations(&mut trial.spline);
        let rows = [self.tasks.rows(), self.powers.rows()];
        trial.points.resize_values(self.spline.dof, rows, self.spline.mesh.points());
        trial.points.ends.resize(self.spline.dof, self.tasks.end_rows());
        trial.spline.evaluate(&mut trial.points.z);
        let evaluated = self
            .dynamics
            .evaluate(&mut trial.points)
            .and_then(|()| self.tasks.evaluate(&mut trial.points))
            .and_then(|()| self.tasks.evaluate_ends(&trial.spline, &mut trial.points));
        if evaluated.is_err() {
            return false;
        }
        self.powers.evaluate(&mut trial.points);
        trial.points.evaluate_rates(&trial.spline);
        trial.distance.resize(self.barrier.count(), 0.0);
        self.barrier.measure(&trial.spline, &trial.points, &mut trial.distance);
        self.relaxation.add_step(alpha, mu, &self.barrier, &mut trial.distance);
        trial.slack.clone_from(&self.barrier.slack);
        for ((slack, step), &distance) in trial.slack.iter_mut().zip(&trial.slack_step).zip(&trial.distance) {
            if *slack > 0.0 && slack.is_finite() {
                *slack = (*slack + alpha * step).max(distance);
            }
        }
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
        for at in 0..self.barrier.multiplier.len() {
            if !self.barrier.is_on(at) {
                continue;
            }
            if !self.barrier.is_limit(at) {
                self.barrier.multiplier[at] += alpha * self.trial.multiplier_step[at];
            } else {
                let eta = self.barrier.multiplier[at] + dual * self.trial.multiplier_step[at];
                let central = self.mu * self.barrier.weight[at] / self.barrier.slack[at];
                self.barrier.multiplier[at] = eta.clamp(central / constants::FAR, constants::FAR * central);
            }
        }
        if !self.barrier.relief.is_empty() {
            self.take_relief(alpha);
        }
        self.measure_figures_of(cost);
    }

    /// An infeasibility, or zero where it is rounding.
    fn noticed(&self, theta: f64) -> f64 {
        if theta <= self.least_violation { 0.0 } else { theta }
    }
}
