//! A primal-dual interior-point method for motions with hard limits.

use super::basis::{Basis, COEFFICIENTS, PLACES, POINTS};
use super::ends::Ends;
use super::limits::{Barrier, Limited, Side, measure};
use super::points::{PointDynamics, Points};
use super::running::Running;
use super::spline::{Spline, combine};
use super::system::{System, add_inner, add_node, remove, scaled};
use crate::numerics::block_tridiagonal::BlockTridiagonal;
use costate::EvalError;

/// Constants of the iteration.
mod constants {
    /// Smallest part of a slack or multiplier that a step leaves.
    pub const BOUNDARY: f64 = 0.005;
    /// First damping where the matrix is not positive definite, and the factor from one to the next.
    pub const DAMPING: f64 = 1e-3;
    pub const DAMPING_UP: f64 = 8.0;
    pub const DAMPING_DOWN: f64 = 0.25;
    pub const MOST_DAMPING: f64 = 1e10;
    pub const LEAST_DAMPING: f64 = 1e-8;
    /// Shortest step that is tried before the damping rises.
    pub const SHORTEST: f64 = 0.05;
    /// Slacks start at this part of the range of their limit, if not farther inside.
    pub const FIRST_SLACK: f64 = 0.05;
    /// Sufficient decrease.
    pub const ARMIJO: f64 = 1e-4;
    pub const VIOLATION: f64 = 1e-5;
}

/// How an iteration ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum End {
    Solved,
    IterationLimit,
    NoProgress,
}

/// Figures of an iterate.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Figures {
    pub cost: f64,
    /// Sum of slack times multiplier.
    pub gap: f64,
    /// Largest violation of a limit, in parts of its range.
    pub violation: f64,
    /// Newton decrement: twice the change of cost that the next step promises.
    pub decrement: f64,
    pub iterations: usize,
    pub factorisations: usize,
    pub evaluations: usize,
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
    pub verbose: bool,
    system: System,
    damping: f64,
    mu: f64,
    trial: Trial,
    steps: [Vec<f64>; 2],
    /// Change of the distances at mu = 0, and its factor of mu.
    changes: [Vec<f64>; 2],
    time_steps: [f64; 2],
}

/// A trial step.
#[derive(Debug, Default)]
struct Trial {
    spline: Spline,
    points: Points,
    slack: Vec<f64>,
    multiplier: Vec<f64>,
    distance: Vec<f64>,
    slack_step: Vec<f64>,
    multiplier_step: Vec<f64>,
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
            verbose: false,
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

