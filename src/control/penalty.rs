//! Penalties on positions and rates: `weight/2 (violation)^2`, once continuously differentiable.

use super::problem::Penalty;
use crate::scalar::Scalar;

/// A penalty and its first two derivatives.
#[derive(Clone, Copy, Debug)]
pub(super) struct Term<S = f64> {
    pub value: S,
    pub first: S,
    pub second: S,
}

/// All penalties of a problem; infinite where there is no limit.
#[derive(Clone, Debug)]
pub(super) struct Penalties {
    weight: f64,
    q: Vec<(f64, f64)>,
    v_max: Option<Vec<f64>>,
}

impl Penalties {
    /// Those of n joints.
    pub fn new(n: usize, penalty: Option<&Penalty>) -> Self {
        let none = Penalty::default();
        let penalty = penalty.unwrap_or(&none);
        let entry = |list: &Option<Vec<f64>>, i: usize, no: f64| list.as_ref().map_or(no, |list| list[i]);
        let range =
            |i| (entry(&penalty.q_min, i, f64::NEG_INFINITY), entry(&penalty.q_max, i, f64::INFINITY));
        Self { weight: penalty.weight, q: (0..n).map(range).collect(), v_max: penalty.v_max.clone() }
    }

    /// Whether rates are limited.
    pub fn limit_rates(&self) -> bool {
        self.v_max.is_some() && self.weight > 0.0
    }

    /// Whether the rate of joint i is limited.
    pub fn limit_rate(&self, i: usize) -> bool {
        self.limit_rates() && self.v_max.as_ref().is_some_and(|v_max| v_max[i].is_finite())
    }

    /// Whether anything is limited.
    pub fn any(&self) -> bool {
        self.weight > 0.0
    }

    /// The weight, to be changed by a continuation.
    pub fn set_weight(&mut self, weight: f64) {
        self.weight = weight;
    }

    /// That of the position of joint i.
    pub fn position<S: Scalar>(&self, i: usize, q: S) -> Term<S> {
        self.beyond(self.q[i], q)
    }

    /// That of the rate of joint i.
    pub fn rate<S: Scalar>(&self, i: usize, v: S) -> Term<S> {
        let limit = self.v_max.as_ref().map_or(f64::INFINITY, |v_max| v_max[i]);
        self.beyond((-limit, limit), v)
    }

    fn beyond<S: Scalar>(&self, (low, high): (f64, f64), x: S) -> Term<S> {
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
}
