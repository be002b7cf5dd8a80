//! Elimination of the matrix of a chain from its last node on: what is left of it behind each node.
//!
//! The part of a chain behind node k, with the unknowns x of that node given, has the unknowns y of the next
//! interval and node and those behind them. With the latter eliminated the equations are
//!
//! $$ \begin{pmatrix} Y & Z \\\\ Z^\top & W \end{pmatrix} \begin{pmatrix} y \\\\ w \end{pmatrix} = 0, \qquad
//!    y = -Y^{-1} Z w, \qquad S = W - Z^\top Y^{-1} Z $$
//!
//! with w = (x, shared unknowns). S, the second derivatives of the least value by w, takes the place of W at
//! node k when the interval before it is eliminated: one sweep for all nodes.
//!
//! The unknowns of the next node may be differences d: the node is F x + d. It contributes `d' S d / 2 + d' S
//! F x + x' F' S F x / 2` then, and the rounding of an interval that is much stiffer does not reach S.

use super::chain::{ChainMatrix, NotPositiveDefinite};
use super::substitution::backward;
use super::tiles::{BadPivot, factorise_rows, subtract_square};

/// Most orders of derivatives at a node.
const MOST_ORDERS: usize = 3;

/// What is left behind a node.
#[derive(Clone, Debug)]
pub(crate) struct ChainEnd {
    node: usize,
    inner: usize,
    shared: usize,
    /// Rows `[Y Z]`, then of U with Y = U'U: inner unknowns, the next node; columns of these, of node k and
    /// of what is shared.
    rows: Vec<f64>,
    /// S - W in w = (x, shared), the upper triangle, and S.
    carried: Vec<f64>,
    schur: Vec<f64>,
    part: Vec<f64>,
    /// S at the next node, all of it, and S F.
    next: Vec<f64>,
    next_flow: Vec<f64>,
}

impl ChainEnd {
    /// For so many unknowns of a node, of an interval, and shared ones.
    pub fn new(node: usize, inner: usize, shared: usize) -> Self {
        let (rows, kept) = (inner + node, node + shared);
        Self {
            node,
            inner,
            shared,
            rows: vec![0.0; rows * (rows + kept)],
            carried: vec![0.0; kept * kept],
            schur: vec![0.0; kept * kept],
            part: vec![0.0; rows + kept],
            next: vec![0.0; node * node],
            next_flow: vec![0.0; node * node],
        }
    }

    /// Begins at the last node.
    pub fn begin(&mut self) {
        self.carried.fill(0.0);
    }

    /// Takes S of the node behind interval k, before that is added to the matrix.
    pub fn take_next(&mut self, k: usize, matrix: &ChainMatrix) {
        let (node, kept) = (self.node, self.node + self.shared);
        let rows = matrix.blocks(k).2;
        for i in 0..node {
            for j in i..node {
                let entry = rows[2 * node * i + j] + self.carried[kept * i + j];
                (self.next[node * i + j], self.next[node * j + i]) = (entry, entry);
            }
        }
    }

