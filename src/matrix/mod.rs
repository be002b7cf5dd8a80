//! A dense row-major matrix over any scalar, and blocks of it.

mod panel;
mod pattern;
mod place;
mod product;
mod rows;
mod tile;
mod tiles;
mod transpose;

pub(crate) use panel::{Panel, Source, sized};
pub(crate) use pattern::Pattern;
pub(crate) use place::Place;
pub(crate) use product::{Left, Part};
pub(crate) use rows::{add_rows, dot_packs, sum_rows, write_packs};
pub use rows::{add_scaled, dot};
pub(crate) use tile::Update;
pub(crate) use tiles::{Terms, Tiles};

use crate::scalar::{Pack, Scalar};
use nalgebra::{DMatrix, DMatrixView, Dim, Dyn};
use std::ops::{Index, IndexMut};

/// As many copies of a value: `vec![value; count]` without its loop over clones, which is compiled for each
/// type, part by part.
///
/// For vectors of the length of the tree: `vec![0.0; n]` takes zeros from the system, which long ones need.
#[inline(never)]
pub(crate) fn filled<T: Copy>(value: T, count: usize) -> Vec<T> {
    let mut copies = Vec::with_capacity(count);
    for _ in 0..count {
        copies.push(value);
    }
    copies
}

/// A term of one entry of a matrix.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Entry<S> {
    pub row: usize,
    pub column: usize,
    pub value: S,
}

/// A dense matrix, stored row by row.
#[derive(Clone, Debug)]
pub struct Matrix<S> {
    rows: usize,
    columns: usize,
    data: Vec<S>,
}

impl<S: Scalar> Matrix<S> {
    /// A matrix of zeros.
    pub fn zeros(rows: usize, columns: usize) -> Self {
        Self { rows, columns, data: vec![S::zero(); rows * columns] }
    }

    /// A matrix of as many rows of `columns` entries as `entries` fill, row by row.
    pub fn from_rows(columns: usize, entries: &[S]) -> Self {
        let rows = entries.len() / columns.max(1);
        Self { rows, columns, data: entries[..rows * columns].to_vec() }
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of columns.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Row `i`.
    #[inline]
    pub fn row(&self, i: usize) -> &[S] {
        &self.data[i * self.columns..(i + 1) * self.columns]
    }

    /// Mutable access to row `i`.
    #[inline]
    pub fn row_mut(&mut self, i: usize) -> &mut [S] {
        &mut self.data[i * self.columns..(i + 1) * self.columns]
    }

    /// Writes the lanes of a pack to column `j`, from row `i` on.
    #[inline(always)]
    pub(crate) fn write_column<P: Pack<S>>(&mut self, i: usize, j: usize, pack: P) {
        (0..P::LANES).for_each(|lane| self[(i + lane, j)] = pack.lane(lane));
    }

    /// Row `i`, mutable, and row `k < i`.
    #[inline]
    pub(crate) fn row_mut_and_above(&mut self, i: usize, k: usize) -> (&mut [S], &[S]) {
        let (above, from_i) = self.data.split_at_mut(i * self.columns);
        (&mut from_i[..self.columns], &above[k * self.columns..(k + 1) * self.columns])
    }

    /// Row `i`, mutable, and row `k > i`.
    #[inline]
    pub(crate) fn row_mut_and_below(&mut self, i: usize, k: usize) -> (&mut [S], &[S]) {
        let (to_k, from_k) = self.data.split_at_mut(k * self.columns);
        (&mut to_k[i * self.columns..(i + 1) * self.columns], &from_k[..self.columns])
    }

    /// All entries, row by row.
    pub fn as_slice(&self) -> &[S] {
        &self.data
    }

    /// The whole matrix as a block.
    pub fn view(&self) -> Block<'_, S> {
        self.block(0, 0, self.rows, self.columns)
    }

    /// The block of `rows` x `columns` entries that starts at (`top`, `left`).
    pub(crate) fn block(&self, top: usize, left: usize, rows: usize, columns: usize) -> Block<'_, S> {
        Block { matrix: self, top, left, rows, columns }
    }

    pub(crate) fn fill_zero(&mut self) {
        self.data.fill(S::zero());
    }

    pub(crate) fn copy_from(&mut self, other: &Self) {
        self.data.copy_from_slice(&other.data);
    }
}

