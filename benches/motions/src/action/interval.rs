//! The second derivatives of the action over one interval, without its inner points.

use super::points::{BLOCKS, WEIGHTS, differentiation};
use crate::numerics::{Rows, WrongSign, backward, factorise, forward, negate, subtract};
use costate::matrix::{add_scaled, dot};

/// Where the points of an interval stand in its matrix: inner ones first, then the left and the right node.
const PLACE: [usize; 4] = [2, 0, 1, 3];

/// The factors of one interval.
///
/// Its matrix Z, minus the second derivatives, has the unknowns q of the inner points, q of the nodes and y
/// of the nodes; y of the inner points meet no other y, and are eliminated as squares.
#[derive(Clone)]
pub struct Interval {
    n: usize,
    /// Rows of the inner q, 2n x 6n.
    inner: Vec<f64>,
    /// Rows of the inner y: `K^-1/2 A`, 2n x 4n, K the prices of controls.
    pull: Vec<f64>,
    /// K^-1/2, 2n.
    root: Vec<f64>,
}

/// What eliminations of all intervals share.
pub struct Work {
    d: [[f64; 4]; 4],
    /// Of the nodes, 4n x 4n: q left and right, y left and right.
    pub nodes: Vec<f64>,
    /// Rows of A of the y of the nodes, 2n x 4n.
    of_nodes: Vec<f64>,
    /// One row for each point.
    sums: Vec<f64>,
    /// One row.
    row: Vec<f64>,
    /// A part of a vector.
    pub part: Vec<f64>,
}

impl Work {
    pub fn new(n: usize) -> Self {
        Self {
            d: differentiation(),
            nodes: vec![0.0; 16 * n * n],
            of_nodes: vec![0.0; 8 * n * n],
            sums: vec![0.0; 16 * n],
            row: vec![0.0; 4 * n],
            part: vec![0.0; 6 * n],
        }
    }
}

