//! Warm starts: on other nodes, after limits were moved, and away from limits that stop the steps.

use super::iterate::Interior;
use crate::constants::direct as constants;
use crate::direct::limits::multipliers::Multipliers;
use crate::direct::points::values::PointDynamics;
use costate::EvalError;

impl<D: PointDynamics> Interior<D> {
    /// Takes the motion over to other nodes, with multipliers in proportion to the weights of the points.
    pub fn move_to(&mut self, nodes: Vec<f64>) -> Result<(), EvalError> {
        let mut old = std::mem::take(&mut self.multipliers);
        old.fill(&self.spline, &self.barrier);
        let at_ends: Vec<f64> = self.barrier.at_ends().map(|at| self.barrier.multiplier[at]).collect();
        let gap = self.figures.gap.max(constants::WARM * self.figures.size);
        self.spline = self.spline.on_nodes(nodes);
        self.start(Some(0.0))?;
        self.warm_start(&old, gap, self.figures.violation);
        self.multipliers = old;
        for (at, multiplier) in self.barrier.at_ends().zip(at_ends) {
            self.barrier.multiplier[at] = multiplier;
        }
        self.centre_ends();
        self.measure_figures();
        Ok(())
    }

    /// Begins again on the same nodes with another cost.
    pub fn begin_again(&mut self) {
        self.measure_distances();
        self.measure_figures();
        self.recentre(self.figures.gap, self.figures.violation);
    }

    /// Goes on after limits were moved inside: a step brings the motion back to them, all else stays.
    pub fn begin_inside(&mut self) {
        self.measure_distances();
        self.measure_figures();
        self.recentre(self.figures.gap, 0.0);
    }

    /// Moves slacks and multipliers to the central path after two steps that were cut short.
    pub(super) fn move_from_limits(&mut self, part: f64) {
        let limited = self.barrier.total_weight() > 0.0 && !self.relaxation.is_on();
        let short = part < constants::SHORT && limited;
        self.short_steps = if short { self.short_steps + 1 } else { 0 };
        if self.short_steps == constants::SHORT_STEPS {
            self.short_steps = 0;
            self.recentre(constants::AWAY * self.figures.gap, self.figures.violation);
            self.filter.clear();
        }
    }

    /// Begins again from the same motion and its multipliers.
    fn recentre(&mut self, gap: f64, rough: f64) {
        let mut old = std::mem::take(&mut self.multipliers);
        old.fill(&self.spline, &self.barrier);
        self.warm_start(&old, gap, rough);
        self.multipliers = old;
        self.centre_ends();
        self.measure_figures();
    }

    /// Puts limits at the ends near the central path, from their multipliers.
    fn centre_ends(&mut self) {
        for at in self.barrier.at_ends() {
            if !self.barrier.is_limit(at) {
                continue;
            }
            let (range, weight) = (1.0 / self.barrier.unit[at], self.barrier.weight[at]);
            let density = self.barrier.multiplier[at] / weight;
            self.move_to_path(at, range, constants::LEAST_SLACK, density);
        }
    }

    /// Puts a limit near the central path: a slack of at least the part `least` of its range, a multiplier
    /// near this density times its weight.
    fn move_to_path(&mut self, at: usize, range: f64, least: f64, density: f64) {
        let distance = self.barrier.distance[at];
        let most = distance.max(constants::FIRST_SLACK * range);
        let of_multiplier = self.mu / density.max(f64::MIN_POSITIVE);
        let slack = distance.max(least * range).max(of_multiplier).min(most);
        let central = self.mu / slack;
        let density = density.clamp(central / constants::OFF_CENTRE, constants::OFF_CENTRE * central);
        self.barrier.slack[at] = slack;
        self.barrier.multiplier[at] = self.barrier.weight[at] * density;
    }

    /// Slacks and multipliers near the central path, for a gap of at least what it costs to move all limits
    /// by the part `rough` of their ranges.
    fn warm_start(&mut self, old: &Multipliers, gap: f64, rough: f64) {
        let total = self.barrier.total_weight().max(f64::MIN_POSITIVE);
        let least = constants::LEAST_SLACK.max(rough.min(1.0));
        self.mu = gap.max(least * self.cost_of_ranges(old)) / total;
        let mut lookup = old.lookup();
        for at in 0..self.barrier.count() {
            let weight = self.barrier.weight[at];
            let Some(index) = self.barrier.side_index(at).filter(|_| weight > 0.0) else { continue };
            let side = self.barrier.side(at);
            let (range, is_equation) = (side.range, side.is_equation);
            let density = lookup.density(self.barrier.place(at, &self.spline), index);
            if is_equation {
                self.barrier.multiplier[at] = weight * density;
            } else {
                self.move_to_path(at, range, least, density);
            }
        }
    }

    /// What it would cost by these multipliers to move all limits by their ranges.
    fn cost_of_ranges(&self, multipliers: &Multipliers) -> f64 {
        let (barrier, mut lookup) = (&self.barrier, multipliers.lookup());
        let costs = (0..barrier.count()).filter(|&at| barrier.is_limit(at)).filter_map(|at| {
            let density = lookup.density(barrier.place(at, &self.spline), barrier.side_index(at)?);
            Some(barrier.weight[at] * density.max(0.0) / barrier.unit[at])
        });
        costs.sum()
    }
}
