//! The linear solver of Newton's method.

use crate::matrix::{Matrix, dot, filled};
use crate::scalar::Scalar;

/// `A = L U` of a square matrix, L with unit diagonal, without pivoting.
///
/// Pivoting would branch on values, which differ between lanes. It is not needed for steps that are short
/// compared with the time constants of the model: A is `1 - h a f_x`, the identity for h = 0. If h is so long
/// that a leading minor of A nearly vanishes, the derivatives of the step lose digits in proportion, even if
/// A is regular. If the minor vanishes, quotients are infinite, and Newton's method reports that it did not
/// converge.
#[derive(Clone, Debug)]
pub(super) struct Lu<S> {
    a: Matrix<S>,
    inverse_pivots: Vec<S>,
}

impl<S: Scalar> Lu<S> {
    pub fn new(size: usize) -> Self {
        Self { a: Matrix::zeros(size, size), inverse_pivots: filled(S::zero(), size) }
    }

    pub fn size(&self) -> usize {
        self.inverse_pivots.len()
    }

    /// Row i of A; fill all rows before [`factor`](Self::factor).
    pub fn row_mut(&mut self, i: usize) -> &mut [S] {
        self.a.row_mut(i)
    }

    pub fn factor(&mut self) {
        for i in 0..self.size() {
            for k in 0..i {
                let (row, pivot_row) = self.a.row_mut_and_above(i, k);
                let quotient = row[k] * self.inverse_pivots[k];
                row[k] = quotient;
                subtract(&mut row[k + 1..], quotient, &pivot_row[k + 1..]);
            }
            self.inverse_pivots[i] = self.a[(i, i)].recip();
        }
    }

    /// `b <- A^-1 b`.
    pub fn solve(&self, b: &mut [S]) {
        for i in 0..self.size() {
            let known = dot(&self.a.row(i)[..i], &b[..i]);
            b[i] -= known;
        }
        for i in (0..self.size()).rev() {
            let known = dot(&self.a.row(i)[i + 1..], &b[i + 1..]);
            b[i] = (b[i] - known) * self.inverse_pivots[i];
        }
    }

    /// `b <- A'^-1 b`.
    pub fn solve_transposed(&self, b: &mut [S]) {
        for i in 0..self.size() {
            b[i] *= self.inverse_pivots[i];
            let (known, rest) = b.split_at_mut(i + 1);
            subtract(rest, known[i], &self.a.row(i)[i + 1..]);
        }
        for i in (0..self.size()).rev() {
            let (rest, known) = b.split_at_mut(i);
            subtract(rest, known[0], &self.a.row(i)[..i]);
        }
    }

    /// `B <- A^-1 B` for the rows of a matrix from `top` on.
    pub fn solve_rows(&self, b: &mut Matrix<S>, top: usize) {
        for i in 0..self.size() {
            for k in 0..i {
                let (row, above) = b.row_mut_and_above(top + i, top + k);
                subtract(row, self.a[(i, k)], above);
            }
        }
        for i in (0..self.size()).rev() {
            for k in i + 1..self.size() {
                let (row, below) = b.row_mut_and_below(top + i, top + k);
                subtract(row, self.a[(i, k)], below);
            }
            b.row_mut(top + i).iter_mut().for_each(|entry| *entry *= self.inverse_pivots[i]);
        }
    }
}

/// `target -= factor source`.
fn subtract<S: Scalar>(target: &mut [S], factor: S, source: &[S]) {
    target.iter_mut().zip(source).for_each(|(target, &source)| *target -= factor * source);
}

#[cfg(test)]
mod tests {
    use super::Lu;
    use crate::matrix::Matrix;

    #[test]
    fn solutions_satisfy_their_equations() {
        let a = |i: usize, j: usize| if i == j { 1.0 } else { 0.1 * (i as f64 - 0.7 * j as f64).sin() };
        let n = 5;
        let mut lu = Lu::<f64>::new(n);
        for i in 0..n {
            (0..n).for_each(|j| lu.row_mut(i)[j] = a(i, j));
        }
        lu.factor();
        let b: Vec<f64> = (0..n).map(|i| 1.0 - 0.3 * i as f64).collect();
        let (mut x, mut y) = (b.clone(), b.clone());
        lu.solve(&mut x);
        lu.solve_transposed(&mut y);
        let mut rows = Matrix::zeros(n + 2, 2);
        (0..n).for_each(|i| rows.row_mut(i + 2).copy_from_slice(&[b[i], 2.0 * b[i]]));
        lu.solve_rows(&mut rows, 2);
        for i in 0..n {
            let residual = (0..n).map(|j| a(i, j) * x[j]).sum::<f64>() - b[i];
            let transposed = (0..n).map(|j| a(j, i) * y[j]).sum::<f64>() - b[i];
            assert!(residual.abs() < 1e-15 && transposed.abs() < 1e-15);
            assert!((rows[(i + 2, 0)] - x[i]).abs() < 1e-15 && (rows[(i + 2, 1)] - 2.0 * x[i]).abs() < 1e-15);
        }
    }
}
