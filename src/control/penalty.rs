//! Penalties on positions and rates: `weight/2 (violation)^2`, once continuously differentiable.

use super::problem::Penalty;

/// A penalty and its first two derivatives.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Term {
    pub value: f64,
    pub first: f64,
    pub second: f64,
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

    /// Whether anything is limited.
    pub fn any(&self) -> bool {
        self.weight > 0.0
    }

    /// The weight, to be changed by a continuation.
    pub fn set_weight(&mut self, weight: f64) {
        self.weight = weight;
    }

    /// That of the position of joint i.
    pub fn position(&self, i: usize, q: f64) -> Term {
        let (low, high) = self.q[i];
        self.beyond(low, high, q)
    }

    /// That of the rate of joint i.
    pub fn rate(&self, i: usize, v: f64) -> Term {
        self.v_max.as_ref().map_or(Term::default(), |v_max| self.beyond(-v_max[i], v_max[i], v))
    }

    fn beyond(&self, low: f64, high: f64, x: f64) -> Term {
        let violation = if x < low {
            x - low
        } else if x > high {
            x - high
        } else {
            return Term::default();
        };
        let first = self.weight * violation;
        Term { value: 0.5 * first * violation, first, second: self.weight }
    }
}
