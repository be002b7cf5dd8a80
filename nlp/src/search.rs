//! The line search along a step, with second-order corrections.

use crate::barrier::{barrier_residuals, longest_steps, slope};
use crate::elements::gather;
use crate::filter::{Acceptance, Measure};
use crate::newton::Accuracy;
use crate::outcome::SolveError;
use crate::problem::StagedProblem;
use crate::scaled::Scaled;
use crate::solve::Solver;
use crate::vectors::move_along;

/// Steps shorter than this, relative to the point, are rounding.
const TINY: f64 = 10.0 * f64::EPSILON;

impl Solver {
    /// Whether the step is rounding.
    pub(crate) fn is_tiny<P: StagedProblem>(&self, problem: &Scaled<'_, P>) -> bool {
        let Self { step, iterate, .. } = self;
        let of_slacks =
            step.slacks.iter().zip(&iterate.slacks).all(|(d, s)| d.abs() <= TINY * (1.0 + s.abs()));
        of_slacks && step.x.iter().enumerate().all(|(k, d)| d.abs() <= TINY * problem.size(&iterate.point, k))
    }

    /// The derivative of the objective of the barrier problem along the step.
    pub(crate) fn slope(&mut self, mu: f64) -> f64 {
        let Self { layout, blocks, newton, room, step, .. } = self;
        let mut sum = slope(newton.reciprocals(), step, mu);
        for (element, block) in layout.elements().zip(blocks.all()) {
            let (d, ..) = room.of(block.gradient.len());
            gather(layout, element, (&step.x, &blocks.units.steps), d);
            let products = block.gradient.iter().zip(d).map(|(slope, d)| slope * *d);
            sum += blocks.units.cost * products.sum::<f64>();
        }
        sum
    }

    /// Shortens the step until the filter accepts the trial point: the length of the step then.
    pub(crate) fn search<P: StagedProblem>(
        &mut self,
        problem: &mut Scaled<'_, P>,
        (mu, tau): (f64, f64),
    ) -> Result<Option<f64>, SolveError<P::Error>> {
        let current = Measure::of(&self.iterate);
        let slope = self.slope(mu);
        let [longest, of_multipliers] =
            longest_steps(&self.iterate, self.newton.reciprocals(), &self.step, tau);
        let least = self.filter.least_length(current.violation, slope);
        let mut alpha = longest;
        let mut is_first = true;
        loop {
            self.try_step(problem, false, alpha)?;
            let trial = Measure::of(&self.trial);
            if let Some(accepted) = self.filter.judge([current, trial], mu, (alpha, slope)) {
                self.accept(accepted, current, (alpha, slope));
                self.move_multipliers(false, (alpha, of_multipliers));
                self.newton.adapt(alpha / longest);
                return Ok(Some(alpha));
            }
            if is_first
                && trial.violation >= current.violation
                && let Some(length) = self.correct(problem, (current, trial), (mu, tau, alpha, slope))?
            {
                self.newton.adapt((length / longest).min(1.0));
                return Ok(Some(length));
            }
            is_first = false;
            alpha *= 0.5;
            if alpha < least.max(f64::EPSILON) {
                self.newton.adapt(0.0);
                return Ok(None);
            }
        }
    }

    /// Second-order corrections of a step of length alpha: Waechter and Biegler 2006, section 2.4.
    fn correct<P: StagedProblem>(
        &mut self,
        problem: &mut Scaled<'_, P>,
        (current, trial): (Measure, Measure),
        (mu, tau, mut alpha, slope): (f64, f64, f64, f64),
    ) -> Result<Option<f64>, SolveError<P::Error>> {
        let (factor, most) = self.settings.filter.correction;
        let first = alpha;
        let mut violation = trial.violation;
        self.corrected.copy_from(&self.residuals);
        barrier_residuals(&self.iterate, self.newton.reciprocals(), &self.targets, &mut self.corrected);
        for _ in 0..most {
            if !violation.is_finite() {
                break;
            }
            let Self { layout, iterate, trial, blocks, corrected, newton, correction, targets, .. } = self;
            for (to, c) in corrected.equalities.iter_mut().zip(&trial.values.equalities) {
                *to = alpha * *to + c;
            }
            for (i, to) in corrected.ranges.iter_mut().enumerate() {
                *to = alpha * *to + trial.values.ranges[i] - trial.slacks[i];
            }
            if newton
                .step(layout, iterate, blocks, (corrected, targets), (Accuracy::Refined, correction))
                .is_err()
            {
                break;
            }
            let [longest, of_multipliers] = longest_steps(iterate, newton.reciprocals(), correction, tau);
            alpha = longest;
            self.try_step(problem, true, alpha)?;
            let measure = Measure::of(&self.trial);
            if let Some(accepted) = self.filter.judge([current, measure], mu, (first, slope)) {
                self.accept(accepted, current, (first, slope));
                self.move_multipliers(true, (alpha, of_multipliers));
                return Ok(Some(alpha));
            }
            if measure.violation > factor * violation {
                break;
            }
            violation = measure.violation;
        }
        Ok(None)
    }

    /// The point and slacks at a length along the step, or along its correction.
    fn try_step<P: StagedProblem>(
        &mut self,
        problem: &mut Scaled<'_, P>,
        is_corrected: bool,
        alpha: f64,
    ) -> Result<(), SolveError<P::Error>> {
        let Self { iterate, trial, step, correction, bounds, .. } = self;
        let step = if is_corrected { correction } else { step };
        problem.retract(&iterate.point, &step.x, alpha, &mut trial.point);
        move_along(&mut trial.slacks, &iterate.slacks, &step.slacks, alpha);
        for (side, alpha) in [(0, alpha), (1, -alpha)] {
            move_along(&mut trial.gaps[side], &iterate.gaps[side], &step.slacks, alpha);
        }
        trial.settle(bounds);
        Ok(problem.evaluate(&trial.point, &mut trial.values)?)
    }

    /// Multipliers of the trial point.
    fn move_multipliers(&mut self, is_corrected: bool, (alpha, of_bounds): (f64, f64)) {
        let Self { iterate, trial, step, correction, .. } = self;
        let step = if is_corrected { correction } else { step };
        move_along(&mut trial.y, &iterate.y, &step.y, alpha);
        move_along(&mut trial.v, &iterate.v, &step.v, alpha);
        for side in 0..2 {
            move_along(&mut trial.z[side], &iterate.z[side], &step.z[side], of_bounds);
        }
    }

    /// Notes the current iterate in the filter unless the objective decided.
    fn accept(&mut self, accepted: Acceptance, current: Measure, (alpha, slope): (f64, f64)) {
        if accepted == Acceptance::Either || !self.filter.switches(current.violation, alpha, slope) {
            self.filter.add(current);
        }
    }
}
