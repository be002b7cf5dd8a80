//! Motions as piecewise polynomials in s: in phase p, which takes the time T_p, s = p + (t - t_p) / T_p.

use super::basis::{Basis, flow};
use super::mesh::Mesh;
use super::shape::{MOST_COEFFICIENTS, Shape};
use std::borrow::Cow;
use std::sync::Arc;

/// q(s) on [0, K], a polynomial of degree four or five on each interval ([`Shape`]); and the times of the K
/// phases.
///
/// Derivatives in s jump where one phase ends and the next one begins, those in time do not. So the unknowns
/// at the ends of phases are derivatives in time, and each interval depends on the time of its own phase
/// alone.
#[derive(Clone, Debug, Default)]
pub(crate) struct Spline {
    /// Number of joints.
    pub dof: usize,
    pub mesh: Arc<Mesh>,
    /// q and dq/ds at each node, n entries each, and the second derivative where it is continuous; at the
    /// ends of phases q, v and the acceleration. Then the heights of the bubbles of each interval, n entries,
    /// where there are any.
    pub unknowns: Vec<f64>,
    /// T_p (s).
    pub times: Vec<f64>,
    /// For each node the orders of its unknowns that Newton's equations of the interval before it take as
    /// differences, from what the left end gives there ([`Self::flow`]); empty: none.
    pub differences: Vec<[bool; 3]>,
}

/// The unknowns of an interval that are derivatives in time: at an end of a phase that is an end of it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TimeDerivative {
    /// Their number among the coefficients of the interval and a joint.
    pub column: usize,
    /// Their order, m: the coefficient is T^m times the unknown.
    pub order: f64,
    /// The first of them among all unknowns.
    pub first: usize,
}

impl Spline {
    /// The number of unknowns of n joints.
    pub fn size(n: usize, intervals: usize, shape: Shape) -> usize {
        shape.node() * n * (intervals + 1) + shape.inner() * n * intervals
    }

    /// Number of unknowns at a node.
    #[inline(always)]
    pub fn node(&self) -> usize {
        self.mesh.shape.node() * self.dof
    }

    /// Takes another motion; allocates only if that is longer than ever before.
    pub fn copy_from(&mut self, other: &Self) {
        self.dof = other.dof;
        self.times.clone_from(&other.times);
        self.mesh.clone_from(&other.mesh);
        self.unknowns.clone_from(&other.unknowns);
    }

