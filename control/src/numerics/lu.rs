//! `P A = L U` of small dense matrices, with exchange of rows.

use costate::matrix::add_scaled;

/// The first `columns` steps of Gaussian elimination, with exchange of rows, on a matrix of rows of length
/// `width`.
///
/// Leaves the multipliers below the diagonal, and in `exchanges[c]` the row that was exchanged with row c.
/// False if a column has no pivot that is finite and not zero.
pub(crate) fn eliminate(a: &mut [f64], width: usize, columns: usize, exchanges: &mut [usize]) -> bool {
    let rows = a.len() / width;
    for c in 0..columns.min(rows) {
        let mut best = c;
        for r in c + 1..rows {
            if a[r * width + c].abs() > a[best * width + c].abs() {
                best = r;
            }
        }
        exchanges[c] = best;
        if best != c {
            let (above, below) = a.split_at_mut(best * width);
            above[c * width..(c + 1) * width].swap_with_slice(&mut below[..width]);
        }
        let pivot = a[c * width + c];
        if pivot == 0.0 || !pivot.is_finite() {
            return false;
        }
        let (above, below) = a.split_at_mut((c + 1) * width);
        let pivot_row = &above[c * width..];
        for row in below.chunks_exact_mut(width) {
            let quotient = row[c] / pivot;
            row[c] = quotient;
            if quotient != 0.0 {
                add_scaled(&mut row[c + 1..], -quotient, &pivot_row[c + 1..]);
            }
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
    for c in 0..columns {
        if exchanges[c] != c {
            let (above, below) = b.split_at_mut(exchanges[c] * width);
            above[c * width..(c + 1) * width].swap_with_slice(&mut below[..width]);
        }
    }
    for c in 0..columns {
        let (above, below) = b.split_at_mut((c + 1) * width);
        let pivot_row = &above[c * width..];
        for (r, row) in below.chunks_exact_mut(width).enumerate() {
            let quotient = a[(c + 1 + r) * a_width + c];
            if quotient != 0.0 {
                add_scaled(row, -quotient, pivot_row);
            }
        }
    }
}

/// `B <- U^-1 B` with the upper triangle U of [`eliminate`] in the first n columns of A; rows of B have
/// length `width`.
pub(crate) fn substitute(a: &[f64], a_width: usize, n: usize, b: &mut [f64], width: usize) {
    for i in (0..n).rev() {
        let (above, below) = b.split_at_mut((i + 1) * width);
        let row = &mut above[i * width..];
        for k in i + 1..n {
            add_scaled(row, -a[i * a_width + k], &below[(k - i - 1) * width..(k - i) * width]);
        }
        let pivot = a[i * a_width + i];
        row.iter_mut().for_each(|entry| *entry /= pivot);
    }
}

/// `B <- A^-1 B` with the factors of [`eliminate`] of a square A of size n.
pub(crate) fn solve(a: &[f64], n: usize, exchanges: &[usize], b: &mut [f64], width: usize) {
    follow(a, n, n, exchanges, b, width);
    substitute(a, n, n, b, width);
}
