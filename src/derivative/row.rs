//! One comparison: the difference of two matrices, and how it is judged.

use super::report::{Figure, Verdict, worse};
use crate::matrix::{Block, Matrix};
use crate::scalar::{Count, Scalar};

/// Half the distance from 1 to the next `f64`: the largest relative error of one operation, u = 2^-53.
const UNIT: f64 = 0.5 * f64::EPSILON;

/// How many standard deviations of its rounding error a difference may have, see [`Routes`](super::Routes).
pub const SAFETY: f64 = 32.0;

/// Exponents of the scales `d_i = sqrt(M_ii)`, see [`Row`]: of x = (q, p), and of what is dual to it.
pub(super) const STATE: &[i8] = &[1, -1];
pub(super) const COSTATE: &[i8] = &[-1, 1];

/// The difference of two matrices that should be equal.
///
/// It is judged block by block, each block in scaled coordinates `q_i d_i`, `p_i / d_i`, where the largest
/// entries of the difference and of its rounding error are compared. So the verdict does not depend on units,
/// and an entry that vanishes by cancellation is judged by its block.
#[derive(Clone, Debug)]
pub(crate) struct Row<S> {
    /// Quantity and method.
    pub name: [&'static str; 2],
    pub difference: Matrix<S>,
    /// The reference, for the size.
    pub size: Matrix<S>,
    /// Row and column i are multiplied by `d_i^e`, `d_i = sqrt(M_ii)`, with one exponent e for every n of
    /// them; exponent 0 means a single row or column that keeps its unit.
    pub scales: [&'static [i8]; 2],
}

impl<S: Scalar> Row<S> {
    #[inline]
    pub fn new(
        name: [&'static str; 2],
        found: Block<'_, S>,
        reference: Block<'_, S>,
        scales: [&'static [i8]; 2],
    ) -> Self {
        let (rows, columns) = (reference.rows(), reference.columns());
        let difference = matrix(rows, columns, |i, j| found.row(i)[j] - reference.row(i)[j]);
        Self { name, difference, size: matrix(rows, columns, |i, j| reference.row(i)[j]), scales }
    }

    /// `A - A'` of a matrix that should be symmetric.
    #[inline]
    pub fn asymmetry(name: [&'static str; 2], a: &Matrix<S>, scale: &'static [i8]) -> Self {
        let transpose = matrix(a.columns(), a.rows(), |i, j| a[(j, i)]);
        Self::new(name, a.view(), transpose.view(), [scale, scale])
    }
}

/// A row and its rounding errors.
#[derive(Clone, Debug)]
pub(crate) struct Judged {
    pub row: Row<f64>,
    pub rounded: Row<Count>,
}

impl Judged {
    /// Compares block by block and keeps the worst block; a row without blocks agrees.
    pub fn judge(&self, d: &[f64]) -> Figure {
        let [quantity, route] = self.row.name;
        let none = Figure { quantity, route, difference: 0.0, bound: 0.0 };
        let figures = self.blocks(d).map(|block| self.figure(&block));
        figures.reduce(|worst, figure| worst.or_worse(&figure)).unwrap_or(none)
    }

    /// Whether a change of the largest entry of each block, by this part of it, exceeds the bound. Blocks
    /// that are rounding only are passed over.
    pub fn detects(&self, change: f64, d: &[f64]) -> bool {
        self.blocks(d).filter(|block| block.size > SAFETY * UNIT * block.error).all(|block| {
            let changed = Largest { difference: change * block.size - block.difference, ..block };
            self.figure(&changed).verdict(1.0) == Verdict::Differs
        })
    }

    /// Relative bound of one block.
    pub fn bound(&self, [row, column]: [usize; 2], d: &[f64]) -> f64 {
        let [rows, columns] = self.row.scales.map(|exponents| parts(exponents, d));
        self.figure(&self.largest(&rows[row], &columns[column])).bound
    }

    /// A block relative to its size.
    fn figure(&self, block: &Largest) -> Figure {
        let [quantity, route] = self.row.name;
        let Largest { difference, error, size } = *block;
        let relative = |x: f64| if size == 0.0 { x } else { x / size };
        Figure { quantity, route, difference: relative(difference), bound: SAFETY * UNIT * relative(error) }
    }

    fn blocks(&self, d: &[f64]) -> impl Iterator<Item = Largest> {
        let [rows, columns] = self.row.scales.map(|exponents| parts(exponents, d));
        rows.into_iter()
            .flat_map(move |down| columns.clone().into_iter().map(move |right| self.largest(&down, &right)))
    }

    fn largest(&self, rows: &Part, columns: &Part) -> Largest {
        let mut largest = Largest { difference: 0.0, error: 0.0, size: 0.0 };
        for (i, a) in rows.scales.iter().enumerate() {
            for (j, b) in columns.scales.iter().enumerate() {
                let (at, scale) = ((rows.start + i, columns.start + j), a * b);
                let difference = self.row.difference[at].abs() * scale;
                largest.difference = worse(largest.difference, difference);
                largest.error = worse(largest.error, self.rounded.difference[at].rounding() * scale);
                largest.size = worse(largest.size, self.row.size[at].abs() * scale + difference);
            }
        }
        largest
    }
}

/// Largest scaled entries of a block.
struct Largest {
    difference: f64,
    /// Standard deviation, in units of u.
    error: f64,
    size: f64,
}

/// A part of the rows or columns.
#[derive(Clone)]
struct Part {
    start: usize,
    scales: Vec<f64>,
}

fn parts(exponents: &[i8], d: &[f64]) -> Vec<Part> {
    let mut begin = 0;
    let part = |&exponent: &i8| {
        let scales = match exponent {
            0 => vec![1.0],
            _ => d.iter().map(|d| d.powi(i32::from(exponent))).collect(),
        };
        let start = begin;
        begin += scales.len();
        Part { start, scales }
    };
    exponents.iter().map(part).collect()
}

/// A matrix by its entries.
#[inline]
pub(crate) fn matrix<S: Scalar>(rows: usize, columns: usize, entry: impl Fn(usize, usize) -> S) -> Matrix<S> {
    let mut matrix = Matrix::zeros(rows, columns);
    for i in 0..rows {
        for j in 0..columns {
            matrix[(i, j)] = entry(i, j);
        }
    }
    matrix
}
