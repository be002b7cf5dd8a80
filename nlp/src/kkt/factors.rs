//! L, M and D of a stage, and substitution with them.
//!
//! Columns are taken four at a time, so that their sums and products are independent.

use super::front::{Front, Pivot, inverse_of_two};
use crate::tiles::{LANES, Sums, add_rows, four, fused, products};

#[derive(Clone, Debug, Default)]
pub(super) struct Factors {
    /// Global numbers of all rows, in the order of elimination.
    pub rows: Vec<usize>,
    pub pivots: Vec<Pivot>,
    eliminated: usize,
    stride: usize,
    /// The columns of the eliminated rows with padding, and columns of zeros up to a multiple of four.
    columns: Vec<f64>,
}

impl Factors {
    /// With room for a stage that can eliminate so many rows and shares some others, and for rows that wait.
    pub fn with_room(own: usize, shared: usize) -> Self {
        let (own, size) = (own + shared, own + 2 * shared + LANES);
        Self {
            rows: Vec::with_capacity(size),
            pivots: Vec::with_capacity(own),
            columns: Vec::with_capacity((own + LANES) * size),
            ..Self::default()
        }
    }

    /// Takes the eliminated columns, and the order of rows; `row` is that at a place of the front as it was
    /// assembled.
    #[inline(always)]
    pub fn take(&mut self, front: &Front, row: impl Fn(usize) -> usize) {
        self.rows.clear();
        self.rows.extend(front.order.iter().map(|&place| row(place)));
        self.pivots.clear();
        self.pivots.extend_from_slice(&front.pivots);
        (self.eliminated, self.stride) = (front.eliminated, front.stride());
        self.columns.clear();
        self.columns.extend_from_slice(front.factors());
        self.columns.resize(self.eliminated.next_multiple_of(LANES) * self.stride, 0.0);
    }

    /// Adds the rows with zero pivots.
    pub fn zeros(&self, zeros: &mut Vec<usize>) {
        let mut k = 0;
        for pivot in &self.pivots {
            if *pivot == Pivot::Zero {
                zeros.push(self.rows[k]);
            }
            k += pivot.order();
        }
    }

    /// `y = L^-1 x` of the eliminated rows, and x less M y of the others.
    #[inline(always)]
    pub fn forward<const FUSED: bool>(&self, x: &mut [f64], local: &mut Vec<f64>) {
        self.gather(x, local);
        for (panel, columns) in self.columns.chunks_exact(LANES * self.stride.max(1)).enumerate() {
            let (columns, triangle) = self.below(columns, panel);
            let (done, rest) = local.split_at_mut((panel + 1) * LANES);
            let done = &mut done[panel * LANES..];
            for j in 0..LANES {
                for i in j + 1..LANES {
                    done[i] = fused::<FUSED>(-triangle[j][i], done[j], done[i]);
                }
            }
            add_rows::<FUSED>(columns, four(|j| -done[j]), rest);
        }
        self.rows.iter().zip(&*local).for_each(|(&row, &value)| x[row] = value);
    }

    /// `L^-T (D^-1 y - M' x)` of the eliminated rows, where x of the others is known.
    #[inline(always)]
    pub fn backward<const FUSED: bool>(&self, x: &mut [f64], local: &mut Vec<f64>, sums: &mut Sums) {
        self.gather(x, local);
        let mut k = 0;
        for pivot in &self.pivots {
            match *pivot {
                Pivot::Zero => local[k] = 0.0,
                Pivot::One(d) => local[k] /= d,
                Pivot::Two(block) => [local[k], local[k + 1]] = inverse_of_two(block)(local[k], local[k + 1]),
            }
            k += pivot.order();
        }
        for (panel, columns) in self.columns.chunks_exact(LANES * self.stride.max(1)).enumerate().rev() {
            let (columns, triangle) = self.below(columns, panel);
            let (done, rest) = local.split_at_mut((panel + 1) * LANES);
            let done = &mut done[panel * LANES..];
            let sums = products::<FUSED>(columns, rest, sums);
            for j in (0..LANES).rev() {
                let mut sum = sums[j];
                for i in j + 1..LANES {
                    sum = fused::<FUSED>(triangle[j][i], done[i], sum);
                }
                done[j] -= sum;
            }
        }
        self.rows[..self.eliminated].iter().zip(&*local).for_each(|(&row, &value)| x[row] = value);
    }

    /// The entries of the rows of this stage, with padding.
    #[inline(always)]
    fn gather(&self, x: &[f64], local: &mut Vec<f64>) {
        local.clear();
        local.extend(self.rows.iter().map(|&row| x[row]));
        local.resize(self.stride, 0.0);
    }

    /// Of four columns the rows below the square on the diagonal, and this square.
    #[inline(always)]
    fn below<'a>(&self, columns: &'a [f64], panel: usize) -> ([&'a [f64]; LANES], [&'a [f64]; LANES]) {
        let column = |j: usize| columns[j * self.stride..][panel * LANES..self.stride].split_at(LANES);
        (four(|j| column(j).1), four(|j| column(j).0))
    }
}
