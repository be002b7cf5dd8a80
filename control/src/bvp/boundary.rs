//! The equations that all discretisations share: conditions at the ends and at switches.

use crate::bvp::mesh::{Mesh, Span};
use crate::bvp::timed::Timed;
use crate::bvp::values::Values;
use crate::extremal::Extremal;
use crate::numerics::almost_block_diagonal::{AlmostBlockDiagonal, SingularMatrix};
use costate::EvalError;

/// Residuals and matrix of a boundary-value problem on a mesh, in scaled variables: those at the ends and at switches come
/// from here, those of the intervals from who bridges them.
pub(crate) struct Borders {
    m: usize,
    at_start: usize,
    pub matrix: AlmostBlockDiagonal,
    /// In the order of the matrix.
    pub residual: Vec<f64>,
    /// Divisors of the conditions at start, end and of each switch.
    divisors: Vec<f64>,
    conditions: Vec<f64>,
}

impl Borders {
    /// For `nodes` nodes of m unknowns, `at_start` of the conditions at the first of them.
    pub fn new(m: usize, at_start: usize, nodes: usize) -> Self {
        Self {
            m,
            at_start,
            matrix: AlmostBlockDiagonal::zeros(m, at_start, nodes - 1),
            residual: vec![0.0; nodes * m],
            divisors: vec![1.0; m + nodes],
            conditions: vec![0.0; m * m],
        }
    }

    /// Where the rows of span k begin in a right-hand side.
    pub fn row(&self, k: usize) -> usize {
        self.at_start + k * self.m
    }

    /// Residuals of the conditions at `nodes`; with `matrix`, also their rows of the matrix.
    pub fn set<E: Extremal>(
        &mut self,
        timed: &mut Timed<'_, E>,
        mesh: &Mesh,
        nodes: &[f64],
        scale: &[f64],
        matrix: bool,
    ) -> Result<(), EvalError> {
        let (m, first, last) = (self.m, self.at_start, mesh.spans.len());
        timed.start(&nodes[..m], &mut self.residual[..first], &mut self.conditions[..first * m])?;
        if matrix {
            set_divisors(&mut self.conditions[..first * m], scale, &mut self.divisors[..first]);
            self.matrix.left_mut().copy_from_slice(&self.conditions[..first * m]);
        }
        let (end, rows) = (last * m + first, m - first);
        let conditions = &mut self.conditions[..rows * m];
        timed.end(&nodes[last * m..], &mut self.residual[end..], conditions)?;
        if matrix {
            set_divisors(conditions, scale, &mut self.divisors[first..m]);
            self.matrix.right_mut().copy_from_slice(conditions);
        }
        for (r, divisor) in self.divisors[..m].iter().enumerate() {
            let at = if r < first { r } else { end + r - first };
            self.residual[at] /= divisor;
        }
        for (k, span) in mesh.spans.iter().enumerate() {
            if let Span::Switch { arc } = *span {
                self.set_switch(timed, (k, arc), &nodes[k * m..(k + 2) * m], scale, matrix);
            }
        }
        Ok(())
    }

    fn set_switch<E: Extremal>(
        &mut self,
        timed: &mut Timed<'_, E>,
        (k, arc): (usize, usize),
        nodes: &[f64],
        scale: &[f64],
        matrix: bool,
    ) {
        let (m, row) = (self.m, self.row(k));
        let (left, right) = nodes.split_at(m);
        let target = &mut self.residual[row..row + m];
        for c in 0..m {
            target[c] = (right[c] - left[c]) / scale[c];
            if matrix {
                let row = self.matrix.block_row_mut(k, c);
                row.fill(0.0);
                (row[c], row[m + c]) = (-1.0, 1.0);
            }
        }
        // In place of the continuity of the duration.
        let z = timed.z_len();
        let (value, gradient) = timed.switching(arc, left);
        if matrix {
            let row = self.matrix.block_row_mut(k, z);
            row.fill(0.0);
            row[..z].copy_from_slice(gradient);
            set_divisors(&mut row[..m], scale, &mut self.divisors[m + k..m + k + 1]);
        }
        target[z] = value / self.divisors[m + k];
    }

    /// Factors the matrix.
    pub fn factor(&mut self) -> Result<(), SingularMatrix> {
        self.matrix.factor()
    }
}

/// Columns for scaled components, rows divided by their largest entry.
fn set_divisors(rows: &mut [f64], scale: &[f64], divisors: &mut [f64]) {
    for (row, divisor) in rows.chunks_exact_mut(scale.len()).zip(divisors) {
        row.iter_mut().zip(scale).for_each(|(entry, scale)| *entry *= scale);
        let largest = row.iter().fold(0.0_f64, |largest, entry| largest.max(entry.abs()));
        *divisor = if largest > 0.0 { largest } else { 1.0 };
        row.iter_mut().for_each(|entry| *entry /= *divisor);
    }
}

/// Scales: the largest size of each component at the nodes, but no less than a hundredth of that of its group. True where a
/// group is all zero, and has the scale 1. `with`: a correction that counts too.
pub(crate) fn set_scales<E: Extremal>(
    timed: &Timed<'_, E>,
    nodes: &[f64],
    scale: &mut [f64],
    with: Option<&Values>,
) -> bool {
    let m = scale.len();
    let mut sizes = vec![0.0_f64; m];
    for (i, value) in nodes.iter().enumerate() {
        let moved = with.map_or(0.0, |with| with.nodes[i].abs() * scale[i % m]);
        sizes[i % m] = sizes[i % m].max(value.abs()).max(moved);
    }
    let z = timed.z_len();
    let group = |c: usize| if c < z { timed.extremal.group(c) } else { usize::MAX - c };
    let mut unknown = false;
    for c in 0..m {
        let largest = (0..m).filter(|&d| group(d) == group(c)).map(|d| sizes[d]).fold(0.0_f64, f64::max);
        let floor = if largest > 0.0 { 0.01 * largest } else { 1.0 };
        scale[c] = sizes[c].max(floor);
        unknown |= largest == 0.0;
    }
    unknown
}
