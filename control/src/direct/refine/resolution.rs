//! Where a mesh is too coarse: estimated errors, and limits that are exceeded between points.

use super::between::{BETWEEN, evaluate_places, rule, weight};
use super::crossings::Crossings;
use super::excess::Excess;
use super::jumps::Jumps;
use super::overshoots::Overshoots;
use super::peaks::Peak;
use super::rates_between::RatesBetween;
use crate::constants::direct as constants;
use crate::direct::interior::iterate::Interior;
use crate::direct::limits::distances::measure;
use crate::direct::limits::side::{Limited, Side};
use crate::direct::points::panels::GAUSS;
use crate::direct::points::rates::RateCosts;
use crate::direct::points::values::{PointDynamics, Points};
use crate::task::functions::Swept;
use costate::EvalError;

/// What a mesh does not resolve.
#[derive(Clone, Debug, Default)]
pub(crate) struct Resolution {
    /// Estimated error of the cost by each interval.
    pub errors: Vec<f64>,
    /// Largest violation of a limit inside of each interval, in parts of its range; of those whose values do
    /// not jump at nodes.
    pub violations: Vec<f64>,
    /// The largest violation of a clearance in each interval.
    pub(super) swept: Vec<Swept>,
    /// Violations of those whose values may jump there.
    pub overshoots: Overshoots,
    /// Time integral of what limits cut off torques in each interval, in parts of their ranges (s).
    pub cut: Vec<f64>,
    /// The cost of the motion, by a finer rule than that of its points, and that of each interval.
    pub cost: f64,
    pub costs: Vec<f64>,
    pub(super) jumps: Jumps,
    /// Nodes of this mesh that were moved.
    pub(super) moves: Vec<Move>,
    points: Points,
    /// Where intervals cross something narrow.
    pub(super) crossings: Crossings,
    pub(super) distance: Vec<f64>,
    pub(super) excess: Excess,
    /// What limits make most of the error of each interval.
    pub(super) peaks: Vec<Peak>,
    pub(super) rates: RatesBetween,
    /// Intervals that are narrower are not divided.
    pub narrowest: f64,
    /// New nodes are farther from others.
    pub closest: f64,
}

/// A node that was moved.
#[derive(Clone, Copy, Debug)]
pub(super) struct Move {
    /// Where it is now.
    pub place: f64,
    pub distance: f64,
}

impl Resolution {
    /// Estimated error of the cost.
    pub fn error(&self) -> f64 {
        self.errors.iter().sum()
    }

    /// Largest violation between points of limits whose values do not jump at nodes.
    pub fn violation(&self) -> f64 {
        self.violations.iter().fold(0.0, |most, &violation| most.max(violation))
    }

    /// Distances to all limits between the points, all sides of one place after the other.
    pub fn distances(&self) -> &[f64] {
        &self.distance
    }

    /// The largest violation of a clearance in an interval, wherever it is between the points.
    pub fn swept(&self, interval: usize) -> Swept {
        self.swept.get(interval).copied().unwrap_or_default()
    }

    /// How far the motion goes beyond a side between the points, in parts of its range.
    pub fn exceeded_by(&self, side: usize) -> f64 {
        (0..self.violations.len()).map(|k| self.excess.of(k, side)).fold(0.0, f64::max)
    }

    /// The same of jerks and rates of torques.
    pub fn rate_distances(&self) -> &[f64] {
        &self.rates.distance
    }

    /// Measures a solved motion.
    pub fn measure<D: PointDynamics>(&mut self, interior: &mut Interior<D>) -> Result<(), EvalError> {
        let intervals = interior.spline.mesh.intervals();
        [self.narrowest, self.closest] = interior.narrowest();
        self.errors.clear();
        self.errors.resize(intervals, 0.0);
        self.cut.clear();
        self.cut.resize(intervals, 0.0);
        self.violations.clear();
        self.violations.resize(intervals, 0.0);
        self.overshoots.clear(intervals);
        self.evaluate_between(interior)?;
        if interior.spline.mesh.shape.is_smooth() {
            self.overshoots.others.most.copy_from_slice(&self.rates.violations);
        }
        self.estimate(interior);
        self.compare_costs(interior);
        self.swept.clear();
        for k in 0..intervals {
            self.swept.push(interior.model.tasks.sweep(&interior.spline, k)?);
        }
        self.look_between(interior);
        self.violations.iter_mut().zip(&self.swept).for_each(|(most, swept)| *most = most.max(swept.part));
        Ok(())
    }

    /// Whether the cost between the points has little to do with that at the points: then what is gained on
    /// this mesh is lost on the next one. No if the motion cannot be evaluated there.
    pub fn is_far_off<D: PointDynamics>(&mut self, interior: &mut Interior<D>) -> bool {
        self.errors.clear();
        self.errors.resize(interior.spline.mesh.intervals(), 0.0);
        if self.evaluate_between(interior).is_err() {
            return false;
        }
        self.compare_costs(interior);
        self.error() > constants::UNRESOLVED * interior.figures.size
    }

