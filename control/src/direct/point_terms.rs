//! First and second derivatives of the Lagrangian of the barrier problem at one point, in z = (q, v, a).

use super::limits::Barrier;
use super::points::Points;
use super::running::Running;
use super::shape::MOST_COEFFICIENTS;
use super::side::{Limited, Side};
use super::spline::{Spline, TimeDerivative};

/// Weights of the torques and rows in the Lagrangian: those for [`Points::weights`],
/// [`Points::g_weights`] and [`Points::h_weights`], and of the rows at the ends. Those of the torques are
/// without what rows h make of them.
pub(super) fn weigh(spline: &Spline, points: &mut Points, barrier: &Barrier, running: &Running) {
    let (n, rows, powers) = (points.dof, points.rows, points.powers);
    points.g_weights.fill(0.0);
    points.h_weights.fill(0.0);
    points.rates.collect(spline, barrier, &running.rates);
    for (weight, at) in points.ends.weights.iter_mut().zip(barrier.at_ends()) {
        *weight = -barrier.side(at).sign * barrier.multiplier[at];
    }
    for p in 0..points.count() {
        let weight = spline.weight(p);
        let weights = &mut points.weights[n * p..][..n];
        for ((w, &tau), &r) in weights.iter_mut().zip(&points.tau[n * p..]).zip(&running.effort) {
            *w = weight * r * tau;
        }
        if points.rates.has_torques {
            let by_rates = &points.rates.by_torques[0][n * p..];
            weights.iter_mut().zip(by_rates).for_each(|(w, by_rate)| *w += by_rate);
        }
        for i in 0..running.energy.weights.len() {
            points.h_weights[powers * p + i] =
                weight * running.energy.term(i, points.h[powers * p + i]).first;
        }
        for (side, multiplier) in barrier.sides().iter().zip(&barrier.multiplier[barrier.at_point(p)]) {
            match side.limited {
                Limited::Torque => weights[side.joint] -= side.sign * multiplier,
                Limited::Power | Limited::TorqueSpeed => {
                    points.h_weights[powers * p + side.joint] -= side.sign * multiplier;
                }
                Limited::Task => points.g_weights[rows * p + side.joint] -= side.sign * multiplier,
                _ => {}
            }
        }
    }
}

/// The terms of a side in the Lagrangian, whose slack and multiplier are eliminated: with d = s, eta s = mu w
/// (w the weight of the entry),
///
/// $$ \Delta s = \Delta d + d - s, \qquad \Delta \eta = a - \sigma \Delta d, \qquad
///    \sigma = \eta / s, \quad a = (\mu w - \eta d)/s $$
///
/// Derivatives by the value with the multipliers, at mu = 0, and the factor of mu; and the second derivative.
/// The same holds for an equation, with its own sigma and without mu.
#[inline(always)]
pub(super) fn side_terms(barrier: &Barrier, at: usize, sign: f64) -> ([f64; 3], f64) {
    let (s, eta, d) = (barrier.slack[at], barrier.multiplier[at], barrier.distance[at]);
    if s.is_infinite() {
        return ([0.0; 3], 0.0);
    }
    let sigma = barrier.curvature(at);
    let of_mu = if s > 0.0 { -sign * barrier.weight[at] / s } else { 0.0 };
    ([-sign * eta, -sign * (eta - sigma * d), of_mu], sigma)
}

/// Adds `factor` times the gradient in z of the value that a side limits at a point.
#[inline(always)]
pub(super) fn add_row(points: &Points, p: usize, side: &Side, factor: f64, z: &mut [f64]) {
    let n = points.dof;
    let row = match side.limited {
        Limited::Torque => &points.tau_z(p)[3 * n * side.joint..][..3 * n],
        Limited::Power | Limited::TorqueSpeed => &points.h_z(p)[3 * n * side.joint..][..3 * n],
        Limited::Task => &points.g_x(p)[2 * n * side.joint..][..2 * n],
        _ => {
            z[side.index(n)] += factor;
            return;
        }
    };
    z.iter_mut().zip(row).for_each(|(z, row)| *z += factor * row);
}

