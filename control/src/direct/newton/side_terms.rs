//! What sides of limits and equations add to the Lagrangian of the barrier problem.

use crate::direct::limits::barrier::Barrier;
use crate::direct::limits::side::{Limited, Side};
use crate::direct::motion::spline::Spline;
use crate::direct::points::running::Running;
use crate::direct::points::values::Points;

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
/// The same holds for an equation, with its own sigma and without mu. Rows of a program have the first one
/// alone.
#[inline(always)]
pub(crate) fn side_terms(barrier: &Barrier, at: usize, sign: f64) -> ([f64; 3], f64) {
    if barrier.is_apart {
        return ([-sign * barrier.multiplier[at], 0.0, 0.0], 0.0);
    }
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
