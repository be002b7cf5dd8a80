//! `P A = L U` of small dense matrices, with exchange of rows, in the loops of the widest vectors.
//!
//! The elimination is Crout's, in panels of [`PANEL`] columns: the columns of a panel are brought up to date
//! with all columns before it, its pivots are chosen, then its rows. Sums over columns stay in registers.

use super::padded::multiply_add;
use super::products::{subtract_own_products, subtract_products};
use costate::matrix::dot;
use costate_numerics::in_widest;

/// Columns of a panel: numbers of the widest vectors.
const PANEL: usize = 8;

/// The first `columns` steps of Gaussian elimination, with exchange of rows, on a matrix of rows of length
/// `width`.
///
/// Leaves the multipliers below the diagonal, and in `exchanges[c]` the row that was exchanged with row c.
/// False if a column has no pivot that is finite and not zero.
pub(crate) fn eliminate(a: &mut [f64], width: usize, columns: usize, exchanges: &mut [usize]) -> bool {
    in_widest!(eliminate_panels(a, width, columns, exchanges))
}

#[inline(always)]
fn eliminate_panels<const FUSED: bool>(
    a: &mut [f64],
    width: usize,
    columns: usize,
    exchanges: &mut [usize],
) -> bool {
    let columns = columns.min(a.len() / width);
    for first in (0..columns).step_by(PANEL) {
        let end = (first + PANEL).min(columns);
        let (above, below) = a.split_at_mut(first * width);
        subtract_own_products(below, above, width, first..end);
        for (c, exchange) in exchanges.iter_mut().enumerate().take(end).skip(first) {
            if !pivot::<FUSED>(a, width, c, end, exchange) {
                return false;
            }
        }
        let (above, below) = a.split_at_mut(first * width);
        let panel = &mut below[..(end - first) * width];
        subtract_own_products(panel, above, width, end..width);
        for r in 1..end - first {
            let (before, row) = panel.split_at_mut(r * width);
            let (factors, row) = row[first..width].split_at_mut(end - first);
            for (factor, upper) in factors[..r].iter().zip(before.chunks_exact(width)) {
                for (to, from) in row.iter_mut().zip(&upper[end..]) {
                    *to = multiply_add::<FUSED>(-factor, *from, *to);
                }
            }
        }
    }
    let (above, below) = a.split_at_mut(columns * width);
    subtract_own_products(below, above, width, columns..width);
    true
}

/// Exchanges row c with that of the largest entry of column c, and eliminates this column from the rows
/// below, up to the column `end`.
#[inline(always)]
fn pivot<const FUSED: bool>(a: &mut [f64], width: usize, c: usize, end: usize, exchange: &mut usize) -> bool {
    let (mut best, mut largest) = (c, -1.0);
    for (r, row) in a.chunks_exact(width).enumerate().skip(c) {
        let size = row[c].abs();
        if size > largest {
            (best, largest) = (r, size);
        }
    }
    *exchange = best;
    let (above, below) = a.split_at_mut((c + 1) * width);
    let pivot_row = &mut above[c * width..];
    if best != c {
        pivot_row.swap_with_slice(&mut below[(best - c - 1) * width..][..width]);
    }
    let pivot = pivot_row[c];
    if pivot == 0.0 || !pivot.is_finite() {
        return false;
    }
    let inverse = 1.0 / pivot;
    let pivot_row = &pivot_row[c + 1..end];
    for row in below.chunks_exact_mut(width) {
        let factor = row[c] * inverse;
        row[c] = factor;
        for (to, from) in row[c + 1..end].iter_mut().zip(pivot_row) {
            *to = multiply_add::<FUSED>(-factor, *from, *to);
        }
    }
    true
}

/// Applies the row operations of [`eliminate`] to `b`, whose rows have length `width`.
pub(crate) fn follow(
    a: &[f64],
    a_width: usize,
    columns: usize,
    exchanges: &[usize],
    b: &mut [f64],
    width: usize,
) {
    for (c, &exchange) in exchanges[..columns].iter().enumerate() {
        if exchange != c {
            let (above, below) = b.split_at_mut(exchange * width);
            above[c * width..(c + 1) * width].swap_with_slice(&mut below[..width]);
        }
    }
    if width == 1 {
        for r in 1..b.len() {
            let (known, rest) = b.split_at_mut(r);
            let factors = &a[r * a_width..][..r.min(columns)];
            rest[0] -= dot(factors, &known[..factors.len()]);
        }
        return;
    }
    in_widest!(follow_panels(a, a_width, columns, b, width));
}

#[inline(always)]
fn follow_panels<const FUSED: bool>(a: &[f64], a_width: usize, columns: usize, b: &mut [f64], width: usize) {
    for first in (0..columns).step_by(PANEL) {
        let end = (first + PANEL).min(columns);
        let (above, below) = b.split_at_mut(first * width);
        let panel = &mut below[..(end - first) * width];
        subtract_products((panel, width), (&a[first * a_width..], a_width), (above, width));
        for r in 1..end - first {
            let (before, row) = panel.split_at_mut(r * width);
            let factors = &a[(first + r) * a_width + first..][..r];
            subtract_rows::<FUSED>(&mut row[..width], factors, before);
        }
    }
    let (above, below) = b.split_at_mut(columns * width);
    if !below.is_empty() {
        subtract_products((below, width), (&a[columns * a_width..], a_width), (above, width));
    }
}

/// `to -= sum of factors times rows`, one row after the other.
#[inline(always)]
fn subtract_rows<const FUSED: bool>(to: &mut [f64], factors: &[f64], rows: &[f64]) {
    for (factor, row) in factors.iter().zip(rows.chunks_exact(to.len())) {
        for (to, from) in to.iter_mut().zip(row) {
            *to = multiply_add::<FUSED>(-factor, *from, *to);
        }
    }
}

