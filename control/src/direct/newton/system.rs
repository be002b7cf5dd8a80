//! Newton's equations: second derivatives of the Lagrangian of the barrier problem in the unknowns.

use super::border::Border;
use super::by_times::ByTimes;
use super::end_columns::EndColumns;
use super::interval::{IntervalHessian, add_by_time, add_gradient};
use super::metric::Metric;
use super::point_terms::{Gradients, Second, Touch, Work};
use super::rate_rows::RateRows;
use super::side_terms::side_terms;
use crate::direct::limits::at_node::{AtNode, ByTime, NodeValue};
use crate::direct::limits::barrier::Barrier;
use crate::direct::limits::ends::Ends;
use crate::direct::motion::shape::{MOST_COEFFICIENTS, Shape};
use crate::direct::motion::spline::Spline;
use crate::direct::points::panels::{GAUSS, next_panel};
use crate::direct::points::running::Running;
use crate::direct::points::values::Points;
use crate::numerics::chain::{ChainMatrix, dot};
use crate::numerics::padded::add_rows;
use costate_numerics::in_widest;
use std::ops::Range;

/// The equations `[K B; B' C] (dx, dy) = -(g, g_y)`, g = g_0 + mu g_1, for the unknowns x of a spline and
/// those that are shared, y: parameters of the times of its phases, and states at both ends of a motion whose
/// end follows its start. Slacks and multipliers are eliminated at each point ([`side_terms`]).
#[derive(Clone, Debug)]
pub(crate) struct System {
    pub(in crate::direct) matrix: ChainMatrix,
    pub(super) factor: ChainMatrix,
    pub(in crate::direct) damping: ChainMatrix,
    pub(super) damping_is_current: bool,
    /// Gradients in x at mu = 0 and its factor of mu.
    pub gradient: [Vec<f64>; 2],
    /// The same in y.
    pub shared_gradient: [Vec<f64>; 2],
    pub(super) border: Border,
    /// What rows of both ends add between them: the state of the start by that of the end.
    pub(in crate::direct) across: Vec<f64>,
    /// What the equations have for the given ends.
    pub(crate) at_ends: EndColumns,
    pub(in crate::direct) by_times: ByTimes,
    /// The metric of damping in the times, diagonal: cost over the squares of times.
    pub(super) time_metric: Vec<f64>,
    /// Gradient of corrections, in x, in the times and in y.
    pub(crate) correction: Vec<f64>,
    pub(crate) time_correction: Vec<f64>,
    pub(crate) shared_correction: Vec<f64>,
    pub(crate) work: Work,
    /// q, v, a at a place beside the points.
    pub(super) of_place: Vec<f64>,
    /// Limits that are touched for an instant; of a motion that is differentiated alone.
    pub touches: Vec<Touch>,
    /// Whether second derivatives of torques and rows count.
    pub exact: bool,
    /// Which gradients are collected at points; with that of the cost alone derivatives by times are missing.
    pub(super) gradients: Gradients,
    /// Whether only the intervals behind a node are assembled, with gradients at all nodes.
    pub(super) is_rest: bool,
    pub(super) interval: IntervalHessian,
    pub(super) metric: Metric,
    pub(crate) rate_rows: RateRows,
}

/// A place of a motion: its interval, s, and z = (q, v, a).
pub(super) struct Place<'a> {
    pub k: usize,
    pub s: f64,
    pub z: &'a [f64],
    /// Whether its cost depends on the time since the start of the motion.
    pub has_clock: bool,
}

impl System {
    /// For n joints and so many rows of tasks and of powers.
    pub fn new(n: usize, shape: Shape, rows: [usize; 2]) -> Self {
        let empty = || ChainMatrix::new(shape.node() * n, shape.inner() * n);
        Self {
            matrix: empty(),
            factor: empty(),
            damping: empty(),
            damping_is_current: false,
            gradient: [Vec::new(), Vec::new()],
            shared_gradient: Default::default(),
            border: Border::default(),
            across: Vec::new(),
            at_ends: EndColumns::new(n, shape),
            by_times: ByTimes::default(),
            time_metric: Vec::new(),
            correction: Vec::new(),
            time_correction: Vec::new(),
            shared_correction: Vec::new(),
            work: Work::new(n, rows),
            of_place: vec![0.0; 3 * n],
            touches: Vec::new(),
            exact: true,
            gradients: Gradients::All,
            is_rest: false,
            interval: IntervalHessian::new(n, shape),
            metric: Metric::new(n, shape),
            rate_rows: RateRows::new(n),
        }
    }

