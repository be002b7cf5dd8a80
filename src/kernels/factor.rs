//! Branch-sparse factorisation of the mass matrix, `M = L' D L`.

use crate::matrix::{Matrix, add_rows};
use crate::robot::Tree;
use crate::scalar::Scalar;

/// `M = L' D L` with unit lower triangular L, no pivoting (Featherstone's branch-induced sparsity).
///
/// Row k of L has entries only at the ancestors of joint k; where armature couples joints of different branches, the
/// pattern is closed under elimination. Pivot D_k is the articulated inertia of joint k.
#[derive(Clone, Debug)]
pub struct Factor<S> {
    starts: Vec<usize>,
    columns: Vec<usize>,
    /// Rows, and places in `lower`, of the entries of each column.
    column_starts: Vec<usize>,
    column_entries: Vec<(usize, usize)>,
    lower: Vec<S>,
    inverse_pivots: Vec<S>,
    pivots: Vec<S>,
    work: Matrix<S>,
}

impl<S: Scalar> Factor<S> {
    /// Symbolic factorisation and buffers.
    pub fn new(tree: &Tree) -> Self {
        let n = tree.len();
        let mut filled = vec![vec![false; n]; n];
        (0..n).for_each(|i| tree.subtree(i).iter().for_each(|&k| filled[k][i] = true));
        tree.armature().iter().for_each(|&(i, j, _)| filled[i][j] = true);
        for k in (0..n).rev() {
            let row: Vec<usize> = (0..k).filter(|&i| filled[k][i]).collect();
            for (a, &i) in row.iter().enumerate() {
                row[..a].iter().for_each(|&j| filled[i][j] = true);
            }
        }
        let (mut starts, mut columns) = (vec![0], Vec::new());
        for (k, row) in filled.iter().enumerate() {
            columns.extend((0..k).filter(|&i| row[i]));
            starts.push(columns.len());
        }
        let mut column_starts = vec![0];
        let mut column_entries = Vec::new();
        for i in 0..n {
            let below = (i + 1..n).flat_map(|k| (starts[k]..starts[k + 1]).map(move |at| (k, at)));
            column_entries.extend(below.filter(|&(_, at): &(usize, usize)| columns[at] == i));
            column_starts.push(column_entries.len());
        }
        Self {
            column_starts,
            column_entries,
            lower: vec![S::zero(); columns.len()],
            inverse_pivots: vec![S::one(); n],
            pivots: vec![S::zero(); n],
            work: Matrix::zeros(n, n),
            starts,
            columns,
        }
    }

    /// Row k of L: columns (rising) and values.
    #[inline]
    fn row(&self, k: usize) -> (&[usize], &[S]) {
        let range = self.starts[k]..self.starts[k + 1];
        (&self.columns[range.clone()], &self.lower[range])
    }

    /// Entries of row k of L as terms (i, -L_ki), rising.
    #[inline]
    pub(super) fn row_terms(&self, k: usize) -> impl Iterator<Item = (usize, S)> + Clone {
        let (columns, values) = self.row(k);
        columns.iter().zip(values).map(|(&i, &l)| (i, -l))
    }

    /// Entries of column i of L below the diagonal as terms (k, -L_ki), rising.
    #[inline]
    pub(super) fn column_terms(&self, i: usize) -> impl Iterator<Item = (usize, S)> + Clone {
        let column = &self.column_entries[self.column_starts[i]..self.column_starts[i + 1]];
        column.iter().map(|&(k, at)| (k, -self.lower[at]))
    }

    /// `1 / D_k`, n.
    #[inline]
    pub(super) fn inverse_pivots(&self) -> &[S] {
        &self.inverse_pivots
    }

    /// Factors the n x n matrix; `size_of(k)` is what the rounding of entry (k, k) is in proportion to.
    ///
    /// # Errors
    /// A joint whose pivot is not above its rounding: M is singular to working precision. The factorisation runs to its end
    /// all the same.
    pub fn factor(&mut self, mass_matrix: &Matrix<S>, size_of: impl Fn(usize) -> S) -> Result<(), usize> {
        let n = self.inverse_pivots.len();
        self.work.copy_from(mass_matrix);
        for k in (0..n).rev() {
            let inverse = self.work[(k, k)].recip();
            self.inverse_pivots[k] = inverse;
            let (start, end) = (self.starts[k], self.starts[k + 1]);
            let columns = &self.columns[start..end];
            for (a, &i) in columns.iter().enumerate().rev() {
                let scaled = self.work[(k, i)] * inverse;
                self.lower[start + a] = scaled;
                let (target, source) = self.work.row_mut_and_below(i, k);
                for &j in &columns[..=a] {
                    target[j] -= scaled * source[j];
                }
            }
        }
        if S::CHECKED { self.check_pivots(size_of) } else { Ok(()) }
    }

