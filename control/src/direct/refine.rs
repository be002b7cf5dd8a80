//! Where a mesh is too coarse: estimated errors, and limits that are exceeded between points.

use super::basis::{Basis, PLACES, POINTS};
use super::interior::Interior;
use super::limits::{Limited, Side, measure};
use super::points::{PointDynamics, Points};
use super::spline::Spline;
use crate::constants::direct as constants;
use costate::EvalError;

/// Positions on an interval at which limits are checked between points.
const BETWEEN: [f64; 8] = [0.04, 0.1, 0.25, 0.4, 0.6, 0.75, 0.9, 0.96];

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
        let intervals = interior.spline.intervals();
        self.errors.clear();
        self.errors.resize(intervals, 0.0);
        self.violations.clear();
        self.violations.resize(intervals, 0.0);
        self.estimate(interior);
        self.look_between(interior)
    }

    /// Third derivatives of an exact motion are continuous where its control is smooth. A jump J at the end
    /// of an interval of width h means accelerations that are off by about h J / 8 there, and torques by M
    /// times that; the cost is off by half the square of it in the metric of the problem.
    fn estimate<D: PointDynamics>(&mut self, interior: &Interior<D>) {
        let (spline, points) = (&interior.spline, &interior.points);
        let n = spline.dof;
        let rate = 1.0 / spline.time;
        let mut left = vec![0.0; n];
        let mut right = vec![0.0; n];
        for k in 1..spline.intervals() {
            third(spline, k - 1, 1.0, &mut left);
            third(spline, k, 0.0, &mut right);
            let tau_z = points.tau_z(POINTS * k);
            for side in [k - 1, k] {
                let h = spline.width(side);
                let mut cost = 0.0;
                for i in 0..n {
                    let row = &tau_z[3 * n * i + 2 * n..3 * n * (i + 1)];
                    let jump: f64 = (0..n).map(|j| row[j] * (right[j] - left[j])).sum();
                    let torque = h * jump * rate * rate / 8.0;
                    cost += 0.5 * interior.running.effort[i] * torque * torque;
                }
                self.errors[side] += spline.time * h * cost;
            }
        }
    }

    fn look_between<D: PointDynamics>(&mut self, interior: &mut Interior<D>) -> Result<(), EvalError> {
        let sides: &[Side] = &interior.barrier.sides;
        if sides.is_empty() {
            return Ok(());
        }
        let (spline, n) = (&interior.spline, interior.spline.dof);
        let count = BETWEEN.len() * spline.intervals();
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
            // The points before and after this place, and the part of the way between them.
            let right = PLACES.partition_point(|&place| place < x) + 1;
            let place = |j: usize| if j == 0 { 0.0 } else { PLACES.get(j - 1).map_or(1.0, |&place| place) };
            let part = (x - place(right - 1)) / (place(right) - place(right - 1));
            let length = spline.width(k) / BETWEEN.len() as f64;
            for (i, d) in distance.iter().enumerate() {
                let density = |j: usize| {
                    let p = POINTS * k + j;
                    interior.barrier.multiplier[sides.len() * p + i] / spline.point(p).1
                };
                let density = (1.0 - part) * density(right - 1) + part * density(right);
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
                nodes.push(0.5 * (spline.nodes[k] + spline.nodes[k + 1]));
            }
            nodes.push(spline.nodes[k + 1]);
        }
        nodes
    }
}

/// d3q/ds3 at the part `x` of an interval: the slope of the second derivative, a cubic with these four
/// coefficients.
fn third(spline: &Spline, k: usize, x: f64, values: &mut [f64]) {
    let h = spline.width(k);
    let basis = Basis::at(x, h);
    let n = spline.dof;
    let coefficients = &spline.unknowns[3 * n * k..][..6 * n];
    for (i, value) in values.iter_mut().enumerate() {
        *value = (0..6).map(|b| basis.third[b] * coefficients[b * n + i]).sum();
    }
}
