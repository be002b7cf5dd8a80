//! Penalties on positions and rates: `weight/2 (violation)^2`, once continuously differentiable.
//!
//! A relaxed problem smooths the corner of the violation: `(x + sqrt(x^2 + d^2))/2` in place of `max(x, 0)`.

use crate::problem::Penalty;
use costate::scalar::Scalar;

/// A penalty and its first two derivatives.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Term<S = f64> {
    pub value: S,
    pub first: S,
    pub second: S,
}

/// All penalties of a problem. An infinite limit is none.
#[derive(Clone, Debug)]
pub(crate) struct Penalties {
    weight: f64,
    /// d^2 (rad^2, m^2, and per s^2).
    rounding: f64,
    q: Vec<(f64, f64)>,
    v_max: Option<Vec<f64>>,
}

impl Penalties {
    /// The penalties of n joints.
    pub fn new(n: usize, penalty: Option<&Penalty>) -> Self {
        let none = Penalty::default();
        let penalty = penalty.unwrap_or(&none);
        let entry = |list: &Option<Vec<f64>>, i: usize, no: f64| list.as_ref().map_or(no, |list| list[i]);
        let range =
            |i| (entry(&penalty.q_min, i, f64::NEG_INFINITY), entry(&penalty.q_max, i, f64::INFINITY));
        Self {
            weight: penalty.weight,
            rounding: 0.0,
            q: (0..n).map(range).collect(),
            v_max: penalty.v_max.clone(),
        }
    }

    /// Whether rates are limited.
    pub fn limit_rates(&self) -> bool {
        self.v_max.is_some() && self.weight > 0.0
    }

    /// Whether the rate of joint i is limited.
    pub fn limit_rate(&self, i: usize) -> bool {
        self.limit_rates() && self.v_max.as_ref().is_some_and(|v_max| v_max[i].is_finite())
    }

    /// Whether there are penalties.
    pub fn any(&self) -> bool {
        self.weight > 0.0
    }

    /// Changes the weight.
    pub fn set_weight(&mut self, weight: f64) {
        self.weight = weight;
    }

    /// Smooths corners such that the penalty at a limit is `cost`; 0 for sharp corners. Call it after a
    /// change of the weight.
    pub fn set_rounding(&mut self, cost: f64) {
        self.rounding = if self.weight > 0.0 { 8.0 * cost / self.weight } else { 0.0 };
    }

    /// The penalty on the position of joint i.
    pub fn position<S: Scalar>(&self, i: usize, q: S) -> Term<S> {
        self.beyond(self.q[i], q)
    }

    /// The penalty on the rate of joint i.
    pub fn rate<S: Scalar>(&self, i: usize, v: S) -> Term<S> {
        let limit = self.v_max.as_ref().map_or(f64::INFINITY, |v_max| v_max[i]);
        self.beyond((-limit, limit), v)
    }

    fn beyond<S: Scalar>(&self, (low, high): (f64, f64), x: S) -> Term<S> {
        if self.rounding > 0.0 {
            return self.rounded((low, high), x);
        }
        let (mut violation, mut second) = (S::zero(), S::zero());
        let mut limit = |mask: S::Mask, limit: f64| {
            violation = S::select(mask, x.plus(-limit), violation);
            second = S::select(mask, S::from_f64(self.weight), second);
        };
        if low.is_finite() {
            limit(x.less(S::from_f64(low)), low);
        }
        if high.is_finite() {
            limit(S::from_f64(high).less(x), high);
        }
        let first = violation.times(self.weight);
        Term { value: (first * violation).times(0.5), first, second }
    }

    fn rounded<S: Scalar>(&self, (low, high): (f64, f64), x: S) -> Term<S> {
        let mut sum = Term { value: S::zero(), first: S::zero(), second: S::zero() };
        for (limit, sign) in [(low, -1.0), (high, 1.0)] {
            if limit.is_finite() {
                let beyond = x.plus(-limit).times(sign);
                let root = (beyond * beyond).plus(self.rounding).sqrt();
                let violation = (beyond + root).times(0.5);
                let slope = violation / root;
                let pull = violation.times(self.weight);
                sum.value += (pull * violation).times(0.5);
                sum.first += (pull * slope).times(sign);
                let bend = (root * root * root).recip().times(0.5 * self.rounding);
                sum.second += (slope * slope).times(self.weight) + pull * bend;
            }
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn smoothed_penalties_approximate_sharp_ones_and_have_exact_derivatives() {
        let limits = Penalty { weight: 50.0, q_min: Some(vec![-1.0]), q_max: Some(vec![2.0]), v_max: None };
        let sharp = Penalties::new(1, Some(&limits));
        let mut round = sharp.clone();
        round.set_rounding(1e-3);
        assert!((round.position(0, 2.0).value - 1e-3).abs() < 1e-7);
        for q in [-1.5, -1.01, -0.9, 0.4, 1.99, 2.1, 3.0] {
            let (at, h) = (round.position(0, q), 1e-6);
            let (before, after) = (round.position(0, q - h), round.position(0, q + h));
            assert!(((after.value - before.value) / (2.0 * h) - at.first).abs() < 1e-6, "{q}");
            assert!(((after.first - before.first) / (2.0 * h) - at.second).abs() < 1e-4, "{q}");
            assert!((at.value - sharp.position(0, q).value).abs() < 5e-3, "{q}");
        }
    }
}