    /// Assembles the equations from contracted points.
    pub fn assemble(
        &mut self,
        spline: &Spline,
        points: &Points,
        barrier: &Barrier,
        running: &mut Running,
        ends: &Ends,
    ) {
        self.collect(Gradients::All, spline, points, barrier, running);
        if ends.times.count() > 0 {
            let cost = running.cost(spline, points).abs() / spline.duration();
            let phases = spline.times.len();
            self.time_metric.clear();
            self.time_metric.resize(phases * phases, 0.0);
            for (phase, time) in spline.times.iter().enumerate() {
                self.time_metric[(phases + 1) * phase] = cost / time;
            }
        }
        self.at_ends.take(&self.matrix, &self.by_times.columns, &spline.mesh);
        self.fix(ends, spline);
    }

    /// Adds all of a motion up, by its unknowns, those that are given and shared too, and with all gradients
    /// by its times.
    pub(crate) fn collect(
        &mut self,
        gradients: Gradients,
        spline: &Spline,
        points: &Points,
        barrier: &Barrier,
        running: &mut Running,
    ) {
        self.begin(spline, running);
        self.is_rest = false;
        self.gradients = gradients;
        for p in 0..points.count() {
            self.add_point(p, spline, points, barrier, running);
        }
        self.add_panels(0..spline.mesh.intervals(), spline, running);
        self.add_rates(0..spline.mesh.intervals(), spline, points);
        self.add_hulls(0..spline.mesh.intervals(), spline, points, barrier);
        for k in 0..if self.touches.is_empty() { 0 } else { spline.mesh.intervals() } {
            self.add_touches(k, spline);
        }
        // Rows of a program add nothing but to derivatives by times.
        for k in 0..if gradients == Gradients::All { spline.mesh.nodes.len() } else { 0 } {
            self.add_node(k, spline, barrier);
        }
        self.add_ends(spline, points, barrier, |_| true);
    }

    /// Zero everywhere, but for what the times cost.
    pub(super) fn begin(&mut self, spline: &Spline, running: &mut Running) {
        self.matrix.reset(spline.mesh.intervals());
        self.damping_is_current = false;
        for vector in &mut self.gradient {
            vector.clear();
            vector.resize(spline.unknowns.len(), 0.0);
        }
        self.by_times.reset(spline.mesh.phases(), spline.unknowns.len());
        self.by_times.gradient[0].fill(running.time);
        self.at_ends.reset(spline.unknowns.len(), spline.mesh.intervals());
        running.split(spline);
    }

    /// Adds a point: its gradients and its Hessian in z become those in the unknowns and in the time of its
    /// phase.
    pub(super) fn add_point(
        &mut self,
        p: usize,
        spline: &Spline,
        points: &Points,
        barrier: &Barrier,
        running: &mut Running,
    ) {
        let (k, j) = spline.mesh.interval_of(p);
        let factors = spline.factors(k, j);
        let of_hessian = if self.exact { Second::All } else { Second::Squares };
        let (weight, cost) =
            self.work.collect(p, (of_hessian, self.gradients), spline, points, barrier, running);
        let place =
            Place { k, s: spline.mesh.point(p).0, z: points.z(p), has_clock: running.references.any() };
        self.add_gradients(&place, spline, &factors, weight * cost);
        self.interval.take(j, points.dof, factors, &self.work.hessian);
        let own = spline.mesh.own_points(k);
        if j + 1 == own {
            self.interval.add_to(&mut self.matrix, k, points.dof, own);
        }
    }

