//! A primal-dual interior-point method for motions with hard limits.

use super::ends::Ends;
use super::limits::{Barrier, Limited, Side};
use super::metric::fill_metric;
use super::point_terms::weigh;
use super::points::{PointDynamics, Points};
use super::running::Running;
use super::spline::Spline;
use super::system::System;
use crate::constants::direct as constants;
use crate::numerics::block_tridiagonal::BlockTridiagonal;
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
    /// Largest violation of a limit, in parts of its range.
    pub violation: f64,
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
    pub figures: Figures,
    /// Least size of the cost.
    least_size: f64,
    pub(super) system: System,
    pub(super) damping: f64,
    pub(super) mu: f64,
    pub(super) trial: Trial,
    pub(super) steps: [Vec<f64>; 2],
    /// Change of the distances at mu = 0, and its factor of mu.
    pub(super) changes: [Vec<f64>; 2],
    pub(super) time_steps: [f64; 2],
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
}

impl<D: PointDynamics> Interior<D> {
    pub fn new(spline: Spline, sides: Vec<Side>, running: Running, ends: Ends, dynamics: D) -> Self {
        let n = spline.dof;
        Self {
            spline,
            points: Points::default(),
            barrier: Barrier { sides, ..Barrier::default() },
            running,
            ends,
            dynamics,
            figures: Figures::default(),
            least_size: 0.0,
            system: System::new(n),
            damping: 0.0,
            mu: 0.0,
            trial: Trial::default(),
            steps: [Vec::new(), Vec::new()],
            changes: [Vec::new(), Vec::new()],
            time_steps: [0.0; 2],
        }
    }

    /// Whether a side is off at a point: the unknown is given there.
    fn is_off(&self, p: usize, side: &Side) -> bool {
        let n = self.spline.dof;
        let end = match p {
            0 => &self.ends.start,
            p if p + 1 == self.spline.points() => &self.ends.end,
            _ => return false,
        };
        Ends::gives(end, side.limited as usize, side.joint, n)
    }

    /// Evaluates the spline, and makes slacks and multipliers for it with the barrier `mu`; `None` chooses
    /// it.
    pub fn start(&mut self, mu: Option<f64>) -> Result<(), EvalError> {
        let (n, count) = (self.spline.dof, self.spline.points());
        self.points.resize(n, count);
        self.spline.evaluate(&mut self.points.z);
        if self.least_size == 0.0 {
            self.dynamics.contract(&mut self.points)?;
            self.least_size = self.small_cost();
        }
        self.dynamics.evaluate(&mut self.points)?;
        let sides = self.barrier.sides.len();
        for vector in [&mut self.barrier.slack, &mut self.barrier.multiplier, &mut self.barrier.distance] {
            vector.resize(sides * count, 0.0);
        }
        self.barrier.measure(&self.points);
        self.measure_cost();
        self.mu = mu.unwrap_or(constants::FIRST_GAP * self.figures.size / (sides.max(1) as f64));
        for p in 0..count {
            let weight = self.spline.point(p).1;
            for i in 0..sides {
                let side = self.barrier.sides[i];
                let at = sides * p + i;
                if self.is_off(p, &side) {
                    (self.barrier.slack[at], self.barrier.multiplier[at]) = (f64::INFINITY, 0.0);
                } else {
                    let slack = self.barrier.distance[at].max(constants::FIRST_SLACK * side.range);
                    self.barrier.slack[at] = slack;
                    self.barrier.multiplier[at] = self.mu * weight / slack;
                }
            }
        }
        self.damping = 0.0;
        self.measure_figures();
        Ok(())
    }