/// `B <- U^-1 B` with the upper triangle U of [`eliminate`] in the first n columns of A; rows of B have
/// length `width`.
pub(crate) fn substitute(a: &[f64], a_width: usize, n: usize, b: &mut [f64], width: usize) {
    if width == 1 {
        for i in (0..n).rev() {
            let (head, known) = b.split_at_mut(i + 1);
            let row = &a[i * a_width..][i..n];
            head[i] = (head[i] - dot(&row[1..], &known[..n - i - 1])) / row[0];
        }
        return;
    }
    in_widest!(substitute_panels(a, a_width, n, b, width));
}

#[inline(always)]
fn substitute_panels<const FUSED: bool>(a: &[f64], a_width: usize, n: usize, b: &mut [f64], width: usize) {
    for first in (0..n).step_by(PANEL).rev() {
        let end = (first + PANEL).min(n);
        let (above, below) = b.split_at_mut(end * width);
        let panel = &mut above[first * width..];
        let below = &below[..(n - end) * width];
        subtract_products((panel, width), (&a[first * a_width + end..], a_width), (below, width));
        for r in (0..end - first).rev() {
            let (row, after) = panel[r * width..].split_at_mut(width);
            let factors = &a[(first + r) * a_width + first + r..][..end - first - r];
            subtract_rows::<FUSED>(row, &factors[1..], after);
            let inverse = 1.0 / factors[0];
            row.iter_mut().for_each(|entry| *entry *= inverse);
        }
    }
}

/// `C <- C - A B`, the rows of B and C `width` long, those of A `inner`.
pub(crate) fn subtract_product(c: &mut [f64], width: usize, a: &[f64], inner: usize, b: &[f64]) {
    subtract_products((c, width), (a, inner), (b, width));
}

/// `B <- A^-1 B` with the factors of [`eliminate`] of a square A of size n.
pub(crate) fn solve(a: &[f64], n: usize, exchanges: &[usize], b: &mut [f64], width: usize) {
    follow(a, n, n, exchanges, b, width);
    substitute(a, n, n, b, width);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All sizes around those of panels and tiles, against A x = b; entries over several powers of ten.
    #[test]
    fn solutions_satisfy_their_equations() {
        let mut random = fastrand::Rng::with_seed(1);
        let mut number = || (2.0 * random.f64() - 1.0) * 10.0_f64.powi(random.i32(-3..3));
        for n in 1..40 {
            for width in [1, 2, 3, 7, 8, 13, 24] {
                let a: Vec<f64> = (0..n * n).map(|_| number()).collect();
                let b: Vec<f64> = (0..n * width).map(|_| number()).collect();
                let (mut factors, mut exchanges, mut x) = (a.clone(), vec![0; n], b.clone());
                assert!(eliminate(&mut factors, n, n, &mut exchanges));
                solve(&factors, n, &exchanges, &mut x, width);
                for r in 0..n {
                    for c in 0..width {
                        let terms = (0..n).map(|k| a[r * n + k] * x[k * width + c]);
                        let size: f64 = terms.clone().map(f64::abs).sum();
                        let residual = terms.sum::<f64>() - b[r * width + c];
                        assert!(residual.abs() < 1e-12 * size.max(1.0), "{n} {width} {r} {c}: {residual}");
                    }
                }
            }
        }
    }

    /// Columns beyond those eliminated, and rows below them, as row operations one by one leave them.
    #[test]
    fn part_of_the_columns_is_eliminated() {
        let mut random = fastrand::Rng::with_seed(2);
        for (rows, columns, width) in [(5, 3, 9), (12, 8, 17), (20, 12, 24), (36, 24, 48), (9, 9, 9)] {
            let a: Vec<f64> = (0..rows * width).map(|_| 2.0 * random.f64() - 1.0).collect();
            let (mut blocked, mut exchanges) = (a.clone(), vec![0; columns]);
            assert!(eliminate(&mut blocked, width, columns, &mut exchanges));
            let mut plain = a.clone();
            for c in 0..columns {
                let row_c = plain[exchanges[c] * width..][..width].to_vec();
                plain.copy_within(c * width..(c + 1) * width, exchanges[c] * width);
                plain[c * width..(c + 1) * width].copy_from_slice(&row_c);
                for r in c + 1..rows {
                    let factor = plain[r * width + c] / row_c[c];
                    assert!(factor.abs() <= 1.0 + 1e-12, "the pivot is the largest entry");
                    plain[r * width + c] = factor;
                    (c + 1..width).for_each(|j| plain[r * width + j] -= factor * row_c[j]);
                }
            }
            let difference = blocked.iter().zip(&plain).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max);
            assert!(difference < 1e-11, "{rows} {columns} {width}: {difference}");
            // The same operations on the matrix itself leave U and zeros, below and beyond.
            let mut followed = a;
            follow(&blocked, width, columns, &exchanges, &mut followed, width);
            for r in 0..rows {
                for j in 0..width {
                    let expected = if j < columns.min(r) { 0.0 } else { blocked[r * width + j] };
                    assert!((followed[r * width + j] - expected).abs() < 1e-11, "{rows} {columns} {r} {j}");
                }
            }
        }
    }

    #[test]
    fn a_column_without_a_pivot_is_told() {
        let mut exchanges = [0; 2];
        assert!(!eliminate(&mut [1.0, 2.0, 2.0, 4.0], 2, 2, &mut exchanges));
        assert!(!eliminate(&mut [f64::NAN, 2.0, f64::NAN, 4.0], 2, 2, &mut exchanges));
        assert!(!eliminate(&mut [f64::INFINITY, 2.0, 1.0, 4.0], 2, 2, &mut exchanges));
    }
}
