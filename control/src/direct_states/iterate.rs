//! The iteration on one mesh.

use super::interior::Interior;
use super::points::POINTS;
use super::problem::DirectDynamics;
use super::solution::StateStep;
use crate::constants::{direct as shared, states as constants};
use crate::options::SolverOptions;
use crate::progress::{Iteration, Phase};
use crate::solve::Recorder;
use crate::status::Status;
use costate::EvalError;
use costate::dynamics::{Cost, Dynamics};

impl Interior {
    /// Iterates until the error of the problem is below this tolerance.
    pub fn solve<D: Dynamics<f64>, C: Cost<f64>>(
        &mut self,
        task: &mut DirectDynamics<D, C>,
        tolerance: f64,
        options: &SolverOptions,
        recorder: &mut Recorder<'_>,
        steps: &mut Vec<StateStep>,
    ) -> Result<(), Status> {
        let failed = |error: EvalError| Status::EvaluationFailed(error.into());
        let mut now = self.figure(task, &self.w).map_err(failed)?;
        self.cost = now.cost;
        if !(now.value(self.mu).is_finite() && now.theta.is_finite()) {
            let reason =
                "f or the cost is not finite along the guess: give another start, end or time".to_string();
            return Err(failed(EvalError::Model { reason }));
        }
        let mut restarts = 0;
        let most = options.max_iterations.min(constants::MOST_RESERVED);
        steps.reserve(most);
        recorder.iterations.reserve(most);
        for number in 0..options.max_iterations {
            if let Some(interruption) = recorder.interruption() {
                return Err(interruption.into());
            }
            let stationarity = self.linearise(task).map_err(failed)?;
            if stationarity.is_infinite() {
                let reason = "derivatives of f or of the cost are not finite along the motion".to_string();
                return Err(failed(EvalError::Model { reason }));
            }
            self.residual = self.error(0.0, stationarity, now.theta);
            let is_near = self.gap() <= tolerance * self.cost_size();
            if self.residual <= tolerance && is_near && number > 0 {
                return Ok(());
            }
            let least = self.least_barrier(tolerance);
            while self.mu > least
                && self.error(self.mu, stationarity, now.theta) <= constants::CENTRED * self.mu
            {
                let lower = (constants::BARRIER_DOWN * self.mu).min(self.mu.powf(constants::BARRIER_POWER));
                self.mu = lower.max(least);
                self.filter.clear();
            }
            self.find_step(task)?;
            let [primal, dual] = self.lengths();
            let found = self.search(task, &now, primal);
            let length = found.map_or(0.0, |(_, length)| length);
            steps.push(StateStep {
                intervals: self.layout.intervals,
                residual: self.residual,
                infeasibility: now.theta,
                cost: now.cost,
                barrier: self.mu,
                length,
            });
            recorder.record(Iteration {
                phase: Phase::Direct,
                nodes: POINTS * self.layout.intervals + 1,
                number: number + 1,
                residual: self.residual,
                step: length,
                final_time: self.time(),
                cost: task.reference * now.cost,
            });
            if let Some((new, length)) = found {
                now = new;
                self.accept(length, dual);
                self.cost = now.cost;
                continue;
            }
            if is_near && self.residual <= constants::ACCEPTABLE * tolerance {
                // Once more without the barriers that the step has added.
                self.linearise(task).map_err(failed)?;
                return Ok(());
            }
            restarts += 1;
            if restarts > constants::RESTARTS {
                return Err(Status::NewtonFailed);
            }
            // Multipliers far off curve the model wrongly: begin them anew.
            self.filter.clear();
            self.lambda.fill(0.0);
            self.nu.fill(0.0);
            self.mu = (constants::RESTART_BARRIER * self.mu).min(constants::BARRIER);
        }
        Err(Status::IterationLimit)
    }

    /// Steps of the multipliers of limits, and the parts of both steps that stay inside.
    fn lengths(&mut self) -> [f64; 2] {
        let (boundary, mut dual) = (self.boundary(), 1.0_f64);
        let work = &mut self.work;
        for i in 0..work.step.len() {
            let sides = [
                (self.w[i] - self.low[i], self.z_low[i], work.step[i], &mut work.dz_low[i]),
                (self.high[i] - self.w[i], self.z_high[i], -work.step[i], &mut work.dz_high[i]),
            ];
            for (slack, z, step, dz) in sides {
                if slack.is_finite() {
                    *dz = (self.mu * self.weights[i] - z * step) / slack - z;
                    if *dz < 0.0 {
                        dual = dual.min(-boundary * z / *dz);
                    }
                }
            }
        }
        [self.inside(), dual]
    }

    /// Takes the trial, and the multipliers that belong to it.
    fn accept(&mut self, primal: f64, dual: f64) {
        let work = &mut self.work;
        self.w.copy_from_slice(&work.trial);
        let multipliers = self.lambda.iter_mut().zip(&work.lambda).chain(self.nu.iter_mut().zip(&work.nu));
        multipliers.for_each(|(old, new)| *old += primal * (new - *old));
        for i in 0..self.w.len() {
            let sides = [
                (&mut self.z_low[i], work.dz_low[i], self.w[i] - self.low[i]),
                (&mut self.z_high[i], work.dz_high[i], self.high[i] - self.w[i]),
            ];
            for (z, dz, slack) in sides {
                if slack.is_finite() {
                    // Waechter and Biegler, equation 16.
                    let centre = self.mu * self.weights[i] / slack;
                    *z = (*z + dual * dz).clamp(centre / shared::FAR, shared::FAR * centre);
                }
            }
        }
    }
}
