//! A primal-dual interior-point method for motions with hard limits.

use super::ends::Ends;
use super::filter::Filter;
use super::limits::Barrier;
use super::multipliers::Multipliers;
use super::point_terms::weigh;
use super::points::{PointDynamics, Points};
use super::power::Powers;
use super::running::Running;
use super::side::{Limited, Side};
use super::spline::Spline;
use super::system::System;
use super::tasks::Tasks;
use crate::constants::direct as constants;
use crate::solve::recorder::Interruption;
use costate::EvalError;

/// How an iteration ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum End {
    Solved,
    IterationLimit,
    /// No step was accepted, however short or damped.
    NoProgress,
    Interrupted(Interruption),
}

/// Figures of an iterate.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Figures {
    pub cost: f64,
    /// Size of the cost, for tolerances: no less than that of a small motion.
    pub size: f64,
    /// Sum of slack times multiplier.
    pub gap: f64,
    /// Largest violation of a limit or an equation, in parts of its range.
    pub violation: f64,
    /// The same of equations alone.
    pub equations: f64,
    /// Newton decrement: twice the change of cost that the next step promises.
    pub decrement: f64,
    pub iterations: usize,
}

/// A motion with its slacks and multipliers, and room for a step.
pub(crate) struct Interior<D> {
    pub spline: Spline,
    pub points: Points,
    pub barrier: Barrier,
    pub running: Running,
    pub ends: Ends,
    pub dynamics: D,
    pub tasks: Tasks,
    pub powers: Powers,
    pub figures: Figures,
    /// Least size of the cost.
    least_size: f64,
    /// Violations that may be rounding.
    pub(super) least_violation: f64,
    pub(super) system: System,
    pub(super) filter: Filter,
    pub(super) damping: f64,
    pub(super) mu: f64,
    pub(super) trial: Trial,
    pub(super) steps: [Vec<f64>; 2],
    /// Change of the distances at mu = 0, and its factor of mu.
    pub(super) changes: [Vec<f64>; 2],
    pub(super) time_steps: [f64; 2],
    /// Weights of torques in the metric of damping.
    weights: Vec<f64>,
}

/// A trial step.
#[derive(Debug, Default)]
pub(super) struct Trial {
    pub spline: Spline,
    pub points: Points,
    pub slack: Vec<f64>,
    pub distance: Vec<f64>,
    pub slack_step: Vec<f64>,
    pub multiplier_step: Vec<f64>,
    /// Change of z at a point.
    pub dz: Vec<f64>,
    /// Changes of the torques of an interval, of jerks and of rates of torques.
    pub torques: Vec<f64>,
    pub rates: [Vec<f64>; 2],
}

impl<D: PointDynamics> Interior<D> {
    /// `sides` are the limits of positions, rates, accelerations, torques, jerks and rates of torques.
    pub fn new(
        spline: Spline,
        mut sides: Vec<Side>,
        tasks: Tasks,
        powers: Powers,
        running: Running,
        ends: Ends,
        dynamics: D,
    ) -> Self {
        let (n, shape) = (spline.dof, spline.mesh.shape);
        sides.extend(powers.sides());
        sides.extend(tasks.sides());
        Self {
            spline,
            points: Points::default(),
            barrier: Barrier::new(sides, tasks.end_sides()),
            running,
            ends,
            dynamics,
            figures: Figures::default(),
            least_size: 0.0,
            least_violation: constants::VIOLATION_AT_POINTS,
            system: System::new(n, shape, [tasks.rows(), powers.rows()]),
            tasks,
            powers,
            filter: Filter::default(),
            damping: 0.0,
            mu: 0.0,
            trial: Trial { dz: vec![0.0; 3 * n], ..Trial::default() },
            weights: vec![0.0; n],
            steps: [Vec::new(), Vec::new()],
            changes: [Vec::new(), Vec::new()],
            time_steps: [0.0; 2],
        }
    }

    /// Numbers of rows of tasks and of powers.
    pub fn rows(&self) -> [usize; 2] {
        [self.tasks.rows(), self.powers.rows()]
    }

    /// Evaluates the spline, and makes slacks and multipliers for it with the barrier `mu`; `None` chooses
    /// it.
    pub fn start(&mut self, mu: Option<f64>) -> Result<(), EvalError> {
        let n = self.spline.dof;
        self.points.resize(n, self.rows(), self.spline.mesh.points());
        self.points.ends.resize(n, self.tasks.end_rows());
        self.spline.evaluate(&mut self.points.z);
        if self.least_size == 0.0 {
            self.dynamics.contract(&mut self.points)?;
            self.least_size = self.small_cost();
        }
        self.barrier.resize(&self.spline.mesh, &self.ends);
        self.evaluate()?;
        self.measure_cost();
        self.barrier.stiffness = constants::STIFFNESS * self.figures.size;
        let total = self.barrier.total_weight().max(f64::MIN_POSITIVE);
        self.mu = mu.unwrap_or(constants::FIRST_GAP * self.figures.size / total);
        for at in 0..self.barrier.count() {
            let weight = self.barrier.weight[at];
            let side = self.barrier.side(at);
            let slack = match weight > 0.0 {
                true if side.is_equation => 0.0,
                true => self.barrier.distance[at].max(constants::FIRST_SLACK * side.range),
                false => f64::INFINITY,
            };
            self.barrier.slack[at] = slack;
            self.barrier.multiplier[at] = if slack > 0.0 { self.mu * weight / slack } else { 0.0 };
        }
        self.damping = 0.0;
        self.least_violation = self.find_least_violation();
        self.measure_figures();
        Ok(())
    }

