//! Newton's equations: second derivatives of the Lagrangian of the barrier problem in the unknowns.

use super::basis::{Basis, PLACES, POINTS};
use super::ends::Ends;
use super::limits::Barrier;
use super::point_terms::Work;
use super::points::Points;
use super::running::Running;
use super::scatter::{add_gradient, add_inner, add_node, remove, scaled};
use super::spline::Spline;
use crate::constants::direct::LEAST_CURVATURE;
use crate::numerics::block_tridiagonal::{BlockTridiagonal, NotPositiveDefinite, dot};

/// The equations `[K b; b' c] (dx, dT) = -(g, g_T)`, g = g_0 + mu g_1, for the unknowns x of a spline and its
/// time T.
///
/// Slacks and multipliers are eliminated at each point: with d = s, eta s = mu w (w the weight of the point),
///
/// $$ \Delta s = \Delta d + d - s, \qquad \Delta \eta = a - \sigma \Delta d, \qquad
///    \sigma = \eta / s, \quad a = (\mu w - \eta d)/s $$
#[derive(Clone, Debug)]
pub(crate) struct System {
    matrix: BlockTridiagonal,
    factor: BlockTridiagonal,
    metric: BlockTridiagonal,
    metric_is_current: bool,
    /// Gradients in x at mu = 0, its factor of mu, and the derivative in T.
    pub gradient: [Vec<f64>; 2],
    border: Vec<f64>,
    corner: f64,
    /// The metric of damping in T: cost over T squared.
    time_metric: f64,
    /// Gradients in T.
    pub time_gradient: [f64; 2],
    border_solved: Vec<f64>,
    schur: f64,
    work: Work,
}

impl System {
    pub fn new(n: usize) -> Self {
        let empty = || BlockTridiagonal::new(0, 3 * n);
        Self {
            matrix: empty(),
            factor: empty(),
            metric: empty(),
            metric_is_current: false,
            gradient: [Vec::new(), Vec::new()],
            border: Vec::new(),
            corner: 0.0,
            time_metric: 0.0,
            time_gradient: [0.0; 2],
            border_solved: Vec::new(),
            schur: 1.0,
            work: Work::new(n),
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
        let n = points.dof;
        let count = spline.nodes.len();
        self.matrix.reset(count);
        self.metric_is_current = false;
        for vector in self.gradient.iter_mut().chain([&mut self.border]) {
            vector.clear();
            vector.resize(3 * n * count, 0.0);
        }
        (self.corner, self.time_gradient) = (0.0, [running.time, 0.0]);
        for p in 0..points.count() {
            self.add_point(p, spline, points, barrier, running);
        }
        self.time_metric = running.cost(spline, points).abs() / (spline.time * spline.time);
        self.fix(ends, spline);
    }

    /// Adds a point: its gradients and its Hessian in z become those in the unknowns and in T.
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
        let (weight, cost) = work.collect(p, spline, points, barrier, running);
        work.differentiate_in_time(points.z(p), inverse);
        let [gradient, at_zero, of_mu, slope] = &mut work.z;
        self.time_gradient[0] += weight * cost + dot(at_zero, &work.z_t);
        self.time_gradient[1] += dot(of_mu, &work.z_t);
        self.corner += dot(gradient, &work.z_tt) + 2.0 * dot(slope, &work.z_t);
        for (i, row) in work.hessian.chunks_exact(3 * n).enumerate() {
            let product = dot(row, &work.z_t);
            self.corner += work.z_t[i] * product;
            slope[i] += product + [0.0, -inverse, -2.0 * inverse][i / n] * gradient[i];
        }
        let (k, j) = (p / POINTS, p % POINTS);
        let scales = [1.0, inverse, inverse * inverse];
        if j == 0 {
            add_node(&mut self.matrix, k, n, &work.hessian, scales);
        } else {
            let basis = scaled(&Basis::at(PLACES[j - 1], spline.width(k)), scales);
            add_inner(&mut self.matrix, k, n, &work.hessian, &basis, &mut work.product);
        }
        for (to, from) in self.gradient.iter_mut().chain([&mut self.border]).zip(&work.z[1..]) {
            add_gradient(spline, p, n, from, scales, to);
        }
    }