    /// Takes the motion over to other nodes, with multipliers in proportion to the weights of the points.
    pub fn move_to(&mut self, nodes: Vec<f64>) -> Result<(), EvalError> {
        let sides = self.barrier.sides.len();
        let old: Vec<(f64, f64)> = (0..self.spline.points()).map(|p| self.spline.point(p)).collect();
        let multipliers = std::mem::take(&mut self.barrier.multiplier);
        let sides_or_one = sides.max(1) as f64;
        let mu = self.figures.gap.max(constants::WARM * self.figures.size) / sides_or_one;
        self.spline = self.spline.on_nodes(nodes);
        self.start(Some(mu))?;
        for p in 0..self.spline.points() {
            let (s, weight) = self.spline.point(p);
            let right = old.partition_point(|&(place, _)| place < s).clamp(1, old.len() - 1);
            let (a, b) = (old[right - 1], old[right]);
            let part = ((s - a.0) / (b.0 - a.0)).clamp(0.0, 1.0);
            for i in 0..sides {
                let at = sides * p + i;
                if self.barrier.slack[at].is_infinite() {
                    continue;
                }
                let side = self.barrier.sides[i];
                let density = |q: usize, weight: f64| multipliers[sides * q + i] / weight;
                let density = (1.0 - part) * density(right - 1, a.1) + part * density(right, b.1);
                let distance = self.barrier.distance[at];
                let most = distance.max(constants::FIRST_SLACK * side.range);
                let slack = distance
                    .max(constants::LEAST_SLACK * side.range)
                    .max(mu / density.max(f64::MIN_POSITIVE))
                    .min(most);
                let central = mu / slack;
                self.barrier.slack[at] = slack;
                self.barrier.multiplier[at] =
                    weight * density.clamp(central / constants::OFF_CENTRE, constants::OFF_CENTRE * central);
            }
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
        let range = self.barrier.sides.iter().find(own).map_or(1.0, |side| side.range);
        self.figures.size / self.spline.time / (range * range)
    }

    /// Cost of the efforts that move each joint alone by [`constants::SMALL_MOTION`] in it: M_ii
    /// times that motion over the squared time.
    fn small_cost(&self) -> f64 {
        let (n, time) = (self.spline.dof, self.spline.time);
        let tau_z = self.points.tau_z(0);
        let effort = |(i, r): (usize, &f64)| {
            let torque = tau_z[3 * n * i + 2 * n + i] * constants::SMALL_MOTION / (time * time);
            0.5 * r * torque * torque
        };
        let efforts: f64 = self.running.effort.iter().enumerate().map(effort).sum();
        (time * efforts).max(f64::MIN_POSITIVE.sqrt())
    }

    fn measure_cost(&mut self) {
        self.figures.cost = self.running.cost(&self.spline, &self.points);
        self.figures.size = self.figures.cost.abs().max(self.least_size);
    }

    pub(super) fn measure_figures(&mut self) {
        self.measure_cost();
        self.figures.gap = self.barrier.complementarity();
        self.figures.violation = self.violation();
    }

    /// Largest violation of a limit, in parts of its range.
    fn violation(&self) -> f64 {
        let sides = self.barrier.sides.len();
        let on = self.barrier.slack.iter().zip(&self.barrier.distance).enumerate();
        on.filter(|(_, (slack, _))| slack.is_finite())
            .fold(0.0, |most: f64, (i, (_, d))| most.max(-d / self.barrier.sides[i % sides].range))
    }

    /// Sum of |d - s| in parts of ranges, weighted as the integral.
    pub(super) fn infeasibility(&self, spline: &Spline, distance: &[f64], slack: &[f64]) -> f64 {
        let sides = self.barrier.sides.len();
        let mut sum = 0.0;
        for (at, (d, s)) in distance.iter().zip(slack).enumerate() {
            if s.is_finite() {
                sum += spline.point(at / sides).1 * (d - s).abs() / self.barrier.sides[at % sides].range;
            }
        }
        sum
    }

    /// The barrier -mu sum w log s.
    pub(super) fn logarithms(&self, spline: &Spline, slack: &[f64]) -> f64 {
        let sides = self.barrier.sides.len();
        let on = slack.iter().enumerate().filter(|(_, slack)| slack.is_finite());
        -self.mu * on.map(|(at, slack)| spline.point(at / sides).1 * slack.ln()).sum::<f64>()
    }

    /// Weights and derivatives at the points of this iterate.
    pub fn refresh(&mut self) -> Result<(), EvalError> {
        weigh(&self.spline, &mut self.points, &self.barrier, &self.running);
        self.dynamics.contract(&mut self.points)
    }

    /// Iterates until gap and decrement are below `tolerance` times the cost; `watch` sees each iterate with
    /// the part of the step that led to it, and may stop it.
    pub fn iterate(
        &mut self,
        tolerance: f64,
        most: usize,
        mut watch: impl FnMut(&Self, f64) -> Option<Interruption>,
    ) -> Result<End, EvalError> {
        for _ in 0..most {
            self.figures.iterations += 1;
            self.refresh()?;
            self.system.assemble(&self.spline, &self.points, &self.barrier, &mut self.running, &self.ends);
            let again = (self.damping * constants::DAMPING_DOWN).max(constants::DAMPING);
            let (mut damping, mut taken) = (0.0, None);
            while damping < constants::MOST_DAMPING && taken.is_none() {
                if self.factorise(damping) {
                    self.solve();
                    self.choose_barrier(tolerance);
                    self.figures.decrement = self.decrement();
                    if damping == 0.0 && self.is_solved(tolerance) {
                        self.damping = 0.0;
                        return Ok(End::Solved);
                    }
                    taken = self.search()?;
                    if taken.is_some() {
                        break;
                    }
                }
                damping = (damping * constants::DAMPING_UP).max(again);
            }
            self.damping = damping;
            let Some(part) = taken else { return Ok(End::NoProgress) };
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
        decrement.abs() <= scale && gap <= scale && violation <= constants::VIOLATION_AT_POINTS
    }

    fn factorise(&mut self, damping: f64) -> bool {
        let weights: Vec<f64> = (0..self.spline.dof).map(|joint| self.metric_weight(joint)).collect();
        let (spline, points, ends) = (&self.spline, &self.points, &self.ends);
        let metric = |matrix: &mut BlockTridiagonal| fill_metric(matrix, spline, points, &weights, ends);
        self.system.factorise(damping, ends.free_time, metric).is_ok()
    }
}

#[cfg(test)]
#[path = "interior_tests.rs"]
mod tests;
