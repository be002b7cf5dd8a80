//! Loops over all entries of the barrier, compiled for the widest vectors of the processor.
//!
//! Entries that are off have an infinite slack, equations none ([`Barrier`](super::barrier::Barrier)): both
//! are masked here, without a branch for each entry, and equations are few and come afterwards.

use super::barrier::Barrier;
use super::vectors::{Lanes, for_vectors, is_limit, part};
use crate::constants::direct::{FAR, LEAST_PRODUCT, MOST_PRODUCT};
use crate::numerics::padded::LANES;
use costate_numerics::widest_fused;

/// The changes of distances by all parts of a step: at mu = 0, the factor of mu, corrections.
pub(super) type Changes<'a> = [&'a [f64]; 3];

/// The change of the distances of the entries from `at`.
#[inline(always)]
fn change<const N: usize>(changes: Changes<'_>, mu: f64, at: usize) -> [f64; N] {
    let [zero, of_mu, corrections] = changes.map(|change| part::<N>(change, at));
    std::array::from_fn(|c| zero[c] + mu * of_mu[c] + corrections[c])
}

/// Steps of slacks and multipliers for a barrier; `corrections` are added to `mu w`. The largest decrease of
/// a slack and of a multiplier, in parts of these.
pub(crate) fn steps(
    barrier: &Barrier,
    mu: f64,
    changes: Changes<'_>,
    corrections: &[f64],
    slack_step: &mut [f64],
    multiplier_step: &mut [f64],
) -> [f64; 2] {
    let (slack, multiplier) = (&barrier.slack[..], &barrier.multiplier[..]);
    let (distance, weight) = (&barrier.distance[..], &barrier.weight[..]);
    let mut largest = [Lanes::zeros(); 2];
    for_vectors!(at in slack.len(), N => {
        let (s, eta) = (part::<N>(slack, at), part::<N>(multiplier, at));
        let (d, w) = (part::<N>(distance, at), part::<N>(weight, at));
        let (change, correction) = (change::<N>(changes, mu, at), part::<N>(corrections, at));
        let [mut of_slack, mut of_multiplier, mut primal, mut dual] = [[0.0; N]; 4];
        for c in 0..N {
            let entry = Entry { slack: s[c], multiplier: eta[c], distance: d[c] + change[c] };
            [of_slack[c], of_multiplier[c], primal[c], dual[c]] =
                step_of_limit(entry, mu * w[c] + correction[c]);
        }
        slack_step[at..at + N].copy_from_slice(&of_slack);
        multiplier_step[at..at + N].copy_from_slice(&of_multiplier);
        largest[0].keep_largest::<N>(primal);
        largest[1].keep_largest::<N>(dual);
    });
    for at in barrier.equations() {
        let d = barrier.distance[at] + change::<1>(changes, mu, at)[0];
        multiplier_step[at] = -barrier.curvature(at) * d;
    }
    largest.map(Lanes::largest)
}

/// Slack, multiplier, and the distance after the step.
struct Entry {
    slack: f64,
    multiplier: f64,
    distance: f64,
}

/// The steps of slack and multiplier, whose product is `aim` then but for the product of both steps; and by
/// how much they fall, in parts of themselves. All zero for what is no limit. The one division is slow.
#[inline(always)]
fn step_of_limit(Entry { slack, multiplier, distance }: Entry, aim: f64) -> [f64; 4] {
    let on = is_limit(slack);
    let s = if on { slack } else { 1.0 };
    // A multiplier of zero falls by all of itself or not at all.
    let is_zero = multiplier == 0.0;
    let eta = if is_zero { 1.0 } else { multiplier };
    let of_product = 1.0 / (s * eta);
    let of = aim - multiplier * distance;
    let [step, multiplier_step] = [distance - s, of * (eta * of_product)];
    let falls = -of * of_product;
    let falls = if is_zero { if of < 0.0 { f64::INFINITY } else { 0.0 } } else { falls };
    let found = [step, multiplier_step, -step * (eta * of_product), falls];
    found.map(|value| if on { value } else { 0.0 })
}

