//! Where a mesh is too coarse: estimated errors, and limits that are exceeded between points.

use super::basis::POINTS;
use super::interior::Interior;
use super::limits::{Limited, Multipliers, Side, measure};
use super::points::{PointDynamics, Points};
use super::spline::Spline;
use crate::constants::direct as constants;
use costate::EvalError;

/// Positions on an interval at which limits are checked between points.
const BETWEEN: [f64; 8] = [0.01, 0.05, 0.2, 0.35, 0.65, 0.8, 0.95, 0.99];

/// What a mesh does not resolve.
#[derive(Clone, Debug, Default)]
pub(crate) struct Resolution {
    /// Estimated error of the cost by each interval.
    pub errors: Vec<f64>,
    /// Largest violation of a limit inside of each interval, in parts of its range.
    pub violations: Vec<f64>,
    points: Points,
    distance: Vec<f64>,
}

impl Resolution {
    /// Estimated error of the cost.
    pub fn error(&self) -> f64 {
        self.errors.iter().sum()
    }

    /// Largest violation between points.
    pub fn violation(&self) -> f64 {
        self.violations.iter().fold(0.0, |most, &violation| most.max(violation))
    }

    /// Distances to all limits between the points, all sides of one place after the other.
    pub fn distances(&self) -> &[f64] {
        &self.distance
    }

    /// Measures a solved motion.
    pub fn measure<D: PointDynamics>(&mut self, interior: &mut Interior<D>) -> Result<(), EvalError> {
        let intervals = interior.spline.mesh.intervals();
        self.errors.clear();
        self.errors.resize(intervals, 0.0);
        self.violations.clear();
        self.violations.resize(intervals, 0.0);
        self.estimate(interior);
        self.look_between(interior)
    }

    /// Where its control is smooth, the acceleration of an exact motion differs from this one by about a
    /// Legendre polynomial of degree three on each interval, which vanishes at the points. At a node the two
    /// that meet there make a jump J, so each is about J/2 there. The cost is off by half the square of M times
    /// that in the metric of the problem; the square of the polynomial has the mean 1/7.
    fn estimate<D: PointDynamics>(&mut self, interior: &Interior<D>) {
        let (spline, points) = (&interior.spline, &interior.points);
        let n = spline.dof;
        let mut left = vec![0.0; 3 * n];
        let mut right = vec![0.0; 3 * n];
        for k in 1..spline.mesh.intervals() {
            spline.in_interval(k - 1, 1.0, &mut left);
            spline.in_interval(k, 0.0, &mut right);
            let tau_z = points.tau_z(POINTS * k);
            let mut cost = 0.0;
            for i in 0..n {
                let row = &tau_z[3 * n * i + 2 * n..3 * n * (i + 1)];
                let jump: f64 = (0..n).map(|j| row[j] * (right[2 * n + j] - left[2 * n + j])).sum();
                cost += 0.5 * interior.running.effort[i] * jump * jump / (4.0 * 7.0);
            }
            for side in [k - 1, k] {
                self.errors[side] += 0.5 * spline.time * spline.mesh.width(side) * cost;
            }
        }
    }

    fn look_between<D: PointDynamics>(&mut self, interior: &mut Interior<D>) -> Result<(), EvalError> {
        let sides: &[Side] = interior.barrier.sides();
        if sides.is_empty() {
            return Ok(());
        }
        let multipliers = Multipliers::of(&interior.spline, &interior.barrier);
        let (spline, n) = (&interior.spline, interior.spline.dof);
        let count = BETWEEN.len() * spline.mesh.intervals();
        self.points.resize(n, count);
        for (at, z) in self.points.z.chunks_exact_mut(3 * n).enumerate() {
            spline.in_interval(at / BETWEEN.len(), BETWEEN[at % BETWEEN.len()], z);
        }
        interior.dynamics.evaluate(&mut self.points)?;
        self.distance.resize(sides.len() * count, 0.0);
        measure(sides, &self.points, &mut self.distance);
        for (at, distance) in self.distance.chunks_exact(sides.len()).enumerate() {
            let (k, x) = (at / BETWEEN.len(), BETWEEN[at % BETWEEN.len()]);
            let most = &mut self.violations[k];
            // Torques and accelerations jump: around a jump the polynomial overshoots on any mesh.
            let kept = distance.iter().zip(sides).filter(|(_, side)| side.limited < Limited::Acceleration);
            *most = kept.fold(*most, |most, (d, side)| most.max(-d / side.range));
            let length = spline.mesh.width(k) / BETWEEN.len() as f64;
            let s = spline.mesh.nodes[k] + x * spline.mesh.width(k);
            for (i, d) in distance.iter().enumerate() {
                let density = multipliers.density(s, i);
                self.errors[k] += length * density * d.abs();
            }
        }
        Ok(())
    }

    /// Nodes of a finer mesh: intervals are halved that exceed a limit between points, and those with the
    /// largest errors, until what is left is a small part of the whole or of `tolerance`.
    pub fn nodes(&self, spline: &Spline, tolerance: f64) -> Vec<f64> {
        let mut order: Vec<usize> = (0..self.errors.len()).collect();
        order.sort_by(|&a, &b| self.errors[b].total_cmp(&self.errors[a]));
        let mut halved: Vec<bool> =
            self.violations.iter().map(|&violation| violation > constants::VIOLATION_BETWEEN).collect();
        let mut rest = self.error();
        let enough = constants::LEFT * rest.max(tolerance);
        for k in order {
            if rest <= enough {
                break;
            }
            halved[k] = true;
            rest -= self.errors[k];
        }
        let mut nodes = vec![0.0];
        for (k, halved) in halved.into_iter().enumerate() {
            if halved {
                nodes.push(0.5 * (spline.mesh.nodes[k] + spline.mesh.nodes[k + 1]));
            }
            nodes.push(spline.mesh.nodes[k + 1]);
        }
        nodes
    }
}
