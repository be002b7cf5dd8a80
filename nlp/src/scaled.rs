//! A program in units of its typical sizes.

use crate::blocks::{Blocks, Units, Values, Weights};
use crate::layout::Layout;
use crate::problem::StagedProblem;
use crate::scales::Scales;

/// The program that the algorithm works on: every unknown, row and the cost divided by its typical size.
///
/// ```text
/// f^ = f / s_f    c^_i = c_i / s_i    g^_j = g_j / s_j    d^_k = d_k / s_k
/// ```
pub(crate) struct Scaled<'a, P> {
    pub problem: &'a mut P,
    scaling: Scaling,
}

/// The typical sizes of a program, and room for what is scaled.
#[derive(Clone, Debug)]
pub(crate) struct Scaling {
    scales: Scales,
    is_plain: bool,
    /// Weights and a step of the program itself.
    equalities: Vec<f64>,
    ranges: Vec<f64>,
    step: Vec<f64>,
    units: Units,
}

/// Without entries: what a solver keeps while its room is lent.
impl Default for Scaling {
    fn default() -> Self {
        let none = Vec::new;
        Self {
            scales: Scales { cost: 1.0, steps: none(), equalities: none(), ranges: none() },
            is_plain: true,
            equalities: none(),
            ranges: none(),
            step: none(),
            units: Units::default(),
        }
    }
}

impl Scaling {
    pub fn new(layout: &Layout) -> Self {
        let scales = Scales::ones(layout);
        Self {
            is_plain: true,
            equalities: scales.equalities.clone(),
            ranges: scales.ranges.clone(),
            step: scales.steps.clone(),
            units: Units::ones(layout),
            scales,
        }
    }

    pub fn scales(&self) -> &Scales {
        &self.scales
    }

    /// Takes the sizes of a program with the same layout.
    pub fn take(&mut self, scales: Option<&Scales>) {
        self.is_plain = scales.is_none();
        let Scales { cost, steps, equalities, ranges } = &mut self.scales;
        match scales {
            Some(scales) => {
                *cost = scales.cost;
                let pairs =
                    [(steps, &scales.steps), (equalities, &scales.equalities), (ranges, &scales.ranges)];
                pairs.into_iter().for_each(|(to, from)| to.copy_from_slice(from));
            }
            None => {
                *cost = 1.0;
                [steps, equalities, ranges].into_iter().for_each(|to| to.fill(1.0));
            }
        }
        self.units.take(&self.scales);
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

    /// The other way round.
    pub fn scale(&self, equalities: &mut [f64], ranges: &mut [f64]) {
        let factor = self.scales.cost.recip();
        for (y, scale) in equalities.iter_mut().zip(&self.scales.equalities) {
            *y *= factor * scale;
        }
        for (v, scale) in ranges.iter_mut().zip(&self.scales.ranges) {
            *v *= factor * scale;
        }
    }

    /// The cost of the program itself.
    pub fn unscaled_cost(&self, cost: f64) -> f64 {
        cost * self.scales.cost
    }
}

impl<'a, P: StagedProblem> Scaled<'a, P> {
    /// With the sizes that were taken before.
    pub fn with(problem: &'a mut P, scaling: Scaling) -> Self {
        Self { problem, scaling }
    }

    /// The room, for later.
    pub fn into_scaling(self) -> Scaling {
        self.scaling
    }

    /// Bound of a range, the lower or the upper one.
    pub fn bound(&self, side: usize, row: usize) -> f64 {
        self.problem.bounds()[side][row] / self.scaling.scales.ranges[row]
    }

    /// The typical sizes.
    pub fn scales(&self) -> &Scales {
        &self.scaling.scales
    }

    /// Multipliers of the scaled program from those of the program itself.
    pub fn scale(&self, equalities: &mut [f64], ranges: &mut [f64]) {
        self.scaling.scale(equalities, ranges);
    }

    #[inline(never)]
    pub fn evaluate(&mut self, point: &[f64], values: &mut Values) -> Result<(), P::Error> {
        self.problem.evaluate(point, values)?;
        let Scaling { scales, is_plain, .. } = &self.scaling;
        if !is_plain {
            values.cost /= scales.cost;
            divide(&mut values.equalities, &scales.equalities);
            divide(&mut values.ranges, &scales.ranges);
        }
        Ok(())
    }

    /// Blocks for these weights of the scaled functions: derivatives of the program itself, and their units.
    #[inline(never)]
    pub fn linearise(
        &mut self,
        point: &[f64],
        weights: Weights<'_>,
        blocks: &mut Blocks,
    ) -> Result<(), P::Error> {
        blocks.fill_zero();
        blocks.units.copy_from(&self.scaling.units);
        let Self { problem, scaling: Scaling { units, equalities, ranges, .. } } = self;
        multiply(weights.equalities, &units.equalities, equalities);
        multiply(weights.ranges, &units.ranges, ranges);
        let weights = Weights { cost: weights.cost * units.cost, equalities, ranges };
        problem.linearise(point, weights, blocks)
    }

    /// Convex Hessians for the weights of the last derivatives, with this weight of the cost, if there are
    /// any.
    pub fn convexify(&mut self, point: &[f64], cost: f64, blocks: &mut Blocks) -> Result<bool, P::Error> {
        let Self { problem, scaling: Scaling { units, equalities, ranges, .. } } = self;
        let weights = Weights { cost: cost * units.cost, equalities, ranges };
        problem.convexify(point, weights, blocks)
    }

    /// Adds a multiple of the metric, over the scale of the cost.
    pub fn add_metric(&mut self, point: &[f64], factor: f64, blocks: &mut Blocks) -> Result<(), P::Error> {
        let factor = factor * self.scaling.units.cost;
        self.problem.add_metric(point, factor, blocks)
    }

    /// The size of unknown k, scaled, at least 1; 1 where a point has other entries than a step.
    pub fn size(&self, point: &[f64], k: usize) -> f64 {
        let steps = &self.scaling.scales.steps;
        if point.len() == steps.len() { (point[k] / steps[k]).abs().max(1.0) } else { 1.0 }
    }

    /// `moved = point (+) length step`, for a scaled step.
    pub fn retract(&mut self, point: &[f64], step: &[f64], length: f64, moved: &mut [f64]) {
        let Scaling { scales, step: unscaled, .. } = &mut self.scaling;
        for ((to, step), scale) in unscaled.iter_mut().zip(step).zip(&scales.steps) {
            *to = length * step * scale;
        }
        self.problem.retract(point, unscaled, moved);
    }
}

fn divide(values: &mut [f64], scales: &[f64]) {
    values.iter_mut().zip(scales).for_each(|(value, scale)| *value /= scale);
}

fn multiply(values: &[f64], factors: &[f64], to: &mut [f64]) {
    to.iter_mut().zip(values.iter().zip(factors)).for_each(|(to, (value, factor))| *to = value * factor);
}