/// Rows a of the blocks for one kind of row: those by the variable itself, and by its rate.
struct Row<'a> {
    own: [&'a [f64]; 4],
    /// `[by q, by v]` of the rate.
    rate: [[&'a [f64]; 4]; 2],
}

impl Interval {
    pub fn new(n: usize) -> Self {
        let zeros = |count: usize| vec![0.0; count * n * n];
        Self { n, inner: zeros(12), pull: zeros(8), root: vec![0.0; 2 * n] }
    }

    /// Eliminates the inner unknowns; leaves the matrix of the nodes in `work`. `price`: b^2 / r of the
    /// controls.
    pub fn condense(
        &mut self,
        h: f64,
        price: &[f64],
        blocks: &[f64],
        work: &mut Work,
    ) -> Result<(), WrongSign> {
        let n = self.n;
        let (wide, most) = (4 * n, 6 * n);
        self.inner.fill(0.0);
        work.nodes.fill(0.0);
        let block = |k: usize, a: usize| -> [&[f64]; 4] {
            std::array::from_fn(|i| &blocks[((i * BLOCKS + k) * n + a) * n..][..n])
        };
        for a in 0..n {
            let rows = Row { own: block(0, a), rate: [block(2, a), block(3, a)] };
            rows.sum(&work.d, &mut work.sums);
            for (j, place) in PLACE.into_iter().enumerate() {
                let to = match place {
                    place @ 0..2 => &mut self.pull[(place * n + a) * wide..][..wide],
                    place => &mut work.of_nodes[((place - 2) * n + a) * wide..][..wide],
                };
                rows.collect(&work.d, &work.sums, j, to);
                let by_v = block(1, a)[j];
                for m in 0..4 {
                    add_scaled(&mut to[PLACE[m] * n..][..n], work.d[j][m], by_v);
                }
            }
            let rows = Row { own: block(4, a), rate: [block(5, a), block(6, a)] };
            rows.sum(&work.d, &mut work.sums);
            for j in 0..4 {
                let row = &mut work.row;
                rows.collect(&work.d, &work.sums, j, row);
                for m in 0..4 {
                    for b in 0..n {
                        row[PLACE[m] * n + b] += work.d[j][m] * blocks[((j * BLOCKS + 5) * n + b) * n + a];
                    }
                }
                match PLACE[j] {
                    place @ 0..2 => self.inner[(place * n + a) * most..][..wide].copy_from_slice(row),
                    place => {
                        work.nodes[((place - 2) * n + a) * wide..][..2 * n].copy_from_slice(&row[2 * n..])
                    }
                }
            }
        }
        for (e, row) in self.pull.chunks_exact_mut(wide).enumerate() {
            self.root[e] = 1.0 / (h * WEIGHTS[1] * price[e % n]).sqrt();
            row.iter_mut().for_each(|entry| *entry *= self.root[e]);
        }
        subtract((&self.pull, wide), 0, (&mut self.inner, most), wide);
        let of_q = 2 * n * wide;
        subtract((&self.pull, wide), 2 * n, (&mut work.nodes[..of_q], wide), 2 * n);
        negate(&mut self.inner);
        negate(&mut work.nodes);
        for (e, row) in work.of_nodes.chunks_exact(wide).enumerate() {
            for c in 0..2 * n {
                self.inner[c * most + wide + e] = -row[c];
                work.nodes[c * wide + 2 * n + e] = -row[2 * n + c];
            }
            work.nodes[(2 * n + e) * wide + 2 * n + e] = -h * WEIGHTS[0] * price[e % n];
        }
        factorise(&mut self.inner, most)?;
        subtract((&self.inner, most), 2 * n, (&mut work.nodes, wide), wide);
        Ok(())
    }

    fn rows(&self) -> Rows<'_> {
        (&self.inner, 6 * self.n)
    }

    /// The right-hand side of the inner unknowns, eliminated; what it adds to that of the nodes is left in
    /// `part`: q left and right, y left and right.
    pub fn reduce(&self, q: &mut [f64], y: &mut [f64], part: &mut [f64]) {
        let n = self.n;
        part[..2 * n].copy_from_slice(q);
        part[2 * n..].fill(0.0);
        for ((y, root), row) in y.iter_mut().zip(&self.root).zip(self.pull.chunks_exact(4 * n)) {
            *y *= root;
            add_scaled(&mut part[..4 * n], -*y, row);
        }
        forward(self.rows(), part);
        q.copy_from_slice(&part[..2 * n]);
    }

    /// The inner unknowns from those of the nodes, in `part`.
    pub fn expand(&self, q: &mut [f64], y: &mut [f64], part: &mut [f64]) {
        let n = self.n;
        part[..2 * n].copy_from_slice(q);
        backward(self.rows(), part);
        q.copy_from_slice(&part[..2 * n]);
        for ((y, root), row) in y.iter_mut().zip(&self.root).zip(self.pull.chunks_exact(4 * n)) {
            *y = -root * (*y + dot(row, &part[..4 * n]));
        }
    }
}

impl Row<'_> {
    /// For each point the row by the rates there, in all unknowns.
    #[inline(always)]
    fn sum(&self, d: &[[f64; 4]; 4], sums: &mut [f64]) {
        let n = self.own[0].len();
        for (i, sums) in sums.chunks_exact_mut(4 * n).enumerate() {
            for m in 0..4 {
                let to = &mut sums[PLACE[m] * n..][..n];
                to.iter_mut().zip(self.rate[1][i]).for_each(|(to, entry)| *to = d[i][m] * entry);
            }
            add_scaled(&mut sums[PLACE[i] * n..][..n], 1.0, self.rate[0][i]);
        }
    }

    /// The row of point j, but for what meets the rates in its columns.
    #[inline(always)]
    fn collect(&self, d: &[[f64; 4]; 4], sums: &[f64], j: usize, to: &mut [f64]) {
        let (n, width) = (self.own[0].len(), to.len());
        let [a, b, c, e] = [0, 1, 2, 3].map(|i| &sums[i * width..][..width]);
        for k in 0..width {
            to[k] = d[0][j] * a[k] + d[1][j] * b[k] + d[2][j] * c[k] + d[3][j] * e[k];
        }
        add_scaled(&mut to[PLACE[j] * n..][..n], 1.0, self.own[j]);
    }
}
