//! A primal-dual interior-point method for motions with hard limits.

use super::figures::Figures;
use super::filter::Filter;
use super::looseness::Looseness;
use super::relaxation::Relaxation;
use super::small_cost::SmallCost;
use super::softer::Softer;
use super::squares::{Squares, Stall};
use crate::constants::direct as constants;
use crate::direct::limits::barrier::Barrier;
use crate::direct::limits::ends::Ends;
use crate::direct::limits::model::Model;
use crate::direct::limits::multipliers::Multipliers;
use crate::direct::limits::settled::settled;
use crate::direct::limits::side::Side;
use crate::direct::motion::spline::Spline;
use crate::direct::newton::metric::weigh_torques;
use crate::direct::newton::system::System;
use crate::direct::points::running::Running;
use crate::direct::points::values::{PointDynamics, Points};
use crate::problem::narrow::Narrow;
use crate::result::stage_times::{Clock, Stage};
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

/// A motion with its slacks and multipliers, and room for a step.
pub(crate) struct Interior<D> {
    pub spline: Spline,
    pub points: Points,
    pub barrier: Barrier,
    pub running: Running,
    /// What is narrow but knots, where errors are estimated and nodes are added.
    pub crossed: Narrow,
    /// Times of the knots of references (s), rising.
    pub knots: Vec<f64>,
    pub ends: Ends,
    pub model: Model<D>,
    pub figures: Figures,
    /// That of small motions, which is the least size of costs.
    pub(super) small_cost: Option<SmallCost>,
    /// Violations that may be rounding.
    pub(super) least_violation: f64,
    /// The tolerance on the last one of several meshes: with a larger one the iterate only leads to the next.
    pub(crate) last_tolerance: Option<f64>,
    /// That of the tolerance that was asked for.
    pub(crate) looseness: Looseness,
    pub(crate) system: System,
    /// How far limits give; not at all outside of the elastic phase.
    pub(crate) relaxation: Relaxation,
    pub(crate) filter: Filter,
    pub(crate) damping: f64,
    squares: Squares,
    pub(super) softer: Softer,
    /// Steps that were cut short, one after the other.
    pub(super) short_steps: usize,
    /// The part of the longest possible step that was taken last.
    pub(super) taken: f64,
    pub(crate) mu: f64,
    pub(crate) trial: Trial,
    /// The step at mu = 0, its factor of mu, what corrections add, and another one of these.
    pub(crate) steps: [Vec<f64>; 4],
    /// Changes of the distances by these.
    pub(crate) changes: [Vec<f64>; 4],
    /// Those of the times of phases, and those of shared unknowns.
    pub(crate) time_steps: [Vec<f64>; 4],
    pub(crate) shared_steps: [Vec<f64>; 4],
    /// What corrections add to `mu w` at each entry, and another one of these.
    pub(super) corrections: [Vec<f64>; 2],
    /// Room for those of a warm start.
    pub(crate) multipliers: Multipliers,
    /// Weights of torques in the metric of damping.
    weights: Vec<f64>,
    /// The times of the stages, where they are asked for.
    pub clock: Clock,
}

