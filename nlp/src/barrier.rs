//! The barrier parameter, and steps that stay inside the bounds.

use crate::centrality::Targets;
use crate::iterate::{Bounds, Iterate, Residuals, Step, central};
use crate::vectors::{largest_of, sum_of, worse};
use costate_numerics::in_widest;

/// Slacks begin at least so far inside their bounds.
pub(crate) const LEAST_ROOM: f64 = 1e-12;

/// How the barrier parameter changes, and where iterates begin.
///
/// Sources: S. Mehrotra, "On the implementation of a primal-dual interior point method", SIAM Journal on
/// Optimization 2 (1992), 575-601; J. Nocedal, A. Waechter, R. A. Waltz, "Adaptive barrier update strategies
/// for nonlinear interior methods", SIAM Journal on Optimization 19 (2009), 1674-1693; Waechter and Biegler
/// 2006.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BarrierSettings {
    /// mu at the start.
    pub start: f64,
    /// mu_target: the program is solved where the conditions of the barrier problem at this mu hold. Zero:
    /// with mu as far down as the tolerance needs, a tenth of it, and conditions of the program itself.
    pub least: f64,
    /// mu is at most so many times the larger one of `start` and that of the start, whatever the settings
    /// below would make it: where a program cannot be solved multipliers grow, and mu with them. As
    /// mu_max_fact of IPOPT, but of mu in the place of the mean product at the start.
    pub largest: f64,
    /// Smallest and largest factor from the mean of all products of slacks and multipliers to the next mu.
    /// Between them it is sigma = (mu_aff / mu)^3 with the mean mu_aff that the step for mu = 0 would leave
    /// (Mehrotra 1992).
    pub change: [f64; 2],
    /// The mean is not made smaller than this part of the Newton decrement over the number of bounds: far
    /// from the central path slacks would come close to zero before the others.
    pub centring: f64,
    /// Where the Hessian is not the exact one, a short step for mu = 0 says nothing: mu stays until its
    /// decrement, or that of the step before, is below the first one, a part of the sum of the products, and
    /// falls by the second one, a factor, then.
    pub regularised: [f64; 2],
    /// tau_min: a step goes at most this part of the way to a bound, or `1 - mu` if that is larger (Waechter
    /// and Biegler 2006, eq. (8)).
    pub part: f64,
    /// kappa_sigma: multipliers of bounds are kept within this factor of mu over the slack (eq. (16)).
    pub neighbourhood: f64,
    /// kappa_1, kappa_2: slacks start at least this far inside their bounds, relative to the size of the
    /// bound and to the range (section 3.6).
    pub inside: [f64; 2],
    /// From given multipliers, slacks begin where these are on the central path, at most the first one
    /// inside, if the function is no farther. Then multipliers come within the second, a factor, of it.
    pub near: [f64; 2],
}

impl Default for BarrierSettings {
    fn default() -> Self {
        Self {
            start: 0.1,
            least: 0.0,
            largest: 1e3,
            change: [1e-3, 10.0],
            centring: 0.01,
            regularised: [1e-3, 0.125],
            part: 0.99,
            neighbourhood: 1e10,
            inside: [1e-2, 1e-2],
            near: [0.05, 10.0],
        }
    }
}

impl BarrierSettings {
    /// The last mu, for this tolerance.
    pub(crate) fn last(&self, tolerance: f64) -> f64 {
        if self.least > 0.0 { self.least } else { 0.1 * tolerance }
    }

    /// The next mu, between the last one and the largest, from the mean of all products now: `part` of it is
    /// left by the step for mu = 0, `None` where the Hessian is regularised or a convex one. The decrements,
    /// over the number of bounds, are those of that step and of the one before.
    pub(crate) fn next(
        &self,
        mean: f64,
        part: Option<f64>,
        decrements: [f64; 2],
        [last, largest]: [f64; 2],
    ) -> f64 {
        let [least, most] = self.change;
        let [small, factor] = self.regularised;
        let [now, before] = decrements;
        let sigma = match part {
            Some(part) => part.clamp(0.0, 1.0).powi(3),
            None if now.min(before) < small * mean => factor,
            None => 1.0,
        };
        let centre = (self.centring * now).min(most * mean);
        (mean * sigma.max(least)).max(centre).min(largest).max(last)
    }