    /// Compares each pivot with the rounding it may consist of.
    ///
    /// `D_i = w' M w` for the motion w of joint i and, free, the joints beyond it: column i of `U = L^-1`. An error of
    /// `eps size_k` in each `M_kk` therefore moves D_i by `eps sum_k U_ki^2 size_k`; 128 times that must stay below D_i. U
    /// is only computed where some pivot is below a thousandth of its size: elsewhere nothing has cancelled.
    fn check_pivots(&mut self, size_of: impl Fn(usize) -> S) -> Result<(), usize> {
        let n = self.inverse_pivots.len();
        if (0..n).all(|k| S::all(size_of(k).times(1e-3).less(self.work[(k, k)]))) {
            return Ok(());
        }
        for (k, pivot) in self.pivots.iter_mut().enumerate() {
            *pivot = self.work[(k, k)];
        }
        self.invert_lower();
        let unit = 128.0 * S::EPSILON;
        for i in (0..n).rev() {
            let moved = (i..n).fold(S::zero(), |sum, k| {
                let u = self.work[(k, i)];
                sum + u * u * size_of(k)
            });
            if !S::all(moved.times(unit).less(self.pivots[i])) {
                return Err(i);
            }
        }
        Ok(())
    }

    /// `U = L^-1` into the work matrix: rows from the first on, entries right of the diagonal left as they are.
    fn invert_lower(&mut self) {
        for k in 0..self.inverse_pivots.len() {
            let range = self.starts[k]..self.starts[k + 1];
            self.work.row_mut(k)[..k].fill(S::zero());
            self.work[(k, k)] = S::one();
            for (&i, &l) in self.columns[range.clone()].iter().zip(&self.lower[range]) {
                let (target, source) = self.work.row_mut_and_above(k, i);
                for (t, &s) in target[..=i].iter_mut().zip(source) {
                    *t -= l * s;
                }
            }
        }
    }

    /// `x <- M^-1 x`, length n.
    pub fn solve(&self, x: &mut [S]) {
        let n = self.inverse_pivots.len();
        for k in (0..n).rev() {
            let (columns, values) = self.row(k);
            let from = x[k];
            for (&i, &l) in columns.iter().zip(values) {
                x[i] -= l * from;
            }
        }
        for k in 0..n {
            let (columns, values) = self.row(k);
            let mut sum = x[k] * self.inverse_pivots[k];
            for (&i, &l) in columns.iter().zip(values) {
                sum -= l * x[i];
            }
            x[k] = sum;
        }
    }

    /// `Y <- L'^-1 Y` for a matrix with n rows: the first half of a solution.
    pub fn solve_first_half(&self, y: &mut Matrix<S>) {
        let stride = y.columns();
        for i in (0..self.inverse_pivots.len()).rev() {
            let (target, after) = y.row_mut_and_after(i);
            add_rows(target, after, stride, self.column_terms(i).map(|(k, factor)| (k - i - 1, factor)));
        }
    }

    /// `Z = D^-1 Y`, for Y and Z of n rows.
    pub fn divide_by_pivots(&self, y: &Matrix<S>, z: &mut Matrix<S>) {
        for (k, &inverse) in self.inverse_pivots.iter().enumerate() {
            for (z, &y) in z.row_mut(k).iter_mut().zip(y.row(k)) {
                *z = y * inverse;
            }
        }
    }

    /// `Z <- L^-1 Z`: the second half of a solution.
    pub fn solve_second_half(&self, z: &mut Matrix<S>) {
        let stride = z.columns();
        for k in 0..self.inverse_pivots.len() {
            let (target, before) = z.row_mut_and_before(k);
            add_rows(target, before, stride, self.row_terms(k));
        }
    }

    /// `M^-1 = U D^-1 U'` with `U = L^-1`, n x n, exactly symmetric.
    pub fn inverse(&mut self, inverse: &mut Matrix<S>) {
        let n = self.inverse_pivots.len();
        self.invert_lower();
        inverse.fill_zero();
        for k in 0..n {
            for i in k..n {
                let scaled = self.work[(i, k)] * self.inverse_pivots[k];
                for j in k..=i {
                    inverse[(i, j)] += scaled * self.work[(j, k)];
                }
            }
        }
        for i in 0..n {
            for j in 0..i {
                inverse[(j, i)] = inverse[(i, j)];
            }
        }
    }
}