    /// Goes on to node k, whose interval is assembled in the matrix with all behind it. `columns` are those
    /// of the shared unknowns, and `corner` their own second derivatives, row by row. Unknowns of the next
    /// node that are `removed` are given. With a `flow` they are differences: F is that with each entry times
    /// the identity, rows of removed unknowns are zero, [S of the node](Self::take_next) is known, and
    /// nothing shared counts.
    ///
    /// # Errors
    /// [`NotPositiveDefinite`].
    pub fn take<'a>(
        &mut self,
        k: usize,
        matrix: &ChainMatrix,
        columns: impl Fn(usize) -> &'a [f64],
        corner: &[f64],
        removed: impl Fn(usize) -> bool,
        flow: Option<&[[f64; MOST_ORDERS]]>,
    ) -> Result<(), NotPositiveDefinite> {
        let (node, inner, shared) = (self.node, self.inner, self.shared);
        let (count, kept) = (inner + node, node + shared);
        let width = count + kept;
        let (of_inner, left, right) = matrix.blocks(k);
        let nodes = node * (matrix.intervals() + 1);
        self.rows.fill(0.0);
        let (inner_rows, node_rows) = self.rows.split_at_mut(inner * width);
        for (i, row) in inner_rows.chunks_exact_mut(width).enumerate() {
            let from = &of_inner[(inner + 2 * node) * i..][..inner + 2 * node];
            row[..inner].copy_from_slice(&from[..inner]);
            row[inner..count].copy_from_slice(&from[inner + node..]);
            row[count..count + node].copy_from_slice(&from[inner..inner + node]);
            let shared = row[count + node..].iter_mut().enumerate();
            shared.for_each(|(j, to)| *to = columns(j)[nodes + inner * k + i]);
        }
        for (i, row) in node_rows.chunks_exact_mut(width).enumerate() {
            let own = right[2 * node * i..][..node].iter().zip(&self.carried[kept * i..]);
            row[inner..count].iter_mut().zip(own).for_each(|(to, (own, carried))| *to = own + carried);
            for (l, to) in row[count..count + node].iter_mut().enumerate() {
                *to = left[2 * node * l + node + i];
            }
            for (j, to) in row[count + node..].iter_mut().enumerate() {
                *to = columns(j)[node * (k + 1) + i] + self.carried[kept * i + node + j];
            }
        }
        if let Some(flow) = flow {
            times_flow(&self.next, flow, node, &mut self.next_flow);
            let rows = self.rows.chunks_exact_mut(width).skip(inner);
            for (row, product) in rows.zip(self.next_flow.chunks_exact(node)) {
                row[count..count + node].iter_mut().zip(product).for_each(|(to, from)| *to += from);
            }
        }
        for i in (0..node).filter(|i| removed(*i)) {
            let at = inner + i;
            self.rows.chunks_exact_mut(width).for_each(|row| row[at] = 0.0);
            self.rows[width * at..width * (at + 1)].fill(0.0);
            self.rows[(width + 1) * at] = 1.0;
        }
        factorise_rows(&mut self.rows, width, count, width)
            .map_err(|BadPivot| NotPositiveDefinite { block: k })?;
        for row in self.carried.chunks_exact_mut(kept).take(node) {
            row.fill(0.0);
        }
        subtract_square((&self.rows, width), count, (&mut self.carried, kept), kept, kept);
        if let Some(flow) = flow {
            // (S F)' F.
            for i in 0..node {
                (0..node).for_each(|j| self.next[node * j + i] = self.next_flow[node * i + j]);
            }
            times_flow(&self.next, flow, node, &mut self.next_flow);
            for (carried, product) in
                self.carried.chunks_exact_mut(kept).zip(self.next_flow.chunks_exact(node))
            {
                carried.iter_mut().zip(product).for_each(|(to, from)| *to += from);
            }
        }
        // With W, which is complete behind this node.
        for i in 0..kept {
            for j in i..kept {
                let own = match (i < node, j < node) {
                    (true, true) => left[2 * node * i + j],
                    (true, false) => columns(j - node)[node * k + i],
                    _ => corner[shared * (i - node) + j - node],
                };
                let entry = own + self.carried[kept * i + j];
                (self.schur[kept * i + j], self.schur[kept * j + i]) = (entry, entry);
            }
        }
        Ok(())
    }

    /// S at this node, row by row.
    pub fn schur(&self) -> &[f64] {
        &self.schur
    }

    /// y and w by w: inner unknowns, those of the next node, of this one, shared ones.
    pub fn respond(&mut self, kept: &[f64]) -> &[f64] {
        let count = self.inner + self.node;
        self.part[..count].fill(0.0);
        self.part[count..].copy_from_slice(kept);
        backward(&self.rows, self.part.len(), &mut self.part);
        &self.part
    }
}

