//! Multiple shooting: the equations, and their linearisation by the variational equations.
//!
//! $$ w_R - \phi(w_L) = 0, \qquad \phi(w_L) = w(s_R), \quad w' = g(w), \quad w(s_L) = w_L $$
//! $$ \frac{\partial \phi}{\partial w_L} = W(s_R), \qquad W' = G(w) \thinspace W, \quad W(s_L) = 1 $$
//!
//! w and W are integrated together, with error control of both; costs are integrated beside them. Source: J.
//! Stoer, R. Bulirsch, *Introduction to Numerical Analysis*, Springer 2002, section 7.3.5.

use crate::bvp::boundary::Borders;
use crate::bvp::mesh::{Mesh, Span};
use crate::bvp::scales::Scales;
use crate::bvp::timed::Timed;
use crate::bvp::values::Values;
use crate::bvp::{Discretised, Failure, Solvable};
use crate::extremal::Extremal;
use crate::numerics::dormand_prince::{DormandPrince, Stopped};

/// Continuity between segments, and the conditions at the ends and at switches.
pub(crate) struct Shooting {
    pub mesh: Mesh,
    m: usize,
    pub current: Values,
    pub scale: Vec<f64>,
    pub borders: Borders,
    /// Costs of each span at the last evaluation.
    costs: Vec<(f64, f64)>,
    /// w, cost and penalty; then W, column by column.
    state: Vec<f64>,
    jacobian: Vec<f64>,
    without: DormandPrince,
    with: DormandPrince,
}

impl Shooting {
    /// Buffers, and values from the nodes of a guess of w at each (arc, scaled time on it); `tolerance` of a
    /// step of the integration, in parts of the size of each component.
    pub fn new<E: Extremal + ?Sized>(
        timed: &Timed<'_, E>,
        mesh: Mesh,
        tolerance: f64,
        mut guess: impl FnMut(usize, f64, &mut [f64]),
    ) -> Self {
        let (m, nodes) = (timed.len(), mesh.nodes());
        let mut current = Values::zeros(nodes, m, 2);
        let (first, others) = current.nodes.split_at_mut(m);
        guess(0, 0.0, first);
        let mut s = 0.0;
        for (span, node) in mesh.spans.iter().zip(others.chunks_exact_mut(m)) {
            match *span {
                Span::Switch { arc } => {
                    s = 0.0;
                    guess(arc + 1, 0.0, node);
                }
                Span::Interval { arc, length } => {
                    s += length;
                    guess(arc, s.min(1.0), node);
                }
            }
        }
        let (value, all) = (m + 2, m + 2 + m * m);
        Self {
            borders: Borders::new(m, timed.at_start(), nodes),
            costs: vec![(0.0, 0.0); nodes - 1],
            scale: vec![1.0; m],
            state: vec![0.0; all],
            jacobian: vec![0.0; m * m],
            without: DormandPrince::new(value, tolerance),
            with: DormandPrince::new(all, tolerance),
            current,
            mesh,
            m,
        }
    }

    /// Changes the tolerance of a step of the integration.
    pub fn set_tolerance(&mut self, tolerance: f64) {
        self.without.set_tolerance(tolerance);
        self.with.set_tolerance(tolerance);
    }

    /// Integrates w along a part of an arc; returns its end.
    pub fn carry<E: Extremal + ?Sized>(
        &mut self,
        timed: &mut Timed<'_, E>,
        arc: usize,
        length: f64,
        w: &[f64],
    ) -> Result<&[f64], Stopped> {
        let m = self.m;
        let state = &mut self.state[..m + 2];
        state[..m].copy_from_slice(w);
        state[m..].fill(0.0);
        self.without.integrate(state, 0.0..length, |_, state, rates| {
            let rate = timed.evaluate(&state[..m], arc, &mut rates[..m])?;
            let duration = timed.duration(&state[..m]);
            (rates[m], rates[m + 1]) = (duration * rate.cost, duration * rate.penalty);
            Ok(())
        })?;
        Ok(&self.state[..m])
    }