    /// Evaluates the spline, and makes slacks and multipliers for it with the barrier `mu`; `None` chooses it.
    pub fn start(&mut self, mu: Option<f64>) -> Result<(), EvalError> {
        let (n, count) = (self.spline.dof, self.spline.points());
        self.points.resize(n, count);
        self.spline.evaluate(&mut self.points.z);
        self.dynamics.evaluate(&mut self.points)?;
        let sides = self.barrier.sides.len();
        for vector in [&mut self.barrier.slack, &mut self.barrier.multiplier, &mut self.barrier.distance] {
            vector.resize(sides * count, 0.0);
        }
        self.barrier.measure(&self.points);
        let cost = self.running.cost(&self.spline, &self.points);
        self.mu = mu.unwrap_or(0.1 * cost.abs().max(1e-6) / (sides.max(1) as f64));
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
        let mu = self.figures.gap / (sides.max(1) as f64);
        let mu = mu.max(std::env::var("MU").map_or(1e-3, |t| t.parse().unwrap()) * self.figures.cost.abs() / (sides.max(1) as f64));
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
                let slack = self.barrier.distance[at].max(1e-5 * side.range).max(mu / density.max(1e-300)).min(
                    self.barrier.distance[at].max(constants::FIRST_SLACK * side.range)
                );
                let central = mu / slack;
                self.barrier.slack[at] = slack;
                self.barrier.multiplier[at] = weight * density.clamp(0.1 * central, 10.0 * central);
            }
        }
        self.measure_figures();
        Ok(())
    }

    /// Weight of a squared error of a torque in the cost: the effort, or for least time the cost of a second
    /// over the square of the range of the torque.
    pub fn weight_of_torque(&self, joint: usize) -> f64 {
        let effort = self.running.effort[joint];
        effort
    }

    fn measure_figures(&mut self) {
        self.figures.cost = self.running.cost(&self.spline, &self.points);
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
    fn infeasibility(&self, spline: &Spline, distance: &[f64], slack: &[f64]) -> f64 {
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
    fn logarithms(&self, spline: &Spline, slack: &[f64]) -> f64 {
        let sides = self.barrier.sides.len();
        let on = slack.iter().enumerate().filter(|(_, slack)| slack.is_finite());
        -self.mu * on.map(|(at, slack)| spline.point(at / sides).1 * slack.ln()).sum::<f64>()
    }

    /// Iterates until gap and decrement are below `tolerance` times the cost.
    pub fn iterate(&mut self, tolerance: f64, most: usize) -> Result<End, EvalError> {
        let free_time = self.ends.free_time;
        for _ in 0..most {
            self.figures.iterations += 1;
            System::weigh(&self.spline, &mut self.points, &self.barrier, &self.running);
            self.dynamics.contract(&mut self.points)?;
            self.system.assemble(&self.spline, &self.points, &self.barrier, &mut self.running, &self.ends);
            let mut damping = 0.0;
            let mut accepted = false;
            let again = (self.damping * constants::DAMPING_DOWN).max(constants::DAMPING);
            while damping < constants::MOST_DAMPING {
                if !self.factorise(damping, free_time) {
                    damping = (damping * constants::DAMPING_UP).max(again);
                    continue;
                }
                self.solve(free_time);
                self.choose_barrier(tolerance);
                let decrement = self.decrement();
                self.figures.decrement = decrement;
                let scale = tolerance * self.figures.cost.abs();
                if damping == 0.0
                    && decrement.abs() <= scale
                    && self.figures.gap <= scale
                    && self.figures.violation <= 1e-9
                {
                    self.damping = 0.0;
                    return Ok(End::Solved);
                }
                if self.search()? {
                    accepted = true;
                    break;
                }
                damping = (damping * constants::DAMPING_UP).max(again);
            }
            self.damping = damping;
            if !accepted {
                return Ok(End::NoProgress);
            }
        }
        Ok(End::IterationLimit)
    }

    fn factorise(&mut self, damping: f64, free_time: bool) -> bool {
        self.figures.factorisations += 1;
        let (spline, points, running, ends) = (&self.spline, &self.points, &self.running, &self.ends);
        let metric = |matrix: &mut BlockTridiagonal| fill_metric(matrix, spline, points, running, ends);
        self.system.factorise(damping, free_time, metric).is_ok()
    }

    /// Both parts of the step, and of the change of distances.
    fn solve(&mut self, free_time: bool) {
        let n = self.spline.dof;
        let sides = self.barrier.sides.len();
        for part in 0..2 {
            let dt = self.system.solve(part, free_time, &mut self.steps[part]);
            self.time_steps[part] = dt;
            let block = 3 * n;
            let last = self.steps[part].len() - block;
            for (offset, fixed) in [(0, &self.ends.start), (last, &self.ends.end)] {
                for (i, tangent) in fixed.iter().enumerate() {
                    if let Some(tangent) = tangent {
                        self.steps[part][offset + i] = tangent * dt;
                    }
                }
            }
            self.changes[part].resize(sides * self.points.count(), 0.0);
            if sides == 0 {
                continue;
            }
            let mut dz = vec![0.0; block];
            for p in 0..self.points.count() {
                let (k, j) = (p / POINTS, p % POINTS);
                let step = &self.steps[part][block * k..];
                if j == 0 {
                    dz.copy_from_slice(&step[..block]);
                } else {
                    combine(&Basis::at(PLACES[j - 1], self.spline.width(k)), n, &step[..COEFFICIENTS * n], &mut dz);
                }
                let (z, rate) = (self.points.z(p), 1.0 / self.spline.time);
                for i in 0..n {
                    dz[n + i] = rate * (dz[n + i] - z[n + i] * dt);
                    dz[2 * n + i] = rate * (rate * dz[2 * n + i] - 2.0 * z[2 * n + i] * dt);
                }
                let tau_z = self.points.tau_z(p);
                for (change, side) in self.changes[part][sides * p..][..sides].iter_mut().zip(&self.barrier.sides) {
                    let value = if side.limited == Limited::Torque {
                        let row = &tau_z[3 * n * side.joint..][..3 * n];
                        row.iter().zip(&dz).map(|(a, b)| a * b).sum()
                    } else {
                        dz[side.index(n)]
                    };
                    *change = side.sign * value;
                }
            }
        }
    }

    /// Steps of slacks and multipliers for a barrier, and how far they may go.
    fn steps_of(&mut self, mu: f64) -> (f64, f64) {
        let sides = self.barrier.sides.len();
        let count = self.barrier.slack.len();
        self.trial.slack_step.resize(count, 0.0);
        self.trial.multiplier_step.resize(count, 0.0);
        let (mut primal, mut dual) = (1.0_f64, 1.0_f64);
        let keep = 1.0 - constants::BOUNDARY;
        for at in 0..count {
            let (s, eta, d) = (self.barrier.slack[at], self.barrier.multiplier[at], self.barrier.distance[at]);
            if s.is_infinite() {
                continue;
            }
            let weight = self.spline.point(at / sides).1;
            let change = self.changes[0][at] + mu * self.changes[1][at];
            let ds = change + d - s;
            let deta = (mu * weight - eta * d - eta * change) / s;
            if ds < 0.0 {
                primal = primal.min(keep * s / -ds);
            }
            if deta < 0.0 {
                dual = dual.min(keep * eta / -deta);
            }
            (self.trial.slack_step[at], self.trial.multiplier_step[at]) = (ds, deta);
        }
        (primal, dual)
    }

    /// Mehrotra's choice: from the complementarity that the step at mu = 0 would leave.
    fn choose_barrier(&mut self, tolerance: f64) {
        let gap = self.figures.gap;
        if gap == 0.0 {
            self.mu = 0.0;
            return;
        }
        let active = self.barrier.sides.len() as f64;
        let now = gap / active;
        let (primal, dual) = self.steps_of(0.0);
        let mut left = 0.0;
        for at in 0..self.barrier.slack.len() {
            let (s, eta) = (self.barrier.slack[at], self.barrier.multiplier[at]);
            if s.is_finite() {
                left += (s + primal * self.trial.slack_step[at]) * (eta + dual * self.trial.multiplier_step[at]);
            }
        }
        let part = (left / gap).clamp(0.0, 1.0);
        self.mu = now;
        let floor = 0.1 * tolerance * self.figures.cost.abs() / active;
        let centre = 0.01 * self.decrement().abs() / active;
        self.mu = (now * (part * part * part).max(1e-3)).max(floor).max(centre.min(now * 10.0));
    }

    /// -(g dx) for the step.
    fn decrement(&self) -> f64 {
        let mu = self.mu;
        let gradient = |i: usize| self.system.gradient[0][i] + mu * self.system.gradient[1][i];
        let step = |i: usize| self.steps[0][i] + mu * self.steps[1][i];
        let sum: f64 = (0..self.steps[0].len()).map(|i| gradient(i) * step(i)).sum();
        let time = self.system.time_gradient[0] + mu * self.system.time_gradient[1];
        -(sum + time * (self.time_steps[0] + mu * self.time_steps[1]))
    }

    /// Tries shorter and shorter steps. Whether one was taken.
    fn search(&mut self) -> Result<bool, EvalError> {
        let mu = self.mu;
        let (primal, dual) = self.steps_of(mu);
        // Slope of cost and barrier.
        let mut slope = 0.0;
        for i in 0..self.steps[0].len() {
            slope += self.system.gradient[0][i] * (self.steps[0][i] + mu * self.steps[1][i]);
        }
        let dt = self.time_steps[0] + mu * self.time_steps[1];
        slope += self.system.time_gradient[0] * dt;
        let sides = self.barrier.sides.len();
        for at in 0..self.barrier.slack.len() {
            let (s, eta, d) = (self.barrier.slack[at], self.barrier.multiplier[at], self.barrier.distance[at]);
            if s.is_finite() {
                let change = self.changes[0][at] + mu * self.changes[1][at];
                slope += eta * (1.0 - d / s) * change - mu * self.spline.point(at / sides).1 * self.trial.slack_step[at] / s;
            }
        }
        let theta = self.infeasibility(&self.spline, &self.barrier.distance, &self.barrier.slack);
        let value = self.figures.cost + self.logarithms(&self.spline, &self.barrier.slack);
        let mut alpha = primal;
        loop {
            self.evaluate_trial(alpha)?;
            let trial = &self.trial;
            let cost = self.running.cost(&trial.spline, &trial.points);
            let new_theta = self.infeasibility(&trial.spline, &trial.distance, &trial.slack);
            let new_value = cost + self.logarithms(&trial.spline, &trial.slack);
            let rounding = 1e-13 * value.abs();
            let feasible = theta <= 1e-7;
            let fine = if feasible && slope < 0.0 {
                new_value <= value + constants::ARMIJO * alpha * slope + rounding && new_theta <= 1e-5
            } else {
                new_theta <= (1.0 - constants::VIOLATION) * theta
                    || new_value <= value - constants::VIOLATION * theta + rounding
            };
            let sane = trial.spline.time > 0.0 && cost.is_finite() && new_theta <= 10.0 * theta.max(1.0);
            if fine && sane {
                if self.verbose {
                    eprintln!(
                        "{:3} J {:.9e} gap {:.1e} viol {:.1e} decr {:.1e} mu {:.1e} theta {:.1e} damp {:.0e} a {:.3} {:.3} T {:.6}",
                        self.figures.iterations, self.figures.cost, self.figures.gap, self.figures.violation,
                        self.figures.decrement, mu, theta, self.damping, alpha, dual, self.spline.time,
                    );
                }
                self.take(dual);
                return Ok(true);
            }
            alpha *= 0.5;
            if alpha < constants::SHORTEST * primal {
                return Ok(false);
            }
        }
    }

    /// Spline, points, distances and slacks after the part `alpha` of the step.
    fn evaluate_trial(&mut self, alpha: f64) -> Result<(), EvalError> {
        self.figures.evaluations += 1;
        let mu = self.mu;
        let trial = &mut self.trial;
        trial.spline.clone_from(&self.spline);
        for (i, unknown) in trial.spline.unknowns.iter_mut().enumerate() {
            *unknown += alpha * (self.steps[0][i] + mu * self.steps[1][i]);
        }
        trial.spline.time += alpha * (self.time_steps[0] + mu * self.time_steps[1]);
        trial.points.resize(self.spline.dof, self.spline.points());
        trial.spline.evaluate(&mut trial.points.z);
        self.dynamics.evaluate(&mut trial.points)?;
        trial.distance.resize(self.barrier.distance.len(), 0.0);
        measure(&self.barrier.sides, &trial.points, &mut trial.distance);
        trial.slack.clone_from(&self.barrier.slack);
        for ((slack, step), &distance) in trial.slack.iter_mut().zip(&trial.slack_step).zip(&trial.distance) {
            if slack.is_finite() {
                *slack = (*slack + alpha * step).max(distance);
            }
        }
        Ok(())
    }

    /// Makes the trial the iterate.
    fn take(&mut self, dual: f64) {
        std::mem::swap(&mut self.spline, &mut self.trial.spline);
        std::mem::swap(&mut self.points.z, &mut self.trial.points.z);
        std::mem::swap(&mut self.points.tau, &mut self.trial.points.tau);
        std::mem::swap(&mut self.barrier.slack, &mut self.trial.slack);
        std::mem::swap(&mut self.barrier.distance, &mut self.trial.distance);
        let sides = self.barrier.sides.len();
        for at in 0..self.barrier.multiplier.len() {
            if self.barrier.slack[at].is_finite() {
                let eta = self.barrier.multiplier[at] + dual * self.trial.multiplier_step[at];
                // Not farther than a factor of 1e10 from the central path.
                let central = self.mu * self.spline.point(at / sides).1 / self.barrier.slack[at];
                self.barrier.multiplier[at] = eta.clamp(1e-10 * central, 1e10 * central);
            }
        }
        self.measure_figures();
    }
}

/// The metric of damping: `sum w T (M da)' R (M da)`.
fn fill_metric(matrix: &mut BlockTridiagonal, spline: &Spline, points: &Points, running: &Running, ends: &Ends) {
    let (n, width) = (spline.dof, 3 * spline.dof);
    let scales = [1.0, 1.0 / spline.time, 1.0 / (spline.time * spline.time)];
    let mut hessian = vec![0.0; width * width];
    let mut product = vec![0.0; 2 * width * width];
    let any = running.effort.iter().any(|&r| r > 0.0);
    for p in 0..points.count() {
        let weight = spline.point(p).1 * spline.time;
        let tau_z = points.tau_z(p);
        for i in 0..n {
            for j in 0..n {
                let entries = (0..n).map(|l| {
                    let r = if any { running.effort[l] } else { 1.0 };
                    r * tau_z[width * l + 2 * n + i] * tau_z[width * l + 2 * n + j]
                });
                hessian[width * (2 * n + i) + 2 * n + j] = weight * entries.sum::<f64>();
            }
        }
        let (k, j) = (p / POINTS, p % POINTS);
        if j == 0 {
            add_node(matrix, k, n, &hessian, scales);
        } else {
            let basis = scaled(&Basis::at(PLACES[j - 1], spline.width(k)), scales);
            add_inner(matrix, k, n, &hessian, &basis, &mut product);
        }
    }
    for (k, fixed) in [(0, &ends.start), (spline.intervals(), &ends.end)] {
        (0..width).filter(|&i| fixed[i].is_some()).for_each(|i| remove(matrix, k, i, width));
    }
}