/// Arrays of one point.
#[derive(Clone, Debug, Default)]
pub(super) struct Work {
    /// Gradients in z: with the multipliers, at mu = 0, factor of mu, and H z_T.
    pub z: [Vec<f64>; 4],
    /// The same in tau, without the last one.
    tau: [Vec<f64>; 3],
    /// Second derivatives by limits of z, 3n, and of tau with the effort, n.
    curvature: Vec<f64>,
    tau_curvature: Vec<f64>,
    /// The same for the rows of tasks.
    g: [Vec<f64>; 3],
    g_curvature: Vec<f64>,
    /// The same for the rows of powers.
    h: [Vec<f64>; 3],
    h_curvature: Vec<f64>,
    /// 3n x 3n: with the limits and the squares of the torques.
    pub hessian: Vec<f64>,
    /// dz/dT at constant unknowns, and the second derivative.
    pub z_t: Vec<f64>,
    pub z_tt: Vec<f64>,
}

impl Work {
    /// Room for n joints and so many rows of tasks and of powers.
    pub fn new(n: usize, rows: [usize; 2]) -> Self {
        let zeros = || vec![0.0; 3 * n];
        let three = |rows: usize| [vec![0.0; rows], vec![0.0; rows], vec![0.0; rows]];
        Self {
            z: [zeros(), zeros(), zeros(), zeros()],
            tau: three(n),
            curvature: zeros(),
            tau_curvature: vec![0.0; n],
            g: three(rows[0]),
            g_curvature: vec![0.0; rows[0]],
            h: three(rows[1]),
            h_curvature: vec![0.0; rows[1]],
            hessian: vec![0.0; 9 * n * n],
            z_t: zeros(),
            z_tt: zeros(),
        }
    }

    /// Gradients and Hessian of a point in z. Its weight in the integral over s, and its running cost.
    #[inline(always)]
    pub fn collect(
        &mut self,
        p: usize,
        exact: bool,
        spline: &Spline,
        points: &Points,
        barrier: &Barrier,
        running: &mut Running,
    ) -> (f64, f64) {
        let (n, time) = (points.dof, spline.clock(spline.mesh.interval_of(p).0));
        let (_, weight) = spline.mesh.point(p);
        let (z, tau, tau_z) = (points.z(p), points.tau(p), points.tau_z(p));
        let rows = self.tau.iter_mut().chain(&mut self.g).chain(&mut self.h);
        self.z.iter_mut().chain(rows).for_each(|vector| vector.fill(0.0));
        self.curvature.fill(0.0);
        self.g_curvature.fill(0.0);
        self.h_curvature.fill(0.0);
        // The running cost, then its effort and its energy.
        if exact {
            self.hessian.copy_from_slice(points.hessian(p));
        } else {
            self.hessian.fill(0.0);
        }
        let [gradient, _, _, slope] = &mut self.z;
        let mut cost = running.add_terms(z, [weight, time], gradient, slope, &mut self.hessian);
        for i in 0..n {
            let force = running.effort[i] * tau[i];
            cost += 0.5 * force * tau[i];
            self.tau[0][i] = time * weight * force;
            self.tau_curvature[i] = time * weight * running.effort[i];
            for (slope, &tau_z) in self.z[3].iter_mut().zip(&tau_z[3 * n * i..3 * n * (i + 1)]) {
                *slope += weight * force * tau_z;
            }
        }
        cost += self.add_energy(p, [weight, time], points, running);
        let [gradient, at_zero, ..] = &mut self.z;
        at_zero.copy_from_slice(gradient);
        for [gradient, at_zero, _] in [&mut self.tau, &mut self.h] {
            at_zero.copy_from_slice(gradient);
        }
        self.add_sides(p, n, barrier);
        if points.rates.has_torques {
            for (tau, by_rates) in self.tau.iter_mut().zip(&points.rates.by_torques) {
                tau.iter_mut().zip(&by_rates[n * p..]).for_each(|(tau, by_rate)| *tau += by_rate);
            }
        }
        let (g_x, h_z) = (points.g_x(p), points.h_z(p));
        let rows = self.tau.iter().zip(&self.g).zip(&self.h);
        for (((tau, g), h), z) in rows.zip(&mut self.z) {
            let of_tau = tau.iter().zip(tau_z.chunks_exact(3 * n));
            let of_g = g.iter().zip(g_x.chunks_exact(2 * n));
            for (&factor, row) in of_tau.chain(of_g).chain(h.iter().zip(h_z.chunks_exact(3 * n))) {
                z.iter_mut().zip(row).for_each(|(z, row)| *z += factor * row);
            }
        }
        add_squares(&mut self.hessian, 3 * n, &self.tau_curvature, tau_z.chunks_exact(3 * n));
        add_squares(&mut self.hessian, 3 * n, &self.g_curvature, g_x.chunks_exact(2 * n));
        add_squares(&mut self.hessian, 3 * n, &self.h_curvature, h_z.chunks_exact(3 * n));
        for i in 0..3 * n {
            self.hessian[3 * n * i + i] += self.curvature[i];
        }
        (weight, cost)
    }

