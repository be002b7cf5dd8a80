//! The iterate on one mesh, its limits and multipliers.

use super::ends::EndRow;
use super::interval::{Interval, Scratch};
use super::points::{Layout, POINTS, Radau};
use super::problem::DirectDynamics;
use super::recursion::Recursion;
use crate::bvp::collocation::error::defined;
use crate::constants::states as constants;
use crate::direct::Filter;
use crate::problem::FinalTime;
use costate::dynamics::{Cost, Dynamics};

/// Iterate and workspaces of one mesh.
pub(super) struct Interior {
    pub layout: Layout,
    pub radau: Radau,
    /// Widths in s.
    pub widths: Vec<f64>,
    /// The unknowns.
    pub w: Vec<f64>,
    pub low: Vec<f64>,
    pub high: Vec<f64>,
    /// Multipliers of the limits.
    pub(super) z_low: Vec<f64>,
    pub(super) z_high: Vec<f64>,
    /// Weights of the logarithms of both limits of an unknown: those of quadrature along the motion, 1 of T.
    pub(super) weights: Vec<f64>,
    /// Sum of the weights of all limits.
    logarithms: f64,
    /// Multipliers of the defects, and of what is given at the end.
    pub lambda: Vec<f64>,
    pub(super) nu: Vec<f64>,
    /// What is given at the end.
    pub ends: Vec<EndRow>,
    /// Components of (x, T) that are free at the start.
    pub(super) free: Vec<usize>,
    pub intervals: Vec<Interval>,
    pub(super) recursion: Recursion,
    pub(super) filter: Filter,
    pub(super) mu: f64,
    pub(super) damping: f64,
    pub(super) work: Work,
    /// Whether the last Newton matrix was positive definite without damping.
    pub definite: bool,
    pub cost: f64,
    /// Error of the conditions of first order.
    pub residual: f64,
}

/// Vectors that a step needs.
pub(super) struct Work {
    pub residual: Vec<f64>,
    pub step: Vec<f64>,
    pub trial: Vec<f64>,
    /// A step and its multipliers while it is corrected.
    pub kept: [Vec<f64>; 3],
    pub dz_low: Vec<f64>,
    pub dz_high: Vec<f64>,
    /// New multipliers.
    pub lambda: Vec<f64>,
    pub nu: Vec<f64>,
    /// Derivatives of the running cost and of y'f at a point.
    pub l_1: Vec<f64>,
    pub l_2: Vec<f64>,
    pub f_2: Vec<f64>,
    /// (dx, dT, dU) of an interval, (dx, dT) of a node, and the gradient of what follows.
    pub y: Vec<f64>,
    pub state: Vec<f64>,
    pub after: Vec<f64>,
    pub end_weights: Vec<f64>,
    pub scratch: Scratch,
}

impl Work {
    fn new(layout: &Layout, ends: usize) -> Self {
        let Layout { n, m, intervals } = *layout;
        let zeros = |count| vec![0.0; count];
        let (count, size) = (layout.count(), n + m);
        Self {
            residual: zeros(count),
            step: zeros(count),
            trial: zeros(count),
            kept: [zeros(count), zeros(intervals * POINTS * n), zeros(ends)],
            dz_low: zeros(count),
            dz_high: zeros(count),
            lambda: zeros(intervals * POINTS * n),
            nu: zeros(ends),
            l_1: zeros(size),
            l_2: zeros(size * size),
            f_2: zeros(size * size),
            y: zeros(n + 1 + POINTS * m),
            state: zeros(n + 1),
            after: zeros(n),
            end_weights: zeros(ends),
            scratch: Scratch::new(n, m),
        }
    }

    /// Exchanges the step and its multipliers with those that are kept.
    pub fn exchange_step(&mut self) {
        let [step, lambda, nu] = &mut self.kept;
        std::mem::swap(&mut self.step, step);
        std::mem::swap(&mut self.lambda, lambda);
        std::mem::swap(&mut self.nu, nu);
    }
}