    /// Adds references on intervals that have knots inside, panel by panel
    /// ([`crate::direct::points::panels`]).
    pub(super) fn add_panels(&mut self, intervals: Range<usize>, spline: &Spline, running: &mut Running) {
        let mut z = std::mem::take(&mut self.of_place);
        for k in intervals {
            if !running.panels.is_split(k) {
                continue;
            }
            let (left, width, clock) = (spline.mesh.nodes[k], spline.mesh.width(k), spline.clock(k));
            let mut from = 0.0;
            while let Some(to) = next_panel(&running.references, spline, k, from) {
                for [place, part] in GAUSS {
                    let (x, weight) = (from + place * (to - from), part * (to - from) * width);
                    spline.in_interval(k, x, &mut z);
                    let time = spline.time_at(left) + x * width * clock;
                    let cost = self.work.collect_references((time, &z), [weight, clock], running);
                    let factors = spline.factors_at(k, x);
                    let place = Place { k, s: left + x * width, z: &z, has_clock: true };
                    self.add_gradients(&place, spline, &factors, weight * cost);
                    self.interval.take(0, spline.dof, factors, &self.work.hessian);
                    self.interval.add_to(&mut self.matrix, k, spline.dof, 1);
                }
                from = to;
            }
        }
        self.of_place = z;
    }

    /// Adds the gradients of a place that was collected, and what they are by the time of its phase; `cost`
    /// is its part of the integral over s.
    #[inline(always)]
    pub(super) fn add_gradients(
        &mut self,
        &Place { k, s, z, has_clock }: &Place<'_>,
        spline: &Spline,
        factors: &[[f64; MOST_COEFFICIENTS]; 3],
        cost: f64,
    ) {
        if self.gradients == Gradients::OfCost {
            return add_gradient(spline, k, factors, &self.work.z[1], &mut self.gradient[0]);
        }
        let (n, phase, inverse) = (spline.dof, spline.mesh.phase(k), 1.0 / spline.clock(k));
        let work = &mut self.work;
        work.differentiate_in_time(z, spline, k, factors);
        let [gradient, at_zero, of_mu, slope] = &mut work.z;
        let by_times = &mut self.by_times;
        by_times.gradient[0][phase] += cost + dot(at_zero, &work.z_t);
        by_times.gradient[1][phase] += dot(of_mu, &work.z_t);
        let mut second = dot(gradient, &work.z_tt) + 2.0 * dot(slope, &work.z_t);
        // H is symmetric.
        work.product.fill(0.0);
        in_widest!(add_rows(&mut work.product, &work.z_t, &work.hessian));
        second += dot(&work.z_t, &work.product);
        slope.iter_mut().zip(&work.product).for_each(|(slope, product)| *slope += product);
        for (factor, group) in [(-inverse, n..2 * n), (-2.0 * inverse, 2 * n..3 * n)] {
            let slope = slope[group.clone()].iter_mut().zip(&gradient[group]);
            slope.for_each(|(slope, gradient)| *slope += factor * gradient);
        }
        by_times.add_second([phase; 2], second);
        let column = &mut by_times.columns[phase];
        let targets = self.gradient.iter_mut().chain([&mut *column]);
        for (to, from) in targets.zip(&work.z[1..]) {
            add_gradient(spline, k, factors, from, to);
        }
        add_by_time(spline, k, factors, &work.z[0], column);
        if has_clock {
            by_times.add_clock((k, s), spline, factors, work);
        }
        if self.is_rest || k == 0 || k + 1 == spline.mesh.intervals() {
            add_gradient(spline, k, factors, &work.z[0], &mut self.at_ends.gradient);
        }
    }

    /// Adds the limits of positions and rates at a node.
    pub(super) fn add_node(&mut self, k: usize, spline: &Spline, barrier: &Barrier) {
        let (node, at_node) = (spline.node(), AtNode::new(spline, k));
        for at in barrier.at_node(k) {
            let side = barrier.side(at);
            let ([gradient, at_zero, of_mu], sigma) = side_terms(barrier, at, side.sign);
            let NodeValue { unknown, scale, by_time, .. } = at_node.of(side);
            self.gradient[0][unknown] += scale * at_zero;
            self.gradient[1][unknown] += scale * of_mu;
            self.matrix.node_rows(k)[(2 * node + 1) * (unknown - node * k)] += scale * scale * sigma;
            if let Some(ByTime { phase, first, second, mixed }) = by_time {
                let by_times = &mut self.by_times;
                by_times.gradient[0][phase] += first * at_zero;
                by_times.gradient[1][phase] += first * of_mu;
                by_times.add_second([phase; 2], first * first * sigma + second * gradient);
                by_times.columns[phase][unknown] += scale * first * sigma + mixed * gradient;
            }
        }
    }

