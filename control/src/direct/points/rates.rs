//! Jerks and rates of torques at Gauss's points of motions whose accelerations are continuous.
//!
//! The jerk is q'''/T^3. The rate of a torque is that of the polynomial through its values at the points of
//! an interval, x_m on [0, 1],
//!
//! $$ r_j = \frac{1}{h T} \sum_m D_{jm} \tau_m $$
//!
//! so its second derivatives are sums of those of torques: no third derivative of the dynamics is needed.

use crate::direct::motion::shape::{LOBATTO_PLACES, MOST_POINTS, PLACES, POINTS};
use crate::direct::motion::spline::Spline;
use crate::numerics::lagrange::slopes;
use crate::problem::Objective;

/// Weights of `1/2 w y^2` per second, for the jerk and for the rate of the torque of each joint.
#[derive(Clone, Debug, Default)]
pub(crate) struct RateCosts {
    /// Empty if jerks cost nothing.
    pub jerk: Vec<f64>,
    /// Empty if rates of torques cost nothing.
    pub torque: Vec<f64>,
}

impl RateCosts {
    pub fn new(cost: &Objective) -> Self {
        let weights = |list: &Option<Vec<f64>>| {
            list.clone().filter(|list| list.iter().any(|&weight| weight != 0.0)).unwrap_or_default()
        };
        Self { jerk: weights(&cost.jerk), torque: weights(&cost.torque_rate) }
    }

    /// Whether the jerk, or the rate of the torque, of each of n joints costs something: then the cost is
    /// strictly convex in all jerks, since M is positive definite.
    pub fn cost_all(&self, n: usize) -> bool {
        let costs = |weights: &[f64], i: usize| weights.get(i).is_some_and(|weight| *weight > 0.0);
        (0..n).all(|i| costs(&self.jerk, i) || costs(&self.torque, i))
    }

    /// The cost of jerks and rates of torques, per second.
    pub fn rate(&self, jerk: &[f64], torque: &[f64]) -> f64 {
        let sum = |weights: &[f64], values: &[f64]| -> f64 {
            weights.iter().zip(values).map(|(w, y)| 0.5 * w * y * y).sum()
        };
        sum(&self.jerk, jerk) + sum(&self.torque, torque)
    }
}

/// Derivatives of the Lagrange function by one value y.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Term {
    /// With the multipliers, at mu = 0, and the factor of mu.
    pub first: [f64; 3],
    pub second: f64,
    /// Derivative by y and by the T that multiplies the cost.
    pub slope: f64,
    /// The cost over T.
    pub cost: f64,
}

/// Values at all of Gauss's points, and what the Lagrange function makes of them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Rates {
    /// n a point.
    pub jerk: Vec<f64>,
    /// n a point.
    pub torque: Vec<f64>,
    /// The same of the Lagrange function.
    pub(crate) jerk_terms: Vec<Term>,
    pub(crate) torque_terms: Vec<Term>,
    /// Derivatives of the Lagrange function by the torques at all points through their rates: with the
    /// multipliers, at mu = 0, and the factor of mu. Empty if no rate of a torque matters.
    pub(crate) by_torques: [Vec<f64>; 3],
    /// Whether any rate of a torque is limited or costs anything, and whether any jerk does.
    pub(crate) has_torques: bool,
    pub(crate) has_jerks: bool,
}

impl Rates {
    /// Room for the values at the points of a mesh.
    pub fn resize(&mut self, n: usize, gauss_points: usize) {
        self.jerk.resize(n * gauss_points, 0.0);
        self.torque.resize(n * gauss_points, 0.0);
    }

    /// Jerks and rates of torques, from the torques at all points.
    pub fn evaluate(&mut self, spline: &Spline, tau: &[f64]) {
        let (n, mesh) = (spline.dof, &spline.mesh);
        let places = self.jerk.chunks_exact_mut(n).zip(self.torque.chunks_exact_mut(n)).enumerate();
        for (p, (jerk, torque)) in places {
            let (k, j) = (p / POINTS, p % POINTS);
            let rate = 1.0 / spline.clock(k);
            let (inner, ends) = spline.of_interval(&spline.unknowns, k);
            spline.gauss_basis(k, j).jerk(n, inner, ends, jerk);
            jerk.iter_mut().for_each(|jerk| *jerk *= rate * rate * rate);
            combine(&SLOPES[j], &tau[n * mesh.first_point(k)..], torque);
            let scale = rate / mesh.width(k);
            torque.iter_mut().for_each(|torque| *torque *= scale);
        }
    }

    /// The cost.
    pub fn cost(&self, spline: &Spline, costs: &RateCosts) -> f64 {
        let n = spline.dof;
        let weight = |p: usize| spline.mesh.gauss_point(p).1 * spline.clock(p / POINTS);
        let values = self.jerk.chunks_exact(n).zip(self.torque.chunks_exact(n)).enumerate();
        values.map(|(p, (jerk, torque))| weight(p) * costs.rate(jerk, torque)).sum()
    }
}

/// Sums of values at the points of an interval, n each.
pub(crate) fn combine(factors: &[f64; MOST_POINTS], values: &[f64], sum: &mut [f64]) {
    sum.fill(0.0);
    for (values, factor) in values.chunks_exact(sum.len()).zip(factors) {
        sum.iter_mut().zip(values).for_each(|(sum, value)| *sum += factor * value);
    }
}

/// D: derivatives at Gauss's points of the polynomial through values at Lobatto's points on [0, 1].
pub(crate) const SLOPES: [[f64; MOST_POINTS]; POINTS] = [
    slopes(&LOBATTO_PLACES, PLACES[0]),
    slopes(&LOBATTO_PLACES, PLACES[1]),
    slopes(&LOBATTO_PLACES, PLACES[2]),
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::direct::motion::mesh::Mesh;
    use crate::direct::motion::shape::Shape;

    #[test]
    fn rates_of_quartics_are_exact() {
        let value = |x: f64| 0.3 - x + 2.0 * x.powi(3) - 0.7 * x.powi(4);
        for (j, x) in PLACES.into_iter().enumerate() {
            let mut slope = [0.0];
            combine(&SLOPES[j], &LOBATTO_PLACES.map(value), &mut slope);
            assert!((slope[0] - (-1.0 + 6.0 * x * x - 2.8 * x.powi(3))).abs() < 1e-13, "{x}");
        }
    }

    #[test]
    fn jerks_are_derivatives_of_accelerations() {
        let mut random = fastrand::Rng::with_seed(7);
        let mesh = Mesh::new(vec![0.0, 0.4, 1.0], Shape::Quintic);
        let unknowns = (0..Spline::size(2, 2, Shape::Quintic)).map(|_| random.f64() - 0.5).collect();
        let spline = Spline { dof: 2, mesh, unknowns, times: vec![1.3], ..Spline::default() };
        let mut rates = Rates::default();
        rates.resize(2, spline.mesh.gauss_points());
        // With the accelerations, cubics, as torques the rates of torques are the jerks.
        let mut z = vec![0.0; 6 * spline.mesh.points()];
        spline.evaluate(&mut z);
        let a: Vec<f64> = z.chunks_exact(6).flat_map(|z| z[4..].to_vec()).collect();
        rates.evaluate(&spline, &a);
        let size = rates.jerk.iter().fold(0.0, |most: f64, jerk| most.max(jerk.abs()));
        assert!(size > 1.0);
        for (jerk, rate) in rates.jerk.iter().zip(&rates.torque) {
            assert!((jerk - rate).abs() < 1e-12 * size, "{jerk} {rate}");
        }
    }
}