    /// Values at the points of the motion, and distances to all limits.
    pub(super) fn evaluate(&mut self) -> Result<(), EvalError> {
        self.spline.evaluate(&mut self.points.z);
        self.dynamics.evaluate(&mut self.points)?;
        self.tasks.evaluate(&mut self.points)?;
        self.tasks.evaluate_ends(&self.spline, &mut self.points)?;
        self.powers.evaluate(&mut self.points);
        self.points.evaluate_rates(&self.spline);
        let mut distance = std::mem::take(&mut self.barrier.distance);
        self.barrier.measure(&self.spline, &self.points, &mut distance);
        self.barrier.distance = distance;
        Ok(())
    }

    /// Takes the motion over to other nodes, with multipliers in proportion to the weights of the points.
    pub fn move_to(&mut self, nodes: Vec<f64>) -> Result<(), EvalError> {
        let old = Multipliers::of(&self.spline, &self.barrier);
        let at_ends: Vec<f64> = self.barrier.at_ends().map(|at| self.barrier.multiplier[at]).collect();
        let total = self.barrier.total_weight().max(f64::MIN_POSITIVE);
        let gap = self.figures.gap.max(constants::WARM * self.figures.size);
        self.spline = self.spline.on_nodes(nodes);
        self.start(Some(gap / total))?;
        let rough = self.figures.violation.min(1.0);
        let mu = gap.max(rough * self.figures.size) / total;
        self.mu = mu;
        for at in 0..self.barrier.count() {
            let weight = self.barrier.weight[at];
            if weight == 0.0 {
                continue;
            }
            let side = self.barrier.side(at);
            let Some(index) = self.barrier.side_index(at) else {
                self.barrier.multiplier[at] = at_ends[at - self.barrier.at_ends().start];
                continue;
            };
            let density = old.density(self.barrier.place(at, &self.spline), index);
            if side.is_equation {
                self.barrier.multiplier[at] = weight * density;
                continue;
            }
            let distance = self.barrier.distance[at];
            let most = distance.max(constants::FIRST_SLACK * side.range);
            let slack = distance
                .max(constants::LEAST_SLACK.max(constants::FIRST_SLACK * rough) * side.range)
                .max(mu / density.max(f64::MIN_POSITIVE))
                .min(most);
            let central = mu / slack;
            self.barrier.slack[at] = slack;
            self.barrier.multiplier[at] =
                weight * density.clamp(central / constants::OFF_CENTRE, constants::OFF_CENTRE * central);
        }
        self.measure_figures();
        Ok(())
    }

    /// Weight of a squared change of a torque in the metric of damping: the effort; without it the cost of a
    /// second over the square of the range of the torque.
    fn metric_weight(&self, joint: usize) -> f64 {
        let effort = self.running.effort[joint];
        if effort > 0.0 {
            return effort;
        }
        let own = |side: &&Side| side.limited == Limited::Torque && side.joint == joint;
        let range = self.barrier.sides().iter().find(own).map_or(1.0, |side| side.range);
        self.figures.size / self.spline.time / (range * range)
    }

    /// Cost of the efforts, of the energy, of the jerks and of the rates of torques that move each joint
    /// alone by [`constants::SMALL_MOTION`] in it: the torque is M_ii times that motion over the squared
    /// time.
    fn small_cost(&self) -> f64 {
        let (n, time) = (self.spline.dof, self.spline.time);
        let tau_z = self.points.tau_z(0);
        let cost = |(i, r): (usize, &f64)| {
            let torque = tau_z[3 * n * i + 2 * n + i] * constants::SMALL_MOTION / (time * time);
            let power = torque * constants::SMALL_MOTION / time;
            let rates = &self.running.rates;
            let of = |weights: &[f64], y: f64| weights.get(i).map_or(0.0, |w| 0.5 * w * y * y);
            let jerk = constants::SMALL_MOTION / (time * time * time);
            0.5 * r * torque * torque
                + self.running.energy.weights.get(i).map_or(0.0, |e| e * power)
                + of(&rates.jerk, jerk)
                + of(&rates.torque, torque / time)
        };
        let costs: f64 = self.running.effort.iter().enumerate().map(cost).sum();
        (time * costs).max(f64::MIN_POSITIVE.sqrt())
    }

    fn measure_cost(&mut self) {
        let cost = self.running.cost(&self.spline, &self.points);
        self.take_cost(cost);
    }

    fn take_cost(&mut self, cost: f64) {
        self.figures.cost = cost;
        self.figures.size = self.figures.cost.abs().max(self.least_size);
    }

    pub(super) fn measure_figures(&mut self) {
        let cost = self.running.cost(&self.spline, &self.points);
        self.measure_figures_of(cost);
    }