impl Interior {
    /// From these unknowns, moved away from their limits; `is_warm` on later meshes.
    pub fn new<D: Dynamics<f64>, C: Cost<f64>>(
        task: &DirectDynamics<D, C>,
        widths: Vec<f64>,
        mut w: Vec<f64>,
        is_warm: bool,
    ) -> Self {
        let layout = Layout { n: task.model.states(), m: task.model.controls(), intervals: widths.len() };
        let (n, count) = (layout.n, layout.count());
        let [low, high] = limits(task, &layout);
        let (mut low, mut high) = (low, high);
        let fixed_of = |free: &[usize]| (0..n).filter(|i| !free.contains(i)).collect::<Vec<_>>();
        let (fixed, ends) = (fixed_of(&task.problem.end.free), EndRow::of(&task.problem.end));
        let mut fix = |at: usize, value: f64| {
            (low[at], high[at], w[at]) = (f64::NEG_INFINITY, f64::INFINITY, value);
        };
        fixed_of(&task.problem.start.free).into_iter().for_each(|i| fix(i, task.problem.start.x[i]));
        fixed.iter().for_each(|&i| fix(layout.node(layout.intervals) + i, task.problem.end.x[i]));
        let mut free = task.problem.start.free.clone();
        free.sort_unstable();
        free.dedup();
        if matches!(task.problem.time, FinalTime::Free { .. }) {
            free.push(n);
        }
        let (mu, room) = match is_warm {
            true => (constants::WARM, constants::WARM_ROOM),
            false => (constants::BARRIER, constants::ROOM),
        };
        let radau = Radau::new();
        let weights = weights(&layout, &radau, &widths);
        let (mut z_low, mut z_high, mut logarithms) = (vec![0.0; count], vec![0.0; count], 0.0);
        for i in 0..count {
            // A guess of T, whose limit is 0, is positive and stays as it is given.
            let room = if i == layout.time() { 0.0 } else { room };
            let range = if (high[i] - low[i]).is_finite() { high[i] - low[i] } else { f64::INFINITY };
            let distance = |limit: f64| room * limit.abs().max(1.0).min(range);
            if low[i].is_finite() {
                w[i] = w[i].max(low[i] + distance(low[i]));
            }
            if high[i].is_finite() {
                w[i] = w[i].min(high[i] - distance(high[i]));
                z_high[i] = mu * weights[i] / (high[i] - w[i]);
                logarithms += weights[i];
            }
            if low[i].is_finite() {
                z_low[i] = mu * weights[i] / (w[i] - low[i]);
                logarithms += weights[i];
            }
        }
        let mut filter = Filter::default();
        filter.reserve();
        Self {
            layout,
            radau,
            weights,
            logarithms,
            lambda: vec![0.0; layout.intervals * POINTS * n],
            nu: vec![0.0; ends.len()],
            intervals: vec![Interval::new(n, layout.m); layout.intervals],
            recursion: Recursion::new(&layout),
            work: Work::new(&layout, ends.len()),
            filter,
            mu,
            damping: 0.0,
            definite: false,
            cost: f64::NAN,
            residual: f64::INFINITY,
            widths,
            w,
            low,
            high,
            z_low,
            z_high,
            ends,
            free,
        }
    }

    pub fn time(&self) -> f64 {
        self.w[self.layout.time()]
    }

    /// Largest values of the components of x along the motion.
    pub fn sizes(&self) -> Vec<f64> {
        (0..self.layout.n).map(|i| self.size(i)).collect()
    }

    pub(super) fn size(&self, component: usize) -> f64 {
        let at = |k| self.w[self.layout.node(k) + component].abs();
        (0..=self.layout.intervals).map(at).fold(constants::LEAST_SIZE, f64::max)
    }

