//! Newton's equations: second derivatives of the Lagrangian of the barrier problem in the unknowns.

use super::basis::{Basis, COEFFICIENTS, PLACES, POINTS};
use super::ends::Ends;
use super::limits::{Barrier, Limited};
use super::points::Points;
use super::running::Running;
use super::spline::Spline;
use crate::numerics::block_tridiagonal::{BlockTridiagonal, NotPositiveDefinite};

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

/// Arrays of one point.
#[derive(Clone, Debug, Default)]
struct Work {
    /// Gradients in z: with the multipliers, at mu = 0, factor of mu, and H z_T.
    z: [Vec<f64>; 4],
    /// The same in tau, without the last one.
    tau: [Vec<f64>; 3],
    /// Second derivatives by limits of z, 3n, and of tau with the effort, n.
    curvature: Vec<f64>,
    tau_curvature: Vec<f64>,
    hessian: Vec<f64>,
    product: Vec<f64>,
    z_t: Vec<f64>,
    z_tt: Vec<f64>,
}

impl System {
    pub fn new(n: usize) -> Self {
        let empty = || BlockTridiagonal::new(0, 3 * n);
        let zeros = || vec![0.0; 3 * n];
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
            work: Work {
                z: [zeros(), zeros(), zeros(), zeros()],
                tau: [vec![0.0; n], vec![0.0; n], vec![0.0; n]],
                curvature: zeros(),
                tau_curvature: vec![0.0; n],
                hessian: vec![0.0; 9 * n * n],
                product: vec![0.0; 3 * n * COEFFICIENTS * n],
                z_t: zeros(),
                z_tt: zeros(),
            },
        }
    }

    /// Weights of the torques in the Lagrangian: those for [`Points::weights`].
    pub fn weigh(spline: &Spline, points: &mut Points, barrier: &Barrier, running: &Running) {
        let n = points.dof;
        for p in 0..points.count() {
            let weight = spline.point(p).1 * spline.time;
            let weights = &mut points.weights[n * p..][..n];
            for ((w, &tau), &r) in weights.iter_mut().zip(&points.tau[n * p..]).zip(&running.effort) {
                *w = weight * r * tau;
            }
            let first = barrier.sides.len() * p;
            for (i, side) in barrier.sides.iter().enumerate() {
                if side.limited == Limited::Torque {
                    weights[side.joint] -= side.sign * barrier.multiplier[first + i];
                }
            }
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

    fn add_point(
        &mut self,
        p: usize,
        spline: &Spline,
        points: &Points,
        barrier: &Barrier,
        running: &mut Running,
    ) {
        let (n, time) = (points.dof, spline.time);
        let (_, weight) = spline.point(p);
        let (z, tau, tau_z) = (points.z(p), points.tau(p), points.tau_z(p));
        let work = &mut self.work;
        work.z.iter_mut().chain(&mut work.tau).for_each(|vector| vector.fill(0.0));
        work.curvature.fill(0.0);
        // The running cost, then its effort.
        work.hessian.copy_from_slice(points.hessian(p));
        let [gradient, _, _, slope] = &mut work.z;
        let mut cost = running.add_terms(z, [weight, time], gradient, slope, &mut work.hessian);
        for i in 0..n {
            let force = running.effort[i] * tau[i];
            cost += 0.5 * force * tau[i];
            work.tau[0][i] = time * weight * force;
            work.tau_curvature[i] = time * weight * running.effort[i];
            for (slope, &tau_z) in work.z[3].iter_mut().zip(&tau_z[3 * n * i..3 * n * (i + 1)]) {
                *slope += weight * force * tau_z;
            }
        }
        let [gradient, at_zero, ..] = &mut work.z;
        at_zero.copy_from_slice(gradient);
        let [gradient, at_zero, _] = &mut work.tau;
        at_zero.copy_from_slice(gradient);
        let sides = barrier.sides.len() * p;
        for (i, side) in barrier.sides.iter().enumerate() {
            let (s, eta, d) =
                (barrier.slack[sides + i], barrier.multiplier[sides + i], barrier.distance[sides + i]);
            if s.is_infinite() {
                continue;
            }
            let sigma = eta / s;
            let parts = [-side.sign * eta, -side.sign * (eta - sigma * d), -side.sign * weight / s];
            if side.limited == Limited::Torque {
                work.tau.iter_mut().zip(parts).for_each(|(to, part)| to[side.joint] += part);
                work.tau_curvature[side.joint] += sigma;
            } else {
                let index = side.index(n);
                work.z.iter_mut().zip(parts).for_each(|(to, part)| to[index] += part);
                work.curvature[index] += sigma;
            }
        }
        for (tau, z) in work.tau.iter().zip(&mut work.z) {
            for (&factor, row) in tau.iter().zip(tau_z.chunks_exact(3 * n)) {
                z.iter_mut().zip(row).for_each(|(z, row)| *z += factor * row);
            }
        }
        work.add_torque_square(n, tau_z);
        for i in 0..3 * n {
            work.hessian[3 * n * i + i] += work.curvature[i];
        }
        // Derivatives in T: z = (q, q'/T, q''/T^2). work.z[3] holds l_z times the weight.
        let inverse = 1.0 / time;
        for i in 0..n {
            let (v, a) = (z[n + i], z[2 * n + i]);
            (work.z_t[i], work.z_t[n + i], work.z_t[2 * n + i]) = (0.0, -inverse * v, -2.0 * inverse * a);
            let square = inverse * inverse;
            (work.z_tt[i], work.z_tt[n + i], work.z_tt[2 * n + i]) =
                (0.0, 2.0 * square * v, 6.0 * square * a);
        }
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
            scatter(spline, p, n, from, scales, to);
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
            if !(self.schur > 1e-14 * self.corner.abs()) {
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

impl Work {
    /// H += tau_z' C tau_z.
    fn add_torque_square(&mut self, n: usize, tau_z: &[f64]) {
        let width = 3 * n;
        for (row, &curvature) in tau_z.chunks_exact(width).zip(&self.tau_curvature) {
            if curvature == 0.0 {
                continue;
            }
            for (i, to) in self.hessian.chunks_exact_mut(width).enumerate() {
                let factor = curvature * row[i];
                to.iter_mut().zip(row).for_each(|(to, entry)| *to += factor * entry);
            }
        }
    }
}

/// Factors of the derivatives in time: those in s, times 1, 1/T, 1/T^2.
pub(super) fn scaled(basis: &Basis, scales: [f64; 3]) -> [[f64; COEFFICIENTS]; 3] {
    let rows = basis.rows();
    [0, 1, 2].map(|s| rows[s].map(|factor| factor * scales[s]))
}

/// Adds the Hessian of a node to its diagonal block.
pub(super) fn add_node(matrix: &mut BlockTridiagonal, k: usize, n: usize, hessian: &[f64], scales: [f64; 3]) {
    let width = 3 * n;
    for (i, (to, from)) in
        matrix.block_row(k).chunks_exact_mut(2 * width).zip(hessian.chunks_exact(width)).enumerate()
    {
        for j in i..width {
            to[j] += scales[i / n] * scales[j / n] * from[j];
        }
    }
}

/// Adds the Hessian of an inner point to the blocks of its interval.
pub(super) fn add_inner(
    matrix: &mut BlockTridiagonal,
    k: usize,
    n: usize,
    hessian: &[f64],
    basis: &[[f64; COEFFICIENTS]; 3],
    product: &mut [f64],
) {
    let width = 3 * n;
    // product[i] = sum over t of H[i, t] basis[t][b], columns b n + j.
    for (to, from) in product.chunks_exact_mut(2 * width).zip(hessian.chunks_exact(width)) {
        for (b, to) in to.chunks_exact_mut(n).enumerate() {
            let [f0, f1, f2] = [basis[0][b], basis[1][b], basis[2][b]];
            for j in 0..n {
                to[j] = f0 * from[j] + f1 * from[n + j] + f2 * from[2 * n + j];
            }
        }
    }
    let (here, next) = matrix.block_rows(k);
    for (a, i) in (0..COEFFICIENTS).flat_map(|a| (0..n).map(move |i| (a, i))) {
        let factors = [basis[0][a], basis[1][a], basis[2][a]];
        let [p0, p1, p2] = [0, 1, 2].map(|s| &product[2 * width * (s * n + i)..][..2 * width]);
        let (to, from) = if a < 3 {
            (&mut here[2 * width * (a * n + i)..][a * n..2 * width], a * n)
        } else {
            (&mut next[2 * width * ((a - 3) * n + i)..][(a - 3) * n..width], a * n)
        };
        for (j, to) in to.iter_mut().enumerate() {
            *to += factors[0] * p0[from + j] + factors[1] * p1[from + j] + factors[2] * p2[from + j];
        }
    }
}

/// Adds a gradient in z at a point to one in the unknowns.
fn scatter(spline: &Spline, p: usize, n: usize, from: &[f64], scales: [f64; 3], to: &mut [f64]) {
    let (k, j) = (p / POINTS, p % POINTS);
    let to = &mut to[3 * n * k..];
    if j == 0 {
        for (i, (to, from)) in to.iter_mut().zip(from).enumerate() {
            *to += scales[i / n] * from;
        }
        return;
    }
    let basis = scaled(&Basis::at(PLACES[j - 1], spline.width(k)), scales);
    for (b, to) in to.chunks_exact_mut(n).take(COEFFICIENTS).enumerate() {
        for (i, to) in to.iter_mut().enumerate() {
            *to += basis[0][b] * from[i] + basis[1][b] * from[n + i] + basis[2][b] * from[2 * n + i];
        }
    }
}

/// Makes row and column of an unknown those of the identity.
pub(super) fn remove(matrix: &mut BlockTridiagonal, k: usize, i: usize, block: usize) {
    let width = 2 * block;
    let rows = matrix.block_row(k);
    rows[width * i..][..width].fill(0.0);
    (0..i).for_each(|l| rows[width * l + i] = 0.0);
    rows[width * i + i] = 1.0;
    if k > 0 {
        let above = matrix.block_row(k - 1);
        (0..block).for_each(|l| above[width * l + block + i] = 0.0);
    }
}

fn dot(x: &[f64], y: &[f64]) -> f64 {
    x.iter().zip(y).map(|(x, y)| x * y).sum()
}
