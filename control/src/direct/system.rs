//! Newton's equations: second derivatives of the Lagrangian of the barrier problem in the unknowns.

use super::end_columns::EndColumns;
use super::ends::Ends;
use super::interval::{IntervalHessian, add_gradient, row_length};
use super::limits::Barrier;
use super::metric::Metric;
use super::point_terms::{Work, side_terms};
use super::points::Points;
use super::rate_rows::RateRows;
use super::running::Running;
use super::shape::Shape;
use super::side::Limited;
use super::spline::Spline;
use crate::constants::direct::LEAST_CURVATURE;
use crate::numerics::chain::{ChainMatrix, NotPositiveDefinite, dot};
use crate::numerics::widest::widest_fused;

/// The equations `[K b; b' c] (dx, dT) = -(g, g_T)`, g = g_0 + mu g_1, for the unknowns x of a spline and its
/// time T. Slacks and multipliers are eliminated at each point ([`side_terms`]).
#[derive(Clone, Debug)]
pub(crate) struct System {
    pub(super) matrix: ChainMatrix,
    pub(super) factor: ChainMatrix,
    damping: ChainMatrix,
    damping_is_current: bool,
    /// Gradients in x at mu = 0, its factor of mu, and the derivative in T.
    pub gradient: [Vec<f64>; 2],
    pub(super) border: Vec<f64>,
    /// What the equations have for the given ends.
    pub(super) at_ends: EndColumns,
    pub(super) corner: f64,
    /// The metric of damping in T: cost over T squared.
    time_metric: f64,
    /// Gradients in T.
    pub time_gradient: [f64; 2],
    pub(super) border_solved: Vec<f64>,
    pub(super) schur: f64,
    /// Gradient of corrections, in x and T.
    pub(super) correction: Vec<f64>,
    pub(super) time_correction: f64,
    pub(super) work: Work,
    /// Whether second derivatives of torques and rows count.
    pub exact: bool,
    interval: IntervalHessian,
    metric: Metric,
    pub(super) rate_rows: RateRows,
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
            border: Vec::new(),
            at_ends: EndColumns::new(n, shape),
            corner: 0.0,
            time_metric: 0.0,
            time_gradient: [0.0; 2],
            border_solved: Vec::new(),
            schur: 1.0,
            correction: Vec::new(),
            time_correction: 0.0,
            work: Work::new(n, rows),
            exact: true,
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
        widest_fused(
            #[inline(always)]
            |_| self.assemble_all(spline, points, barrier, running, ends),
        );
    }

    #[inline(always)]
    fn assemble_all(
        &mut self,
        spline: &Spline,
        points: &Points,
        barrier: &Barrier,
        running: &mut Running,
        ends: &Ends,
    ) {
        self.matrix.reset(spline.mesh.intervals());
        self.damping_is_current = false;
        for vector in self.gradient.iter_mut().chain([&mut self.border]) {
            vector.clear();
            vector.resize(spline.unknowns.len(), 0.0);
        }
        self.at_ends.reset(spline.unknowns.len(), spline.mesh.intervals());
        (self.corner, self.time_gradient) = (0.0, [running.time, 0.0]);
        for p in 0..points.count() {
            self.add_point(p, spline, points, barrier, running);
        }
        self.add_rates(spline, points);
        for k in 0..spline.mesh.nodes.len() {
            self.add_node(k, spline, barrier);
        }
        self.add_ends(spline, points, barrier);
        if ends.free_time {
            self.time_metric = running.cost(spline, points).abs() / (spline.time * spline.time);
        }
        self.at_ends.take(&self.matrix, &self.border, spline.mesh.intervals());
        self.fix(ends, spline);
    }

    /// Adds a point: its gradients and its Hessian in z become those in the unknowns and in T.
    #[inline(always)]
    fn add_point(
        &mut self,
        p: usize,
        spline: &Spline,
        points: &Points,
        barrier: &Barrier,
        running: &mut Running,
    ) {
        let (n, inverse) = (points.dof, 1.0 / spline.time);
        let work = &mut self.work;
        let (weight, cost) = work.collect(p, self.exact, spline, points, barrier, running);
        work.differentiate_in_time(points.z(p), inverse);
        let [gradient, at_zero, of_mu, slope] = &mut work.z;
        self.time_gradient[0] += weight * cost + dot(at_zero, &work.z_t);
        self.time_gradient[1] += dot(of_mu, &work.z_t);
        self.corner += dot(gradient, &work.z_tt) + 2.0 * dot(slope, &work.z_t);
        for (i, row) in work.hessian.chunks_exact(row_length(n)).enumerate() {
            let product = dot(row, &work.z_t);
            self.corner += work.z_t[i] * product;
            slope[i] += product + [0.0, -inverse, -2.0 * inverse][i / n] * gradient[i];
        }
        let (k, j) = spline.mesh.interval_of(p);
        let factors = spline.mesh.basis(k, j).in_time(inverse);
        self.interval.take(j, n, factors, &work.hessian);
        let points = spline.mesh.own_points(k);
        if j + 1 == points {
            self.interval.add_to(&mut self.matrix, k, n, points);
        }
        for (to, from) in self.gradient.iter_mut().chain([&mut self.border]).zip(&work.z[1..]) {
            add_gradient(spline, k, &factors, from, to);
        }
        if k == 0 || k + 1 == spline.mesh.intervals() {
            add_gradient(spline, k, &factors, &work.z[0], &mut self.at_ends.gradient);
        }
    }

    /// Adds the limits of positions and rates at a node.
    fn add_node(&mut self, k: usize, spline: &Spline, barrier: &Barrier) {
        let (n, node, inverse) = (spline.dof, spline.node(), 1.0 / spline.time);
        let first = node * k;
        for at in barrier.at_node(k) {
            let side = barrier.side(at);
            let ([gradient, at_zero, of_mu], sigma) = side_terms(barrier, at, side.sign);
            let i = side.index(n);
            let is_rate = side.limited == Limited::Rate;
            let scale = if is_rate { inverse } else { 1.0 };
            self.gradient[0][first + i] += scale * at_zero;
            self.gradient[1][first + i] += scale * of_mu;
            self.matrix.node_rows(k)[(2 * node + 1) * i] += scale * scale * sigma;
            if is_rate {
                // v = q'/T.
                let v = inverse * spline.unknowns[first + i];
                let slope = -inverse * v;
                self.time_gradient[0] += slope * at_zero;
                self.time_gradient[1] += slope * of_mu;
                self.corner += slope * slope * sigma + 2.0 * inverse * inverse * v * gradient;
                self.border[first + i] += scale * slope * sigma - inverse * inverse * gradient;
            }
        }
    }

    /// Adds the rows of tasks at both ends, which depend on positions.
    #[inline(always)]
    fn add_ends(&mut self, spline: &Spline, points: &Points, barrier: &Barrier) {
        let (n, node, mut done) = (spline.dof, spline.node(), [false; 2]);
        for (at, g_x) in barrier.at_ends().zip(points.ends.g_x.chunks_exact(2 * n)) {
            let (end, row) = (barrier.end_of(at), &g_x[..n]);
            let k = end * spline.mesh.intervals();
            let (parts, sigma) = side_terms(barrier, at, barrier.side(at).sign);
            let gradients = self.gradient.iter_mut().chain([&mut self.at_ends.gradient]);
            for (gradient, part) in gradients.zip([parts[1], parts[2], parts[0]]) {
                let gradient = gradient[node * k..].iter_mut().zip(row);
                gradient.for_each(|(to, entry)| *to += part * entry);
            }
            let rows = self.matrix.node_rows(k);
            for (to, entry) in rows.chunks_exact_mut(2 * node).zip(row) {
                let factor = sigma * entry;
                to.iter_mut().zip(row).for_each(|(to, entry)| *to += factor * entry);
            }
            if !std::mem::replace(&mut done[end], true) && self.exact {
                let hessian = points.ends.hessian[end].chunks_exact(2 * n).take(n);
                for (to, from) in rows.chunks_exact_mut(2 * node).zip(hessian) {
                    to.iter_mut().zip(&from[..n]).for_each(|(to, from)| *to += from);
                }
            }
        }
    }

    /// Takes the given ends out of the equations: their unknowns depend on T alone.
    fn fix(&mut self, ends: &Ends, spline: &Spline) {
        let (intervals, node) = (spline.mesh.intervals(), spline.node());
        for (k, i, [_, curvature]) in ends.with_curvatures(intervals, spline.time) {
            self.corner += curvature * self.at_ends.gradient(usize::from(k > 0), i);
        }
        for (k, i, tangent) in ends.all(intervals, spline.time).filter(|(_, _, tangent)| *tangent != 0.0) {
            // One after the other: each adds its products with the matrix.
            let at = node * k + i;
            self.time_gradient[0] += tangent * self.gradient[0][at];
            self.time_gradient[1] += tangent * self.gradient[1][at];
            self.corner += tangent * (2.0 * self.border[at] + tangent * self.matrix.entry(at, at));
            self.matrix.add_column(k, i, tangent, &mut self.border);
        }
        for (k, i, _) in ends.all(intervals, spline.time) {
            self.matrix.remove(k, i);
            let vectors = self.gradient.iter_mut().chain([&mut self.border]);
            vectors.for_each(|vector| vector[node * k + i] = 0.0);
        }
    }

    /// Factorises, with `damping` times the metric of `weights` added to K.
    pub fn factorise(
        &mut self,
        damping: f64,
        ends: &Ends,
        spline: &Spline,
        points: &Points,
        weights: &[f64],
    ) -> Result<(), NotPositiveDefinite> {
        self.factor.copy_from(&self.matrix);
        if damping > 0.0 {
            if !self.damping_is_current {
                self.damping.reset(spline.mesh.intervals());
                self.metric.fill(&mut self.damping, spline, points, weights, ends);
                self.damping_is_current = true;
            }
            self.factor.add(damping, &self.damping);
        }
        self.factor.factorise()?;
        if ends.free_time {
            self.border_solved.clone_from(&self.border);
            self.factor.solve(&mut self.border_solved);
            self.schur = self.corner + damping * self.time_metric - dot(&self.border, &self.border_solved);
            let definite = self.schur > LEAST_CURVATURE * self.corner.abs();
            if !definite {
                return Err(NotPositiveDefinite { block: spline.mesh.nodes.len() });
            }
        }
        Ok(())
    }

    /// Makes room for the metric of damping.
    pub fn reserve_damping(&mut self, intervals: usize) {
        self.damping.reset(intervals);
        self.damping_is_current = false;
    }

    /// Solves for the part of the step that belongs to the gradient `part`.
    pub fn solve(&mut self, part: usize, free_time: bool, dx: &mut Vec<f64>) -> f64 {
        dx.clear();
        dx.extend(self.gradient[part].iter().map(|g| -g));
        self.finish_solution(self.time_gradient[part], free_time, dx)
    }

    /// Solves for a step with the negative gradient in `dx`.
    pub(super) fn finish_solution(&mut self, time_gradient: f64, free_time: bool, dx: &mut [f64]) -> f64 {
        self.factor.solve(dx);
        if !free_time {
            return 0.0;
        }
        let dt = (-time_gradient - dot(&self.border, dx)) / self.schur;
        dx.iter_mut().zip(&self.border_solved).for_each(|(dx, b)| *dx -= dt * b);
        dt
    }

    /// Solves with another right-hand side, whose last entry is that of T.
    pub fn solve_column(&mut self, column: &mut [f64], free_time: bool) {
        let Some((dt, dx)) = column.split_last_mut() else { return };
        self.factor.solve(dx);
        *dt = if free_time { (*dt - dot(&self.border, dx)) / self.schur } else { 0.0 };
        if free_time {
            dx.iter_mut().zip(&self.border_solved).for_each(|(dx, b)| *dx -= *dt * b);
        }
    }
}

#[cfg(test)]
#[path = "system_tests.rs"]
mod tests;
