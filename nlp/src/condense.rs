//! Hessians with the curvature of ranges.
//!
//! $$ W + G^T \Sigma G = W + \sum_r (\sqrt{\sigma_r} g_r) (\sqrt{\sigma_r} g_r)^T $$

use crate::blocks::{Blocks, Units};
use crate::dense::Dense;
use crate::elements::{Jacobian, squares};
use crate::layout::{Element, Layout};
use crate::tiles::{LANES, four, scaled_product, scaled_products, update};
use costate_numerics::in_widest;

/// The matrices of Newton's equations by element, in units of the scaled program.
#[derive(Clone, Debug)]
pub(crate) struct Condensed {
    /// Upper triangles of `W + G' Sigma G`, times a factor; rows are padded.
    pub hessians: Vec<Dense>,
    /// Jacobians of the equations.
    pub jacobians: Vec<Dense>,
    /// Scales of the unknowns of one element.
    columns: Vec<f64>,
    /// Rows of one element times the square roots of their weights, padded.
    weighted: Vec<f64>,
}

impl Condensed {
    pub fn new(layout: &Layout) -> Self {
        let padded = |element| layout.width(element).next_multiple_of(LANES);
        let most = |size: &dyn Fn(Element) -> usize| layout.elements().map(size).max().unwrap_or(0);
        let jacobian = |element| Dense::zeros(layout.rows(element).equalities, layout.width(element));
        Self {
            hessians: squares(layout),
            jacobians: layout.elements().map(jacobian).collect(),
            columns: vec![0.0; most(&padded)],
            weighted: vec![
                0.0;
                most(&|element| layout.rows(element).ranges.next_multiple_of(4) * padded(element))
            ],
        }
    }

    /// Takes these blocks, with weights of the ranges; the Hessians times this factor.
    pub fn set(&mut self, layout: &Layout, blocks: &Blocks, weights: &[f64], factor: f64) {
        in_widest!(self.set_all(layout, blocks, weights, factor));
    }

    /// Takes the Jacobians of these blocks. The Hessians become zero.
    pub fn set_jacobians(&mut self, layout: &Layout, blocks: &Blocks) {
        for ((element, block), to) in layout.elements().zip(blocks.all()).zip(&mut self.jacobians) {
            let columns = columns_of(layout, element, &blocks.units, &mut self.columns);
            let [equalities, _] = blocks.units.jacobians(layout, element, block);
            scale_jacobian(equalities, columns, to);
        }
        self.hessians.iter_mut().for_each(|hessian| hessian.entries_mut().fill(0.0));
    }

    #[inline(always)]
    fn set_all<const FUSED: bool>(&mut self, layout: &Layout, blocks: &Blocks, weights: &[f64], factor: f64) {
        let Self { hessians, jacobians, columns, weighted } = self;
        let root = factor.sqrt();
        let to = hessians.iter_mut().zip(jacobians);
        for ((element, block), (hessian, jacobian)) in layout.elements().zip(blocks.all()).zip(to) {
            let columns = columns_of(layout, element, &blocks.units, columns);
            let [equalities, ranges] = blocks.units.jacobians(layout, element, block);
            scale_jacobian(equalities, columns, jacobian);
            columns.iter_mut().for_each(|column| *column *= root);
            scale_hessian(&block.hessian, columns, hessian);
            add_squares::<FUSED>(hessian, (&weights[layout.ranges_of(element)], ranges), columns, weighted);
        }
    }
}

/// The scales of the unknowns of an element.
#[inline(always)]
pub(crate) fn columns_of<'a>(
    layout: &Layout,
    element: Element,
    units: &Units,
    to: &'a mut [f64],
) -> &'a mut [f64] {
    let mut at = 0;
    for range in layout.unknowns(element) {
        let from = &units.steps[range];
        to[at..at + from.len()].copy_from_slice(from);
        at += from.len();
    }
    &mut to[..at]
}

/// The upper triangle of a Hessian in these units, with padded rows.
#[inline(always)]
pub(crate) fn scale_hessian(hessian: &Dense, columns: &[f64], to: &mut Dense) {
    let (n, stride) = (columns.len(), to.columns());
    let whole = n / 4 * 4;
    for i in (0..whole).step_by(4) {
        // Of the square on the diagonal both triangles.
        let rows = four(|r| &hessian.row(i + r)[i..]);
        let factors = four(|r| columns[i + r]);
        scaled_products(factors, rows, &columns[i..], &mut to.entries_mut()[i * stride + i..], stride);
    }
    for i in whole..n {
        scaled_product(columns[i], &hessian.row(i)[i..], &columns[i..], &mut to.row_mut(i)[i..]);
    }
}

