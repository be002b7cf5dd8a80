//! The border of Newton's equations: the unknowns that many intervals share.

use crate::constants::direct::LEAST_CURVATURE;
use crate::direct::limits::ends::{Ends, Tie};
use crate::direct::motion::mesh::Mesh;
use crate::numerics::bordered::Bordered;
use crate::numerics::chain::ChainMatrix;

/// B and C of the [bordered](Bordered) equations, and what damping adds to them.
#[derive(Clone, Debug, Default)]
pub(super) struct Border {
    /// B.
    columns: Vec<Vec<f64>>,
    /// C, row by row.
    corner: Vec<f64>,
    /// Columns of the metric of damping, and its corner.
    metric: Vec<Vec<f64>>,
    metric_corner: Vec<f64>,
    /// With damping.
    bordered: Bordered,
    count: usize,
}

/// What rows of both ends of a motion add to K beside what it has for each of them: rows for the state of the
/// start, columns for that of the end. Empty without such rows.
pub(super) type Across<'a> = &'a [f64];

/// Adds the column of entry `start` of the state at the start, and of `end` at the end, to those of K.
fn add_across(across: Across<'_>, tie: &Tie, node: usize, last: usize, column: &mut [f64]) {
    if across.is_empty() {
        return;
    }
    let row = &across[node * tie.start..node * (tie.start + 1)];
    column[last..last + node].iter_mut().zip(row).for_each(|(to, entry)| *to += entry);
    if let Some(end) = tie.end {
        column[..node]
            .iter_mut()
            .zip(across[end..].iter().step_by(node))
            .for_each(|(to, entry)| *to += tie.sign * entry);
    }
}

/// Columns and corner of the shared unknowns by those of the times, and by the tied states in a matrix; then
/// zero for what is removed.
fn collect(
    columns: &mut Vec<Vec<f64>>,
    corner: &mut Vec<f64>,
    (by_times, of_times): (&[Vec<f64>], &[f64]),
    (matrix, across): (&ChainMatrix, Across<'_>),
    ends: &Ends,
    mesh: &Mesh,
) {
    let (node, last) = (matrix.first_of(1), matrix.first_of(mesh.intervals()));
    let (count, free, tied) = (ends.shared(), ends.times.count(), &ends.tied);
    let size = matrix.size();
    if columns.len() < count {
        columns.resize_with(count, Vec::new);
    }
    let columns = &mut columns[..count];
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
            let tie = &tied[j - free];
            matrix.add_column(0, tie.start, 1.0, column);
            if let Some(end) = tie.end {
                matrix.add_column(mesh.intervals(), end, tie.sign, column);
            }
            add_across(across, tie, node, last, column);
        }
    }
    corner.clear();
    corner.resize(count * count, 0.0);
    for i in 0..count {
        for j in 0..=i {
            let entry = if i < free {
                let phases = mesh.phases();
                let of = |a: usize, b: usize| ends.times.factor(a, i) * ends.times.factor(b, j);
                of_times.iter().enumerate().map(|(at, second)| of(at / phases, at % phases) * second).sum()
            } else {
                let Tie { start, end, sign } = tied[i - free];
                columns[j][start] + end.map_or(0.0, |end| sign * columns[j][last + end])
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
        matrix: (&ChainMatrix, Across<'_>),
        ends: &Ends,
        mesh: &Mesh,
    ) {
        self.count = ends.shared();
        collect(&mut self.columns, &mut self.corner, by_times, matrix, ends, mesh);
    }

    /// Takes the metric of damping: in the times, K x K, and the matrix.
    pub fn collect_metric(&mut self, of_times: &[f64], matrix: &ChainMatrix, ends: &Ends, mesh: &Mesh) {
        collect(&mut self.metric, &mut self.metric_corner, (&[], of_times), (matrix, &[]), ends, mesh);
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
        self.bordered.reset(self.count);
        self.bordered.corner.copy_from_slice(&self.corner);
        for (to, column) in self.bordered.columns.iter_mut().zip(&self.columns) {
            to.extend_from_slice(column);
        }
        if damping > 0.0 {
            let columns = self.bordered.columns.iter_mut().zip(&self.metric);
            let corner = (&mut self.bordered.corner, &self.metric_corner);
            for (to, from) in columns.chain([corner]) {
                to.iter_mut().zip(from).for_each(|(to, from)| *to += damping * from);
            }
        }
        self.bordered.factorise(LEAST_CURVATURE, |column| matrix.solve(column))
    }

    /// The steps of the shared unknowns for the right-hand side `shared`, and of the others for a solution
    /// `dx` with constant shared ones, which becomes that of the whole.
    pub fn finish(&self, dx: &mut [f64], shared: &mut [f64]) {
        self.bordered.finish([dx, &mut []], shared);
    }
}
