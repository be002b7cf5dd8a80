//! Collocation on a mesh: the equations, and the correction that their linearisation asks for.

use super::almost_block_diagonal::{AlmostBlockDiagonal, SingularMatrix};
use super::condensed::Condensed;
use super::extremal::{Extremal, Rate};
use super::lobatto::Lobatto;
use super::mesh::{Mesh, Span};
use super::timed::Timed;
use super::values::Values;
use crate::error::EvalError;

/// The collocation equations on one mesh: all that is ever allocated for it.
///
/// ```text
/// z_j - z_L - h sum_l a_jl g_l = 0  at inner points,     z_R - z_L - h sum_l b_l g_l = 0
/// ```
///
/// and the conditions at the ends and at switches. Residuals and corrections are in scaled variables: component c of a
/// correction, and equation c of an interval, are in parts of `scale[c]`.
pub(super) struct Collocation {
    pub method: Lobatto,
    pub mesh: Mesh,
    pub m: usize,
    pub current: Values,
    /// dw/ds at the last evaluation.
    pub slopes: Values,
    /// H* and cost at the last evaluation: nodes, inner points.
    pub rates: (Vec<Rate>, Vec<Rate>),
    pub scale: Vec<f64>,
    node_jacobians: Vec<f64>,
    condensed: Vec<Condensed>,
    pub(super) matrix: AlmostBlockDiagonal,
    /// Residuals in the order of the matrix, and of the inner points.
    pub(super) residual: Vec<f64>,
    pub(super) inner_residual: Vec<f64>,
    /// Divisors of the conditions at start, end and of each switch.
    pub(super) divisors: Vec<f64>,
    pub(super) conditions: Vec<f64>,
    pub(super) at_start: usize,
}

/// Why a linearisation failed.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Failure {
    Evaluation(EvalError),
    Singular(SingularMatrix),
}

impl From<EvalError> for Failure {
    fn from(error: EvalError) -> Self {
        Self::Evaluation(error)
    }
}

impl Collocation {
    /// Buffers, and values from a guess of w at each (arc, scaled time on it).
    pub fn new<E: Extremal>(
        timed: &Timed<'_, E>,
        mesh: Mesh,
        points: usize,
        mut guess: impl FnMut(usize, f64, &mut [f64]),
    ) -> Self {
        let (m, nodes, method) = (timed.len(), mesh.nodes(), Lobatto::new(points));
        let inner = (nodes - 1) * (points - 2);
        let at_start = timed.at_start();
        let mut values = Values::zeros(nodes, m, points);
        let mut s = 0.0;
        guess(0, 0.0, &mut values.nodes[..m]);
        for (k, span) in mesh.spans.iter().enumerate() {
            let node = &mut values.nodes[(k + 1) * m..(k + 2) * m];
            match *span {
                Span::Switch { arc } => {
                    s = 0.0;
                    guess(arc + 1, 0.0, node);
                }
                Span::Interval { arc, length } => {
                    guess(arc, (s + length).min(1.0), node);
                    for j in 0..points - 2 {
                        let at = (k * (points - 2) + j) * m;
                        guess(arc, s + length * method.points[j + 1], &mut values.inner[at..at + m]);
                    }
                    s += length;
                }
            }
        }
        Self {
            condensed: vec![Condensed::new(m, points - 2); nodes - 1],
            matrix: AlmostBlockDiagonal::zeros(m, at_start, nodes - 1),
            slopes: Values::zeros(nodes, m, points),
            rates: (vec![Rate::default(); nodes], vec![Rate::default(); inner]),
            scale: vec![1.0; m],
            node_jacobians: vec![0.0; nodes * m * m],
            residual: vec![0.0; nodes * m],
            inner_residual: vec![0.0; inner * m],
            divisors: vec![1.0; m + nodes],
            conditions: vec![0.0; m * m],
            current: values,
            at_start,
            method,
            mesh,
            m,
        }
    }

    /// Values of the same shape, zero.
    pub fn zeros(&self) -> Values {
        Values::zeros(self.mesh.nodes(), self.m, self.method.len())
    }

    /// Scales: the largest size of each component along the motion, but no less than a hundredth of that of its group.
    /// True where a group is all zero, and has the scale 1. `with`: a correction that counts too.
    pub fn set_scales<E: Extremal>(&mut self, timed: &Timed<'_, E>, with: Option<&Values>) -> bool {
        let m = self.m;
        let mut sizes = vec![0.0_f64; m];
        for (i, value) in self.current.nodes.iter().enumerate() {
            let moved = with.map_or(0.0, |with| with.nodes[i].abs() * self.scale[i % m]);
            sizes[i % m] = sizes[i % m].max(value.abs()).max(moved);
        }
        let z = timed.z_len();
        let group = |c: usize| if c < z { timed.extremal.group(c) } else { usize::MAX - c };
        let mut unknown = false;
        for c in 0..m {
            let largest = (0..m).filter(|&d| group(d) == group(c)).map(|d| sizes[d]).fold(0.0_f64, f64::max);
            let floor = if largest > 0.0 { 0.01 * largest } else { 1.0 };
            self.scale[c] = sizes[c].max(floor);
            unknown |= largest == 0.0;
        }
        unknown
    }