    /// What row i of the end is missed by.
    pub fn missed(&self, i: usize) -> f64 {
        self.ends[i].missed(&self.layout, &self.w)
    }

    /// The size of row i of the end.
    pub fn end_size(&self, i: usize) -> f64 {
        self.ends[i].size(|component| self.size(component))
    }

    /// Curvature and force of the barrier of unknown i.
    pub(super) fn barrier(&self, i: usize) -> (f64, f64) {
        let (mut curvature, mut force) = (0.0, 0.0);
        if self.low[i].is_finite() {
            let slack = self.w[i] - self.low[i];
            curvature += self.z_low[i] / slack;
            force -= self.mu * self.weights[i] / slack;
        }
        if self.high[i].is_finite() {
            let slack = self.high[i] - self.w[i];
            curvature += self.z_high[i] / slack;
            force += self.mu * self.weights[i] / slack;
        }
        (curvature, force)
    }

    /// The size of the cost, also where it vanishes.
    pub fn cost_size(&self) -> f64 {
        self.cost.abs().max(constants::LEAST_COST)
    }

    /// The last barrier: all logarithms together cost a part of the tolerance, relative to the cost.
    pub(super) fn least_barrier(&self, tolerance: f64) -> f64 {
        let share = self.cost_size() / self.logarithms.max(f64::MIN_POSITIVE);
        constants::LEAST_BARRIER * tolerance * share.min(1.0)
    }

    /// Sum of slack times multiplier: what the barrier costs, to first order.
    pub(super) fn gap(&self) -> f64 {
        let mut gap = 0.0;
        for i in 0..self.w.len() {
            for (z, slack) in self.sides(i) {
                if slack.is_finite() {
                    gap += z * slack;
                }
            }
        }
        gap
    }

    /// Multiplier and slack of both limits of unknown i.
    fn sides(&self, i: usize) -> [(f64, f64); 2] {
        [(self.z_low[i], self.w[i] - self.low[i]), (self.z_high[i], self.high[i] - self.w[i])]
    }

    /// Error of stationarity, defects and complementarity with a barrier, by the size of the multipliers.
    pub(super) fn error(&self, mu: f64, stationarity: f64, theta: f64) -> f64 {
        let size =
            self.lambda.iter().fold(1.0, |most: f64, y| most.max(y.abs() / constants::LARGE_MULTIPLIERS));
        let mut most = defined(stationarity / size).max(defined(theta));
        for i in 0..self.w.len() {
            for (z, slack) in self.sides(i) {
                if slack.is_finite() {
                    most = most.max(defined(z * slack / self.weights[i] - mu) / size);
                }
            }
        }
        most
    }
}

/// Weights of the logarithms. The start counts as a node.
fn weights(layout: &Layout, radau: &Radau, widths: &[f64]) -> Vec<f64> {
    let size = layout.n + layout.m;
    let mut weights = vec![widths[0] * radau.weights[POINTS - 1]; layout.n];
    for width in widths {
        radau.weights.iter().for_each(|weight| weights.extend((0..size).map(|_| width * weight)));
    }
    weights.push(1.0);
    weights
}

/// Limits of all unknowns. T is positive.
fn limits<D, C>(task: &DirectDynamics<D, C>, layout: &Layout) -> [Vec<f64>; 2] {
    [(0, f64::NEG_INFINITY), (1, f64::INFINITY)].map(|(side, none)| {
        let mut all = vec![none; layout.count()];
        let mut set = |from: usize, limits: &[f64]| all[from..from + limits.len()].copy_from_slice(limits);
        set(0, &task.x_limits[side]);
        for k in 0..layout.intervals {
            for j in 0..POINTS {
                set(layout.point(k, j), &task.x_limits[side]);
                set(layout.point(k, j) + layout.n, &task.u_limits[side]);
            }
        }
        if side == 0 && matches!(task.problem.time, FinalTime::Free { .. }) {
            set(layout.time(), &[0.0]);
        }
        all
    })
}