    /// tau.
    pub(crate) fn part_of_way(&self, mu: f64) -> f64 {
        self.part.max(1.0 - mu)
    }

    /// Slacks and multipliers for the functions of an iterate and this mu: near its multipliers v if these
    /// are known, else on the central path.
    pub(crate) fn begin(&self, iterate: &mut Iterate, bounds: &Bounds, (mu, are_known): (f64, bool)) {
        let [most, factor] = self.near;
        let Iterate { slacks, gaps, v, z, values, .. } = iterate;
        for (i, slack) in slacks.iter_mut().enumerate() {
            let (value, lower, upper) = (values.ranges[i], bounds.lower[i], bounds.upper[i]);
            // Where a multiplier is on the central path.
            let room = |z: f64, bound: f64| {
                let size = if bound.is_finite() { bound.abs().max(1.0) } else { 1.0 };
                (mu / z.max(f64::MIN_POSITIVE)).min(most).max(LEAST_ROOM * size)
            };
            *slack = match are_known {
                false => self.inside(value, lower, upper),
                true => between(value, lower + room(-v[i], lower), upper - room(v[i], upper)),
            };
            [gaps[0][i], gaps[1][i]] = bounds.gaps(*slack, i);
            let central = central([gaps[0][i], gaps[1][i]], mu);
            let near = |z: f64, central: f64| z.clamp(central / factor, central * factor);
            [z[0][i], z[1][i]] = match are_known {
                false => central,
                true => [near(-v[i], central[0]), near(v[i], central[1])],
            };
            v[i] = z[1][i] - z[0][i];
        }
    }

    /// The value nearest to `value` that is inside the bounds by the distances of a start.
    pub(crate) fn inside(&self, value: f64, lower: f64, upper: f64) -> f64 {
        let [absolute, relative] = self.inside;
        let range = upper - lower;
        let room = |bound: f64| (absolute * bound.abs().max(1.0)).min(relative * range);
        match (lower.is_finite(), upper.is_finite()) {
            (true, true) => between(value, lower + room(lower), upper - room(upper)),
            (true, false) => value.max(lower + absolute * lower.abs().max(1.0)),
            (false, true) => value.min(upper - absolute * upper.abs().max(1.0)),
            (false, false) => value,
        }
    }
}

/// The value nearest to this one between these, or their middle if they leave no room.
fn between(value: f64, low: f64, high: f64) -> f64 {
    if low < high { value.clamp(low, high) } else { 0.5 * (low + high) }
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
pub(crate) fn reset_multipliers(iterate: &mut Iterate, mu: f64, factor: f64) {
    for (z, gaps) in iterate.z.iter_mut().zip(&iterate.gaps) {
        in_widest!(reset(z, gaps, mu, factor));
    }
}

/// Of the bounds of one side.
#[inline(always)]
fn reset<const FUSED: bool>(z: &mut [f64], gaps: &[f64], mu: f64, factor: f64) {
    let down = factor.recip();
    for (z, &gap) in z.iter_mut().zip(gaps) {
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

/// Residuals of slacks with `t / (s - l)` in the place of z, where t are the targets of the step: mu, unless
/// it is corrected.
pub(crate) fn barrier_residuals(
    iterate: &Iterate,
    [below, above]: &[Vec<f64>; 2],
    [of_below, of_above]: &Targets,
    to: &mut Residuals,
) {
    let gaps = below.iter().zip(of_below).zip(above.iter().zip(of_above)).zip(&iterate.v);
    for (to, (((below, of_below), (above, of_above)), v)) in to.slacks.iter_mut().zip(gaps) {
        *to = (of_above * above - of_below * below) - v;
    }
}