    /// Slopes and residuals at `values`.
    pub fn evaluate<E: Extremal>(
        &mut self,
        timed: &mut Timed<'_, E>,
        values: &Values,
    ) -> Result<(), EvalError> {
        let (m, inner) = (self.m, self.method.len() - 2);
        for i in 0..self.mesh.nodes() {
            let (arc, range) = (self.mesh.arc_of_node(i), i * m..(i + 1) * m);
            let slope = &mut self.slopes.nodes[range.clone()];
            self.rates.0[i] = timed.rate(&values.nodes[range], arc, slope)?;
        }
        for (k, span) in self.mesh.spans.iter().enumerate() {
            if let Span::Interval { arc, .. } = *span {
                for point in k * inner..(k + 1) * inner {
                    let range = point * m..(point + 1) * m;
                    let slope = &mut self.slopes.inner[range.clone()];
                    self.rates.1[point] = timed.rate(&values.inner[range], arc, slope)?;
                }
            }
        }
        self.set_residuals(timed, values, false)
    }

    /// Slopes, residuals and the factored matrix at the current values.
    pub fn linearise<E: Extremal>(&mut self, timed: &mut Timed<'_, E>) -> Result<(), Failure> {
        let (m, inner) = (self.m, self.method.len() - 2);
        for i in 0..self.mesh.nodes() {
            let (arc, range) = (self.mesh.arc_of_node(i), i * m..(i + 1) * m);
            let jacobian = &mut self.node_jacobians[i * m * m..(i + 1) * m * m];
            let slope = &mut self.slopes.nodes[range.clone()];
            self.rates.0[i] = timed.linear(&self.current.nodes[range], arc, slope, jacobian)?;
            to_scaled(jacobian, &self.scale);
        }
        for (k, span) in self.mesh.spans.iter().enumerate() {
            if let Span::Interval { arc, length } = *span {
                let condensed = &mut self.condensed[k];
                for j in 0..inner {
                    let point = k * inner + j;
                    let range = point * m..(point + 1) * m;
                    let (slope, jacobian) =
                        (&mut self.slopes.inner[range.clone()], condensed.jacobian_mut(j));
                    self.rates.1[point] = timed.linear(&self.current.inner[range], arc, slope, jacobian)?;
                    to_scaled(jacobian, &self.scale);
                }
                let ends = self.node_jacobians[k * m * m..(k + 2) * m * m].split_at(m * m);
                condensed
                    .condense(&self.method, length, ends, (&mut self.matrix, k))
                    .map_err(Failure::Singular)?;
            }
        }
        let current = std::mem::replace(&mut self.current, Values { nodes: Vec::new(), inner: Vec::new() });
        let set = self.set_residuals(timed, &current, true);
        self.current = current;
        set?;
        self.matrix.factor().map_err(Failure::Singular)
    }

    /// `-A^-1 r` for the residuals of the last evaluation and the matrix of the last linearisation.
    pub fn correction(&mut self, target: &mut Values) {
        let (m, inner, first) = (self.m, self.method.len() - 2, self.at_start);
        target.nodes.iter_mut().zip(&self.residual).for_each(|(to, from)| *to = -from);
        target.inner.iter_mut().zip(&self.inner_residual).for_each(|(to, from)| *to = -from);
        for (k, span) in self.mesh.spans.iter().enumerate() {
            if let Span::Interval { length, .. } = *span {
                let own = &mut target.inner[k * inner * m..(k + 1) * inner * m];
                let reduced = &mut target.nodes[first + k * m..first + (k + 1) * m];
                self.condensed[k].reduce(&self.method, length, own, reduced);
            }
        }
        self.matrix.solve(&mut target.nodes);
        for (k, span) in self.mesh.spans.iter().enumerate() {
            if let Span::Interval { .. } = span {
                let own = &mut target.inner[k * inner * m..(k + 1) * inner * m];
                self.condensed[k].expand(&target.nodes[k * m..(k + 2) * m], own);
            }
        }
    }

    /// `-A^-1 r` at the nodes for residuals of the intervals alone, m for each span, in scaled variables.
    pub fn response(&mut self, defects: &[f64], target: &mut Values) {
        let first = self.at_start;
        target.nodes.fill(0.0);
        for (to, from) in target.nodes[first..].iter_mut().zip(defects) {
            *to = -from;
        }
        self.matrix.solve(&mut target.nodes);
    }
}

/// Rows in parts of the scale of their component, columns for components in parts of theirs.
fn to_scaled(jacobian: &mut [f64], scale: &[f64]) {
    for (row, of_row) in jacobian.chunks_exact_mut(scale.len()).zip(scale) {
        row.iter_mut().zip(scale).for_each(|(entry, of_column)| *entry *= of_column / of_row);
    }
}