    /// Adds the rows at these ends of phases.
    #[inline(always)]
    pub(super) fn add_ends(
        &mut self,
        spline: &Spline,
        points: &Points,
        barrier: &Barrier,
        which: impl Fn(usize) -> bool,
    ) {
        let (n, node, mut done) = (spline.dof, spline.node(), None);
        let has_far = !points.ends.far.is_empty();
        self.across.clear();
        self.across.resize(if has_far { node * node } else { 0 }, 0.0);
        for (number, (at, g_x)) in barrier.at_ends().zip(points.ends.g_x.chunks_exact(2 * n)).enumerate() {
            let end = barrier.end_of(at);
            if !which(end) {
                continue;
            }
            let k = spline.mesh.ends()[end];
            let (parts, sigma) = side_terms(barrier, at, barrier.side(at).sign);
            self.add_row_at(k, parts, sigma, g_x);
            if let Some(far) = points.ends.far.chunks_exact(2 * n).nth(number) {
                self.add_row_at(spline.mesh.intervals(), parts, sigma, far);
                for (to, entry) in self.across.chunks_exact_mut(node).zip(g_x) {
                    to.iter_mut().zip(far).for_each(|(to, far)| *to += sigma * entry * far);
                }
            }
            if done.replace(end) != Some(end) && self.exact {
                self.add_hessian_at(k, &points.ends.hessian[end]);
            }
        }
        if has_far && self.exact && which(spline.mesh.phases()) {
            let last = points.ends.hessian.len() - 1;
            self.add_hessian_at(spline.mesh.intervals(), &points.ends.hessian[last]);
        }
    }

    /// Adds a row over the state of a node.
    #[inline(always)]
    fn add_row_at(&mut self, k: usize, parts: [f64; 3], sigma: f64, row: &[f64]) {
        let node = self.matrix.first_of(1);
        let gradients = self.gradient.iter_mut().chain([&mut self.at_ends.gradient]);
        for (gradient, part) in gradients.zip([parts[1], parts[2], parts[0]]) {
            let gradient = gradient[node * k..].iter_mut().zip(row);
            gradient.for_each(|(to, entry)| *to += part * entry);
        }
        for (to, entry) in self.matrix.node_rows(k).chunks_exact_mut(2 * node).zip(row) {
            let factor = sigma * entry;
            to.iter_mut().zip(row).for_each(|(to, entry)| *to += factor * entry);
        }
    }

    /// Adds second derivatives by q and v of a node.
    #[inline(always)]
    fn add_hessian_at(&mut self, k: usize, hessian: &[f64]) {
        let (node, size) = (self.matrix.first_of(1), 2 * self.work.z_t.len() / 3);
        let rows = self.matrix.node_rows(k).chunks_exact_mut(2 * node);
        for (to, from) in rows.zip(hessian.chunks_exact(size)) {
            to.iter_mut().zip(from).for_each(|(to, from)| *to += from);
        }
    }

    /// Takes what is given or tied at the ends out of the equations, and collects what is shared.
    fn fix(&mut self, ends: &Ends, spline: &Spline) {
        let (by_times, mesh) = (&self.by_times, &spline.mesh);
        let matrix = (&self.matrix, &self.across[..]);
        self.border.collect((&by_times.columns, &by_times.second), matrix, ends, mesh);
        let pairs = self.gradient.iter_mut().zip(&by_times.gradient);
        for ((gradient, by_times), shared) in pairs.zip(&mut self.shared_gradient) {
            shared.resize(ends.shared(), 0.0);
            ends.reduce(mesh, gradient, by_times, shared);
        }
        ends.removed(mesh).for_each(|(k, i)| self.matrix.remove(k, i));
    }
}

#[cfg(test)]
#[path = "system_tests.rs"]
pub(in crate::direct) mod tests;

#[cfg(test)]
#[path = "gait_tests.rs"]
mod gait_tests;
