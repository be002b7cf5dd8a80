//! A program in units of its typical sizes.

use crate::blocks::{Block, Blocks, Dense, Values, Weights};
use crate::elements::Pattern;
use crate::problem::{Scales, StagedProblem};
use costate_numerics::in_widest;

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
    /// Scales of the unknowns of an element.
    columns: Vec<f64>,
}

impl<'a, P: StagedProblem> Scaled<'a, P> {
    pub fn new(problem: &'a mut P) -> Self {
        let layout = problem.layout();
        let (n, m, r) = (layout.steps(), layout.equalities(), layout.ranges());
        let is_plain = problem.scales().is_none();
        let scales = problem.scales().cloned().unwrap_or_else(|| Scales::ones(layout));
        let (equalities, ranges, step) = (vec![0.0; m], vec![0.0; r], vec![0.0; n]);
        let columns = Vec::with_capacity(layout.steps());
        Self { problem, scales, is_plain, equalities, ranges, step, columns }
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

    /// Blocks for these weights of the scaled functions.
    pub fn linearise(
        &mut self,
        point: &[f64],
        weights: Weights<'_>,
        blocks: &mut Blocks,
    ) -> Result<(), P::Error> {
        blocks.fill_zero();
        if self.is_plain {
            self.problem.linearise(point, weights, blocks)?;
            blocks.all_mut().iter_mut().for_each(note_patterns);
            return Ok(());
        }
        let Self { problem, scales, equalities, ranges, .. } = self;
        equalities.copy_from_slice(weights.equalities);
        ranges.copy_from_slice(weights.ranges);
        divide(equalities, &scales.equalities);
        divide(ranges, &scales.ranges);
        let weights = Weights { cost: weights.cost / scales.cost, equalities, ranges };
        problem.linearise(point, weights, blocks)?;
        in_widest!(self.scale(blocks));
        Ok(())
    }

    #[inline(always)]
    fn scale<const FUSED: bool>(&mut self, blocks: &mut Blocks) {
        let Self { problem, scales, columns, .. } = self;
        let layout = problem.layout();
        for (element, block) in layout.elements().zip(blocks.all_mut()) {
            columns.clear();
            for range in layout.unknowns(element) {
                columns.extend_from_slice(&scales.steps[range]);
            }
            multiply(&mut block.gradient, scales.cost.recip(), columns);
            for (i, &scale) in columns.iter().enumerate() {
                multiply(&mut block.hessian.row_mut(i)[i..], scale, &columns[i..]);
            }
            let Block { equalities, equality_pattern, ranges, range_pattern, .. } = block;
            let of_equalities = &scales.equalities[layout.equalities_of(element)];
            let of_ranges = &scales.ranges[layout.ranges_of(element)];
            scale_rows(equalities, of_equalities, columns, equality_pattern);
            scale_rows(ranges, of_ranges, columns, range_pattern);
        }
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

#[inline(always)]
fn multiply(row: &mut [f64], factor: f64, columns: &[f64]) {
    row.iter_mut().zip(columns).for_each(|(entry, scale)| *entry *= factor * scale);
}

#[inline(always)]
fn scale_rows(rows: &mut Dense, scales: &[f64], columns: &[f64], pattern: &mut Pattern) {
    pattern.clear();
    for (i, scale) in scales.iter().enumerate() {
        let (row, factor) = (rows.row_mut(i), scale.recip());
        let mut count = 0_u64;
        for (entry, scale) in row.iter_mut().zip(columns) {
            count += u64::from(*entry != 0.0);
            *entry *= factor * scale;
        }
        pattern.push(row, count);
    }
}

fn note_patterns(block: &mut Block) {
    let Block { equalities, equality_pattern, ranges, range_pattern, .. } = block;
    for (rows, pattern) in [(equalities, equality_pattern), (ranges, range_pattern)] {
        pattern.clear();
        for i in 0..rows.rows() {
            let row = rows.row(i);
            pattern.push(row, row.iter().map(|&entry| u64::from(entry != 0.0)).sum());
        }
    }
}