    /// The cost of energy at a point, a function of the first rows h. Its value.
    #[inline(always)]
    fn add_energy(&mut self, p: usize, [weight, time]: [f64; 2], points: &Points, running: &Running) -> f64 {
        let (n, mut cost) = (points.dof, 0.0);
        for i in 0..running.energy.weights.len() {
            let term = running.energy.term(i, points.h(p)[i]);
            cost += term.value;
            self.h[0][i] = time * weight * term.first;
            self.h_curvature[i] = time * weight * term.second;
            for (slope, &h_z) in self.z[3].iter_mut().zip(&points.h_z(p)[3 * n * i..3 * n * (i + 1)]) {
                *slope += weight * term.first * h_z;
            }
        }
        cost
    }

    /// The limits of a point.
    #[inline(always)]
    fn add_sides(&mut self, p: usize, n: usize, barrier: &Barrier) {
        for (at, side) in barrier.at_point(p).zip(barrier.sides()) {
            let (parts, sigma) = side_terms(barrier, at, side.sign);
            let (gradients, curvatures, index) = match side.limited {
                Limited::Torque => (&mut self.tau[..], &mut self.tau_curvature, side.joint),
                Limited::Power | Limited::TorqueSpeed => (&mut self.h[..], &mut self.h_curvature, side.joint),
                Limited::Task => (&mut self.g[..], &mut self.g_curvature, side.joint),
                _ => (&mut self.z[..], &mut self.curvature, side.index(n)),
            };
            gradients.iter_mut().zip(parts).for_each(|(to, part)| to[index] += part);
            curvatures[index] += sigma;
        }
    }

    /// Derivatives of z = (q, q'/T, q''/T^2) in the time T of the phase of interval `k`, at constant
    /// unknowns. Those that are derivatives in time, of the order m, are in z with the powers `T^(m - s)`,
    /// s = 0, 1, 2.
    #[inline(always)]
    pub fn differentiate_in_time(
        &mut self,
        z: &[f64],
        spline: &Spline,
        k: usize,
        factors: &[[f64; MOST_COEFFICIENTS]; 3],
    ) {
        let (n, inverse) = (z.len() / 3, 1.0 / spline.clock(k));
        let square = inverse * inverse;
        for i in 0..n {
            let (v, a) = (z[n + i], z[2 * n + i]);
            (self.z_t[i], self.z_t[n + i], self.z_t[2 * n + i]) = (0.0, -inverse * v, -2.0 * inverse * a);
            (self.z_tt[i], self.z_tt[n + i], self.z_tt[2 * n + i]) =
                (0.0, 2.0 * square * v, 6.0 * square * a);
        }
        for TimeDerivative { column, order, first } in spline.time_derivatives(k) {
            for (s, factors) in factors.iter().enumerate() {
                let part = factors[column] * order;
                let second = part * square * (order - 1.0 - 2.0 * s as f64);
                for (i, x) in spline.unknowns[first..first + n].iter().enumerate() {
                    self.z_t[s * n + i] += part * inverse * x;
                    self.z_tt[s * n + i] += second * x;
                }
            }
        }
    }
}

/// `H += J' C J` with the rows of J, which may be shorter than those of H.
#[inline(always)]
pub(super) fn add_squares<'a>(
    hessian: &mut [f64],
    width: usize,
    curvatures: &[f64],
    rows: impl Iterator<Item = &'a [f64]>,
) {
    for (row, &curvature) in rows.zip(curvatures).filter(|(_, curvature)| **curvature != 0.0) {
        for (to, entry) in hessian.chunks_exact_mut(width).zip(row) {
            let factor = curvature * entry;
            to.iter_mut().zip(row).for_each(|(to, entry)| *to += factor * entry);
        }
    }
}
