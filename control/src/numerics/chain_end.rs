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

use super::chain::{ChainMatrix, NotPositiveDefinite};
use super::substitution::backward;
use super::tiles::{BadPivot, factorise_rows, subtract_square};

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
        }
    }

    /// Begins at the last node.
    pub fn begin(&mut self) {
        self.carried.fill(0.0);
    }

    /// Goes on to node k, whose interval is assembled in the matrix with all behind it. `columns` are those
    /// of the shared unknowns, and `corner` their own second derivatives, row by row. Unknowns of the next
    /// node that are `removed` are given.
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
            end.take(k, &matrix, |j| &columns[j], &corner, |i| given(k + 1, i)).unwrap();
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
}