impl<S> Index<(usize, usize)> for Matrix<S> {
    type Output = S;
    #[inline]
    fn index(&self, (i, j): (usize, usize)) -> &S {
        &self.data[i * self.columns + j]
    }
}

impl<S> IndexMut<(usize, usize)> for Matrix<S> {
    #[inline]
    fn index_mut(&mut self, (i, j): (usize, usize)) -> &mut S {
        &mut self.data[i * self.columns + j]
    }
}

/// A read-only rectangular block of a [`Matrix`]. Indices out of range panic, as for a slice.
#[derive(Clone, Copy, Debug)]
pub struct Block<'a, S> {
    matrix: &'a Matrix<S>,
    top: usize,
    left: usize,
    rows: usize,
    columns: usize,
}

impl<'a, S: Scalar> Block<'a, S> {
    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of columns.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Row `i`.
    pub fn row(&self, i: usize) -> &'a [S] {
        assert!(i < self.rows, "row {i} is outside a block of {} rows", self.rows);
        &self.matrix.row(self.top + i)[self.left..self.left + self.columns]
    }

    /// The first `rows` rows and `columns` columns.
    pub(crate) fn corner(&self, rows: usize, columns: usize) -> Self {
        assert!(rows <= self.rows && columns <= self.columns, "a corner is no larger than its block");
        Self { rows, columns, ..*self }
    }

    /// The rows, from the first to the last.
    pub fn iter_rows(&self) -> impl Iterator<Item = &'a [S]> {
        let block = *self;
        (0..self.rows).map(move |i| block.row(i))
    }
}

impl<'a> Block<'a, f64> {
    /// The same entries as an nalgebra view, without a copy.
    pub fn as_nalgebra(&self) -> DMatrixView<'a, f64, Dyn, Dyn> {
        let columns = self.matrix.columns;
        let empty = self.rows == 0 || self.columns == 0;
        let start = if empty { 0 } else { self.top * columns + self.left };
        let end = if empty { 0 } else { start + (self.rows - 1) * columns + self.columns };
        DMatrixView::from_slice_with_strides_generic(
            &self.matrix.data[start..end],
            Dyn::from_usize(self.rows),
            Dyn::from_usize(self.columns),
            Dyn::from_usize(columns),
            Dyn::from_usize(1),
        )
    }

    /// A copy as an nalgebra matrix.
    pub fn to_nalgebra(&self) -> DMatrix<f64> {
        self.as_nalgebra().into_owned()
    }
}

impl<S> Index<(usize, usize)> for Block<'_, S> {
    type Output = S;
    #[inline]
    fn index(&self, (i, j): (usize, usize)) -> &S {
        assert!(i < self.rows && j < self.columns, "({i}, {j}) is outside {} x {}", self.rows, self.columns);
        &self.matrix[(self.top + i, self.left + j)]
    }
}

#[cfg(test)]
mod tests {
    use super::Matrix;

    #[test]
    fn blocks_and_nalgebra_see_the_same_entries() {
        let mut m = Matrix::<f64>::zeros(4, 6);
        for i in 0..4 {
            for j in 0..6 {
                m[(i, j)] = (10 * i + j) as f64;
            }
        }
        let block = m.block(2, 3, 2, 3);
        assert_eq!(block.row(1), &[33.0, 34.0, 35.0]);
        let seen = block.as_nalgebra();
        assert_eq!(seen.shape(), (2, 3));
        for i in 0..2 {
            for j in 0..3 {
                assert_eq!(seen[(i, j)], block[(i, j)]);
            }
        }
        assert_eq!(m.view().to_nalgebra()[(3, 5)], 35.0);
        for (rows, columns) in [(0, 3), (3, 0), (0, 0)] {
            let empty = Matrix::<f64>::zeros(rows, columns);
            assert_eq!(empty.view().to_nalgebra().shape(), (rows, columns));
            assert_eq!(empty.view().iter_rows().count(), rows);
        }
        assert_eq!(m.block(4, 6, 0, 0).to_nalgebra().shape(), (0, 0));
    }

    #[test]
    #[should_panic(expected = "row 2 is outside a block of 2 rows")]
    fn a_block_ends_where_it_ends() {
        let m = Matrix::<f64>::zeros(4, 6);
        m.block(0, 0, 2, 3).row(2);
    }
}
