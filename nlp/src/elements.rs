//! Vectors, and products with the blocks of elements.

use crate::blocks::Dense;
use crate::layout::{Element, Layout};

/// A square matrix of zeros for each element.
pub(crate) fn squares(layout: &Layout) -> Vec<Dense> {
    let square = |element| Dense::zeros(layout.width(element), layout.width(element));
    layout.elements().map(square).collect()
}

/// Room for the entries of any element, twice.
pub(crate) fn room(layout: &Layout) -> [Vec<f64>; 2] {
    let most = layout.elements().map(|element| layout.width(element)).max().unwrap_or(0);
    [vec![0.0; most], vec![0.0; most]]
}

/// The largest absolute value; not-a-number if one is.
pub(crate) fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, value| worse(most, value.abs()))
}

/// The larger one; not-a-number is the largest.
pub(crate) fn worse(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::NAN } else { a.max(b) }
}

/// The entries of a vector that an element depends on, in the order of its columns.
#[inline(always)]
pub(crate) fn gather(layout: &Layout, element: Element, from: &[f64], to: &mut [f64]) {
    let mut at = 0;
    for range in layout.unknowns(element) {
        let end = at + range.len();
        to[at..end].copy_from_slice(&from[range]);
        at = end;
    }
}

/// Adds the entries of an element to a vector.
#[inline(always)]
pub(crate) fn scatter(layout: &Layout, element: Element, from: &[f64], to: &mut [f64]) {
    let mut at = 0;
    for range in layout.unknowns(element) {
        let end = at + range.len();
        to[range].iter_mut().zip(&from[at..end]).for_each(|(to, from)| *to += from);
        at = end;
    }
}

/// `to = A d`, for the entries d of an element.
#[inline(always)]
pub(crate) fn times(rows: &Dense, d: &[f64], to: &mut [f64]) {
    for (i, to) in to.iter_mut().enumerate() {
        *to = dot(rows.row(i), d);
    }
}

/// `to += A' y`, for the entries `to` of an element.
#[inline(always)]
pub(crate) fn add_transposed(rows: &Dense, y: &[f64], to: &mut [f64]) {
    for (i, &y) in y.iter().enumerate() {
        to.iter_mut().zip(rows.row(i)).for_each(|(to, entry)| *to += y * entry);
    }
}

/// `to += W d`, of the upper triangle of W.
#[inline(always)]
pub(crate) fn add_symmetric(hessian: &Dense, d: &[f64], to: &mut [f64]) {
    for (i, &factor) in d.iter().enumerate() {
        let row = &hessian.row(i)[i + 1..];
        let sum = hessian[(i, i)] * factor + dot(row, &d[i + 1..]);
        to[i] += sum;
        to[i + 1..].iter_mut().zip(row).for_each(|(to, entry)| *to += entry * factor);
    }
}

/// A scalar product as eight sums, which a processor adds side by side.
#[inline(always)]
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<8>(), b.as_chunks::<8>());
    let mut sums = [0.0; 8];
    for (a, b) in a.iter().zip(b) {
        sums.iter_mut().zip(a.iter().zip(b)).for_each(|(sum, (a, b))| *sum += a * b);
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum();
    let [p, q, r, s] = [0, 1, 2, 3].map(|i| sums[i] + sums[i + 4]);
    (p + q) + (r + s) + rest
}
