//! The equations that all discretisations share: the conditions at the ends and at switches.

use crate::bvp::mesh::{Mesh, Span};
use crate::bvp::scales::{Scales, set_scales};
use crate::bvp::timed::Timed;
use crate::bvp::values::Values;
use crate::extremal::Extremal;
use crate::numerics::almost_block_diagonal::{AlmostBlockDiagonal, SingularMatrix};
use costate::EvalError;

/// Residuals and matrix of a boundary-value problem on a mesh, in scaled variables. The conditions at the
/// ends and at switches are set here, the equations of the intervals by the discretisation.
pub(crate) struct Borders {
    m: usize,
    at_start: usize,
    pub matrix: AlmostBlockDiagonal,
    /// In the order of the matrix.
    pub residual: Vec<f64>,
    /// Divisors of the conditions at start, end and of each switch.
    divisors: Vec<f64>,
    conditions: Vec<f64>,
    /// Jacobian of dw/ds at the first node, once the scales need it.
    coupling: Vec<f64>,
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
            coupling: Vec::new(),
        }
    }

    /// Sets `scale` from the values at the nodes and, if given, a correction `with`.
    pub fn set_scales<E: Extremal + ?Sized>(
        &self,
        timed: &Timed<'_, E>,
        nodes: &[f64],
        scale: &mut [f64],
        with: Option<&Values>,
    ) -> Scales {
        set_scales(timed, nodes, scale, &self.coupling, with)
    }

    /// Evaluates the coupling of the components at the first node. If that fails, there is none.
    pub fn set_coupling<E: Extremal + ?Sized>(&mut self, timed: &mut Timed<'_, E>, nodes: &[f64]) {
        let mut slope = vec![0.0; self.m];
        self.coupling = vec![0.0; self.m * self.m];
        if timed.linearise(&nodes[..self.m], 0, &mut slope, &mut self.coupling).is_err() {
            self.coupling.fill(0.0);
        }
    }

    /// Where the rows of span k begin in a right-hand side.
    pub fn row(&self, k: usize) -> usize {
        self.at_start + k * self.m
    }

    /// Residuals of the conditions at `nodes`; with `matrix`, also their rows of the matrix.
    pub fn set<E: Extremal + ?Sized>(
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
                let nodes = nodes[k * m..(k + 2) * m].split_at(m);
                self.set_switch(timed, Border { span: k, arc, nodes }, scale, matrix);
            }
        }
        Ok(())
    }

    fn set_switch<E: Extremal + ?Sized>(
        &mut self,
        timed: &mut Timed<'_, E>,
        border: Border<'_>,
        scale: &[f64],
        matrix: bool,
    ) {
        let Border { span: k, arc, nodes: (left, right) } = border;
        let (m, row) = (self.m, self.row(k));
        let target = &mut self.residual[row..row + m];
        for c in 0..m {
            target[c] = (right[c] - left[c]) / scale[c];
            if matrix {
                let row = self.matrix.block_row_mut(k, c);
                row.fill(0.0);
                (row[c], row[m + c]) = (-1.0, 1.0);
            }
        }
        // The duration is not continuous; its row holds the switching condition.
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

/// The border between `arc` and the next one: a span, and the nodes at its ends.
struct Border<'a> {
    span: usize,
    arc: usize,
    nodes: (&'a [f64], &'a [f64]),
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