    /// The figures of an iterate whose cost is known.
    pub(super) fn measure_figures_of(&mut self, cost: f64) {
        self.take_cost(cost);
        self.figures.gap = self.barrier.complementarity();
        [self.figures.equations, self.figures.violation] = self.violations();
    }

    /// Largest violation of an equation, and of all, in parts of ranges.
    fn violations(&self) -> [f64; 2] {
        let (barrier, mut most) = (&self.barrier, [0.0_f64; 2]);
        for at in (0..barrier.count()).filter(|&at| barrier.is_on(at)) {
            let (d, is_equation) = (barrier.distance[at], barrier.slack[at] == 0.0);
            let which = usize::from(!is_equation);
            most[which] = most[which].max(barrier.unit[at] * if is_equation { d.abs() } else { -d });
        }
        [most[0], most[0].max(most[1])]
    }

    /// Makes equations stiffer if a whole step left much of them: their multipliers settle too slowly.
    fn stiffen(&mut self, before: f64, part: f64) {
        let left = self.figures.equations;
        let slow = left > constants::VIOLATION_AT_POINTS && left > constants::LEFT_OF_EQUATIONS * before;
        let close = before < constants::CLOSE_TO_EQUATIONS && self.damping == 0.0;
        if slow && close && part == 1.0 {
            let most = constants::MOST_STIFFNESS * self.figures.size;
            self.barrier.stiffness = (constants::STIFFER * self.barrier.stiffness).min(most);
        }
    }

    /// Sum of |d - s| in parts of ranges, weighted.
    pub(super) fn infeasibility(&self, distance: &[f64], slack: &[f64]) -> f64 {
        let barrier = &self.barrier;
        let pairs = distance.iter().zip(slack).zip(barrier.weight.iter().zip(&barrier.unit));
        let on = pairs.filter(|((_, slack), _)| slack.is_finite());
        on.map(|((distance, slack), (weight, unit))| weight * unit * (distance - slack).abs()).sum()
    }

    /// The sum of w log s.
    pub(super) fn logarithms(&self, slack: &[f64]) -> f64 {
        let pairs = slack.iter().zip(&self.barrier.weight);
        let on = pairs.filter(|(slack, _)| **slack > 0.0 && slack.is_finite());
        on.map(|(slack, weight)| weight * slack.ln()).sum()
    }

    /// Weights and derivatives at the points of this iterate.
    pub fn refresh(&mut self) -> Result<(), EvalError> {
        weigh(&self.spline, &mut self.points, &self.barrier, &self.running);
        self.powers.weigh_torques(&mut self.points);
        self.dynamics.contract(&mut self.points)?;
        self.powers.contract(&mut self.points);
        self.tasks.contract(&self.spline, &mut self.points)
    }

    /// Iterates until gap and decrement are below `tolerance` times the cost; `watch` sees each iterate with
    /// the part of the step that led to it, and may stop it.
    pub fn iterate(
        &mut self,
        tolerance: f64,
        most: usize,
        mut watch: impl FnMut(&Self, f64) -> Option<Interruption>,
    ) -> Result<End, EvalError> {
        self.filter.clear();
        for _ in 0..most {
            self.figures.iterations += 1;
            let equations = self.figures.equations;
            self.refresh()?;
            self.system.assemble(&self.spline, &self.points, &self.barrier, &mut self.running, &self.ends);
            let again = (self.damping * constants::DAMPING_DOWN).max(constants::DAMPING);
            let (mut damping, mut taken) = (0.0, None);
            while damping < constants::MOST_DAMPING && taken.is_none() {
                self.damping = damping;
                if self.factorise(damping) {
                    self.solve();
                    self.choose_barrier(tolerance);
                    self.figures.decrement = self.decrement();
                    if damping <= constants::SOLVED_DAMPING && self.is_solved(tolerance) {
                        self.damping = 0.0;
                        return Ok(End::Solved);
                    }
                    taken = self.search();
                    if taken.is_some() {
                        break;
                    }
                }
                damping = (damping * constants::DAMPING_UP).max(again);
            }
            let Some(part) = taken else {
                if self.filter.forget() {
                    continue;
                }
                return Ok(End::NoProgress);
            };
            self.stiffen(equations, part);
            if let Some(interruption) = watch(self, part) {
                return Ok(End::Interrupted(interruption));
            }
        }
        Ok(End::IterationLimit)
    }

    /// Whether the next step would change next to nothing, and the limits are kept at all points.
    fn is_solved(&self, tolerance: f64) -> bool {
        let Figures { size, gap, violation, decrement, .. } = self.figures;
        let scale = tolerance * size;
        decrement.abs() <= scale && gap <= scale && violation <= self.least_violation
    }

    pub(super) fn factorise(&mut self, damping: f64) -> bool {
        for joint in 0..self.weights.len() {
            self.weights[joint] = self.metric_weight(joint);
        }
        self.system.factorise(damping, &self.ends, &self.spline, &self.points, &self.weights).is_ok()
    }
}

#[cfg(test)]
#[path = "interior_tests.rs"]
mod tests;
