//! Jerks and rates of torques beside the points of a motion.

use super::between::{BETWEEN, weight};
use super::peak::least_between;
use crate::direct::interior::iterate::Interior;
use crate::direct::limits::distances::measure_rates;
use crate::direct::motion::shape::{POINTS, WEIGHTS};
use crate::direct::points::rates::RateCosts;
use crate::direct::points::values::{PointDynamics, Points};
use costate::EvalError;

/// Jerks and exact rates of torques, `tau_z (v, a, q''')`, at some places of each interval.
#[derive(Clone, Debug, Default)]
pub(super) struct RatesBetween {
    jerk: Vec<f64>,
    torque: Vec<f64>,
    /// q, v, a and jerk of a place.
    z: Vec<f64>,
    sides: usize,
    /// Distances to all limits, one place after the other.
    pub distance: Vec<f64>,
    /// Largest violation in each interval, in parts of ranges.
    pub violations: Vec<f64>,
    /// The same of each side, the sides of one interval after the other; 0 for none.
    over: Vec<f64>,
}

impl RatesBetween {
    /// Those at these `places` of each interval, whose values are `points`. Nothing where accelerations jump.
    pub fn evaluate<D: PointDynamics>(
        &mut self,
        interior: &mut Interior<D>,
        places: &[f64],
        points: &mut Points,
    ) -> Result<(), EvalError> {
        let (spline, n) = (&interior.spline, interior.spline.dof);
        if !spline.mesh.shape.is_smooth() {
            return Ok(());
        }
        let has_torques = interior.points.rates.has_torques;
        if has_torques {
            let phases = interior.spline.mesh.ends().iter().skip(1).map(|node| places.len() * node);
            points.resize(n, interior.rows(), phases);
            points.weights.fill(0.0);
            interior.model.dynamics.contract(points)?;
        }
        self.z.resize(4 * n, 0.0);
        self.jerk.clear();
        self.torque.clear();
        for p in 0..points.count() {
            spline.in_interval(p / places.len(), places[p % places.len()], &mut self.z);
            self.jerk.extend_from_slice(&self.z[3 * n..]);
            let rows = points.tau_z.get(3 * n * n * p..3 * n * n * (p + 1)).filter(|_| has_torques);
            for i in 0..n {
                let row = rows.map(|rows| &rows[3 * n * i..3 * n * (i + 1)]);
                let rate = |row: &[f64]| row.iter().zip(&self.z[n..]).map(|(a, b)| a * b).sum();
                self.torque.push(row.map_or(0.0, rate));
            }
        }
        let sides = interior.barrier.rate_sides();
        self.sides = sides.len();
        self.distance.clear();
        self.distance.resize(sides.len() * points.count(), 0.0);
        let values = self.jerk.chunks_exact(n).zip(self.torque.chunks_exact(n));
        measure_rates(sides, values, &mut self.distance);
        self.violations.clear();
        self.violations.resize(spline.mesh.intervals(), 0.0);
        self.over.clear();
        if places.len() != BETWEEN.len() {
            return Ok(());
        }
        for k in 0..spline.mesh.intervals() {
            for (i, side) in sides.iter().enumerate() {
                let values = std::array::from_fn(|at| self.distance(BETWEEN.len() * k + at)[i]);
                let over = side.violation(least_between(values).1).max(0.0);
                self.over.push(over);
                self.violations[k] = self.violations[k].max(over);
            }
        }
        Ok(())
    }

    /// Largest violation of a side in an interval, its ends included, in parts of its range.
    pub fn of(&self, interval: usize, side: usize) -> f64 {
        self.over[self.sides * interval + side]
    }

    /// Distances to all limits at a place.
    pub fn distance(&self, p: usize) -> &[f64] {
        &self.distance[self.sides * p..][..self.sides]
    }

    /// Mean cost of jerks and rates of torques on an interval, from Gauss's points and from all places.
    pub fn costs(&self, k: usize, points: &Points, costs: &RateCosts) -> [f64; 2] {
        let n = points.dof;
        if points.rates.jerk.is_empty() {
            return [0.0; 2];
        }
        let rate = |jerk: &[f64], torque: &[f64], p: usize| {
            costs.rate(&jerk[n * p..n * (p + 1)], &torque[n * p..n * (p + 1)])
        };
        let coarse = |j: usize| WEIGHTS[j] * rate(&points.rates.jerk, &points.rates.torque, POINTS * k + j);
        let fine = |at: usize| weight(at) * rate(&self.jerk, &self.torque, BETWEEN.len() * k + at);
        [(0..POINTS).map(coarse).sum(), (0..BETWEEN.len()).map(fine).sum()]
    }
}
