//! Vectors, and products with the blocks of elements.

use crate::blocks::Dense;
use crate::layout::{Element, Layout};
use crate::tiles::{LANES, Sums, add_rows, fused, products};

/// A square matrix of zeros for each element, its rows padded for tiles.
pub(crate) fn squares(layout: &Layout) -> Vec<Dense> {
    let square = |width: usize| Dense::zeros(width, width.next_multiple_of(LANES));
    layout.elements().map(|element| square(layout.width(element))).collect()
}

/// Entries of one element, twice, and partial sums of scalar products.
#[derive(Clone, Debug)]
pub(crate) struct Room {
    first: Vec<f64>,
    second: Vec<f64>,
    pub sums: Sums,
}

impl Room {
    /// For any element.
    pub fn new(layout: &Layout) -> Self {
        let most = layout.elements().map(|element| layout.width(element)).max().unwrap_or(0);
        Self { first: vec![0.0; most], second: vec![0.0; most], sums: Sums::default() }
    }

    /// For an element with so many unknowns.
    #[inline(always)]
    pub fn of(&mut self, width: usize) -> (&mut [f64], &mut [f64], &mut Sums) {
        (&mut self.first[..width], &mut self.second[..width], &mut self.sums)
    }
}

/// Which rows of a Jacobian have one entry that is not zero, such as limits of one unknown.
#[derive(Clone, Debug, Default)]
pub(crate) struct Pattern {
    /// Row and column.
    pub single: Vec<[usize; 2]>,
    pub dense: Vec<usize>,
}

impl Pattern {
    /// Of so many rows, all dense.
    pub fn dense(rows: usize) -> Self {
        Self { single: Vec::with_capacity(rows), dense: (0..rows).collect() }
    }

    pub fn clear(&mut self) {
        self.single.clear();
        self.dense.clear();
    }

    /// Adds the next row, which has so many entries other than zero.
    #[inline(always)]
    pub fn push(&mut self, row: &[f64], count: u64) {
        let i = self.single.len() + self.dense.len();
        match row.iter().position(|&entry| entry != 0.0) {
            Some(column) if count == 1 => self.single.push([i, column]),
            _ => self.dense.push(i),
        }
    }

    /// The dense rows, four at a time; the last ones are repeated.
    #[inline(always)]
    fn fours(&self) -> impl Iterator<Item = ([usize; 4], usize)> {
        let of = |rows: &[usize]| (std::array::from_fn(|r| rows[r.min(rows.len() - 1)]), rows.len());
        self.dense.chunks(4).map(of)
    }
}

/// The largest absolute value; not-a-number if one is.
pub(crate) fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, value| worse(most, value.abs()))
}

/// The larger one; not-a-number is the largest.
#[inline(always)]
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
pub(crate) fn times<const FUSED: bool>(
    (rows, pattern): (&Dense, &Pattern),
    d: &[f64],
    to: &mut [f64],
    sums: &mut Sums,
) {
    for &[i, column] in &pattern.single {
        to[i] = rows[(i, column)] * d[column];
    }
    for (places, _) in pattern.fours() {
        let found = products::<FUSED>(places.map(|i| rows.row(i)), d, sums);
        places.into_iter().zip(found).for_each(|(i, product)| to[i] = product);
    }
}

/// `to += A' y`, for the entries `to` of an element.
#[inline(always)]
pub(crate) fn add_transposed<const FUSED: bool>(
    (rows, pattern): (&Dense, &Pattern),
    y: &[f64],
    to: &mut [f64],
) {
    for &[i, column] in &pattern.single {
        to[column] = fused::<FUSED>(rows[(i, column)], y[i], to[column]);
    }
    for (places, count) in pattern.fours() {
        let factors = std::array::from_fn(|r| if r < count { y[places[r]] } else { 0.0 });
        add_rows::<FUSED>(places.map(|i| rows.row(i)), factors, to);
    }
}

/// `to += W d`, of the upper triangle of W.
#[inline(always)]
pub(crate) fn add_symmetric<const FUSED: bool>(hessian: &Dense, d: &[f64], to: &mut [f64], sums: &mut Sums) {
    let n = d.len();
    for i in (0..n).step_by(4) {
        let end = n.min(i + 4);
        // The square on the diagonal, then the rest of its rows.
        for row in i..end {
            to[row] = fused::<FUSED>(hessian[(row, row)], d[row], to[row]);
            for column in row + 1..end {
                let entry = hessian[(row, column)];
                to[row] = fused::<FUSED>(entry, d[column], to[row]);
                to[column] = fused::<FUSED>(entry, d[row], to[column]);
            }
        }
        if end < n {
            let rows = [0, 1, 2, 3].map(|r| &hessian.row(i + r)[end..n]);
            let found = products::<FUSED>(rows, &d[end..], sums);
            add_rows::<FUSED>(rows, [d[i], d[i + 1], d[i + 2], d[i + 3]], &mut to[end..]);
            to[i..end].iter_mut().zip(found).for_each(|(to, product)| *to += product);
        }
    }
}
