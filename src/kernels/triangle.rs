//! A unit lower triangular matrix with the pattern of a tree.

use crate::matrix::{Panel, Pattern, add_rows, sum_rows};
use crate::robot::Tree;
use crate::scalar::{Pack, Scalar};

/// Unit lower triangular L, n x n: row k has entries only at the ancestors of joint k; where armature or
/// mimic joints couple different branches, the pattern is closed under elimination.
///
/// Const parameters W of the methods: the number of packs per row if known at compile time, else 0.
#[derive(Clone, Debug)]
pub(super) struct Triangle<S: Scalar> {
    rows: Lists,
    columns: Lists,
    /// Whether every entry below the diagonal is in the pattern.
    full: bool,
    /// Entries below the diagonal, or those of another factor with this pattern.
    entries: Panel<S>,
}

/// Positions of the off-diagonal entries by row (or column).
#[derive(Clone, Debug)]
struct Lists {
    starts: Vec<usize>,
    entries: Vec<usize>,
}

impl Lists {
    fn new(of: Vec<Vec<usize>>) -> Self {
        let (mut starts, mut entries) = (vec![0], Vec::new());
        for mut of in of {
            entries.append(&mut of);
            starts.push(entries.len());
        }
        Self { starts, entries }
    }

    /// Entries of row (or column) k, in ascending order.
    #[inline(always)]
    fn of(&self, k: usize) -> &[usize] {
        &self.entries[self.starts[k]..self.starts[k + 1]]
    }
}

impl<S: Scalar> Triangle<S> {
    /// The identity, with the pattern of the factors of the mass matrix.
    pub fn new(tree: &Tree) -> Self {
        let n = tree.dof();
        let filled = tree.factor_pattern();
        let mut columns = vec![Vec::new(); n];
        filled.iter().enumerate().for_each(|(k, row)| row.iter().for_each(|&i| columns[i].push(k)));
        let (rows, columns) = (Lists::new(filled), Lists::new(columns));
        Self { full: rows.entries.len() == n * (n - 1) / 2, columns, rows, entries: Panel::zeros(n, n) }
    }

    /// Whether every entry below the diagonal is in the pattern.
    #[inline(always)]
    pub fn is_full(&self) -> bool {
        self.full
    }

    /// Positions of the entries below the diagonal.
    pub fn pattern(&self) -> Pattern {
        Pattern::from_rows(self.entries.rows(), |k| self.row_pattern(k))
    }

    /// Positions of the entries of `L^-1`, the diagonal included.
    pub fn inverse_pattern(&self) -> Pattern {
        let mut pattern = self.pattern().with_diagonal();
        loop {
            let further = pattern.times(&pattern);
            if further == pattern {
                return pattern;
            }
            pattern = further;
        }
    }

    /// Columns of the entries of row k, ascending.
    #[inline(always)]
    pub fn row_pattern(&self, k: usize) -> &[usize] {
        self.rows.of(k)
    }

    /// Rows of the entries of column i, ascending.
    #[inline(always)]
    pub fn column_pattern(&self, i: usize) -> &[usize] {
        self.columns.of(i)
    }

    /// Entries below the diagonal; entries outside the pattern are undefined.
    #[inline(always)]
    pub fn entries(&self) -> &Panel<S> {
        &self.entries
    }

    /// Mutable access to the same entries.
    #[inline(always)]
    pub fn entries_mut(&mut self) -> &mut Panel<S> {
        &mut self.entries
    }

    /// `target -= sum_i L_ki row_i`: rows of the panel `above` before row k, `width` packs each.
    #[inline(always)]
    pub fn minus_rows(&self, k: usize, target: &mut [S::Pack], above: &[S::Pack], width: usize) {
        let terms = self.rows.of(k).iter().map(|&i| (i, S::Pack::splat(-self.entries.get(k, i))));
        add_rows(target, above, width, terms);
    }

    /// `target -= sum_k L_ki row_k`: rows of the panel `below` after row i, `width` packs each.
    ///
    /// The row computed last is added last, which shortens the chain of dependent sums.
    #[inline(always)]
    pub fn minus_columns<const N: usize, const W: usize>(
        &self,
        i: usize,
        target: &mut [S::Pack],
        below: &[S::Pack],
        width: usize,
    ) {
        let term = |k: usize| (k - i - 1, S::Pack::splat(-self.entries.entry::<W>(k, i)));
        if W > 0 && self.full {
            let n = if N > 0 { N } else { self.entries.rows() };
            sum_rows::<W, S::Pack>(target, below, width, (i + 1..n).rev().map(term));
        } else {
            let terms = self.columns.of(i).iter().rev().map(|&k| term(k));
            sum_rows::<W, S::Pack>(target, below, width, terms);
        }
    }

    /// Entries of row k as terms (i, -L_ki), ascending.
    #[inline(always)]
    pub fn row_terms(&self, k: usize) -> impl Iterator<Item = (usize, S)> + Clone {
        self.rows.of(k).iter().map(move |&i| (i, -self.entries.get(k, i)))
    }

    /// Entries of column i below the diagonal as terms (k, -L_ki), ascending.
    #[inline(always)]
    pub fn column_terms(&self, i: usize) -> impl Iterator<Item = (usize, S)> + Clone {
        self.columns.of(i).iter().map(move |&k| (k, -self.entries.get(k, i)))
    }
}
