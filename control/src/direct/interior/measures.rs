//! Cost, gap and violations of an iterate.

use super::iterate::Interior;
use super::small_cost::SmallCost;
use crate::constants::direct as constants;
use crate::direct::limits::entries::{complementarity, violation};
use crate::direct::points::values::PointDynamics;

impl<D: PointDynamics> Interior<D> {
    /// Measures what small motions cost, at the start of the motion.
    pub(super) fn measure_small_cost(&mut self) {
        let n = self.spline.dof;
        let tau_z = self.points.tau_z(0);
        self.small_cost = Some(SmallCost::new(&self.running, |i| tau_z[3 * n * i + 2 * n + i]));
    }

    /// Distances to all limits from the values at the points.
    pub(super) fn measure_distances(&mut self) {
        let mut distance = std::mem::take(&mut self.barrier.distance);
        self.barrier.measure(&self.spline, &self.points, &mut distance);
        self.barrier.distance = distance;
    }

    pub(crate) fn measure_cost(&mut self) {
        let cost = self.running.cost(&self.spline, &self.points) + self.relaxation.cost(0.0, 0.0);
        self.take_cost(cost);
    }

    fn take_cost(&mut self, cost: f64) {
        self.figures.cost = cost;
        let small = self.small_cost.map_or(0.0, |cost| cost.within(self.spline.duration()));
        let small = small.max(f64::MIN_POSITIVE.sqrt());
        let magnitude = cost + 2.0 * self.running.negative_parts(&self.spline, &self.points);
        self.figures.size = magnitude.abs().max(small);
    }

    pub(crate) fn measure_figures(&mut self) {
        let cost = self.running.cost(&self.spline, &self.points) + self.relaxation.cost(0.0, 0.0);
        self.measure_figures_of(cost);
    }

    /// The figures of an iterate whose cost is known.
    pub(super) fn measure_figures_of(&mut self, cost: f64) {
        self.take_cost(cost);
        self.figures.gap = complementarity(&self.barrier, None);
        [self.figures.equations, self.figures.violation] = self.violations();
    }

    /// Largest violation of an equation, and of all, in parts of ranges.
    fn violations(&self) -> [f64; 2] {
        let barrier = &self.barrier;
        let of_equations = barrier.equations().fold(0.0, |most: f64, at| {
            let off = barrier.unit[at] * barrier.distance[at].abs();
            if off.is_nan() { f64::INFINITY } else { most.max(off) }
        });
        [of_equations, of_equations.max(violation(barrier))]
    }

    /// By how much the cost is off because equations are missed, to first order: the size of the sum of
    /// multipliers times distances, whose parts cancel as they do in the cost. Ranges, which bound each
    /// distance, say nothing about that: where limits of torques are far away, a small part of them may be
    /// worth more than the tolerance. In the elastic phase it does not count.
    pub(super) fn gain_of_equations(&self) -> f64 {
        if self.relaxation.is_on() {
            return 0.0;
        }
        let barrier = &self.barrier;
        barrier.equations().map(|at| barrier.multiplier[at] * barrier.distance[at]).sum::<f64>().abs()
    }

    /// Makes equations stiffer if a whole step left much of them: their multipliers settle too slowly.
    pub(super) fn stiffen(&mut self, before: f64, part: f64) {
        let left = self.figures.equations;
        let slow = left > constants::VIOLATION_AT_POINTS && left > constants::LEFT_OF_EQUATIONS * before;
        let close = before < constants::CLOSE_TO_EQUATIONS && self.damping == 0.0;
        if slow && close && part == 1.0 {
            let most = constants::MOST_STIFFNESS * self.figures.size;
            self.barrier.stiffness = (constants::STIFFER * self.barrier.stiffness).min(most);
        }
    }
}