    /// Where its control is smooth, the torque of an exact motion differs from this one by about a Legendre
    /// polynomial of degree three on each interval, which vanishes at the points. At a node the two that meet
    /// there make a jump J, so each is about J/2 there. The cost is off by half the square of that in the
    /// metric of the effort; the square of the polynomial has the mean 1/7.
    ///
    /// Where accelerations are continuous this holds for rates of torques and for jerks, and torques differ
    /// by the integral of the polynomial, whose square has the mean 1/630, times the width. On coarse meshes
    /// that is too little: hence a factor.
    fn estimate<D: PointDynamics>(&mut self, interior: &Interior<D>) {
        let (spline, n) = (&interior.spline, interior.spline.dof);
        let shape = spline.mesh.shape;
        self.jumps.measure(&interior.points, &spline.mesh, &interior.barrier);
        for (k, error) in self.errors.iter_mut().enumerate() {
            if spline.mesh.is_end(k) && spline.mesh.is_end(k + 1) {
                // Nothing to compare with.
                *error = f64::INFINITY;
                continue;
            }
            let length = spline.length(k);
            let square = |i: usize| 0.25 * self.jumps.mean_square(k, i);
            let effort = |i: usize| interior.running.effort[i] * square(i);
            let squares = (0..n).map(|i| match shape.is_smooth() {
                false => effort(i) / 7.0,
                true => {
                    let RateCosts { jerk, torque } = &interior.running.rates;
                    let of =
                        |weights: &[f64], at: usize| weights.get(i).map_or(0.0, |w| w * square(at) / 7.0);
                    effort(i) * length * length / 630.0 + of(torque, i) + of(jerk, n + i)
                }
            });
            *error = constants::SAFETY * 0.5 * length * squares.sum::<f64>();
        }
    }

    /// Evaluates the motion between the points.
    fn evaluate_between<D: PointDynamics>(&mut self, interior: &mut Interior<D>) -> Result<(), EvalError> {
        evaluate_places(interior, &BETWEEN, &mut self.points)?;
        self.rates.evaluate(interior, &BETWEEN, &mut self.points)?;
        self.crossings.evaluate(interior)
    }

    /// Integrates the running cost by the finer rule: the cost of the motion, and what the points miss of it.
    /// Where an interval crosses something narrow, or a knot of a reference, the rule is that of each panel
    /// between these.
    fn compare_costs<D>(&mut self, interior: &mut Interior<D>) {
        let Interior { spline, running, points, .. } = interior;
        self.cost = 0.0;
        self.costs.clear();
        running.split(spline);
        for (k, error) in self.errors.iter_mut().enumerate() {
            let length = spline.length(k);
            let is_split = running.panels.is_split(k);
            let mut rate = |s: f64, points: &Points, p: usize| match is_split {
                false => running.rate(spline.time_at(s), points.z(p), points.tau(p)),
                true => running.rate_without_references(points.z(p), points.tau(p)),
            };
            let (left, width) = (spline.mesh.nodes[k], spline.mesh.width(k));
            let shape = spline.mesh.shape;
            let weights = shape.weights().iter().enumerate();
            let mut at_point = |j: usize| {
                let p = spline.mesh.first_point(k) + j;
                rate(left + width * shape.places()[j], points, p)
            };
            let coarse: f64 = weights.map(|(j, part)| part * at_point(j)).sum();
            let mut between =
                |at: usize| rate(left + width * BETWEEN[at], &self.points, BETWEEN.len() * k + at);
            let mut fine: f64 = (0..BETWEEN.len()).map(|at| weight(at) * between(at)).sum();
            let mut coarse = coarse;
            if is_split {
                coarse += running.mean_of_references(spline, k, &GAUSS);
                fine += running.mean_of_references(spline, k, &rule());
            }
            if !self.crossings.of(k).is_empty() {
                fine = self.crossings.mean(k, |z, tau| running.rate_without_references(z, tau));
                if running.references.any() {
                    fine += running.mean_of_references(spline, k, &rule());
                }
            }
            let [of_rates, finer] = self.rates.costs(k, points, &running.rates);
            let (coarse, fine) = (coarse + of_rates, length * (fine + finer));
            *error += constants::SAFETY * (fine - length * coarse).abs();
            self.cost += fine;
            self.costs.push(fine);
        }
    }

    /// Measures the cost once more, with other prices than those of the motion, whose errors stay.
    pub fn measure_cost<D>(&mut self, interior: &mut Interior<D>) {
        let errors = self.errors.clone();
        self.compare_costs(interior);
        self.errors = errors;
    }

    /// Looks for limits that are exceeded between the points.
    fn look_between<D>(&mut self, interior: &Interior<D>) {
        let (sides, shape): (&[Side], _) = (interior.barrier.sides(), interior.spline.mesh.shape);
        if sides.is_empty() {
            self.distance.clear();
            return self.add_errors_of_limits(interior);
        }
        self.distance.resize(sides.len() * self.points.count(), 0.0);
        measure(sides, &self.points, &mut self.distance);
        self.crossings.measure(sides);
        for (at, distance) in self.distance.chunks_exact(sides.len()).enumerate() {
            let (k, part) =
                (at / BETWEEN.len(), weight(at % BETWEEN.len()) * interior.spline.clock(at / BETWEEN.len()));
            let torques = distance.iter().zip(sides).filter(|(_, side)| side.limited == Limited::Torque);
            let over = torques.map(|(d, side)| side.violation(*d).max(0.0)).sum::<f64>();
            self.cut[k] += part * interior.spline.mesh.width(k) * over;
        }
        self.excess.measure(&interior.spline, sides, &self.distance);
        for k in 0..interior.spline.mesh.intervals() {
            for (i, side) in sides.iter().enumerate() {
                let over = self.excess.of(k, i);
                // Equations that jump cannot be kept around a jump on any mesh.
                match (side.limited.jumps(shape), side.is_equation) {
                    (false, _) => self.violations[k] = self.violations[k].max(over),
                    (true, false) if interior.spline.mesh.width(k) < 2.0 * self.narrowest => {}
                    (true, false) => {
                        let most = &mut self.overshoots.of_mut(side).most[k];
                        *most = most.max(over);
                    }
                    (true, true) => {}
                }
            }
        }
        self.add_errors_of_limits(interior);
    }
}
