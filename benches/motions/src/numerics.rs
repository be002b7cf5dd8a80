//! Steps of Cholesky factorisations, and what they need of the linear algebra of `costate-control`.

#[path = "../../../control/src/numerics/padded.rs"]
#[allow(dead_code, reason = "only what tiles need is used")]
mod padded;
#[path = "../../../control/src/numerics/substitution.rs"]
mod substitution;
#[path = "../../../control/src/numerics/tiles.rs"]
#[allow(unused_imports, reason = "only symmetric factorisations are used")]
mod tiles;

use tiles::BadPivot;

/// A pivot has the wrong sign.
#[derive(Clone, Copy, Debug)]
pub struct WrongSign;

/// Rows of a matrix and their length.
pub type Rows<'a> = (&'a [f64], usize);

/// U and U'^-1 of the rest of a block of rows, from its first columns, which are symmetric.
pub fn factorise(rows: &mut [f64], stride: usize) -> Result<(), WrongSign> {
    tiles::factorise_rows(rows, stride, rows.len() / stride, stride).map_err(|BadPivot| WrongSign)
}

/// Subtracts X'X, X the columns of `above` from `from`, from the upper triangle of the first columns of all
/// rows below.
pub fn subtract(above: Rows<'_>, from: usize, below: (&mut [f64], usize), width: usize) {
    let size = below.0.len() / below.1;
    tiles::subtract_square(above, from, below, size, width);
}

/// Adds it, to rows of this width.
pub fn add(above: Rows<'_>, from: usize, below: (&mut [f64], usize)) {
    let width = below.1;
    negate(below.0);
    subtract(above, from, (&mut *below.0, width), width);
    negate(below.0);
}

pub fn negate(rows: &mut [f64]) {
    rows.iter_mut().for_each(|entry| *entry = -*entry);
}

/// y of U'y = r in place, and the rest of r without the part of y.
pub fn forward((rows, stride): Rows<'_>, r: &mut [f64]) {
    substitution::forward(rows, stride, r);
}

/// x of U x = y in place, where the rest of x is known.
pub fn backward((rows, stride): Rows<'_>, x: &mut [f64]) {
    substitution::backward(rows, stride, x);
}
