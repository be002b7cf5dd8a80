//! `C -= L U` on tiles of four rows and eight columns, whose sums stay in registers. As in
//! [`tiles`](super::tiles), all is compiled once for each kind of vectors.

use super::tiles::{ROWS, in_tiles, subtract, with_rows};
use costate_numerics::in_widest;
use std::ops::Range;

/// A tile minus the products of `factors`, one slice a row of the tile, and of columns from `j` of `from`.
#[inline(always)]
fn minus_products<const FUSED: bool, const R: usize, const C: usize>(
    mut tile: [[f64; C]; R],
    factors: [&[f64]; R],
    (from, stride): (&[f64], usize),
    j: usize,
) -> [[f64; C]; R] {
    for (k, row) in from.chunks_exact(stride).enumerate() {
        let mut entries = [0.0; C];
        entries.copy_from_slice(&row[j..j + C]);
        for (to, factors) in tile.iter_mut().zip(factors) {
            subtract::<FUSED, C>(to, factors[k], &entries);
        }
    }
    tile
}

/// The columns from `j` of `R` rows.
#[inline(always)]
fn load<const R: usize, const C: usize>(rows: &[f64], stride: usize, j: usize) -> [[f64; C]; R] {
    let mut tile = [[0.0; C]; R];
    for (tile, row) in tile.iter_mut().zip(rows.chunks_exact(stride)) {
        tile.copy_from_slice(&row[j..j + C]);
    }
    tile
}

#[inline(always)]
fn store<const R: usize, const C: usize>(tile: &[[f64; C]; R], rows: &mut [f64], stride: usize, j: usize) {
    for (tile, row) in tile.iter().zip(rows.chunks_exact_mut(stride)) {
        row[j..j + C].copy_from_slice(tile);
    }
}

/// `rows -= L above` in these columns, where L are the first columns of the rows themselves, as many as there
/// are rows above; all rows have the length `stride`.
#[inline(never)]
pub(super) fn subtract_own_products(rows: &mut [f64], above: &[f64], stride: usize, columns: Range<usize>) {
    if !above.is_empty() {
        in_widest!(own_panels(rows, above, stride, columns));
    }
}

#[inline(always)]
fn own_panels<const FUSED: bool>(rows: &mut [f64], above: &[f64], stride: usize, columns: Range<usize>) {
    let (count, known) = (rows.len() / stride, above.len() / stride);
    for i in (0..count).step_by(ROWS) {
        let panel = &mut rows[i * stride..];
        with_rows!(i of count, R => in_tiles!(columns.start, columns.end, j, C => {
            let factors: [&[f64]; R] = std::array::from_fn(|r| &panel[r * stride..][..known]);
            let tile = load::<R, C>(panel, stride, j);
            let tile = minus_products::<FUSED, R, C>(tile, factors, (above, stride), j);
            store(&tile, panel, stride, j);
        }));
    }
}

/// `to -= L from`, where L are the first columns of the rows of `left`; each with the length of its rows.
#[inline(never)]
pub(super) fn subtract_products(to: (&mut [f64], usize), left: (&[f64], usize), from: (&[f64], usize)) {
    if !from.0.is_empty() {
        in_widest!(panels(to, left, from));
    }
}

#[inline(always)]
fn panels<const FUSED: bool>(
    (to, width): (&mut [f64], usize),
    (left, left_stride): (&[f64], usize),
    (from, stride): (&[f64], usize),
) {
    let (count, known) = (to.len() / width, from.len() / stride);
    for i in (0..count).step_by(ROWS) {
        let (panel, left) = (&mut to[i * width..], &left[i * left_stride..]);
        with_rows!(i of count, R => in_tiles!(0, width, j, C => {
            let factors: [&[f64]; R] = std::array::from_fn(|r| &left[r * left_stride..][..known]);
            let tile = load::<R, C>(panel, width, j);
            let tile = minus_products::<FUSED, R, C>(tile, factors, (from, stride), j);
            store(&tile, panel, width, j);
        }));
    }
}
