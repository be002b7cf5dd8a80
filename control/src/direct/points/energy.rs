//! The cost of mechanical energy: the positive part of the power of each joint, smoothed.

use crate::extremal::penalty::Term;
use crate::problem::Objective;

/// `sum e_i phi(p_i)` per second, $\phi(p) = \frac12 (p + \sqrt{p^2 + s^2} - s)$, p the power of a joint (W).
#[derive(Clone, Debug)]
pub(crate) struct Energy {
    /// e_i; empty if energy costs nothing.
    pub weights: Vec<f64>,
    /// s (W).
    smoothing: f64,
}

impl Energy {
    pub fn new(cost: &Objective) -> Self {
        let weights = cost.energy.clone().filter(|_| cost.has_energy()).unwrap_or_default();
        Self { weights, smoothing: cost.energy_smoothing }
    }

    /// The cost of the power of a joint, per second, with its derivatives by the power.
    pub fn term(&self, joint: usize, power: f64) -> Term {
        let (weight, s) = (self.weights[joint], self.smoothing);
        let root = power.hypot(s);
        Term {
            value: 0.5 * weight * (power + (root - s)),
            first: 0.5 * weight * (1.0 + power / root),
            second: 0.5 * weight * (s / root) * (s / root) / root,
        }
    }

    /// The magnitudes of those parts of the cost that are negative, per second.
    pub fn negative_parts(&self, v: &[f64], tau: &[f64]) -> f64 {
        let powers = v.iter().zip(tau).map(|(v, tau)| v * tau);
        (0..self.weights.len()).zip(powers).map(|(i, power)| (-self.term(i, power).value).max(0.0)).sum()
    }

    /// The cost of all powers, per second.
    pub fn rate(&self, v: &[f64], tau: &[f64]) -> f64 {
        let powers = v.iter().zip(tau).map(|(v, tau)| v * tau);
        (0..self.weights.len()).zip(powers).map(|(i, power)| self.term(i, power).value).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::Energy;
    use crate::problem::Objective;

    fn energy(smoothing: f64) -> Energy {
        let cost = Objective::new(0.0, vec![1.0; 2]).with_energy(vec![0.0, 3.0]);
        Energy::new(&cost.with_energy_smoothing(smoothing))
    }

    #[test]
    fn the_cost_is_the_positive_part_but_for_half_the_smoothing() {
        for s in [1e-6, 0.5, 40.0] {
            let energy = energy(s);
            for power in [-1e9, -30.0, -0.5, 0.0, 1e-3, 2.0, 700.0, 1e9] {
                let (exact, value) = (3.0 * f64::max(power, 0.0), energy.term(1, power).value);
                let rounding = 1e-15 * power.abs();
                assert!(value <= exact + rounding && value >= exact - 1.5 * s - rounding, "{s} {power}");
                assert_eq!(energy.term(0, power).value, 0.0);
            }
            assert_eq!(energy.term(1, 0.0).value, 0.0);
        }
        assert_eq!(energy(1.0).rate(&[2.0, 3.0], &[5.0, 0.0]), 0.0);
        let (v, tau) = ([1.0; 2], [0.0, -1e9]);
        assert!((energy(1.0).negative_parts(&v, &tau) - 1.5).abs() < 1e-6);
        assert_eq!(energy(1.0).negative_parts(&v, &[0.0, 2.0]), 0.0);
        assert!(Energy::new(&Objective::new(0.0, vec![1.0]).with_energy(vec![0.0])).weights.is_empty());
    }

    #[test]
    fn derivatives_are_those_of_the_value() {
        let (energy, step) = (energy(0.7), 1e-4);
        for power in [-3.0, -0.2, 0.0, 0.4, 5.0] {
            let [below, at, above] = [-step, 0.0, step].map(|change| energy.term(1, power + change));
            assert!(((above.value - below.value) / (2.0 * step) - at.first).abs() < 1e-7);
            assert!(((above.first - below.first) / (2.0 * step) - at.second).abs() < 1e-7);
        }
    }
}
