//! Cholesky factorisation of the symmetric matrix of a chain: nodes, and between two of them inner unknowns.

use super::substitution::{backward, forward};
use super::tiles::{BadPivot, factorise_rows, subtract_square};
use std::fmt;
use std::ops::Range;

/// A pivot was not positive: the matrix is not positive definite.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct NotPositiveDefinite {
    /// The node or interval with the pivot.
    pub block: usize,
}

impl fmt::Display for NotPositiveDefinite {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "the matrix is not positive definite at node {}", self.block)
    }
}

/// A symmetric matrix of a chain, then its factor U, A = U'U with inner unknowns first.
///
/// A node has `node` unknowns and meets the next one and the inner unknowns of both intervals beside it; an
/// interval has `inner` ones. The order of unknowns in vectors: all nodes, then all intervals. Rows of
/// an interval are `[inner | left node | right node]`, those of a node `[node | next node]`. Only upper
/// triangles of diagonal blocks are read. Rows are combined as wholes, so that loops run over contiguous
/// numbers.
#[derive(Clone, Debug)]
pub(crate) struct ChainMatrix {
    node: usize,
    inner: usize,
    intervals: usize,
    inner_rows: Vec<f64>,
    node_rows: Vec<f64>,
    /// The part of a vector that belongs to an interval.
    part: Vec<f64>,
}

impl ChainMatrix {
    /// A matrix without intervals.
    pub fn new(node: usize, inner: usize) -> Self {
        Self {
            node,
            inner,
            intervals: 0,
            inner_rows: Vec::new(),
            node_rows: Vec::new(),
            part: vec![0.0; inner + 2 * node],
        }
    }

    /// Sets the number of intervals, and all entries to zero. Allocates only if it is larger than ever
    /// before.
    pub fn reset(&mut self, intervals: usize) {
        self.intervals = intervals;
        self.inner_rows.clear();
        self.inner_rows.resize(intervals * self.inner * self.inner_width(), 0.0);
        self.node_rows.clear();
        self.node_rows.resize((intervals + 1) * self.node * 2 * self.node, 0.0);
    }

    /// Number of intervals.
    pub fn intervals(&self) -> usize {
        self.intervals
    }

    /// Length of the rows of an interval.
    pub fn inner_width(&self) -> usize {
        self.inner + 2 * self.node
    }

    /// Number of unknowns.
    pub fn size(&self) -> usize {
        self.node * (self.intervals + 1) + self.inner * self.intervals
    }

    /// Where the unknowns of a node begin among all.
    pub fn first_of(&self, node: usize) -> usize {
        self.node * node
    }

    /// The rows of an interval and those of the nodes at its ends.
    pub fn interval(&mut self, k: usize) -> (&mut [f64], &mut [f64], &mut [f64]) {
        let (inner, node) = (self.inner * self.inner_width(), 2 * self.node * self.node);
        let (left, right) = self.node_rows[k * node..(k + 2) * node].split_at_mut(node);
        (&mut self.inner_rows[k * inner..(k + 1) * inner], left, right)
    }

    /// The same, to read.
    pub fn blocks(&self, k: usize) -> (&[f64], &[f64], &[f64]) {
        let (inner, node) = (self.inner * self.inner_width(), 2 * self.node * self.node);
        let (left, right) = self.node_rows[k * node..(k + 2) * node].split_at(node);
        (&self.inner_rows[k * inner..(k + 1) * inner], left, right)
    }

    /// The rows of a node.
    pub fn node_rows(&mut self, k: usize) -> &mut [f64] {
        let length = 2 * self.node * self.node;
        &mut self.node_rows[k * length..(k + 1) * length]
    }