#[inline(always)]
fn scale_jacobian(Jacobian { rows, factors, .. }: Jacobian<'_>, columns: &[f64], to: &mut Dense) {
    for (i, factor) in factors.iter().enumerate() {
        scaled_product(*factor, rows.row(i), columns, to.row_mut(i));
    }
}

/// Adds `G' Sigma G` to the upper triangle.
#[inline(always)]
fn add_squares<const FUSED: bool>(
    hessian: &mut Dense,
    (weights, Jacobian { rows, pattern, factors }): (&[f64], Jacobian<'_>),
    columns: &[f64],
    weighted: &mut [f64],
) {
    for (row, entries) in pattern.sparse() {
        let scaled = |(column, entry): (usize, f64)| factors[row] * columns[column] * entry;
        for (at, &first) in entries.iter().enumerate() {
            let (factor, to) = (weights[row] * scaled(first), hessian.row_mut(first.0));
            entries[at..].iter().for_each(|&second| to[second.0] += factor * scaled(second));
        }
    }
    let (stride, count) = (hessian.columns(), pattern.dense.len());
    if count == 0 || stride == 0 {
        return;
    }
    for (to, places) in weighted.chunks_mut(4 * stride).zip(pattern.fours()) {
        let factors = four(|r| weights[places[r]].sqrt() * factors[places[r]]);
        // Padding, and entries that are set next.
        for row in to.chunks_exact_mut(stride) {
            if let Some(last) = row.last_chunk_mut::<LANES>() {
                *last = [0.0; LANES];
            }
        }
        scaled_products(factors, four(|r| rows.row(places[r])), columns, to, stride);
    }
    let weighted = &weighted[..count * stride];
    let (size, mut j) = (columns.len(), 0);
    while j < size {
        let to = &mut hessian.entries_mut()[j * stride..];
        j += update::<FUSED, true>((weighted, weighted), to, stride, (j, size - j), j / LANES * LANES);
    }
}

#[cfg(test)]
mod tests {
    use super::Condensed;
    use crate::blocks::Blocks;
    use crate::layout::{Element, Layout, Rows};

    #[test]
    fn condensed_hessians_are_those_of_all_entries() {
        let mut random = fastrand::Rng::with_seed(3);
        let mut number = || random.f64() - 0.5;
        for width in 1..36 {
            let ranges = width % 11;
            let layout =
                Layout::new(vec![width], vec![], 0).with_rows(Element::Node(0), Rows::new(1, ranges));
            let mut blocks = Blocks::new(&layout);
            blocks.units.steps.iter_mut().for_each(|step| *step = 1.0 + number());
            blocks.units.ranges.iter_mut().for_each(|scale| *scale = 1.0 + number());
            let block = blocks.of(Element::Node(0));
            block.hessian.entries_mut().iter_mut().for_each(|entry| *entry = number());
            block.ranges.entries_mut().iter_mut().for_each(|entry| *entry = number());
            // One entry, and three.
            for (row, count) in [(1, 1), (2, 3)] {
                if row < ranges {
                    block.ranges.row_mut(row).fill(0.0);
                    (0..count).for_each(|at| {
                        block.ranges[(row, (at * width / 3).max(width / 7))] = 2.0 + at as f64
                    });
                }
            }
            block.set_patterns();
            let weights: Vec<f64> = (0..ranges).map(|_| 1.0 + number()).collect();
            let mut condensed = Condensed::new(&layout);
            condensed.set(&layout, &blocks, &weights, 0.7);
            let (block, units) = (&blocks.all()[0], &blocks.units);
            for i in 0..width {
                for j in i..width {
                    let mut sum = block.hessian[(i, j)];
                    for (r, weight) in weights.iter().enumerate() {
                        let factor = weight * units.ranges[r] * units.ranges[r];
                        sum += factor * block.ranges[(r, i)] * block.ranges[(r, j)];
                    }
                    sum *= 0.7 * units.steps[i] * units.steps[j];
                    assert!((condensed.hessians[0][(i, j)] - sum).abs() < 1e-13, "{width}: {i} {j}");
                }
            }
        }
    }
}
