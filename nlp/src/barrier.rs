//! The barrier parameter, and steps that stay inside the bounds.

use crate::iterate::{Bounds, Iterate, Residuals, Step};
use crate::vectors::{largest_of, sum_of, worse};
use costate_numerics::in_widest;

/// How the barrier parameter falls.
///
/// Source: Waechter and Biegler 2006, sections 2 and 3.6.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BarrierSettings {
    /// mu at the start.
    pub start: f64,
    /// kappa_epsilon: the barrier problem is solved up to an error of this many times mu.
    pub accuracy: f64,
    /// kappa_mu and theta_mu: the next mu is `min(kappa_mu mu, mu^theta_mu)`.
    pub decrease: (f64, f64),
    /// tau_min: a step goes at most this part of the way to a bound, or `1 - mu` if that is larger.
    pub part: f64,
    /// kappa_sigma: multipliers of bounds are kept within this factor of mu over the slack.
    pub neighbourhood: f64,
    /// kappa_1, kappa_2: slacks start at least this far inside their bounds, relative to the size of the
    /// bound and to the range.
    pub inside: [f64; 2],
}

impl Default for BarrierSettings {
    fn default() -> Self {
        Self {
            start: 0.1,
            accuracy: 10.0,
            decrease: (0.2, 1.5),
            part: 0.99,
            neighbourhood: 1e10,
            inside: [1e-2, 1e-2],
        }
    }
}

impl BarrierSettings {
    /// The next mu, not below a tenth of the tolerance.
    pub(crate) fn next(&self, mu: f64, tolerance: f64) -> f64 {
        let (linear, power) = self.decrease;
        (linear * mu).min(mu.powf(power)).max(0.1 * tolerance)
    }

    /// tau.
    pub(crate) fn part_of_way(&self, mu: f64) -> f64 {
        self.part.max(1.0 - mu)
    }

    /// The value nearest to `value` that is inside the bounds by the distances of a start.
    pub(crate) fn inside(&self, value: f64, lower: f64, upper: f64) -> f64 {
        let [absolute, relative] = self.inside;
        let range = upper - lower;
        let room = |bound: f64| (absolute * bound.abs().max(1.0)).min(relative * range);
        match (lower.is_finite(), upper.is_finite()) {
            (true, true) => value.clamp(lower + room(lower), upper - room(upper)),
            (true, false) => value.max(lower + absolute * lower.abs().max(1.0)),
            (false, true) => value.min(upper - absolute * upper.abs().max(1.0)),
            (false, false) => value,
        }
    }
}

/// The longest steps, at most 1, of slacks and of multipliers of bounds that go at most a part tau of the way
/// to zero; with the reciprocals of the gaps of slacks.
pub(crate) fn longest_steps(
    iterate: &Iterate,
    [below, above]: &[Vec<f64>; 2],
    step: &Step,
    tau: f64,
) -> [f64; 2] {
    let ([lower, upper], [to_lower, to_upper]) = (&iterate.z, &step.z);
    // The part of the way to zero that a whole step goes.
    let of_slacks = worse(
        in_widest!(largest_product(below, &step.slacks, -1.0)),
        in_widest!(largest_product(above, &step.slacks, 1.0)),
    );
    let of_multipliers =
        worse(in_widest!(largest_decrease(lower, to_lower)), in_widest!(largest_decrease(upper, to_upper)));
    [of_slacks, of_multipliers].map(|part| (tau / part).min(1.0))
}

#[inline(always)]
fn largest_product<const FUSED: bool>(reciprocals: &[f64], changes: &[f64], sign: f64) -> f64 {
    largest_of([reciprocals, changes], |[reciprocal, change]| positive(sign * change * reciprocal))
}

#[inline(always)]
fn largest_decrease<const FUSED: bool>(values: &[f64], changes: &[f64]) -> f64 {
    largest_of([values, changes], |[value, change]| if change < 0.0 { -change / value } else { 0.0 })
}

#[inline(always)]
fn positive(value: f64) -> f64 {
    if value > 0.0 { value } else { 0.0 }
}

/// Keeps multipliers of bounds within a factor of `mu / (s - l)`: Waechter and Biegler 2006, eq. (16).
pub(crate) fn reset_multipliers(iterate: &mut Iterate, bounds: &Bounds, mu: f64, factor: f64) {
    let Iterate { slacks, z: [lower, upper], .. } = iterate;
    in_widest!(reset(lower, slacks, &bounds.lower, mu, factor));
    in_widest!(reset(upper, &bounds.upper, slacks, mu, factor));
}

/// Of the bounds of one side, whose gaps are `from - to`.
#[inline(always)]
fn reset<const FUSED: bool>(z: &mut [f64], from: &[f64], to: &[f64], mu: f64, factor: f64) {
    let down = factor.recip();
    for (z, (from, to)) in z.iter_mut().zip(from.iter().zip(to)) {
        let gap = from - to;
        let central = mu / gap;
        let (least, most) = (down * central, factor * central);
        let raised = if *z < least { least } else { *z };
        let kept = if raised > most { most } else { raised };
        *z = if gap < f64::INFINITY { kept } else { 0.0 };
    }
}

/// The derivative of `-mu ln (s - l) - mu ln (u - s)` along a step of the slacks.
pub(crate) fn slope(reciprocals: &[Vec<f64>; 2], step: &Step, mu: f64) -> f64 {
    mu * in_widest!(sum_of_slopes(reciprocals, &step.slacks))
}

#[inline(always)]
fn sum_of_slopes<const FUSED: bool>([below, above]: &[Vec<f64>; 2], slacks: &[f64]) -> f64 {
    sum_of([slacks, below, above], |[d, below, above]| d * (above - below))
}

/// Residuals of slacks with `mu / (s - l)` in the place of z.
pub(crate) fn barrier_residuals(
    iterate: &Iterate,
    [below, above]: &[Vec<f64>; 2],
    mu: f64,
    to: &mut Residuals,
) {
    let gaps = below.iter().zip(above).zip(&iterate.v);
    to.slacks.iter_mut().zip(gaps).for_each(|(to, ((below, above), v))| *to = mu * (above - below) - v);
}
