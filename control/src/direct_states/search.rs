//! The part of a step that is taken.

use super::interior::Interior;
use super::points::{Layout, POINTS};
use super::problem::DirectDynamics;
use crate::constants::{direct as shared, states as constants};
use crate::direct::{Figure, is_better};
use crate::extremal::dynamics::response::eval_error;
use costate::EvalError;
use costate::dynamics::{Cost, Dynamics};

impl Interior {
    /// The longest part of the step that the filter accepts, and its figure. A first trial that meets the
    /// defects worse than before is corrected.
    pub(super) fn search<D: Dynamics<f64>, C: Cost<f64>>(
        &mut self,
        task: &mut DirectDynamics<D, C>,
        now: &Figure,
        longest: f64,
    ) -> Option<(Figure, f64)> {
        let slope = self.slope(task);
        let mut length = longest;
        while length >= constants::SHORTEST * longest {
            if let Ok(new) = self.try_step(task, length) {
                if self.accepts(&new, now, slope, length) {
                    return Some((new, length));
                }
                if length == longest
                    && new.theta >= now.theta
                    && let Some(new) = self.corrected(task, now, slope, length)
                {
                    return Some((new, length));
                }
            }
            length *= 0.5;
        }
        None
    }

    /// The figure after this part of the step, which is the trial.
    fn try_step<D: Dynamics<f64>, C: Cost<f64>>(
        &mut self,
        task: &mut DirectDynamics<D, C>,
        length: f64,
    ) -> Result<Figure, EvalError> {
        let mut trial = std::mem::take(&mut self.work.trial);
        for ((trial, w), step) in trial.iter_mut().zip(&self.w).zip(&self.work.step) {
            *trial = w + length * step;
        }
        let figure = self.figure(task, &trial);
        self.work.trial = trial;
        figure
    }

    /// Whether the filter takes a trial, which promises this slope of the value over this length.
    fn accepts(&mut self, new: &Figure, now: &Figure, slope: f64, length: f64) -> bool {
        let (value, old) = (new.value(self.mu), now.value(self.mu));
        let rounding = shared::ROUNDING * old.abs().max(1.0);
        let promise = length * (-slope).max(0.0).powf(shared::OF_DESCENT);
        let descends = slope < 0.0
            && now.theta < constants::NEARLY_FEASIBLE
            && promise > now.theta.powf(shared::OF_INFEASIBILITY);
        let is_feasible = new.theta <= constants::FEASIBLE && now.theta <= constants::FEASIBLE;
        let is_fine = if descends || is_feasible {
            value <= old + shared::ARMIJO * length * slope.min(0.0) + rounding
        } else {
            is_better(new, now, self.mu, rounding)
        };
        // Not true for NaN.
        let is_taken = value.is_finite()
            && new.theta.is_finite()
            && is_fine
            && self.filter.accepts(new, self.mu, rounding);
        if is_taken && !descends {
            self.filter.add(*now);
        }
        is_taken
    }

    /// Corrections of second order (Waechter and Biegler, section 2.4): Newton's equations again with what
    /// the trial leaves of the defects. Near a saddle a step costs more, to second order, until the defects
    /// are met again; without corrections it is cut to nothing. The step stays, and the corrected one is
    /// the trial where it is accepted.
    fn corrected<D: Dynamics<f64>, C: Cost<f64>>(
        &mut self,
        task: &mut DirectDynamics<D, C>,
        now: &Figure,
        slope: f64,
        longest: f64,
    ) -> Option<Figure> {
        self.work.exchange_step();
        let (mut last, mut length, mut found) = (f64::INFINITY, longest, None);
        for _ in 0..constants::CORRECTIONS {
            let is_known = self.leave_defects(task, length).is_ok();
            if !(is_known && self.correct_step(task)) {
                break;
            }
            length = self.inside();
            let Ok(new) = self.try_step(task, length) else { break };
            if self.accepts(&new, now, slope, longest) {
                found = Some(new);
                break;
            }
            // Not true for NaN.
            let is_less = new.theta <= constants::CORRECTED * last;
            if !is_less {
                break;
            }
            last = new.theta;
        }
        self.work.exchange_step();
        found
    }

    /// Defects of the trial, beside this part of those that the step was found for.
    fn leave_defects<D: Dynamics<f64>, C>(
        &mut self,
        task: &mut DirectDynamics<D, C>,
        length: f64,
    ) -> Result<(), EvalError> {
        let (Layout { n, m, .. }, layout, w) = (self.layout, self.layout, &self.work.trial);
        let time = w[layout.time()];
        for (k, (interval, h)) in self.intervals.iter_mut().zip(&self.widths).enumerate() {
            for j in 0..POINTS {
                let (x, u) = w[layout.point(k, j)..][..n + m].split_at(n);
                let f = task.model.evaluate(x, u).map_err(eval_error)?;
                for (i, f) in f.iter().enumerate() {
                    let old = &mut interval.defect[j * n + i];
                    *old = length * *old + self.radau.defect(&layout, w, (k, j), i, h * time * f);
                }
            }
        }
        Ok(())
    }

    /// The part of the way to a limit that a step may go.
    pub(super) fn boundary(&self) -> f64 {
        (1.0 - self.mu).max(constants::BOUNDARY)
    }

    /// The longest part of the step that stays inside the limits.
    pub(super) fn inside(&self) -> f64 {
        let (boundary, mut length) = (self.boundary(), 1.0_f64);
        for (i, &step) in self.work.step.iter().enumerate() {
            for (slack, step) in [(self.w[i] - self.low[i], step), (self.high[i] - self.w[i], -step)] {
                if slack.is_finite() && step < 0.0 {
                    length = length.min(-boundary * slack / step);
                }
            }
        }
        length
    }
}
