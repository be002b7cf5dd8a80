//! A matrix whose rows are whole packs.

use super::Matrix;
use crate::scalar::{Pack, Scalar};

/// A dense matrix whose rows are padded to a whole number of packs (of registers, if it is computed block by
/// block), and whose number of rows is padded in the same way: the operand of matrix products.
///
/// The padding is never read as a result.
#[derive(Clone, Debug)]
pub(crate) struct Panel<S: Scalar> {
    rows: usize,
    columns: usize,
    width: usize,
    data: Vec<S::Pack>,
}

/// A square matrix that fills a panel of the same size.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Source<'a, S: Scalar> {
    Matrix(&'a Matrix<S>),
    Panel(&'a Panel<S>),
}

impl<S: Scalar> Source<'_, S> {
    /// Entry (i, j).
    #[inline(always)]
    pub fn entry(&self, i: usize, j: usize) -> S {
        match self {
            Self::Matrix(matrix) => matrix[(i, j)],
            Self::Panel(panel) => panel.get(i, j),
        }
    }
}

/// The rows before one, that one, and those after it.
type Split<'a, P> = (&'a [P], &'a mut [P], &'a [P]);

/// Calls a method with the number of joints N and the packs W in a row of N entries as const parameters,
/// where packs have several lanes: both for arms of 6 and 7 joints and machines of 12, W alone for others up
/// to 12. 0 stands for "read the length".
///
/// The branch on a constant matters: code behind a false one is not even compiled.
macro_rules! sized {
    ($S:ty, $n:expr, $object:ident . $method:ident ( $($argument:expr),* )) => {
        if $crate::matrix::Panel::<$S>::ONE_LANE {
            $object.$method::<0, 0>($($argument),*)
        } else {
            match $n {
                6 => $object.$method::<6, 2>($($argument),*),
                7 => $object.$method::<7, 2>($($argument),*),
                12 => $object.$method::<12, 3>($($argument),*),
                1..=4 => $object.$method::<0, 1>($($argument),*),
                5 | 8 => $object.$method::<0, 2>($($argument),*),
                9..=11 => $object.$method::<0, 3>($($argument),*),
                _ => $object.$method::<0, 0>($($argument),*),
            }
        }
    };
}
pub(crate) use sized;

impl<S: Scalar> Panel<S> {
    /// Lanes of a pack.
    pub const LANES: usize = <S::Pack as Pack<S>>::LANES;

    /// Whether packs are single numbers.
    pub const ONE_LANE: bool = Self::LANES == 1;

    /// Whether matrices with so many rows are computed block by block: packs have several lanes, and a row
    /// more of them than [`sized`] knows.
    pub fn in_blocks(n: usize) -> bool {
        !Self::ONE_LANE && n > 12
    }

    /// What that needs; the function is not compiled where packs are single numbers.
    #[inline(always)]
    pub fn for_blocks<T>(n: usize, make: impl FnOnce() -> T) -> Option<Box<T>> {
        if Self::ONE_LANE { None } else { Self::in_blocks(n).then(|| Box::new(make())) }
    }

    /// A matrix of zeros.
    pub fn zeros(rows: usize, columns: usize) -> Self {
        // Tiles take whole registers.
        let packs = if Self::in_blocks(columns) { <S::Pack as Pack<S>>::WIDTH } else { 1 };
        let width = columns.div_ceil(Self::LANES).next_multiple_of(packs);
        let padded = rows.next_multiple_of(Self::LANES * packs);
        Self { rows, columns, width, data: vec![S::Pack::zero(); padded * width] }
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of columns.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Packs in a row. W: their number where it is known, else 0.
    #[inline(always)]
    pub fn width<const W: usize>(&self) -> usize {
        if W > 0 { W } else { self.width }
    }

    /// Packs that hold the first `columns` entries of a row, or all where that is free.
    #[inline(always)]
    pub fn width_up_to<const W: usize>(columns: usize) -> usize {
        if W > 0 { W } else { columns.div_ceil(Self::LANES) }
    }

    /// All packs, row by row.
    #[inline(always)]
    pub fn packs(&self) -> &[S::Pack] {
        &self.data
    }

    /// Mutable access to the same entries.
    #[inline(always)]
    pub fn packs_mut(&mut self) -> &mut [S::Pack] {
        &mut self.data
    }

    /// Row `i`.
    #[inline(always)]
    pub fn row(&self, i: usize) -> &[S::Pack] {
        &self.data[i * self.width..][..self.width]
    }

    /// Row `i`. W: packs per row if known, else 0.
    #[inline(always)]
    pub fn sized_row<const W: usize>(&self, i: usize) -> &[S::Pack] {
        let width = self.width::<W>();
        &self.data[i * width..][..width]
    }

    /// Mutable access to row `i`. W: packs per row if known, else 0.
    #[inline(always)]
    pub fn sized_row_mut<const W: usize>(&mut self, i: usize) -> &mut [S::Pack] {
        let width = self.width::<W>();
        &mut self.data[i * width..][..width]
    }

    /// Mutable access to row `i`.
    #[inline(always)]
    pub fn row_mut(&mut self, i: usize) -> &mut [S::Pack] {
        &mut self.data[i * self.width..][..self.width]
    }

    /// Row `i` to be written, the rows before it and those after it to be read.
    #[inline(always)]
    pub fn split_at_row<const W: usize>(&mut self, i: usize) -> Split<'_, S::Pack> {
        let width = self.width::<W>();
        let (before, from_i) = self.data.split_at_mut(i * width);
        let (row, after) = from_i.split_at_mut(width);
        (before, row, after)
    }