/// Sum of slack times multiplier, after these parts of their steps.
pub(crate) fn complementarity(barrier: &Barrier, after: Option<[(f64, &[f64]); 2]>) -> f64 {
    let (slack, multiplier) = (&barrier.slack[..], &barrier.multiplier[..]);
    let [(primal, slack_step), (dual, multiplier_step)] = after.unwrap_or([(0.0, slack), (0.0, multiplier)]);
    let mut sum = Lanes::zeros();
    for_vectors!(at in slack.len(), N => {
        let (s, eta) = (part::<N>(slack, at), part::<N>(multiplier, at));
        let (ds, deta) = (part::<N>(slack_step, at), part::<N>(multiplier_step, at));
        let product = |c: usize| (s[c] + primal * ds[c]) * (eta[c] + dual * deta[c]);
        sum.add::<N>(std::array::from_fn(|c| if is_limit(s[c]) { product(c) } else { 0.0 }));
    });
    sum.sum()
}

/// Adds to the corrections what the products of slacks and multipliers after these parts of their steps lack
/// or have too much, to come between a part and a multiple of `mu w`.
pub(crate) fn add_corrections(
    barrier: &Barrier,
    mu: f64,
    [(primal, slack_step), (dual, multiplier_step)]: [(f64, &[f64]); 2],
    corrections: &mut [f64],
) {
    let (slack, multiplier, weight) = (&barrier.slack[..], &barrier.multiplier[..], &barrier.weight[..]);
    for_vectors!(at in slack.len(), N => {
        let (s, eta) = (part::<N>(slack, at), part::<N>(multiplier, at));
        let (ds, deta) = (part::<N>(slack_step, at), part::<N>(multiplier_step, at));
        let (w, mut next) = (part::<N>(weight, at), part::<N>(corrections, at));
        for c in 0..N {
            let target = mu * w[c];
            let (least, most) = (LEAST_PRODUCT * target, MOST_PRODUCT * target);
            let product = (s[c] + primal * ds[c]) * (eta[c] + dual * deta[c]);
            let aim = if product < least { least } else { product };
            let aim = if aim > most { most } else { aim };
            let lacks = if aim - product < -most { -most } else { aim - product };
            next[c] += if is_limit(s[c]) { lacks } else { 0.0 };
        }
        corrections[at..at + N].copy_from_slice(&next);
    });
}

/// What the entries add to the slope of cost and barrier along a step.
pub(crate) fn slope(barrier: &Barrier, mu: f64, changes: Changes<'_>, slack_step: &[f64]) -> f64 {
    let (slack, multiplier) = (&barrier.slack[..], &barrier.multiplier[..]);
    let (distance, weight) = (&barrier.distance[..], &barrier.weight[..]);
    let mut sum = Lanes::zeros();
    for_vectors!(at in slack.len(), N => {
        let (s, eta) = (part::<N>(slack, at), part::<N>(multiplier, at));
        let (d, w) = (part::<N>(distance, at), part::<N>(weight, at));
        let (change, ds) = (change::<N>(changes, mu, at), part::<N>(slack_step, at));
        sum.add::<N>(std::array::from_fn(|c| {
            let on = is_limit(s[c]);
            let inverse = 1.0 / if on { s[c] } else { 1.0 };
            let of_distance = eta[c] * (1.0 - d[c] * inverse) * change[c];
            let sum = of_distance - mu * w[c] * ds[c] * inverse;
            if on { sum } else { 0.0 }
        }));
    });
    let of = |at: usize| {
        let eta = barrier.multiplier[at] - barrier.curvature(at) * barrier.distance[at];
        eta * change::<1>(changes, mu, at)[0]
    };
    sum.sum() + barrier.equations().map(of).sum::<f64>()
}

/// Sum of |d - s| in parts of ranges, weighted.
pub(crate) fn infeasibility(barrier: &Barrier, distance: &[f64], slack: &[f64]) -> f64 {
    let (weight, unit) = (&barrier.weight[..], &barrier.unit[..]);
    let mut sum = Lanes::zeros();
    for_vectors!(at in slack.len(), N => {
        let (s, d) = (part::<N>(slack, at), part::<N>(distance, at));
        let (w, unit) = (part::<N>(weight, at), part::<N>(unit, at));
        let off = |c: usize| w[c] * unit[c] * (d[c] - s[c]).abs();
        sum.add::<N>(std::array::from_fn(|c| if s[c] < f64::INFINITY { off(c) } else { 0.0 }));
    });
    sum.sum()
}

/// Slacks after the part `alpha` of a step: no less than the distance that is reached.
pub(crate) fn trial_slacks(slack: &mut [f64], alpha: f64, slack_step: &[f64], distance: &[f64]) {
    for_vectors!(at in slack.len(), N => {
        let (s, d) = (part::<N>(slack, at), part::<N>(distance, at));
        let step = part::<N>(slack_step, at);
        let next: [f64; N] = std::array::from_fn(|c| {
            let next = s[c] + alpha * step[c];
            let next = if d[c] > next { d[c] } else { next };
            if is_limit(s[c]) { next } else { s[c] }
        });
        slack[at..at + N].copy_from_slice(&next);
    });
}