    /// Takes the given ends out of the equations: their unknowns depend on T alone.
    fn fix(&mut self, ends: &Ends, spline: &Spline) {
        let last = spline.intervals();
        let block = ends.start.len();
        for (k, fixed) in [(0, &ends.start), (last, &ends.end)] {
            for (i, tangent) in fixed.iter().enumerate() {
                let Some(tangent) = *tangent else { continue };
                if tangent != 0.0 {
                    self.move_with_time(k, i, tangent, block);
                }
            }
        }
        for (k, fixed) in [(0, &ends.start), (last, &ends.end)] {
            for (i, tangent) in fixed.iter().enumerate() {
                if tangent.is_some() {
                    remove(&mut self.matrix, k, i, block);
                    self.gradient
                        .iter_mut()
                        .chain([&mut self.border])
                        .for_each(|vector| vector[block * k + i] = 0.0);
                }
            }
        }
    }

    /// The border of an unknown that changes with T by `tangent`. Tangents of all unknowns together must be
    /// applied one after the other: each adds its products with the matrix.
    fn move_with_time(&mut self, k: usize, i: usize, tangent: f64, block: usize) {
        let at = block * k + i;
        self.time_gradient[0] += tangent * self.gradient[0][at];
        self.time_gradient[1] += tangent * self.gradient[1][at];
        self.corner += tangent * (2.0 * self.border[at] + tangent * self.matrix.row(k, i)[i]);
        for l in 0..block {
            let entry = if l < i { self.matrix.row(k, l)[i] } else { self.matrix.row(k, i)[l] };
            self.border[block * k + l] += tangent * entry;
            if k > 0 {
                self.border[block * (k - 1) + l] += tangent * self.matrix.row(k - 1, l)[block + i];
            } else if self.matrix.count() > 1 {
                self.border[block + l] += tangent * self.matrix.row(0, i)[block + l];
            }
        }
    }

    /// Factorises, with `damping` times the metric added to K. Whether T is free decides about the border.
    pub fn factorise(
        &mut self,
        damping: f64,
        free_time: bool,
        metric: impl FnOnce(&mut BlockTridiagonal),
    ) -> Result<(), NotPositiveDefinite> {
        self.factor.copy_from(&self.matrix);
        if damping > 0.0 {
            if !self.metric_is_current {
                self.metric.reset(self.matrix.count());
                metric(&mut self.metric);
                self.metric_is_current = true;
            }
            self.factor.add(damping, &self.metric);
        }
        self.factor.factorise()?;
        if free_time {
            self.border_solved.clone_from(&self.border);
            self.factor.solve(&mut self.border_solved);
            self.schur = self.corner + damping * self.time_metric - dot(&self.border, &self.border_solved);
            let definite = self.schur > LEAST_CURVATURE * self.corner.abs();
            if !definite {
                return Err(NotPositiveDefinite { block: self.matrix.count() });
            }
        }
        Ok(())
    }

    /// Solves for the part of the step that belongs to the gradient `part`.
    pub fn solve(&self, part: usize, free_time: bool, dx: &mut Vec<f64>) -> f64 {
        dx.clear();
        dx.extend(self.gradient[part].iter().map(|g| -g));
        self.factor.solve(dx);
        if !free_time {
            return 0.0;
        }
        let dt = (-self.time_gradient[part] - dot(&self.border, dx)) / self.schur;
        dx.iter_mut().zip(&self.border_solved).for_each(|(dx, b)| *dx -= dt * b);
        dt
    }
}

#[cfg(test)]
#[path = "system_tests.rs"]
mod tests;