/// S F: columns of order m are the sums of those of all orders i times the entries (i, m) of the flow.
fn times_flow(rows: &[f64], flow: &[[f64; MOST_ORDERS]], node: usize, to: &mut [f64]) {
    let n = node / flow.len();
    for (s, to) in rows.chunks_exact(node).zip(to.chunks_exact_mut(node)) {
        for (m, to) in to.chunks_exact_mut(n).enumerate() {
            to.fill(0.0);
            for (s, row) in s.chunks_exact(n).zip(flow) {
                to.iter_mut().zip(s).for_each(|(to, s)| *to += row[m] * s);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};

    /// Responses behind each node, and second derivatives of the least value, against dense elimination.
    #[test]
    fn elimination_from_the_end_is_that_of_the_dense_matrix() {
        let (node, inner, intervals, shared) = (3, 2, 4, 2);
        let mut random = fastrand::Rng::with_seed(11);
        let mut matrix = ChainMatrix::new(node, inner);
        matrix.reset(intervals);
        let width = matrix.inner_width();
        for k in 0..intervals {
            for _ in 0..width + 2 {
                let row: Vec<f64> = (0..width).map(|_| random.f64() - 0.5).collect();
                matrix.add_square(k, 1.0, &row);
            }
        }
        let size = matrix.size();
        let columns: Vec<Vec<f64>> =
            (0..shared).map(|_| (0..size).map(|_| random.f64() - 0.5).collect()).collect();
        let corner = [9.0, 0.5, 0.5, 8.0];
        // One unknown of the last node is given.
        let given = |k: usize, i: usize| k == intervals && i == 1;
        let mut end = ChainEnd::new(node, inner, shared);
        end.begin();
        for k in (0..intervals).rev() {
            end.take(k, &matrix, |j| &columns[j], &corner, |i| given(k + 1, i), None).unwrap();
            // Unknowns behind the node, then w.
            let nodes = node * (intervals + 1);
            let behind: Vec<usize> = (node * (k + 1)..nodes)
                .filter(|&at| !given(at / node, at % node))
                .chain(nodes + inner * k..size)
                .collect();
            let dense =
                DMatrix::from_fn(behind.len(), behind.len(), |i, j| matrix.entry(behind[i], behind[j]));
            let w = node + shared;
            let coupling = DMatrix::from_fn(behind.len(), w, |i, j| match j < node {
                true => matrix.entry(behind[i], node * k + j),
                false => columns[j - node][behind[i]],
            });
            let response = -dense.lu().solve(&coupling).unwrap();
            let least = coupling.transpose() * &response;
            for i in 0..w {
                for j in 0..w {
                    let own = match (i < node, j < node) {
                        (true, true) => matrix.entry(node * k + i, node * k + j),
                        (true, false) => columns[j - node][node * k + i],
                        (false, true) => columns[i - node][node * k + j],
                        _ => corner[shared * (i - node) + j - node],
                    };
                    let (found, expected) = (end.schur()[w * i + j], own + least[(i, j)]);
                    assert!((found - expected).abs() < 1e-12 * (1.0 + expected.abs()), "{k} {i} {j}");
                }
                let unit = DVector::from_fn(w, |l, _| f64::from(l == i));
                let found = end.respond(unit.as_slice());
                let at = |place: usize| behind.iter().position(|&own| own == place);
                for (l, &entry) in found.iter().enumerate().take(inner + node) {
                    let place = if l < inner { nodes + inner * k + l } else { node * (k + 1) + l - inner };
                    let expected = at(place).map_or(0.0, |row| response[(row, i)]);
                    assert!((entry - expected).abs() < 1e-12, "{k} {i} {l}: {entry} {expected}");
                }
            }
        }
    }

    /// S of a chain in differences is that of the chain in unknowns; and it keeps its digits where intervals
    /// are stiff in the differences: they are zero then, and S is F' S F with what intervals have of the node
    /// before.
    #[test]
    fn differences_have_the_same_second_derivatives() {
        let (node, inner, intervals) = (4, 1, 5);
        let flow = [[0.5, 0.8, 0.0], [0.0, 0.7, 0.0]];
        let all = DMatrix::from_fn(node, node, |i, j| if i % 2 == j % 2 { flow[i / 2][j / 2] } else { 0.0 });
        let mut random = fastrand::Rng::with_seed(12);
        for stiffness in [1.0, 1e16] {
            let (mut known, mut own) = (ChainMatrix::new(node, inner), ChainMatrix::new(node, inner));
            let mut ends = [ChainEnd::new(node, inner, 0), ChainEnd::new(node, inner, 0)];
            known.reset(intervals);
            own.reset(intervals);
            ends.iter_mut().for_each(ChainEnd::begin);
            let mut limit = DMatrix::zeros(node, node);
            for k in (0..intervals).rev() {
                ends[0].take_next(k, &known);
                ends[1].take_next(k, &own);
                limit = all.transpose() * limit * &all;
                for r in 0..2 * (inner + node) {
                    let mut row: Vec<f64> = (0..inner + 2 * node).map(|_| random.f64() - 0.5).collect();
                    let is_stiff = r < inner + node;
                    if is_stiff {
                        row[inner..inner + node].fill(0.0);
                    }
                    let left = DVector::from_column_slice(&row[inner..inner + node]);
                    limit += &left * left.transpose();
                    let factor = if is_stiff { stiffness } else { 1.0 };
                    own.add_square(k, factor, &row);
                    // In x and y, with d = y - F x.
                    let (left, right) = row[inner..].split_at_mut(node);
                    for (l, left) in left.iter_mut().enumerate() {
                        *left -= (0..node).map(|i| right[i] * all[(i, l)]).sum::<f64>();
                    }
                    known.add_square(k, factor, &row);
                }
                ends[0].take(k, &known, |_| &[], &[], |_| false, None).unwrap();
                ends[1].take(k, &own, |_| &[], &[], |_| false, Some(&flow)).unwrap();
                let expected = if stiffness == 1.0 { ends[0].schur() } else { limit.as_slice() };
                let size = expected.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
                let pairs = ends[1].schur().iter().zip(expected);
                let off = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                assert!(off < 1e-11 * size, "{k}: {off} {size}");
            }
        }
    }
}