/// A trial step.
#[derive(Debug, Default)]
pub(crate) struct Trial {
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
        mut model: Model<D>,
        running: Running,
        mut ends: Ends,
    ) -> Self {
        let (n, shape) = (spline.dof, spline.mesh.shape);
        // States that cannot be evaluated are told when the iteration begins.
        ends.settled = settled(&mut model, &spline, &ends).unwrap_or(ends.settled);
        sides.extend(model.powers.sides());
        sides.extend(model.tasks.sides());
        Self {
            spline,
            points: Points::default(),
            barrier: Barrier::new(sides, &model.tasks.end_sides()),
            running,
            crossed: Narrow::default(),
            knots: Vec::new(),
            ends,
            figures: Figures::default(),
            small_cost: None,
            least_violation: constants::VIOLATION_AT_POINTS,
            last_tolerance: None,
            looseness: Looseness::default(),
            system: System::new(n, shape, model.rows()),
            model,
            relaxation: Relaxation::default(),
            filter: Filter::default(),
            damping: 0.0,
            squares: Squares::default(),
            softer: Softer::default(),
            short_steps: 0,
            multipliers: Multipliers::default(),
            taken: 1.0,
            mu: 0.0,
            trial: Trial { dz: vec![0.0; 3 * n], ..Trial::default() },
            weights: vec![0.0; n],
            clock: Clock::default(),
            steps: Default::default(),
            changes: Default::default(),
            time_steps: Default::default(),
            shared_steps: Default::default(),
            corrections: Default::default(),
        }
    }

    /// Numbers of rows g(q, v) and h(q, v, a) at a point.
    pub fn rows(&self) -> [usize; 2] {
        self.model.rows()
    }

    /// Iterates until gap and decrement are below `tolerance` times the cost; `watch` sees each iterate with
    /// the part of the step that led to it, and may stop it.
    pub fn iterate(
        &mut self,
        tolerance: f64,
        most: usize,
        mut watch: impl FnMut(&mut Self, f64) -> Option<Interruption>,
    ) -> Result<End, EvalError> {
        self.filter.clear();
        let squares = self.has_squares_alone() && !self.relaxation.is_on();
        self.squares = Squares { left: if squares { constants::SQUARES } else { 0 }, damping: 0.0 };
        self.softer = Softer::default();
        self.short_steps = 0;
        self.figures.is_minimum = false;
        self.figures.shortfall = 0.0;
        let (mut at_rounding, mut stall) = (0, Stall::default());
        for _ in 0..most {
            self.figures.iterations += 1;
            let equations = self.figures.equations;
            self.refresh()?;
            self.clock.lap(Stage::Points);
            self.system.exact = true;
            self.assemble();
            self.clock.lap(Stage::Assembly);
            let again = (self.damping * constants::DAMPING_DOWN).max(constants::DAMPING);
            let (mut damping, mut failed, mut taken) = (0.0, None, None);
            while damping < constants::MOST_DAMPING && taken.is_none() {
                self.damping = damping;
                if self.factorise(damping) {
                    damping = self.soften_equations(damping, failed);
                    self.solve();
                    self.choose_barrier(tolerance);
                    self.figures.decrement = self.decrement();
                    self.clock.lap(Stage::Limits);
                    let near = damping <= constants::SOLVED_DAMPING;
                    at_rounding = if near && self.is_at_rounding(tolerance) { at_rounding + 1 } else { 0 };
                    if near && (self.is_solved(tolerance) || at_rounding > constants::STEPS_AT_ROUNDING) {
                        if squares {
                            self.measure_shortfall(damping);
                        }
                        let Figures { shortfall, size, cost, iterations, .. } = self.figures;
                        let least = tolerance * size;
                        if shortfall <= least || stall.is_over(iterations, cost, least) {
                            self.figures.is_minimum = damping == 0.0 && self.system.exact;
                            self.damping = 0.0;
                            return Ok(End::Solved);
                        }
                    }
                    let longest = self.correct();
                    self.clock.lap(Stage::Limits);
                    taken = self.search(longest);
                    self.clock.lap(Stage::Search);
                    if taken.is_some() {
                        break;
                    }
                } else if self.system.exact && self.squares.begin() {
                    self.clock.lap(Stage::Equations);
                    self.system.exact = false;
                    self.assemble();
                    self.clock.lap(Stage::Assembly);
                    damping = self.squares.damping;
                    continue;
                } else {
                    failed = Some(damping);
                }
                damping = (damping * constants::DAMPING_UP).max(again);
            }
            let Some(part) = taken else {
                if self.filter.forget() {
                    continue;
                }
                return Ok(End::NoProgress);
            };
            if !self.system.exact {
                self.squares.adapt(damping, self.taken);
            }
            self.stiffen(equations, part);
            self.move_from_limits(part);
            self.clock.lap(Stage::Search);
            if let Some(interruption) = watch(self, part) {
                return Ok(End::Interrupted(interruption));
            }
        }
        Ok(End::IterationLimit)
    }

    /// Whether the next step would change next to nothing, and the limits are kept at all points.
    fn is_solved(&self, tolerance: f64) -> bool {
        let exceeded = match self.last_tolerance {
            Some(last) if tolerance > last => self.least_violation.max(constants::VIOLATION_ACCEPTED),
            _ => self.least_violation,
        };
        let is_kept = self.figures.violation <= exceeded;
        is_kept && self.is_stationary(tolerance) && self.gain_of_equations() <= tolerance * self.figures.size
    }

    /// The same, but for a violation that is accepted.
    fn is_at_rounding(&self, tolerance: f64) -> bool {
        self.is_stationary(tolerance) && self.figures.violation <= constants::VIOLATION_ACCEPTED
    }

    /// Whether the next step would change next to nothing.
    fn is_stationary(&self, tolerance: f64) -> bool {
        let Figures { size, gap, decrement, .. } = self.figures;
        let scale = tolerance * size;
        let part = match self.last_tolerance {
            Some(last) if tolerance <= last => self.looseness.between(constants::OF_DECREMENT),
            _ => 1.0,
        };
        decrement.abs() <= part * scale && gap <= scale
    }

    /// Whether squares say how far to go: there is an effort, and there are no equations, whose stiff squares
    /// say nothing about the directions that they leave free.
    fn has_squares_alone(&self) -> bool {
        let barrier = &self.barrier;
        let equations = barrier.sides().iter().any(|side| side.is_equation) || !barrier.at_ends().is_empty();
        let smooth = self.spline.mesh.shape.is_smooth();
        self.running.costs_torques() && !equations && !smooth
    }

    pub(crate) fn assemble(&mut self) {
        self.system.assemble(&self.spline, &self.points, &self.barrier, &mut self.running, &self.ends);
        self.relaxation.assemble(&self.spline, &self.points, &self.barrier, &self.ends);
    }

    pub(crate) fn factorise(&mut self, damping: f64) -> bool {
        let rate = self.figures.size / self.spline.duration();
        weigh_torques(&self.running, &self.barrier, rate, &mut self.weights);
        self.system.factorise(damping, &self.ends, &self.spline, &self.points, &self.weights).is_ok()
            && self.relaxation.factorise(&mut self.system)
    }
}

#[cfg(test)]
#[path = "iterate_tests.rs"]
pub(in crate::direct) mod tests;
