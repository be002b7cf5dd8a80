//! Solutions of U'y = r and U x = y on tiles of U, whose diagonal has the reciprocals of its entries.

use super::padded::multiply_add;
use super::tiles::{ROWS, Tile, in_tiles, part, subtract, with_rows};
use costate_numerics::in_widest;

/// y of U'y = r for the rows of a block, in place, and the rest of r without their part.
#[inline(never)]
pub(super) fn forward(rows: &[f64], stride: usize, r: &mut [f64]) {
    in_widest!(forward_panels(rows, stride, r));
}

#[inline(always)]
fn forward_panels<const FUSED: bool>(rows: &[f64], stride: usize, r: &mut [f64]) {
    let size = rows.len() / stride;
    for i in (0..size).step_by(ROWS) {
        let (rows, r) = (&rows[i * stride..], &mut r[i..]);
        with_rows!(i of size, R => substitute_forward::<FUSED, R>(rows, stride, i, r));
    }
}

/// The same for the first `R` entries of r; `rows` are those of U from the diagonal on.
#[inline(always)]
fn substitute_forward<const FUSED: bool, const R: usize>(
    rows: &[f64],
    stride: usize,
    i: usize,
    r: &mut [f64],
) {
    let corner = Tile::<R, R>::load(rows, stride, i).0;
    let mut y = part::<R>(r, 0);
    for k in 0..R {
        y[k] *= corner[k][k];
        for l in k + 1..R {
            y[l] = multiply_add::<FUSED>(-corner[k][l], y[k], y[l]);
        }
    }
    r[..R].copy_from_slice(&y);
    in_tiles!(R, r.len(), j, C => {
        let tile = Tile::<R, C>::load(rows, stride, i + j);
        let mut right = part::<C>(r, j);
        for (y, row) in y.into_iter().zip(&tile.0) {
            subtract::<FUSED, C>(&mut right, y, row);
        }
        r[j..j + C].copy_from_slice(&right);
    });
}

/// x of U x = y for the rows of a block, in place, where the rest of x is known.
#[inline(never)]
pub(super) fn backward(rows: &[f64], stride: usize, r: &mut [f64]) {
    in_widest!(backward_panels(rows, stride, r));
}

#[inline(always)]
fn backward_panels<const FUSED: bool>(rows: &[f64], stride: usize, r: &mut [f64]) {
    let size = rows.len() / stride;
    for i in (0..size).step_by(ROWS).rev() {
        let (rows, r) = (&rows[i * stride..], &mut r[i..]);
        with_rows!(i of size, R => substitute_backward::<FUSED, R>(rows, stride, i, r));
    }
}

/// The first `R` entries of x of U x = y, where the others are known.
#[inline(always)]
fn substitute_backward<const FUSED: bool, const R: usize>(
    rows: &[f64],
    stride: usize,
    i: usize,
    x: &mut [f64],
) {
    let mut sums = [[0.0; 8]; R];
    in_tiles!(R, x.len(), j, C => {
        let (tile, right) = (Tile::<R, C>::load(rows, stride, i + j), part::<C>(x, j));
        for (sums, row) in sums.iter_mut().zip(&tile.0) {
            for c in 0..C {
                sums[c] = multiply_add::<FUSED>(row[c], right[c], sums[c]);
            }
        }
    });
    let corner = Tile::<R, R>::load(rows, stride, i).0;
    for k in (0..R).rev() {
        let [a, b, c, d, e, f, g, h] = sums[k];
        let mut rest = x[k] - (((a + b) + (c + d)) + ((e + f) + (g + h)));
        for l in k + 1..R {
            rest = multiply_add::<FUSED>(-corner[k][l], x[l], rest);
        }
        x[k] = rest * corner[k][k];
    }
}
