//! The border of Newton's equations: the unknowns that many intervals share.

use crate::constants::direct::LEAST_CURVATURE;
use crate::direct::limits::ends::Ends;
use crate::direct::motion::mesh::Mesh;
use crate::numerics::chain::{ChainMatrix, dot};

/// B, C and what they become in the factorisation of
///
/// $$ \begin{pmatrix} K & B \\\\ B^\top & C \end{pmatrix} $$
///
/// with few columns: the Cholesky factor of the dense $S = C - B^\top K^{-1} B$.
#[derive(Clone, Debug, Default)]
pub(super) struct Border {
    /// B, and B with damping.
    columns: Vec<Vec<f64>>,
    damped: Vec<Vec<f64>>,
    /// K^-1 B.
    solved: Vec<Vec<f64>>,
    /// C, row by row.
    corner: Vec<f64>,
    /// Columns of the metric of damping, and its corner.
    metric: Vec<Vec<f64>>,
    metric_corner: Vec<f64>,
    /// The lower factor of S.
    factor: Vec<f64>,
    count: usize,
}

/// Columns and corner of the shared unknowns by those of the times, and by the tied states in a matrix; then
/// zero for what is removed.
fn collect(
    columns: &mut Vec<Vec<f64>>,
    corner: &mut Vec<f64>,
    (by_times, of_times): (&[Vec<f64>], &[f64]),
    matrix: &ChainMatrix,
    ends: &Ends,
    mesh: &Mesh,
) {
    let (count, free, tied) = (ends.shared(), ends.times.count(), &ends.tied);
    let size = matrix.size();
    columns.resize_with(count, Vec::new);
    for (j, column) in columns.iter_mut().enumerate() {
        column.clear();
        column.resize(size, 0.0);
        if j < free {
            for (phase, by_time) in by_times.iter().enumerate() {
                let factor = ends.times.factor(phase, j);
                if factor != 0.0 {
                    column.iter_mut().zip(by_time).for_each(|(to, from)| *to += factor * from);
                }
            }
        } else {
            for node in [0, mesh.intervals()] {
                matrix.add_column(node, tied[j - free], 1.0, column);
            }
        }
    }
    corner.clear();
    corner.resize(count * count, 0.0);
    let last = matrix.first_of(mesh.intervals());
    for i in 0..count {
        for j in 0..=i {
            let entry = if i < free {
                let phases = mesh.phases();
                let of = |a: usize, b: usize| ends.times.factor(a, i) * ends.times.factor(b, j);
                of_times.iter().enumerate().map(|(at, second)| of(at / phases, at % phases) * second).sum()
            } else {
                columns[j][tied[i - free]] + columns[j][last + tied[i - free]]
            };
            (corner[count * i + j], corner[count * j + i]) = (entry, entry);
        }
    }
    for (node, i) in ends.removed(mesh) {
        columns.iter_mut().for_each(|column| column[matrix.first_of(node) + i] = 0.0);
    }
}

impl Border {
    /// Takes the border at an iterate from the derivatives of the gradient by the times of phases, whose own
    /// second derivatives are the second part, K x K, and from K before anything is removed from it.
    pub fn collect(
        &mut self,
        by_times: (&[Vec<f64>], &[f64]),
        matrix: &ChainMatrix,
        ends: &Ends,
        mesh: &Mesh,
    ) {
        self.count = ends.shared();
        collect(&mut self.columns, &mut self.corner, by_times, matrix, ends, mesh);
    }

    /// Takes the metric of damping: in the times, K x K, and the matrix.
    pub fn collect_metric(&mut self, of_times: &[f64], matrix: &ChainMatrix, ends: &Ends, mesh: &Mesh) {
        collect(&mut self.metric, &mut self.metric_corner, (&[], of_times), matrix, ends, mesh);
    }

    /// A column of B.
    #[cfg(test)]
    pub fn column(&self, j: usize) -> &[f64] {
        &self.columns[j]
    }

    /// An entry of C.
    #[cfg(test)]
    pub fn corner(&self, i: usize, j: usize) -> f64 {
        self.corner[self.count * i + j]
    }

    /// Factorises, with `damping` times the metric added. Whether S is positive definite.
    pub fn factorise(&mut self, damping: f64, matrix: &mut ChainMatrix) -> bool {
        let count = self.count;
        self.damped.resize_with(count, Vec::new);
        self.solved.resize_with(count, Vec::new);
        self.factor.clear();
        self.factor.extend_from_slice(&self.corner);
        for (j, damped) in self.damped.iter_mut().enumerate() {
            damped.clone_from(&self.columns[j]);
            if damping > 0.0 {
                damped.iter_mut().zip(&self.metric[j]).for_each(|(to, from)| *to += damping * from);
            }
            self.solved[j].clone_from(damped);
            matrix.solve(&mut self.solved[j]);
        }
        for i in 0..count {
            for j in 0..=i {
                let at = count * i + j;
                if damping > 0.0 {
                    self.factor[at] += damping * self.metric_corner[at];
                }
                self.factor[at] -= dot(&self.damped[i], &self.solved[j]);
            }
        }
        // S = L L'; rows of L in the lower triangle.
        for i in 0..count {
            for j in 0..=i {
                let known: f64 =
                    (0..j).map(|l| self.factor[count * i + l] * self.factor[count * j + l]).sum();
                let rest = self.factor[count * i + j] - known;
                if j < i {
                    self.factor[count * i + j] = rest / self.factor[count * j + j];
                    continue;
                }
                let definite = rest > LEAST_CURVATURE * self.corner[count * i + i].abs();
                if !definite {
                    return false;
                }
                self.factor[count * i + i] = rest.sqrt();
            }
        }
        true
    }

    /// The steps of the shared unknowns for the right-hand side `shared`, and of the others for a solution
    /// `dx` with constant shared ones, which becomes that of the whole.
    pub fn finish(&self, dx: &mut [f64], shared: &mut [f64]) {
        let count = self.count;
        for i in 0..count {
            let known: f64 = (0..i).map(|j| self.factor[count * i + j] * shared[j]).sum();
            shared[i] = (shared[i] - dot(&self.damped[i], dx) - known) / self.factor[count * i + i];
        }
        for i in (0..count).rev() {
            let known: f64 = (i + 1..count).map(|j| self.factor[count * j + i] * shared[j]).sum();
            shared[i] = (shared[i] - known) / self.factor[count * i + i];
        }
        for (step, solved) in shared.iter().zip(&self.solved) {
            dx.iter_mut().zip(solved).for_each(|(dx, entry)| *dx -= step * entry);
        }
    }
}
