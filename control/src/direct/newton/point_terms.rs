//! First and second derivatives of the Lagrangian of the barrier problem at one point, in z = (q, v, a).

use super::interval::row_length;
use crate::direct::limits::barrier::Barrier;
use crate::direct::limits::side::{Limited, Side};
use crate::direct::motion::shape::MOST_COEFFICIENTS;
use crate::direct::motion::spline::{Spline, TimeDerivative};
use crate::direct::points::running::{ByClock, Running};
use crate::direct::points::values::Points;
use crate::numerics::padded::{add_rows, add_squares, pad};
use crate::numerics::widest::in_widest;

/// Weights of the torques and rows in the Lagrangian: those for [`Points::weights`],
/// [`Points::g_weights`] and [`Points::h_weights`], and of the rows at the ends. Those of the torques are
/// without what rows h make of them.
pub(crate) fn weigh(spline: &Spline, points: &mut Points, barrier: &Barrier, running: &Running) {
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
        for ((i, side), at) in barrier.sides().iter().enumerate().zip(barrier.at_point(p)) {
            let multiplier = match barrier.is_hull(i) {
                true => barrier.by_value(spline.mesh.interval_of(p), i, |at| barrier.multiplier[at]),
                false => barrier.multiplier[at],
            };
            match side.limited {
                Limited::Torque => weights[side.joint] -= side.sign * multiplier,
                Limited::Power | Limited::TorqueSpeed | Limited::ToolAcceleration => {
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
pub(crate) fn side_terms(barrier: &Barrier, at: usize, sign: f64) -> ([f64; 3], f64) {
    let (s, eta, d) = (barrier.slack[at], barrier.multiplier[at], barrier.distance[at]);
    if s.is_infinite() {
        return ([0.0; 3], 0.0);
    }
    let sigma = barrier.curvature(at);
    let of_mu = if s > 0.0 { -sign * barrier.weight[at] / s } else { 0.0 };
    ([-sign * eta, -sign * (eta - sigma * d), of_mu], sigma)
}

/// The same of a side by its number and its value at point `j` of interval `k`, which has the entry `at`. The
/// second derivative is zero where coefficients are limited: it is not one by this value alone.
#[inline(always)]
pub(crate) fn entry_terms(
    barrier: &Barrier,
    place: (usize, usize),
    number: usize,
    at: usize,
) -> ([f64; 3], f64) {
    let sign = barrier.numbered(number).sign;
    if !barrier.is_hull(number) {
        return side_terms(barrier, at, sign);
    }
    let part = |i: usize| barrier.by_value(place, number, |at| side_terms(barrier, at, sign).0[i]);
    ([0, 1, 2].map(part), 0.0)
}

/// Adds `factor` times the gradient in z of the value that a side limits at a point.
#[inline(always)]
pub(crate) fn add_row(points: &Points, p: usize, side: &Side, factor: f64, z: &mut [f64]) {
    let n = points.dof;
    let row = match side.limited {
        Limited::Torque => &points.tau_z(p)[3 * n * side.joint..][..3 * n],
        Limited::Power | Limited::TorqueSpeed | Limited::ToolAcceleration => {
            &points.h_z(p)[3 * n * side.joint..][..3 * n]
        }
        Limited::Task => &points.g_x(p)[2 * n * side.joint..][..2 * n],
        _ => {
            z[side.index(n)] += factor;
            return;
        }
    };
    z.iter_mut().zip(row).for_each(|(z, row)| *z += factor * row);
}

/// What is collected of the Hessian of a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Second {
    All,
    /// Without second derivatives of torques and rows.
    Squares,
    Nothing,
}

/// Arrays of one point.
#[derive(Clone, Debug, Default)]
pub(crate) struct Work {
    /// Gradients in z: with the multipliers, at mu = 0, factor of mu, and H z_T; each of [`row_length`].
    pub z: [Vec<f64>; 4],
    /// The same in the rows of this point, without the last one: torques, rows of tasks, rows of powers.
    rows: [Vec<f64>; 3],
    /// Second derivatives by limits of z, 3n, and of rows, with the effort.
    curvature: Vec<f64>,
    row_curvature: Vec<f64>,
    /// The gradients of the rows in z, each of [`row_length`].
    row_z: Vec<f64>,
    /// 3n rows of [`row_length`]: with the limits and the squares of the torques.
    pub hessian: Vec<f64>,
    /// Its product with dz/dT, a row of it.
    pub product: Vec<f64>,
    /// dz/dT at constant unknowns, and the second derivative.
    pub z_t: Vec<f64>,
    pub z_tt: Vec<f64>,
    /// Derivatives by the time since the start of the motion, where there are references.
    pub clock: ByClock,
    /// Numbers of rows of tasks and of powers.
    counts: [usize; 2],
}

impl Work {
    /// Room for n joints and so many rows of tasks and of powers.
    pub fn new(n: usize, counts: [usize; 2]) -> Self {
        let (width, rows) = (row_length(n), n + counts[0] + counts[1]);
        let zeros = |length: usize| vec![0.0; length];
        Self {
            z: [zeros(width), zeros(width), zeros(width), zeros(width)],
            rows: [zeros(rows), zeros(rows), zeros(rows)],
            curvature: zeros(3 * n),
            row_curvature: zeros(rows),
            row_z: zeros(rows * width),
            hessian: zeros(3 * n * width),
            product: zeros(width),
            z_t: zeros(3 * n),
            z_tt: zeros(3 * n),
            clock: ByClock { mixed: zeros(3 * n), ..ByClock::default() },
            counts,
        }
    }

    /// Gradients and Hessian of a point in z. Its weight in the integral over s, and its running cost.
    #[inline(never)]
    pub fn collect(
        &mut self,
        p: usize,
        second: Second,
        spline: &Spline,
        points: &Points,
        barrier: &Barrier,
        running: &mut Running,
    ) -> (f64, f64) {
        in_widest!(self.collect_terms(p, second, spline, points, barrier, running))
    }

    #[inline(always)]
    fn collect_terms<const FUSED: bool>(
        &mut self,
        p: usize,
        second: Second,
        spline: &Spline,
        points: &Points,
        barrier: &Barrier,
        running: &mut Running,
    ) -> (f64, f64) {
        let (n, width) = (points.dof, row_length(points.dof));
        let time = spline.clock(spline.mesh.interval_of(p).0);
        let (_, weight) = spline.mesh.point(p);
        let (z, tau) = (points.z(p), points.tau(p));
        self.z.iter_mut().chain(&mut self.rows).for_each(|vector| vector.fill(0.0));
        self.curvature.fill(0.0);
        self.row_curvature.fill(0.0);
        self.take_rows(p, points);
        // The running cost, then its effort and its energy.
        match second {
            Second::All => pad(points.hessian(p), 3 * n, &mut self.hessian, width),
            Second::Squares | Second::Nothing => self.hessian.fill(0.0),
        }
        let [gradient, _, _, slope] = &mut self.z;
        let mut cost = running.add_terms(z, [weight, time], gradient, slope, &mut self.hessian);
        if running.references.any() {
            let at = (spline.time_of(p), z);
            cost += running.add_references(
                at,
                [weight, time],
                gradient,
                slope,
                &mut self.hessian,
                &mut self.clock,
            );
        }
        for (i, row) in self.row_z[..n * width].chunks_exact(width).enumerate() {
            let force = running.effort[i] * tau[i];
            cost += 0.5 * force * tau[i];
            self.rows[0][i] = time * weight * force;
            self.row_curvature[i] = time * weight * running.effort[i];
            add_rows::<FUSED>(&mut self.z[3], &[weight * force], row);
        }
        cost += self.add_energy::<FUSED>(p, [weight, time], points, running);
        let [gradient, at_zero, ..] = &mut self.z;
        at_zero.copy_from_slice(gradient);
        let [gradient, at_zero, _] = &mut self.rows;
        at_zero.copy_from_slice(gradient);
        self.add_sides(p, spline.mesh.interval_of(p), n, barrier);
        if points.rates.has_torques {
            for (rows, by_rates) in self.rows.iter_mut().zip(&points.rates.by_torques) {
                rows[..n].iter_mut().zip(&by_rates[n * p..]).for_each(|(tau, by_rate)| *tau += by_rate);
            }
        }
        for (factors, z) in self.rows.iter().zip(&mut self.z) {
            add_rows::<FUSED>(z, factors, &self.row_z);
        }
        if second != Second::Nothing {
            self.add_squares_of_rows::<FUSED>(p, points);
        }
        for i in 0..3 * n {
            self.hessian[width * i + i] += self.curvature[i];
        }
        (weight, cost)
    }

    /// Adds the squares of the rows to the Hessian.
    #[inline(always)]
    fn add_squares_of_rows<const FUSED: bool>(&mut self, p: usize, points: &Points) {
        let (n, width) = (points.dof, row_length(points.dof));
        let (of_torques, others) = self.row_curvature.split_at(n);
        let (of_tasks, of_powers) = others.split_at(self.counts[0]);
        let (torques, others) = self.row_z.split_at(n * width);
        let (tasks, powers) = others.split_at(self.counts[0] * width);
        // Most rows of tasks depend on positions alone.
        let rates = points.g_x(p).chunks_exact(2 * n).flat_map(|row| &row[n..]);
        let of_states = if rates.copied().all(|entry| entry == 0.0) { n } else { 2 * n };
        let parts = [(of_torques, torques, 3 * n), (of_tasks, tasks, of_states), (of_powers, powers, 3 * n)];
        for (curvatures, rows, columns) in parts {
            add_squares::<FUSED>(&mut self.hessian, [width, columns], curvatures, rows);
        }
    }

    /// Takes the gradients of the rows of a point.
    #[inline(always)]
    fn take_rows(&mut self, p: usize, points: &Points) {
        let (n, width) = (points.dof, row_length(points.dof));
        let (tau_z, others) = self.row_z.split_at_mut(n * width);
        let (g_x, h_z) = others.split_at_mut(self.counts[0] * width);
        pad(points.tau_z(p), 3 * n, tau_z, width);
        pad(points.g_x(p), 2 * n, g_x, width);
        pad(points.h_z(p), 3 * n, h_z, width);
    }

    /// The cost of energy at a point, a function of the first rows h. Its value.
    #[inline(always)]
    fn add_energy<const FUSED: bool>(
        &mut self,
        p: usize,
        [weight, time]: [f64; 2],
        points: &Points,
        running: &Running,
    ) -> f64 {
        let (width, first, mut cost) = (row_length(points.dof), points.dof + self.counts[0], 0.0);
        for i in 0..running.energy.weights.len() {
            let term = running.energy.term(i, points.h(p)[i]);
            cost += term.value;
            self.rows[0][first + i] = time * weight * term.first;
            self.row_curvature[first + i] = time * weight * term.second;
            let row = &self.row_z[width * (first + i)..width * (first + i + 1)];
            add_rows::<FUSED>(&mut self.z[3], &[weight * term.first], row);
        }
        cost
    }

    /// The limits of a point.
    #[inline(always)]
    fn add_sides(&mut self, p: usize, place: (usize, usize), n: usize, barrier: &Barrier) {
        for ((i, side), at) in barrier.sides().iter().enumerate().zip(barrier.at_point(p)) {
            let (parts, sigma) = entry_terms(barrier, place, i, at);
            let (gradients, curvatures, index) = match side.limited {
                Limited::Torque => (&mut self.rows[..], &mut self.row_curvature, side.joint),
                Limited::Task => (&mut self.rows[..], &mut self.row_curvature, n + side.joint),
                Limited::Power | Limited::TorqueSpeed | Limited::ToolAcceleration => {
                    (&mut self.rows[..], &mut self.row_curvature, n + self.counts[0] + side.joint)
                }
                _ => (&mut self.z[..], &mut self.curvature, side.index(n)),
            };
            gradients.iter_mut().zip(parts).for_each(|(to, part)| to[index] += part);
            curvatures[index] += sigma;
        }
    }

    /// Derivatives of z = (q, q'/T, q''/T^2) in the time T of the phase of interval `k`, at constant
    /// unknowns. Those that are derivatives in time, of the order m, are in z with the powers `T^(m - s)`,
    /// s = 0, 1, 2.
    #[inline(never)]
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
