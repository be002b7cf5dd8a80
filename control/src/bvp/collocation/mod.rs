//! Collocation at Lobatto points on a mesh: the equations and their Newton correction.
//!
//! On an interval of length h with the nodes L and R and the slopes `g_l = g(z_l)` at the s Lobatto points,
//!
//! $$ z_j - z_L - h \sum_l a_{jl} \thinspace g_l = 0 \quad \text{at inner points,} $$
//! $$ z_R - z_L - h \sum_l b_l \thinspace g_l = 0 $$
//!
//! (Lobatto IIIA, order 2s - 2), and the conditions at the ends and at switches. Source: E. Hairer, G.
//! Wanner, *Solving Ordinary Differential Equations II*, Springer 1996, section IV.5; for boundary-value
//! problems Ascher, Mattheij, Russell, *Numerical Solution of Boundary Value Problems for ODEs*, SIAM 1995,
//! section 5.

pub(crate) mod condensed;
pub(crate) mod error;
pub(crate) mod lobatto;
pub(crate) mod polynomial;
pub(crate) mod residuals;

use crate::bvp::boundary::Borders;
use crate::bvp::collocation::condensed::{Condensed, Interval};
use crate::bvp::collocation::lobatto::Lobatto;
use crate::bvp::mesh::{Mesh, Span};
use crate::bvp::scales::Scales;
use crate::bvp::timed::Timed;
use crate::bvp::values::Values;
use crate::bvp::{Discretised, Failure, Solvable};
use crate::extremal::{Extremal, HamiltonianTerms};
use crate::numerics::almost_block_diagonal::SingularMatrix;

/// The collocation equations on one mesh, with all that is ever allocated for it.
///
/// Residuals and corrections are in scaled variables: component c of a correction, and equation c of an
/// interval, are relative to `scale[c]`.
pub(crate) struct Collocation {
    pub method: &'static Lobatto,
    pub mesh: Mesh,
    pub m: usize,
    pub current: Values,
    /// dw/ds at the last evaluation.
    pub slopes: Values,
    /// H* and cost at the last evaluation.
    pub rates: Rates,
    pub scale: Vec<f64>,
    node_jacobians: Vec<f64>,
    condensed: Vec<Condensed>,
    pub(crate) borders: Borders,
    /// Whether the matrix is factored.
    pub factored: bool,
    /// Residuals of the inner points.
    pub(crate) inner_residual: Vec<f64>,
}

/// H* and cost at the points of a mesh.
pub(crate) struct Rates {
    pub nodes: Vec<HamiltonianTerms>,
    pub inner: Vec<HamiltonianTerms>,
}

impl Collocation {
    /// Buffers, and values from a guess of w at each (arc, scaled time on it).
    pub fn new<E: Extremal + ?Sized>(
        timed: &Timed<'_, E>,
        mesh: Mesh,
        points: usize,
        mut guess: impl FnMut(usize, f64, &mut [f64]),
    ) -> Self {
        let (m, nodes, method) = (timed.len(), mesh.nodes(), Lobatto::of(points));
        let inner = (nodes - 1) * (points - 2);
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
            borders: Borders::new(m, timed.at_start(), nodes),
            slopes: Values::zeros(nodes, m, points),
            rates: Rates {
                nodes: vec![HamiltonianTerms::default(); nodes],
                inner: vec![HamiltonianTerms::default(); inner],
            },
            scale: vec![1.0; m],
            node_jacobians: vec![0.0; nodes * m * m],
            factored: false,
            inner_residual: vec![0.0; inner * m],
            current: values,
            method,
            mesh,
            m,
        }
    }

    /// `-A^-1 r` at the nodes for residuals of the intervals alone, m for each span, in scaled variables.
    pub fn response(&mut self, defects: &[f64], target: &mut Values) {
        let first = self.borders.row(0);
        target.nodes.fill(0.0);
        for (to, from) in target.nodes[first..].iter_mut().zip(defects) {
            *to = -from;
        }
        self.borders.matrix.solve(&mut target.nodes);
    }
}

impl Discretised for Collocation {
    fn zeros(&self) -> Values {
        Values::zeros(self.mesh.nodes(), self.m, self.method.len())
    }

    fn current(&self) -> &Values {
        &self.current
    }

    fn current_mut(&mut self) -> &mut Values {
        &mut self.current
    }

    fn scale(&self) -> &[f64] {
        &self.scale
    }

    fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    fn correction(&mut self, target: &mut Values) {
        let (m, inner) = (self.m, self.method.len() - 2);
        target.nodes.iter_mut().zip(&self.borders.residual).for_each(|(to, from)| *to = -from);
        target.inner.iter_mut().zip(&self.inner_residual).for_each(|(to, from)| *to = -from);
        for (k, span) in self.mesh.spans.iter().enumerate() {
            if let Span::Interval { length, .. } = *span {
                let own = &mut target.inner[k * inner * m..(k + 1) * inner * m];
                let reduced = &mut target.nodes[self.borders.row(k)..self.borders.row(k + 1)];
                self.condensed[k].reduce(self.method, length, own, reduced);
            }
        }
        self.borders.matrix.solve(&mut target.nodes);
        for (k, span) in self.mesh.spans.iter().enumerate() {
            if let Span::Interval { .. } = span {
                let own = &mut target.inner[k * inner * m..(k + 1) * inner * m];
                self.condensed[k].expand(&target.nodes[k * m..(k + 2) * m], own);
            }
        }
    }
}

impl<E: Extremal + ?Sized> Solvable<E> for Collocation {
    /// By the quadrature of the method.
    fn costs(&self, timed: &Timed<'_, E>) -> (f64, f64) {
        let (m, inner) = (self.m, self.method.len() - 2);
        let weights = self.method.weights();
        let (mut cost, mut penalty) = (0.0, 0.0);
        for (k, span) in self.mesh.spans.iter().enumerate() {
            if let Span::Interval { length, .. } = *span {
                let h = length * timed.duration(&self.current.nodes[k * m..(k + 1) * m]);
                for (j, weight) in weights.iter().enumerate() {
                    let rate = match j {
                        0 => &self.rates.nodes[k],
                        j if j == inner + 1 => &self.rates.nodes[k + 1],
                        j => &self.rates.inner[k * inner + j - 1],
                    };
                    cost += h * weight * rate.cost;
                    penalty += h * weight * rate.penalty;
                }
            }
        }
        (cost, penalty)
    }

    fn set_scales(&mut self, timed: &Timed<'_, E>, with: Option<&Values>) -> Scales {
        self.borders.set_scales(timed, &self.current.nodes, &mut self.scale, with)
    }

    fn set_coupling(&mut self, timed: &mut Timed<'_, E>) {
        self.borders.set_coupling(timed, &self.current.nodes);
    }

    fn evaluate(&mut self, timed: &mut Timed<'_, E>, values: &Values) -> Result<(), Failure> {
        let (m, inner) = (self.m, self.method.len() - 2);
        for i in 0..self.mesh.nodes() {
            let (arc, range) = (self.mesh.arc_of_node(i), i * m..(i + 1) * m);
            let slope = &mut self.slopes.nodes[range.clone()];
            self.rates.nodes[i] = timed.evaluate(&values.nodes[range], arc, slope)?;
        }
        for (k, span) in self.mesh.spans.iter().enumerate() {
            if let Span::Interval { arc, .. } = *span {
                for point in k * inner..(k + 1) * inner {
                    let range = point * m..(point + 1) * m;
                    let slope = &mut self.slopes.inner[range.clone()];
                    self.rates.inner[point] = timed.evaluate(&values.inner[range], arc, slope)?;
                }
            }
        }
        Ok(self.set_residuals(timed, values, false)?)
    }

    fn linearise(&mut self, timed: &mut Timed<'_, E>) -> Result<(), Failure> {
        self.factored = false;
        let (m, inner) = (self.m, self.method.len() - 2);
        for i in 0..self.mesh.nodes() {
            let (arc, range) = (self.mesh.arc_of_node(i), i * m..(i + 1) * m);
            let jacobian = &mut self.node_jacobians[i * m * m..(i + 1) * m * m];
            let slope = &mut self.slopes.nodes[range.clone()];
            self.rates.nodes[i] = timed.linearise(&self.current.nodes[range], arc, slope, jacobian)?;
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
                    self.rates.inner[point] =
                        timed.linearise(&self.current.inner[range], arc, slope, jacobian)?;
                    to_scaled(jacobian, &self.scale);
                }
                let (left, right) = self.node_jacobians[k * m * m..(k + 2) * m * m].split_at(m * m);
                let rows = self.borders.matrix.block_mut(k);
                if !condensed.condense(self.method, Interval { length, left, right }, rows) {
                    return Err(SingularMatrix { node: k }.into());
                }
            }
        }
        let current = std::mem::replace(
            &mut self.current,
            Values { nodes: Vec::new(), inner: Vec::new(), position: 0.0 },
        );
        let set = self.set_residuals(timed, &current, true);
        self.current = current;
        set?;
        self.borders.factor()?;
        self.factored = true;
        Ok(())
    }
}

/// Rows relative to the scale of their component, columns for scaled components.
pub(crate) fn to_scaled(jacobian: &mut [f64], scale: &[f64]) {
    for (row, of_row) in jacobian.chunks_exact_mut(scale.len()).zip(scale) {
        row.iter_mut().zip(scale).for_each(|(entry, of_column)| *entry *= of_column / of_row);
    }
}
