//! Hessians with the curvature of ranges.
//!
//! $$ W + G^T \Sigma G = W + \sum_r (\sqrt{\sigma_r} g_r) (\sqrt{\sigma_r} g_r)^T $$

use crate::blocks::{Block, Blocks, Dense};
use crate::elements::squares;
use crate::layout::Layout;
use crate::tiles::{LANES, update};
use costate_numerics::in_widest;

/// `W + G' Sigma G` by element.
#[derive(Clone, Debug)]
pub(crate) struct Condensed {
    /// Upper triangles; rows are padded.
    pub hessians: Vec<Dense>,
    /// Rows of one element times the square roots of their weights, padded.
    weighted: Vec<f64>,
}

impl Condensed {
    pub fn new(layout: &Layout) -> Self {
        let size = |element| layout.rows(element).ranges * layout.width(element).next_multiple_of(LANES);
        let most = layout.elements().map(size).max().unwrap_or(0);
        Self { hessians: squares(layout), weighted: vec![0.0; most] }
    }

    /// Takes the Hessians of these blocks, for these weights of the ranges.
    pub fn set(&mut self, layout: &Layout, blocks: &Blocks, weights: &[f64]) {
        in_widest!(self.set_all(layout, blocks, weights));
    }

    #[inline(always)]
    fn set_all<const FUSED: bool>(&mut self, layout: &Layout, blocks: &Blocks, weights: &[f64]) {
        for ((element, block), hessian) in layout.elements().zip(blocks.all()).zip(&mut self.hessians) {
            for i in 0..block.hessian.columns() {
                let row = &block.hessian.row(i)[i..];
                hessian.row_mut(i)[i..i + row.len()].copy_from_slice(row);
            }
            add_squares::<FUSED>(hessian, &weights[layout.ranges_of(element)], block, &mut self.weighted);
        }
    }
}

/// Adds `G' Sigma G` to the upper triangle.
#[inline(always)]
fn add_squares<const FUSED: bool>(
    hessian: &mut Dense,
    weights: &[f64],
    Block { ranges, range_pattern: pattern, .. }: &Block,
    weighted: &mut [f64],
) {
    for &[row, column] in &pattern.single {
        let entry = ranges[(row, column)];
        hessian[(column, column)] += weights[row] * entry * entry;
    }
    let (stride, count) = (hessian.columns(), pattern.dense.len());
    if count == 0 || stride == 0 {
        return;
    }
    let weighted = &mut weighted[..count * stride];
    for (to, &row) in weighted.chunks_exact_mut(stride).zip(&pattern.dense) {
        let (root, from) = (weights[row].sqrt(), ranges.row(row));
        let (to, padding) = to.split_at_mut(from.len());
        to.iter_mut().zip(from).for_each(|(to, from)| *to = root * from);
        padding.fill(0.0);
    }
    let (size, mut j) = (ranges.columns(), 0);
    while j < size {
        let to = &mut hessian.entries_mut()[j * stride..];
        j += update::<FUSED, true>((weighted, weighted), to, stride, (j, size - j), j / LANES * LANES);
    }
}
