//! Steps of Cholesky factorisations: the tiles of `costate-control`.

#[path = "../../../../control/src/numerics/padded.rs"]
#[allow(dead_code, reason = "only what tiles need is used")]
mod padded;
#[path = "../../../../control/src/numerics/tiles.rs"]
#[allow(unused_imports, reason = "only symmetric factorisations are used")]
mod tiles;

use tiles::{BadPivot, ROWS, substitute_backward, substitute_forward, with_rows};

/// A pivot has the wrong sign.
#[derive(Clone, Copy, Debug)]
pub struct WrongSign;

/// Rows of a matrix and their length.
pub type Rows<'a> = (&'a [f64], usize);

/// U and U'^-1 of the rest of a block of rows, from its first columns, which are symmetric.
#[inline(always)]
pub fn factorise<const FUSED: bool>(rows: &mut [f64], stride: usize) -> Result<(), WrongSign> {
    tiles::factorise_rows::<FUSED>(rows, stride, rows.len() / stride, stride).map_err(|BadPivot| WrongSign)
}

/// Subtracts X'X, X the columns of `above` from `from`, from the upper triangle of the first columns of all
/// rows below.
#[inline(always)]
pub fn subtract<const FUSED: bool>(above: Rows<'_>, from: usize, below: (&mut [f64], usize), width: usize) {
    let size = below.0.len() / below.1;
    tiles::subtract_square::<FUSED>(above, from, below, size, width);
}

/// Adds it, to rows of this width.
#[inline(always)]
pub fn add<const FUSED: bool>(above: Rows<'_>, from: usize, below: (&mut [f64], usize)) {
    let width = below.1;
    negate(below.0);
    subtract::<FUSED>(above, from, (&mut *below.0, width), width);
    negate(below.0);
}

pub fn negate(rows: &mut [f64]) {
    rows.iter_mut().for_each(|entry| *entry = -*entry);
}

/// y of U'y = r in place, and the rest of r without the part of y.
#[inline(always)]
pub fn forward<const FUSED: bool>((rows, stride): Rows<'_>, r: &mut [f64]) {
    let size = rows.len() / stride;
    for i in (0..size).step_by(ROWS) {
        let (rows, r) = (&rows[i * stride..], &mut r[i..]);
        with_rows!(i of size, R => substitute_forward::<FUSED, R>(rows, stride, i, r));
    }
}

/// x of U x = y in place, where the rest of x is known.
#[inline(always)]
pub fn backward<const FUSED: bool>((rows, stride): Rows<'_>, x: &mut [f64]) {
    let size = rows.len() / stride;
    for i in (0..size).step_by(ROWS).rev() {
        let (rows, x) = (&rows[i * stride..], &mut x[i..]);
        with_rows!(i of size, R => substitute_backward::<FUSED, R>(rows, stride, i, x));
    }
}