    /// The unknowns of an interval: heights of bubbles, states of both ends.
    #[inline(always)]
    pub fn of_interval<'a>(&self, unknowns: &'a [f64], k: usize) -> (&'a [f64], &'a [f64]) {
        let (node, inner) = (self.node(), self.mesh.shape.inner() * self.dof);
        let (ends, inners) = unknowns.split_at(node * self.mesh.nodes.len());
        (&inners[inner * k..inner * (k + 1)], &ends[node * k..node * (k + 2)])
    }

    /// The time of the phase of an interval (s).
    #[inline(always)]
    pub fn clock(&self, k: usize) -> f64 {
        self.times[self.mesh.phase(k)]
    }

    /// How long an interval takes (s).
    pub fn length(&self, k: usize) -> f64 {
        self.clock(k) * self.mesh.width(k)
    }

    /// How long the motion takes (s).
    pub fn duration(&self) -> f64 {
        self.times.iter().sum()
    }

    /// The time at s (s).
    pub fn time_at(&self, s: f64) -> f64 {
        let parts = self.times.iter().enumerate();
        parts.map(|(phase, time)| time * (s - phase as f64).clamp(0.0, 1.0)).sum()
    }

    /// The time of a point (s).
    pub fn time_of(&self, p: usize) -> f64 {
        self.time_at(self.mesh.point(p).0)
    }

    /// s at a time.
    pub fn place_of(&self, time: f64) -> f64 {
        let mut rest = time.max(0.0);
        for (phase, length) in self.times.iter().enumerate() {
            if rest < *length {
                return phase as f64 + rest / length;
            }
            rest -= length;
        }
        self.times.len() as f64
    }

    /// The weight of a point in the integral over time.
    #[inline(always)]
    pub fn weight(&self, p: usize) -> f64 {
        self.mesh.point(p).1 * self.clock(self.mesh.interval_of(p).0)
    }

    /// What the unknowns at a node are divided by to get derivatives in time of the first order.
    pub fn clock_at(&self, node: usize) -> f64 {
        if self.mesh.is_end(node) { 1.0 } else { self.clock(node) }
    }

    /// The unknowns of an end of a phase among all.
    pub fn end_unknowns(&self, end: usize) -> std::ops::Range<usize> {
        let first = self.node() * self.mesh.ends()[end];
        first..first + self.node()
    }

    /// q and v at an end of a phase, 2n numbers.
    pub fn end(&self, end: usize, state: &mut [f64]) {
        state.copy_from_slice(&self.unknowns[self.end_unknowns(end)][..2 * self.dof]);
    }

    /// The unknowns of an interval that are derivatives in time.
    #[inline(always)]
    pub(crate) fn time_derivatives(&self, k: usize) -> impl Iterator<Item = TimeDerivative> + use<> {
        let (n, order, inner) = (self.dof, self.mesh.shape.node(), self.mesh.shape.inner());
        let ends = [self.mesh.is_end(k), self.mesh.is_end(k + 1)];
        (0..2).filter(move |&side| ends[side]).flat_map(move |side| {
            (1..order).map(move |m| TimeDerivative {
                column: inner + order * side + m,
                order: m as f64,
                first: n * (order * (k + side) + m),
            })
        })
    }

    /// A basis of interval `k` over its unknowns: derivatives in s.
    #[inline(always)]
    fn over_unknowns<'a>(&self, k: usize, mut basis: Cow<'a, Basis>) -> Cow<'a, Basis> {
        if self.mesh.is_end(k) || self.mesh.is_end(k + 1) {
            let (time, own) = (self.clock(k), basis.to_mut());
            for TimeDerivative { column, order, .. } in self.time_derivatives(k) {
                let factor = if order == 1.0 { time } else { time * time };
                own.rows.iter_mut().for_each(|row| row[column] *= factor);
            }
        }
        basis
    }

    /// The orders of derivatives at a node that Newton's equations have as differences; `None` where none is.
    fn taken_as_differences(&self, node: usize) -> Option<[bool; 3]> {
        self.differences.get(node).copied().filter(|orders| orders.contains(&true))
    }

    /// F, which takes the unknowns x of the left node of an interval to those that it gives at the right one
    /// with its highest derivative constant: entries for orders of derivatives there and here, times the
    /// identity. Zero for orders there that are no differences d; with the others the right node is F x + d.
    /// `None` where none is.
    pub fn flow(&self, k: usize) -> Option<[[f64; 3]; 3]> {
        let orders = self.taken_as_differences(k + 1)?;
        let flow = flow(self.mesh.width(k));
        // Unknowns that are derivatives in time are those in s over T^m.
        let [here, there] = [k, k + 1].map(|node| if self.mesh.is_end(node) { self.clock(k) } else { 1.0 });
        Some([0, 1, 2].map(|j| {
            [0, 1, 2].map(|m| match m < j || !orders[j] {
                true => 0.0,
                false => flow[m - j] * here.powi(m as i32) / there.powi(j as i32),
            })
        }))
    }

    /// A basis of interval `k` over what Newton's equations have as unknowns: differences where there are
    /// some.
    #[inline(always)]
    fn over_differences<'a>(&self, k: usize, mut basis: Cow<'a, Basis>) -> Cow<'a, Basis> {
        if let Some(orders) = self.taken_as_differences(k + 1) {
            basis.to_mut().take_differences(self.mesh.shape, self.mesh.width(k), orders);
        }
        self.over_unknowns(k, basis)
    }

    /// The basis at point `j` of an interval over its unknowns.
    #[inline(always)]
    pub(crate) fn basis(&self, k: usize, j: usize) -> Cow<'_, Basis> {
        self.over_unknowns(k, Cow::Borrowed(self.mesh.basis(k, j)))
    }

    /// The same for changes of the unknowns of Newton's equations.
    #[inline(always)]
    pub(crate) fn basis_of_changes(&self, k: usize, j: usize) -> Cow<'_, Basis> {
        self.over_differences(k, Cow::Borrowed(self.mesh.basis(k, j)))
    }

    /// [`Basis::in_time`] at point `j` of an interval, for changes of the unknowns of Newton's equations.
    #[inline(never)]
    pub(crate) fn factors(&self, k: usize, j: usize) -> [[f64; MOST_COEFFICIENTS]; 3] {
        self.basis_of_changes(k, j).in_time(1.0 / self.clock(k))
    }

    /// The same at the part `x` of an interval.
    pub(crate) fn factors_at(&self, k: usize, x: f64) -> [[f64; MOST_COEFFICIENTS]; 3] {
        let basis = Basis::at(self.mesh.shape, x, self.mesh.width(k));
        self.over_differences(k, Cow::Owned(basis)).in_time(1.0 / self.clock(k))
    }

    /// The basis at one of Gauss's points, where accelerations are continuous.
    pub(crate) fn gauss_basis(&self, k: usize, j: usize) -> Cow<'_, Basis> {
        self.over_unknowns(k, Cow::Borrowed(self.mesh.gauss_basis(k, j)))
    }

    /// The same for changes of the unknowns of Newton's equations.
    pub(crate) fn gauss_basis_of_changes(&self, k: usize, j: usize) -> Cow<'_, Basis> {
        self.over_differences(k, Cow::Borrowed(self.mesh.gauss_basis(k, j)))
    }

    /// The basis over the unknowns at the part `x` of an interval.
    pub(super) fn basis_at(&self, k: usize, x: f64) -> Cow<'_, Basis> {
        self.over_unknowns(k, Cow::Owned(Basis::at(self.mesh.shape, x, self.mesh.width(k))))
    }

    /// The change of z = (q, v, a) at a place of interval `k`, which has this basis and this z, by a step of
    /// the unknowns of the interval and of the time of its phase; 3n numbers.
    #[inline(always)]
    pub(crate) fn change(
        &self,
        (k, basis): (usize, &Basis),
        (inner, ends): (&[f64], &[f64]),
        dt: f64,
        z: &[f64],
        dz: &mut [f64],
    ) {
        let (n, rate) = (self.dof, 1.0 / self.clock(k));
        basis.combine(n, inner, ends, dz);
        // What unknowns that are derivatives in time change by T alone.
        for TimeDerivative { column, order, first } in self.time_derivatives(k) {
            for (row, dz) in basis.rows.iter().zip(dz.chunks_exact_mut(n)) {
                let factor = order * rate * row[column] * dt;
                let unknowns = &self.unknowns[first..first + n];
                dz.iter_mut().zip(unknowns).for_each(|(dz, x)| *dz += factor * x);
            }
        }
        for i in 0..n {
            dz[n + i] = rate * (dz[n + i] - z[n + i] * dt);
            dz[2 * n + i] = rate * (rate * dz[2 * n + i] - 2.0 * z[2 * n + i] * dt);
        }
    }

    /// q, v, a at all points, 3n numbers a point.
    pub fn evaluate(&self, z: &mut [f64]) {
        for (p, z) in z.chunks_exact_mut(3 * self.dof).enumerate() {
            let (k, j) = self.mesh.interval_of(p);
            let (inner, ends) = self.of_interval(&self.unknowns, k);
            self.basis(k, j).combine(self.dof, inner, ends, z);
            self.scale(k, z);
        }
    }

    /// q, v, a at the part `x` of interval `k`, 3n numbers; with the jerk 4n.
    pub fn in_interval(&self, k: usize, x: f64, z: &mut [f64]) {
        self.in_parts(k, x, z);
        self.scale(k, z);
    }

    /// The same with derivatives in s.
    pub fn in_parts(&self, k: usize, x: f64, z: &mut [f64]) {
        let (inner, ends) = self.of_interval(&self.unknowns, k);
        self.basis_at(k, x).combine(self.dof, inner, ends, z);
    }

    /// Replaces `coefficients` by those of q on interval `k`, as polynomials of the part x of it: lowest
    /// power first, all of one joint after those of another one. Their number for a joint.
    pub fn coefficients(&self, k: usize, coefficients: &mut Vec<f64>) -> usize {
        let (n, count) = (self.dof, self.mesh.shape.coefficients());
        let mut powers = Basis::powers(self.mesh.shape, self.mesh.width(k));
        for TimeDerivative { column, order, .. } in self.time_derivatives(k) {
            powers[column].iter_mut().for_each(|power| *power *= self.clock(k).powf(order));
        }
        coefficients.clear();
        coefficients.resize(n * count, 0.0);
        let (inner, ends) = self.of_interval(&self.unknowns, k);
        for (all, powers) in inner.chunks_exact(n).chain(ends.chunks_exact(n)).zip(powers) {
            for (own, value) in coefficients.chunks_exact_mut(count).zip(all) {
                own.iter_mut().zip(powers).for_each(|(to, power)| *to += value * power);
            }
        }
        count
    }

    /// Derivatives in s become derivatives in time.
    fn scale(&self, k: usize, z: &mut [f64]) {
        let (rate, mut factor) = (1.0 / self.clock(k), 1.0);
        for derivatives in z.chunks_exact_mut(self.dof).skip(1) {
            factor *= rate;
            derivatives.iter_mut().for_each(|derivative| *derivative *= factor);
        }
    }

    /// A motion through the states and positions that `at` gives in a phase: q and its first two derivatives
    /// in s, n numbers each, at nodes and in the middle of intervals.
    pub fn through(
        n: usize,
        mesh: Arc<Mesh>,
        times: Vec<f64>,
        mut at: impl FnMut(usize, f64, &mut [f64]),
    ) -> Self {
        let shape = mesh.shape;
        let unknowns = vec![0.0; Self::size(n, mesh.intervals(), shape)];
        let mut spline = Self { dof: n, mesh, unknowns, times, ..Self::default() };
        let (node, mut state, mut z) = (shape.node() * n, vec![0.0; 3 * n], vec![0.0; 3 * n]);
        for k in 0..spline.mesh.nodes.len() {
            let interval = k.min(spline.mesh.intervals() - 1);
            at(spline.mesh.phase(interval), spline.mesh.nodes[k], &mut state);
            if spline.mesh.is_end(k) {
                spline.scale(interval, &mut state);
            }
            spline.unknowns[node * k..node * (k + 1)].copy_from_slice(&state[..node]);
        }
        let first = node * spline.mesh.nodes.len();
        for k in 0..if shape.inner() > 0 { spline.mesh.intervals() } else { 0 } {
            at(spline.mesh.phase(k), spline.mesh.nodes[k] + 0.5 * spline.mesh.width(k), &mut state);
            spline.in_parts(k, 0.5, &mut z);
            let bubble = &mut spline.unknowns[first + n * k..first + n * (k + 1)];
            bubble.iter_mut().zip(state.iter().zip(&z)).for_each(|(bubble, (q, cubic))| *bubble = q - cubic);
        }
        spline
    }

    /// The same motion on other nodes: exact where they contain those of this motion.
    pub fn on_nodes(&self, nodes: Vec<f64>) -> Self {
        let (n, shape) = (self.dof, self.mesh.shape);
        let at = |phase: usize, s: f64, z: &mut [f64]| {
            let (k, x) = self.mesh.place_in(phase, s);
            self.in_parts(k, x, z);
        };
        let mut spline = Self::through(n, Mesh::new(nodes, shape), self.times.clone(), at);
        for end in 0..=self.mesh.phases() {
            let state = &self.unknowns[self.end_unknowns(end)];
            let place = spline.end_unknowns(end);
            spline.unknowns[place].copy_from_slice(state);
        }
        spline
    }
}

#[cfg(test)]
#[path = "spline_tests.rs"]
mod tests;
