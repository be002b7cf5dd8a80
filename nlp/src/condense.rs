//! The matrix of Newton's equations without slacks.
//!
//! $$ \begin{pmatrix} W + G_1^T \Sigma_1 G_1 & C^T & G_2^T \\\\ C & & \\\\ G_2 & & -\Sigma_2^{-1}
//! \end{pmatrix}, \qquad G_1^T \Sigma_1 G_1 = \sum_r (\sqrt{\sigma_r} g_r) (\sqrt{\sigma_r} g_r)^T $$
//!
//! Close to a solution the weights of ranges that are held are larger than W by more than the digits of a
//! number. Where there are equations these ranges are rows beside them, 2: of W less would be left than the
//! inertia needs. The others are squares, 1.
//!
//! Rows and columns are scaled, S K S, so that thresholds of pivots compare like with like: unknowns by the
//! roots of the diagonal, then other rows by their largest entries.

use crate::blocks::{Blocks, Units};
use crate::dense::Dense;
use crate::elements::{Jacobian, squares};
use crate::kkt::{Kept, Matrices};
use crate::layout::{Element, Layout, Rows};
use crate::tiles::{LANES, four, largest_number, scaled_product, scaled_products, update};
use crate::vectors::{largest_of, worse};
use costate_numerics::in_widest;

/// Ranges whose squares would be more than so many times as large as W are rows beside the equations: ten of
/// the sixteen digits of W are left in the sums.
const KEPT: f64 = 1e6;

/// Entries of the diagonal below this part of the largest one of W, or of 1, count as that in the scales: the
/// equations say how large steps of unknowns are that have none.
const LEAST_DIAGONAL: f64 = 1e-4;

/// The matrices of Newton's equations by element, in units of the scaled program.
#[derive(Clone, Debug)]
pub(crate) struct Condensed {
    /// Upper triangles of the Hessians with squares of ranges; rows are padded.
    pub hessians: Vec<Dense>,
    /// Jacobians of the equations.
    pub jacobians: Vec<Dense>,
    /// Ranges beside them.
    pub kept: Vec<Kept>,
    /// S: of the unknowns, of the equations, of the ranges.
    scales: Vec<f64>,
    /// Scales of the unknowns of one element.
    columns: Vec<f64>,
    /// Rows of one element times the square roots of their weights, padded.
    weighted: Vec<f64>,
    /// Weights of squares.
    weights: Vec<f64>,
    /// Sizes of steps of the unknowns of one element.
    sizes: Vec<f64>,
}

impl Condensed {
    /// Keeps at most so many ranges of each element.
    pub fn new(layout: &Layout, most_kept: impl Fn(Element) -> usize) -> Self {
        let padded = |element| layout.width(element).next_multiple_of(LANES);
        let most = |size: &dyn Fn(Element) -> usize| layout.elements().map(size).max().unwrap_or(0);
        let jacobian = |element| Dense::zeros(layout.rows(element).equalities, layout.width(element));
        let kept = |element| Kept::with_room(most_kept(element), layout.width(element));
        Self {
            hessians: squares(layout),
            jacobians: layout.elements().map(jacobian).collect(),
            kept: layout.elements().map(kept).collect(),
            scales: vec![1.0; layout.steps() + layout.equalities() + layout.ranges()],
            columns: vec![0.0; most(&padded)],
            weighted: vec![
                0.0;
                most(&|element| layout.rows(element).ranges.next_multiple_of(4) * padded(element))
            ],
            weights: vec![0.0; layout.ranges()],
            sizes: vec![0.0; most(&padded)],
        }
    }

    /// Most ranges of an element that an iteration keeps: as many as can be held at once.
    pub fn most_kept(layout: &Layout, element: Element) -> usize {
        let Rows { equalities, ranges } = layout.rows(element);
        let free = layout.width(element).saturating_sub(equalities);
        if layout.equalities() == 0 { 0 } else { ranges.min(free) }
    }

    /// Takes these blocks, with weights of the ranges.
    pub fn set(&mut self, layout: &Layout, blocks: &Blocks, weights: &[f64]) {
        in_widest!(self.set_all(layout, blocks, weights));
    }

    /// Takes these blocks, with ranges that are held exactly; the others have no effect.
    pub fn hold(&mut self, layout: &Layout, blocks: &Blocks, holds: impl Fn(usize) -> bool) {
        self.set_hessians(layout, blocks);
        self.set_jacobians(layout, blocks);
        for ((element, block), kept) in layout.elements().zip(blocks.all()).zip(&mut self.kept) {
            let columns = columns_of(layout, element, &blocks.units, &mut self.columns);
            let [_, ranges] = blocks.units.jacobians(layout, element, block);
            kept.clear();
            for (i, row) in layout.ranges_of(element).enumerate().filter(|(_, row)| holds(*row)) {
                keep(kept, number(layout, row), (ranges, i), columns, 0.0);
            }
        }
        // Curvature far below 1 is rounding.
        in_widest!(self.scale(layout, 1.0));
    }

