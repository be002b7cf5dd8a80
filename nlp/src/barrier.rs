//! The barrier parameter, and steps that stay inside the bounds.

use crate::iterate::{Bounds, Iterate, Step};

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
/// to zero.
pub(crate) fn longest_steps(iterate: &Iterate, bounds: &Bounds, step: &Step, tau: f64) -> [f64; 2] {
    let shorten = |length: f64, value: f64, change: f64| match change < 0.0 {
        true => length.min(-tau * value / change),
        false => length,
    };
    let (mut of_slacks, mut of_multipliers) = (1.0, 1.0);
    let ([lower, upper], [to_lower, to_upper]) = (&iterate.z, &step.z);
    for i in 0..lower.len() {
        let [below, above] = bounds.gaps(&iterate.slacks, i);
        of_slacks = shorten(of_slacks, below, step.slacks[i]);
        of_slacks = shorten(of_slacks, above, -step.slacks[i]);
        of_multipliers = shorten(of_multipliers, lower[i], to_lower[i]);
        of_multipliers = shorten(of_multipliers, upper[i], to_upper[i]);
    }
    [of_slacks, of_multipliers]
}

/// Keeps multipliers of bounds within a factor of `mu / (s - l)`: Waechter and Biegler 2006, eq. (16).
pub(crate) fn reset_multipliers(iterate: &mut Iterate, bounds: &Bounds, mu: f64, factor: f64) {
    for i in 0..iterate.slacks.len() {
        let gaps = bounds.gaps(&iterate.slacks, i);
        for (z, gap) in iterate.z.iter_mut().zip(gaps) {
            z[i] = if gap.is_finite() { z[i].clamp(mu / (factor * gap), factor * mu / gap) } else { 0.0 };
        }
    }
}

/// The derivative of `-mu ln (s - l) - mu ln (u - s)` along a step of the slacks.
pub(crate) fn slope(iterate: &Iterate, bounds: &Bounds, step: &Step, mu: f64) -> f64 {
    (0..step.slacks.len()).fold(0.0, |sum, i| {
        let [below, above] = bounds.gaps(&iterate.slacks, i);
        sum + mu * step.slacks[i] * (above.recip() - below.recip())
    })
}