    /// The same with W, which is 1 at first; the result is in `self.state`.
    fn carry_with_variations<E: Extremal + ?Sized>(
        &mut self,
        timed: &mut Timed<'_, E>,
        arc: usize,
        length: f64,
        k: usize,
    ) -> Result<(), Stopped> {
        let (m, jacobian) = (self.m, &mut self.jacobian);
        self.state.fill(0.0);
        self.state[..m].copy_from_slice(&self.current.nodes[k * m..(k + 1) * m]);
        (0..m).for_each(|c| self.state[m + 2 + c * (m + 1)] = 1.0);
        self.with.integrate(&mut self.state, 0.0..length, |_, state, rates| {
            let rate = timed.linearise(&state[..m], arc, &mut rates[..m], jacobian)?;
            let duration = timed.duration(&state[..m]);
            (rates[m], rates[m + 1]) = (duration * rate.cost, duration * rate.penalty);
            let columns = state[m + 2..].chunks_exact(m).zip(rates[m + 2..].chunks_exact_mut(m));
            for (column, rates) in columns {
                for (rate, row) in rates.iter_mut().zip(jacobian.chunks_exact(m)) {
                    *rate = costate::matrix::dot(row, column);
                }
            }
            Ok(())
        })
    }

    /// Residual and costs of span k from the state at its end; the right node from `nodes`, else from the
    /// current values.
    fn set_span(&mut self, k: usize, nodes: Option<&[f64]>) {
        let (m, row) = (self.m, self.borders.row(k));
        let right = &nodes.unwrap_or(&self.current.nodes)[(k + 1) * m..(k + 2) * m];
        let ends = right.iter().zip(&self.state).zip(&self.scale);
        let residual = self.borders.residual[row..row + m].iter_mut();
        residual.zip(ends).for_each(|(to, ((right, end), scale))| *to = (right - end) / scale);
        self.costs[k] = (self.state[m], self.state[m + 1]);
    }
}

impl Discretised for Shooting {
    fn zeros(&self) -> Values {
        Values::zeros(self.mesh.nodes(), self.m, 2)
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
        target.nodes.iter_mut().zip(&self.borders.residual).for_each(|(to, from)| *to = -from);
        self.borders.matrix.solve(&mut target.nodes);
    }
}

impl<E: Extremal + ?Sized> Solvable<E> for Shooting {
    fn costs(&self, _: &Timed<'_, E>) -> (f64, f64) {
        self.costs.iter().fold((0.0, 0.0), |sum, cost| (sum.0 + cost.0, sum.1 + cost.1))
    }

    fn set_scales(&mut self, timed: &Timed<'_, E>, with: Option<&Values>) -> Scales {
        let m = self.m;
        let known = self.borders.set_scales(timed, &self.current.nodes, &mut self.scale, with);
        for sizes in [self.without.sizes_mut(), self.with.sizes_mut()] {
            sizes[..m].copy_from_slice(&self.scale);
            sizes[m..m + 2].fill(f64::INFINITY);
            for (e, size) in sizes[m + 2..].iter_mut().enumerate() {
                *size = self.scale[e % m] / self.scale[e / m];
            }
        }
        known
    }

    fn set_coupling(&mut self, timed: &mut Timed<'_, E>) {
        self.borders.set_coupling(timed, &self.current.nodes);
    }

    fn evaluate(&mut self, timed: &mut Timed<'_, E>, values: &Values) -> Result<(), Failure> {
        let m = self.m;
        for k in 0..self.mesh.spans.len() {
            if let Span::Interval { arc, length } = self.mesh.spans[k] {
                self.carry(timed, arc, length, &values.nodes[k * m..(k + 1) * m])?;
                self.set_span(k, Some(&values.nodes));
            }
        }
        Ok(self.borders.set(timed, &self.mesh, &values.nodes, &self.scale, false)?)
    }

    fn linearise(&mut self, timed: &mut Timed<'_, E>) -> Result<(), Failure> {
        let m = self.m;
        for k in 0..self.mesh.spans.len() {
            if let Span::Interval { arc, length } = self.mesh.spans[k] {
                self.carry_with_variations(timed, arc, length, k)?;
                self.set_span(k, None);
                for c in 0..m {
                    let row = self.borders.matrix.block_row_mut(k, c);
                    row.fill(0.0);
                    row[m + c] = 1.0;
                    for (d, entry) in row[..m].iter_mut().enumerate() {
                        *entry = -self.state[m + 2 + d * m + c] * self.scale[d] / self.scale[c];
                    }
                }
            }
        }
        self.borders.set(timed, &self.mesh, &self.current.nodes, &self.scale, true)?;
        Ok(self.borders.factor()?)
    }
}
