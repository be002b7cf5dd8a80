//! A program in units of its typical sizes.

use crate::blocks::{Blocks, Units, Values, Weights};
use crate::problem::{Scales, StagedProblem};

/// The program that the algorithm works on: every unknown, row and the cost divided by its typical size.
///
/// ```text
/// f^ = f / s_f    c^_i = c_i / s_i    g^_j = g_j / s_j    d^_k = d_k / s_k
/// ```
pub(crate) struct Scaled<'a, P> {
    pub problem: &'a mut P,
    scales: Scales,
    is_plain: bool,
    /// Weights and a step of the program itself.
    equalities: Vec<f64>,
    ranges: Vec<f64>,
    step: Vec<f64>,
    units: Units,
}

impl<'a, P: StagedProblem> Scaled<'a, P> {
    pub fn new(problem: &'a mut P) -> Self {
        let layout = problem.layout();
        let (n, m, r) = (layout.steps(), layout.equalities(), layout.ranges());
        let is_plain = problem.scales().is_none();
        let scales = problem.scales().cloned().unwrap_or_else(|| Scales::ones(layout));
        let (equalities, ranges, step) = (vec![0.0; m], vec![0.0; r], vec![0.0; n]);
        let reciprocals = |scales: &[f64]| scales.iter().map(|scale| scale.recip()).collect();
        let units = Units {
            cost: scales.cost.recip(),
            steps: scales.steps.clone(),
            equalities: reciprocals(&scales.equalities),
            ranges: reciprocals(&scales.ranges),
        };
        Self { problem, scales, is_plain, equalities, ranges, step, units }
    }

    /// The bounds of the ranges.
    pub fn bounds(&self) -> [Vec<f64>; 2] {
        let scaled = |bounds: &[f64]| bounds.iter().zip(&self.scales.ranges).map(|(b, s)| b / s).collect();
        self.problem.bounds().map(scaled)
    }

    pub fn evaluate(&mut self, point: &[f64], values: &mut Values) -> Result<(), P::Error> {
        self.problem.evaluate(point, values)?;
        if !self.is_plain {
            values.cost /= self.scales.cost;
            divide(&mut values.equalities, &self.scales.equalities);
            divide(&mut values.ranges, &self.scales.ranges);
        }
        Ok(())
    }

    /// Blocks for these weights of the scaled functions: derivatives of the program itself, and their units.
    pub fn linearise(
        &mut self,
        point: &[f64],
        weights: Weights<'_>,
        blocks: &mut Blocks,
    ) -> Result<(), P::Error> {
        blocks.fill_zero();
        blocks.units.copy_from(&self.units);
        let Self { problem, units, equalities, ranges, .. } = self;
        multiply(weights.equalities, &units.equalities, equalities);
        multiply(weights.ranges, &units.ranges, ranges);
        let weights = Weights { cost: weights.cost * units.cost, equalities, ranges };
        problem.linearise(point, weights, blocks)
    }

    /// The size of unknown k, scaled, at least 1; 1 where a point has other entries than a step.
    pub fn size(&self, point: &[f64], k: usize) -> f64 {
        let steps = &self.scales.steps;
        if point.len() == steps.len() { (point[k] / steps[k]).abs().max(1.0) } else { 1.0 }
    }

    /// `moved = point (+) length step`, for a scaled step.
    pub fn retract(&mut self, point: &[f64], step: &[f64], length: f64, moved: &mut [f64]) {
        for ((to, step), scale) in self.step.iter_mut().zip(step).zip(&self.scales.steps) {
            *to = length * step * scale;
        }
        self.problem.retract(point, &self.step, moved);
    }

    /// Multipliers of the program itself from those of the scaled one: `y = y^ s_f / s_i`.
    pub fn unscale(&self, equalities: &mut [f64], ranges: &mut [f64]) {
        let factor = self.scales.cost;
        for (y, scale) in equalities.iter_mut().zip(&self.scales.equalities) {
            *y *= factor / scale;
        }
        for (v, scale) in ranges.iter_mut().zip(&self.scales.ranges) {
            *v *= factor / scale;
        }
    }

    /// The cost of the program itself.
    pub fn unscaled_cost(&self, cost: f64) -> f64 {
        cost * self.scales.cost
    }
}

fn divide(values: &mut [f64], scales: &[f64]) {
    values.iter_mut().zip(scales).for_each(|(value, scale)| *value /= scale);
}

fn multiply(values: &[f64], factors: &[f64], to: &mut [f64]) {
    to.iter_mut().zip(values.iter().zip(factors)).for_each(|(to, (value, factor))| *to = value * factor);
}