    /// Adds a multiple of the square of a row over the unknowns of interval `k`: inner ones, those of the
    /// left and of the right node.
    pub fn add_square(&mut self, k: usize, factor: f64, row: &[f64]) {
        let (node, inner, width) = (self.node, self.inner, self.inner_width());
        let (of_inner, left, right) = self.interval(k);
        let blocks = [(of_inner, width, 0), (left, 2 * node, inner), (right, 2 * node, inner + node)];
        for (rows, width, first) in blocks {
            let row = &row[first..];
            for (i, to) in rows.chunks_exact_mut(width).enumerate() {
                let factor = factor * row[i];
                to[i..].iter_mut().zip(&row[i..]).for_each(|(to, entry)| *to += factor * entry);
            }
        }
    }

    /// Takes the entries of another matrix.
    pub fn copy_from(&mut self, other: &Self) {
        self.intervals = other.intervals;
        self.inner_rows.clone_from(&other.inner_rows);
        self.node_rows.clone_from(&other.node_rows);
    }

    /// Takes some intervals of another matrix and the rows of their nodes, as the only ones.
    pub fn copy_intervals(&mut self, other: &Self, which: Range<usize>) {
        let (inner, node) = (self.inner * self.inner_width(), 2 * self.node * self.node);
        self.intervals = which.len();
        self.inner_rows.clear();
        self.inner_rows.extend_from_slice(&other.inner_rows[which.start * inner..which.end * inner]);
        self.node_rows.clear();
        self.node_rows.extend_from_slice(&other.node_rows[which.start * node..(which.end + 1) * node]);
    }

    /// A += factor B.
    pub fn add(&mut self, factor: f64, other: &Self) {
        let pairs = [(&mut self.inner_rows, &other.inner_rows), (&mut self.node_rows, &other.node_rows)];
        for (to, from) in pairs {
            to.iter_mut().zip(from).for_each(|(to, from)| *to += factor * from);
        }
    }

    /// An entry, of any two unknowns.
    pub fn entry(&self, i: usize, j: usize) -> f64 {
        let (i, j) = (i.min(j), i.max(j));
        let nodes = self.node * (self.intervals + 1);
        if j < nodes {
            let (k, column) = (i / self.node, j - i / self.node * self.node);
            return if column < 2 * self.node {
                self.node_rows[2 * self.node * (self.node * k + i % self.node) + column]
            } else {
                0.0
            };
        }
        let (k, row) = ((j - nodes) / self.inner, (j - nodes) % self.inner);
        if i >= nodes {
            let (other, first) = ((i - nodes) / self.inner, (i - nodes) % self.inner);
            let at = self.inner_width() * (self.inner * k + first) + row;
            return if other == k { self.inner_rows[at] } else { 0.0 };
        }
        if !(self.node * k..self.node * (k + 2)).contains(&i) {
            return 0.0;
        }
        self.inner_rows[self.inner_width() * (self.inner * k + row) + self.inner + i - self.node * k]
    }

    /// The unknowns that the unknown `i` of node `k` meets.
    fn neighbours(&self, k: usize) -> impl Iterator<Item = usize> {
        let (first, last) = (k.saturating_sub(1), (k + 1).min(self.intervals));
        let nodes = self.node * (self.intervals + 1);
        (self.node * first..self.node * (last + 1))
            .chain(nodes + self.inner * first..nodes + self.inner * last)
    }

    /// `to += factor` times the column of the unknown `i` of node `k`.
    pub fn add_column(&self, k: usize, i: usize, factor: f64, to: &mut [f64]) {
        let at = self.node * k + i;
        self.neighbours(k).for_each(|row| to[row] += factor * self.entry(row, at));
    }

    /// Makes row and column of the unknown `i` of node `k` those of the identity.
    pub fn remove(&mut self, k: usize, i: usize) {
        let (node, width, stride) = (self.node, self.inner_width(), 2 * self.node);
        for interval in k.saturating_sub(1)..(k + 1).min(self.intervals) {
            let column = self.inner + if interval == k { i } else { node + i };
            let rows = &mut self.inner_rows[interval * self.inner * width..][..self.inner * width];
            rows.chunks_exact_mut(width).for_each(|row| row[column] = 0.0);
        }
        let rows = self.node_rows(k);
        rows[stride * i..][..stride].fill(0.0);
        (0..i).for_each(|l| rows[stride * l + i] = 0.0);
        rows[stride * i + i] = 1.0;
        if k > 0 {
            self.node_rows(k - 1).chunks_exact_mut(stride).for_each(|row| row[node + i] = 0.0);
        }
    }

