//! Gaussian elimination on the matrix of a boundary-value problem.

use crate::numerics::lu;

/// A matrix that couples each node with the next one, and conditions on the first and the last node:
///
/// ```text
/// [ left                                ]   first x m
/// [ block 0     (2m wide)               ]   m rows
/// [        block 1                      ]
/// [                  ...                ]
/// [                          right      ]   (m - first) x m
/// ```
///
/// Elimination carries the remaining rows of a node to the next node and exchanges rows among `first + m` at
/// a time. The pivots are those of Gaussian elimination with row exchange on the whole matrix, and there is
/// no fill outside the blocks.
#[derive(Clone, Debug)]
pub struct AlmostBlockDiagonal {
    m: usize,
    first: usize,
    blocks: usize,
    /// `first x m`.
    left: Vec<f64>,
    /// For each block `first + m` rows of length 2m: carried rows, then the block. Factors after elimination.
    panels: Vec<f64>,
    /// `m x m`: rows carried to the last node, then the conditions there.
    last: Vec<f64>,
    exchanges: Vec<usize>,
    /// Work of back-substitution.
    work: Vec<f64>,
}

/// A column has no pivot: the matrix is singular in working precision, or not finite.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the matrix of the boundary-value problem is singular at node {node}")]
#[non_exhaustive]
pub struct SingularMatrix {
    /// The node of this column, from 0.
    pub node: usize,
}

impl AlmostBlockDiagonal {
    /// A matrix of zeros for `blocks + 1` nodes of m unknowns and `first <= m` conditions on the first of
    /// them.
    pub fn zeros(m: usize, first: usize, blocks: usize) -> Self {
        Self {
            m,
            first,
            blocks,
            left: vec![0.0; first * m],
            panels: vec![0.0; blocks * (first + m) * 2 * m],
            last: vec![0.0; m * m],
            exchanges: vec![0; (blocks + 1) * m],
            work: vec![0.0; first + m],
        }
    }

    /// Number of unknowns, `m (blocks + 1)`, and length of a right-hand side: left, blocks, right.
    pub fn size(&self) -> usize {
        self.m * (self.blocks + 1)
    }

    /// The conditions on the first node, row-major, to be written before [`factor`](Self::factor).
    pub fn left_mut(&mut self) -> &mut [f64] {
        &mut self.left
    }

    /// Row `r` of block `k`, 2m entries, to be written before [`factor`](Self::factor).
    pub fn block_row_mut(&mut self, k: usize, r: usize) -> &mut [f64] {
        let width = 2 * self.m;
        let start = (k * (self.first + self.m) + self.first + r) * width;
        &mut self.panels[start..start + width]
    }

    /// All rows of block `k`, m of them, to be written before [`factor`](Self::factor).
    pub(crate) fn block_mut(&mut self, k: usize) -> &mut [f64] {
        let (height, width) = (self.first + self.m, 2 * self.m);
        &mut self.panels[(k * height + self.first) * width..(k + 1) * height * width]
    }

    /// The conditions on the last node, row-major, to be written before [`factor`](Self::factor).
    pub fn right_mut(&mut self) -> &mut [f64] {
        &mut self.last[self.first * self.m..]
    }

    /// Factors the matrix in place. Write all blocks and conditions anew before each call.
    ///
    /// # Errors
    /// [`SingularMatrix`].
    pub fn factor(&mut self) -> Result<(), SingularMatrix> {
        let (m, first, width) = (self.m, self.first, 2 * self.m);
        let size = (first + m) * width;
        for k in 0..self.blocks {
            let (done, rest) = self.panels.split_at_mut(k * size);
            let panel = &mut rest[..size];
            for r in 0..first {
                let row = &mut panel[r * width..(r + 1) * width];
                row[m..].fill(0.0);
                if k == 0 {
                    row[..m].copy_from_slice(&self.left[r * m..(r + 1) * m]);
                } else {
                    let carried = ((k - 1) * (first + m) + m + r) * width + m;
                    row[..m].copy_from_slice(&done[carried..carried + m]);
                }
            }
            if !lu::eliminate(panel, width, m, &mut self.exchanges[k * m..(k + 1) * m]) {
                return Err(SingularMatrix { node: k });
            }
        }
        for r in 0..first {
            let target = &mut self.last[r * m..(r + 1) * m];
            if self.blocks == 0 {
                target.copy_from_slice(&self.left[r * m..(r + 1) * m]);
            } else {
                let carried = ((self.blocks - 1) * (first + m) + m + r) * width + m;
                target.copy_from_slice(&self.panels[carried..carried + m]);
            }
        }
        if !lu::eliminate(&mut self.last, m, m, &mut self.exchanges[self.blocks * m..]) {
            return Err(SingularMatrix { node: self.blocks });
        }
        Ok(())
    }

    /// `b <- A^-1 b` after [`factor`](Self::factor); b and the solution have [`size`](Self::size) entries.
    pub fn solve(&mut self, b: &mut [f64]) {
        let (m, first, width) = (self.m, self.first, 2 * self.m);
        let size = (first + m) * width;
        for k in 0..self.blocks {
            // Rows k m .. k m + first + m of b: carried ones, then those of the block.
            let rows = &mut b[k * m..k * m + first + m];
            let panel = &self.panels[k * size..(k + 1) * size];
            lu::follow(panel, width, m, &self.exchanges[k * m..(k + 1) * m], rows, 1);
        }
        let (before, end) = b.split_at_mut(self.blocks * m);
        lu::solve(&self.last, m, &self.exchanges[self.blocks * m..], end, 1);
        for k in (0..self.blocks).rev() {
            let panel = &self.panels[k * size..(k + 1) * size];
            self.work[..m].copy_from_slice(&b_next(before, end, k, m)[..m]);
            let here = &mut before[k * m..(k + 1) * m];
            for (r, entry) in here.iter_mut().enumerate() {
                *entry -= costate::matrix::dot(&panel[r * width + m..(r + 1) * width], &self.work[..m]);
            }
            lu::substitute(panel, width, m, here, 1);
        }
    }
}

/// The unknowns of node k + 1.
fn b_next<'a>(before: &'a [f64], end: &'a [f64], k: usize, m: usize) -> &'a [f64] {
    let start = (k + 1) * m;
    if start < before.len() { &before[start..start + m] } else { end }
}