    /// Entry (i, j).
    #[inline(always)]
    pub fn get(&self, i: usize, j: usize) -> S {
        self.data[i * self.width + j / Self::LANES].lane(j % Self::LANES)
    }

    /// Entry (i, j). W: packs per row if known, else 0.
    #[inline(always)]
    pub fn entry<const W: usize>(&self, i: usize, j: usize) -> S {
        self.data[i * self.width::<W>() + j / Self::LANES].lane(j % Self::LANES)
    }

    /// Entry (i, j) in every lane.
    #[inline(always)]
    pub fn splat<const W: usize>(&self, i: usize, j: usize) -> S::Pack {
        S::Pack::splat(self.entry::<W>(i, j))
    }

    /// Puts a number into entry (i, j).
    #[inline(always)]
    pub fn set(&mut self, i: usize, j: usize, value: S) {
        self.data[i * self.width + j / Self::LANES].set_lane(j % Self::LANES, value);
    }

    /// Fills row `i` with numbers, as many as there are columns. N: their number where known, else 0.
    #[inline(always)]
    pub fn read_row<const N: usize>(&mut self, i: usize, from: &[S]) {
        let from = if N > 0 { &from[..N] } else { from };
        let row = self.row_mut(i);
        read_packs(from, |k, pack| row[k] = pack);
    }

    /// Takes the entries of a panel of the same size.
    #[inline(always)]
    pub fn copy_from<const N: usize, const W: usize>(&mut self, from: &Self) {
        if N == 0 {
            return self.data.copy_from_slice(&from.data);
        }
        let (to, from) = (&mut self.data[..N * W], &from.data[..N * W]);
        for (to, &from) in to.iter_mut().zip(from) {
            *to = from;
        }
    }

    /// Subtracts numbers, as many as there are columns, from row `i`.
    pub fn subtract_row(&mut self, i: usize, numbers: &[S]) {
        let row = self.row_mut(i);
        read_packs(numbers, |k, pack| row[k] -= pack);
    }

    /// Subtracts a panel of the same size.
    #[inline(always)]
    pub fn subtract(&mut self, other: &Self) {
        self.data.iter_mut().zip(&other.data).for_each(|(entry, &other)| *entry -= other);
    }

    /// `A - B`, of a panel and a matrix of the same size.
    pub fn set_difference(&mut self, a: &Self, b: &Matrix<S>) {
        for i in 0..self.rows {
            let (row, a) = (self.row_mut(i), a.row(i));
            read_packs(b.row(i), |k, pack| row[k] = a[k] - pack);
        }
    }

    /// Copies the entries of a matrix of the same size.
    #[inline(always)]
    pub fn read<const N: usize>(&mut self, from: &Matrix<S>) {
        for i in 0..if N > 0 { N } else { self.rows } {
            self.read_row::<N>(i, from.row(i));
        }
    }

    /// The same from either.
    #[inline(always)]
    pub fn take<const N: usize, const W: usize>(&mut self, from: Source<'_, S>) {
        match from {
            Source::Matrix(matrix) => self.read::<N>(matrix),
            Source::Panel(panel) => self.copy_from::<N, W>(panel),
        }
    }

    /// That panel, or this one with the entries of the matrix.
    pub fn of<'a>(&'a mut self, from: Source<'a, S>) -> &'a Self {
        match from {
            Source::Matrix(matrix) => self.read::<0>(matrix),
            Source::Panel(panel) => return panel,
        }
        self
    }

    /// Fills row `i` with the unit vector `e_i`. W: packs per row if known, else 0.
    #[inline(always)]
    pub fn set_unit_row<const W: usize>(&mut self, i: usize) {
        let zero = S::Pack::zero();
        let row = self.sized_row_mut::<W>(i);
        for pack in row.iter_mut() {
            *pack = zero;
        }
        row[i / Self::LANES] = zero.with_lane(i % Self::LANES, S::one());
    }

    /// Tells the compiler the number of packs of a panel of N x N entries, W packs per row, so that it can
    /// drop index checks.
    #[inline(always)]
    pub fn has_size<const N: usize, const W: usize>(&self) {
        if N > 0 {
            assert!(self.data.len() == N.next_multiple_of(Self::LANES) * W, "a panel of {N} x {N}");
        }
    }

    /// Writes `function` of row `i` to `to`, whose length is the number of columns.
    #[inline(always)]
    pub fn write_row<const W: usize>(&self, i: usize, to: &mut [S], function: impl Fn(S::Pack) -> S::Pack) {
        for (pack, to) in self.sized_row::<W>(i).iter().zip(to.chunks_mut(Self::LANES)) {
            function(*pack).write(to);
        }
    }

    /// Writes all entries to a matrix of the same size.
    pub fn write(&self, to: &mut Matrix<S>) {
        (0..self.rows).for_each(|i| self.write_row::<0>(i, to.row_mut(i), |pack| pack));
    }
}

/// Reads numbers as packs: calls for each with its place.
#[inline(always)]
fn read_packs<S: Scalar>(from: &[S], mut take: impl FnMut(usize, S::Pack)) {
    let packs = from.chunks_exact(Panel::<S>::LANES);
    let rest = packs.remainder();
    // Whole packs apart: each is one load.
    for (k, pack) in packs.enumerate() {
        take(k, S::Pack::read(pack));
    }
    if !rest.is_empty() {
        take(from.len() / Panel::<S>::LANES, S::Pack::read(rest));
    }
}