    /// A = U'U in place; the diagonal of U is replaced by its reciprocals.
    ///
    /// # Errors
    /// [`NotPositiveDefinite`]; the matrix is lost then.
    pub fn factorise(&mut self) -> Result<(), NotPositiveDefinite> {
        let (node, inner, width, stride) = (self.node, self.inner, self.inner_width(), 2 * self.node);
        for k in 0..self.intervals {
            let failed = |BadPivot| NotPositiveDefinite { block: k };
            let (rows, left, right) = self.interval(k);
            factorise_rows(rows, width, inner, width).map_err(failed)?;
            subtract_square((rows, width), inner, (left, stride), node, stride);
            subtract_square((rows, width), inner + node, (right, stride), node, node);
            factorise_rows(left, stride, node, stride).map_err(failed)?;
            subtract_square((left, stride), node, (right, stride), node, node);
        }
        let last = self.intervals;
        factorise_rows(self.node_rows(last), stride, node, node)
            .map_err(|BadPivot| NotPositiveDefinite { block: last })
    }

    /// x = A^-1 r in place, after [`factorise`](Self::factorise).
    pub fn solve(&mut self, r: &mut [f64]) {
        let (node, inner, width) = (self.node, self.inner, self.inner_width());
        let (nodes, inners) = r.split_at_mut(node * (self.intervals + 1));
        let inner_rows = |k: usize| inner * width * k..inner * width * (k + 1);
        let node_rows = |k: usize| 2 * node * node * k..2 * node * node * (k + 1);
        let ends = |k: usize| node * k..(node * (k + 2)).min(node * (self.intervals + 1));
        for k in 0..=self.intervals {
            if k < self.intervals {
                self.part[..inner].copy_from_slice(&inners[inner * k..][..inner]);
                self.part[inner..].copy_from_slice(&nodes[ends(k)]);
                forward(&self.inner_rows[inner_rows(k)], width, &mut self.part);
                inners[inner * k..][..inner].copy_from_slice(&self.part[..inner]);
                nodes[ends(k)].copy_from_slice(&self.part[inner..]);
            }
            forward(&self.node_rows[node_rows(k)], 2 * node, &mut nodes[ends(k)]);
        }
        for k in (0..=self.intervals).rev() {
            backward(&self.node_rows[node_rows(k)], 2 * node, &mut nodes[ends(k)]);
            if k < self.intervals {
                self.part[..inner].copy_from_slice(&inners[inner * k..][..inner]);
                self.part[inner..].copy_from_slice(&nodes[ends(k)]);
                backward(&self.inner_rows[inner_rows(k)], width, &mut self.part);
                inners[inner * k..][..inner].copy_from_slice(&self.part[..inner]);
            }
        }
    }
}

/// x.y over the shorter of the two, in eight sums.
#[inline(always)]
pub(crate) fn dot(x: &[f64], y: &[f64]) -> f64 {
    let length = x.len().min(y.len());
    let ((x, x_rest), (y, y_rest)) = (x[..length].as_chunks::<8>(), y[..length].as_chunks::<8>());
    let mut sums = [0.0; 8];
    for (x, y) in x.iter().zip(y) {
        for c in 0..8 {
            sums[c] += x[c] * y[c];
        }
    }
    let rest: f64 = x_rest.iter().zip(y_rest).map(|(x, y)| x * y).sum();
    let [a, b, c, d, e, f, g, h] = sums;
    ((a + e) + (b + f)) + ((c + g) + (d + h)) + rest
}

#[cfg(test)]
#[path = "chain_tests.rs"]
mod tests;