    /// Takes the Jacobians of these blocks alone, for a matrix with ones in the place of W.
    pub fn set_for_ones(&mut self, layout: &Layout, blocks: &Blocks) {
        self.set_jacobians(layout, blocks);
        self.hessians.iter_mut().for_each(|hessian| hessian.entries_mut().fill(0.0));
        self.kept.iter_mut().for_each(Kept::clear);
        in_widest!(self.scale(layout, 1.0));
    }

    /// The matrices.
    pub fn matrices<'a>(&'a self) -> Matrices<'a, impl Fn(usize) -> &'a Dense> {
        Matrices {
            hessians: &self.hessians,
            jacobian: |element: usize| &self.jacobians[element],
            kept: &self.kept,
        }
    }

    /// How many ranges are rows.
    pub fn kept(&self) -> usize {
        self.kept.iter().map(|kept| kept.rows.len()).sum()
    }

    /// `x = S x`.
    pub fn scale_vector(&self, x: &mut [f64]) {
        x.iter_mut().zip(&self.scales).for_each(|(entry, scale)| *entry *= scale);
    }

    #[inline(always)]
    fn set_hessians(&mut self, layout: &Layout, blocks: &Blocks) {
        for ((element, block), to) in layout.elements().zip(blocks.all()).zip(&mut self.hessians) {
            let columns = columns_of(layout, element, &blocks.units, &mut self.columns);
            scale_hessian(&block.hessian, columns, to);
        }
    }

    #[inline(always)]
    fn set_jacobians(&mut self, layout: &Layout, blocks: &Blocks) {
        for ((element, block), to) in layout.elements().zip(blocks.all()).zip(&mut self.jacobians) {
            let columns = columns_of(layout, element, &blocks.units, &mut self.columns);
            let [equalities, _] = blocks.units.jacobians(layout, element, block);
            for (i, factor) in equalities.factors.iter().enumerate() {
                scaled_product(*factor, equalities.rows.row(i), columns, to.row_mut(i));
            }
        }
    }

    #[inline(always)]
    fn set_all<const FUSED: bool>(&mut self, layout: &Layout, blocks: &Blocks, weights: &[f64]) {
        self.set_hessians(layout, blocks);
        self.set_jacobians(layout, blocks);
        self.weights.copy_from_slice(weights);
        let least = (layout.equalities() > 0).then(|| self.keep_large(layout, blocks));
        let Self { hessians, columns, weighted, weights, .. } = self;
        for ((element, block), hessian) in layout.elements().zip(blocks.all()).zip(hessians) {
            let columns = columns_of(layout, element, &blocks.units, columns);
            let [_, ranges] = blocks.units.jacobians(layout, element, block);
            add_squares::<FUSED>(hessian, (&weights[layout.ranges_of(element)], ranges), columns, weighted);
        }
        if let Some(least) = least {
            self.scale::<FUSED>(layout, least);
        }
    }

    /// Keeps ranges whose squares would be large beside W, but for those of one unknown: they are entries of
    /// the diagonal. Returns the least entry of the diagonal that counts.
    #[inline(always)]
    fn keep_large(&mut self, layout: &Layout, blocks: &Blocks) -> f64 {
        let Self { hessians, kept, columns, weights, scales, sizes, .. } = self;
        let scales = &mut scales[..layout.steps()];
        set_diagonal(layout, hessians, scales);
        let least = LEAST_DIAGONAL * largest_number(scales).max(1.0);
        set_reciprocal_roots(scales, least);
        for ((element, block), kept) in layout.elements().zip(blocks.all()).zip(kept) {
            kept.clear();
            let columns = columns_of(layout, element, &blocks.units, columns);
            let [_, ranges] = blocks.units.jacobians(layout, element, block);
            let (first, most) = (layout.ranges_of(element).start, Self::most_kept(layout, element));
            let mut offer = |i: usize, largest: f64| {
                let entry = ranges.factors[i] * largest;
                let weight = &mut weights[first + i];
                if kept.rows.len() < most && *weight * entry * entry > KEPT {
                    keep(kept, number(layout, first + i), (ranges, i), columns, -weight.recip());
                    *weight = 0.0;
                }
            };
            let sizes = entries_of(layout, element, scales, sizes);
            sizes.iter_mut().zip(&*columns).for_each(|(size, column)| *size *= column);
            for (i, entries) in ranges.pattern.sparse().filter(|(_, entries)| entries.len() > 1) {
                offer(i, entries.iter().fold(0.0, |most, &(j, entry)| worse(most, (sizes[j] * entry).abs())));
            }
            for &i in &ranges.pattern.dense {
                offer(i, largest_of([ranges.rows.row(i), sizes], |[entry, size]| (entry * size).abs()));
            }
        }
        least
    }

    /// Scales all matrices; entries of the diagonal count at least as this.
    #[inline(always)]
    fn scale<const FUSED: bool>(&mut self, layout: &Layout, least: f64) {
        let Self { hessians, jacobians, kept, scales, columns, .. } = self;
        let (steps, rows) = scales.split_at_mut(layout.steps());
        set_diagonal(layout, hessians, steps);
        set_reciprocal_roots(steps, least);
        let matrices = hessians.iter_mut().zip(jacobians).zip(kept);
        for (element, ((hessian, jacobian), kept)) in layout.elements().zip(matrices) {
            let columns = entries_of(layout, element, steps, columns);
            for i in 0..columns.len() {
                let factor = columns[i];
                scale_row(&mut hessian.row_mut(i)[i..columns.len()], factor, &columns[i..]);
            }
            for (i, row) in layout.equalities_of(element).enumerate() {
                rows[row] = scale_to_one(jacobian.row_mut(i), 0.0, columns);
            }
            let all = kept.entries.chunks_exact_mut(columns.len().max(1));
            for ((row, entries), diagonal) in kept.rows.iter().zip(all).zip(&mut kept.diagonal) {
                let scale = scale_to_one(entries, *diagonal, columns);
                rows[row - layout.steps()] = scale;
                *diagonal *= scale * scale;
            }
        }
    }
}