/// Takes the steps of multipliers: those of equations as far as the motion, the others this part, within a
/// factor of `mu w / s` with the new slacks.
pub(crate) fn take_multipliers(
    barrier: &mut Barrier,
    [primal, dual]: [f64; 2],
    mu: f64,
    multiplier_step: &[f64],
) {
    let (slack, weight, multiplier) = (&barrier.slack[..], &barrier.weight[..], &mut barrier.multiplier[..]);
    for_vectors!(at in slack.len(), N => {
        let (s, w) = (part::<N>(slack, at), part::<N>(weight, at));
        let (eta, step) = (part::<N>(multiplier, at), part::<N>(multiplier_step, at));
        let next: [f64; N] = std::array::from_fn(|c| {
            let on = is_limit(s[c]);
            let central = mu * w[c] / if on { s[c] } else { 1.0 };
            let (low, high) = (central * (1.0 / FAR), central * FAR);
            let next = eta[c] + dual * step[c];
            let next = if next < low { low } else { next };
            let next = if next > high { high } else { next };
            if on { next } else { eta[c] }
        });
        multiplier[at..at + N].copy_from_slice(&next);
    });
    for at in &barrier.equations {
        barrier.multiplier[*at] += primal * multiplier_step[*at];
    }
}

/// Largest violation of a limit in parts of its range; 0 for none, infinite where a value is not a number.
pub(crate) fn violation(barrier: &Barrier) -> f64 {
    let (slack, distance, unit) = (&barrier.slack[..], &barrier.distance[..], &barrier.unit[..]);
    let mut most = Lanes::zeros();
    for_vectors!(at in slack.len(), N => {
        let (s, d, unit) = (part::<N>(slack, at), part::<N>(distance, at), part::<N>(unit, at));
        let of = |c: usize| {
            let part = if is_limit(s[c]) { -d[c] * unit[c] } else { 0.0 };
            if part.is_nan() { f64::INFINITY } else { part }
        };
        most.keep_largest::<N>(std::array::from_fn(of));
    });
    most.largest()
}

/// The sum of w log s. Slacks of one weight are multiplied before their logarithm is taken.
pub(crate) fn logarithms(slack: &[f64], weight: &[f64]) -> f64 {
    let mut sum = Logarithms { sum: 0.0, product: 1.0, weight: 0.0 };
    for_vectors!(at in slack.len(), N => {
        let (s, w) = (part::<N>(slack, at), part::<N>(weight, at));
        let (mut factors, mut others) = ([1.0; LANES], false);
        for c in 0..N {
            let on = is_limit(s[c]);
            factors[c] = if on { s[c] } else { 1.0 };
            others |= on & (w[c] != w[0]);
        }
        let product = product(factors);
        if !others && (SMALLEST..LARGEST).contains(&product) {
            sum.add(product, w[0]);
        } else {
            factors.into_iter().zip(w).for_each(|(factor, weight)| sum.add(factor, weight));
        }
    });
    sum.with_product()
}

/// The product of all lanes, by halves.
#[inline(always)]
fn product(mut lanes: [f64; LANES]) -> f64 {
    let mut half = LANES / 2;
    while half > 0 {
        for c in 0..half {
            lanes[c] *= lanes[c + half];
        }
        half /= 2;
    }
    lanes[0]
}

/// A sum of weights times logarithms, with a product whose logarithm is still to be taken.
struct Logarithms {
    sum: f64,
    product: f64,
    weight: f64,
}

impl Logarithms {
    #[inline(always)]
    fn add(&mut self, slack: f64, weight: f64) {
        if weight != self.weight || !(SMALLEST..LARGEST).contains(&self.product) {
            (self.sum, self.product, self.weight) = (self.with_product(), 1.0, weight);
        }
        self.product *= slack;
    }

    fn with_product(&self) -> f64 {
        self.sum + self.weight * self.product.ln()
    }
}

/// Between these a product may be multiplied once more, with slacks from 1e-150 to 1e150.
const SMALLEST: f64 = 1e-150;
const LARGEST: f64 = 1e150;

#[cfg(test)]
#[path = "entries_tests.rs"]
mod tests;