/// The diagonal of the sum of all Hessians.
#[inline(always)]
fn set_diagonal(layout: &Layout, hessians: &[Dense], to: &mut [f64]) {
    to.fill(0.0);
    for (element, hessian) in layout.elements().zip(hessians) {
        for (i, row) in layout.unknowns(element).into_iter().flatten().enumerate() {
            to[row] += hessian[(i, i)];
        }
    }
}

/// Sets sizes to the reciprocals of their roots, smaller ones as this least one; 1 where that is no number.
#[inline(always)]
fn set_reciprocal_roots(sizes: &mut [f64], least: f64) {
    for size in sizes {
        let root = size.abs().max(least).sqrt().recip();
        *size = if root > 0.0 && root < f64::INFINITY { root } else { 1.0 };
    }
}

/// The number of a range among the rows of Newton's equations.
pub(crate) fn number(layout: &Layout, range: usize) -> usize {
    layout.steps() + layout.equalities() + range
}

/// Adds a range, in these units.
#[inline(always)]
fn keep(kept: &mut Kept, number: usize, (ranges, i): (Jacobian<'_>, usize), columns: &[f64], diagonal: f64) {
    kept.rows.push(number);
    kept.diagonal.push(diagonal);
    let entries = ranges.rows.row(i).iter().zip(columns);
    kept.entries.extend(entries.map(|(entry, column)| ranges.factors[i] * entry * column));
}

/// Multiplies entries by those of their columns, and by a factor.
#[inline(always)]
fn scale_row(row: &mut [f64], factor: f64, columns: &[f64]) {
    row.iter_mut().zip(columns).for_each(|(entry, column)| *entry *= factor * column);
}

/// Scales a row with this entry on the diagonal so that its largest entry is 1; returns the factor.
#[inline(always)]
fn scale_to_one(row: &mut [f64], diagonal: f64, columns: &[f64]) -> f64 {
    scale_row(row, 1.0, columns);
    let size = largest_number(row).max(diagonal.abs().sqrt());
    let factor = if size > 0.0 && size < f64::INFINITY { size.recip() } else { 1.0 };
    row.iter_mut().for_each(|entry| *entry *= factor);
    factor
}

/// The scales of the unknowns of an element.
#[inline(always)]
fn columns_of<'a>(layout: &Layout, element: Element, units: &Units, to: &'a mut [f64]) -> &'a mut [f64] {
    entries_of(layout, element, &units.steps, to)
}

/// The entries of a vector that belong to the unknowns of an element.
#[inline(always)]
fn entries_of<'a>(layout: &Layout, element: Element, from: &[f64], to: &'a mut [f64]) -> &'a mut [f64] {
    let mut at = 0;
    for range in layout.unknowns(element) {
        let from = &from[range];
        to[at..at + from.len()].copy_from_slice(from);
        at += from.len();
    }
    &mut to[..at]
}

/// The upper triangle of a Hessian in these units, with padded rows.
#[inline(always)]
fn scale_hessian(hessian: &Dense, columns: &[f64], to: &mut Dense) {
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

    /// Of scaled rows the largest entry is 1, and that of unknowns on the diagonal.
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
            let rows = [&mut block.equalities, &mut block.ranges];
            rows.into_iter().flat_map(|rows| rows.entries_mut()).for_each(|entry| *entry = number());
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
            let mut condensed = Condensed::new(&layout, |_| 0);
            condensed.set(&layout, &blocks, &weights);
            let row = condensed.jacobians[0].row(0);
            assert!((row.iter().fold(0.0_f64, |most, entry| most.max(entry.abs())) - 1.0).abs() < 1e-15);
            let (block, units) = (&blocks.all()[0], &blocks.units);
            for i in 0..width {
                for j in i..width {
                    let mut sum = block.hessian[(i, j)];
                    for (r, weight) in weights.iter().enumerate() {
                        let factor = weight * units.ranges[r] * units.ranges[r];
                        sum += factor * block.ranges[(r, i)] * block.ranges[(r, j)];
                    }
                    sum *= units.steps[i] * units.steps[j] * condensed.scales[i] * condensed.scales[j];
                    assert!((condensed.hessians[0][(i, j)] - sum).abs() < 1e-13, "{width}: {i} {j}");
                }
            }
        }
    }
}
