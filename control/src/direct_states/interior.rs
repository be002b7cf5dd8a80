//! The interior-point iteration on one mesh.

use super::interval::Interval;
use super::points::{Layout, POINTS, Radau};
use super::problem::DirectDynamics;
use super::recursion::Recursion;
use crate::direct::{Figure, Filter, is_better};
use crate::extremal::dynamics::response::eval_error;
use crate::problem::FinalTime;
use crate::status::Status;
use costate::EvalError;
use costate::dynamics::{Cost, Dynamics};
use std::time::Instant;

/// Weight of the squares of the ends, whose multipliers converge by (Hessian / weight) a step.
const END_WEIGHT: f64 = 1e7;
/// First barrier, and the part of a range that a guess keeps from its limits.
const BARRIER: f64 = 0.1;
const ROOM: f64 = 0.01;
/// Most damping of the Hessian.
const MOST_DAMPING: f64 = 1e12;

/// Iterate and workspaces of one mesh.
pub(super) struct Interior {
    pub layout: Layout,
    pub radau: Radau,
    /// Widths in s.
    pub widths: Vec<f64>,
    pub w: Vec<f64>,
    pub low: Vec<f64>,
    pub high: Vec<f64>,
    z_low: Vec<f64>,
    z_high: Vec<f64>,
    /// Multipliers of the defects, and of the fixed components of the end.
    pub lambda: Vec<f64>,
    nu: Vec<f64>,
    fixed: Vec<usize>,
    free: Vec<usize>,
    pub intervals: Vec<Interval>,
    recursion: Recursion,
    filter: Filter,
    mu: f64,
    damping: f64,
    /// Whether the last Newton matrix was positive definite without damping.
    pub definite: bool,
    pub cost: f64,
    pub theta: f64,
    pub iterations: usize,
}

impl Interior {
    pub fn new<D: Dynamics<f64>, C: Cost<f64>>(
        task: &DirectDynamics<D, C>,
        widths: Vec<f64>,
        mut w: Vec<f64>,
        mu: Option<f64>,
    ) -> Self {
        let layout = Layout { n: task.model.states(), m: task.model.controls(), intervals: widths.len() };
        let (n, count) = (layout.n, layout.count());
        let mut low = vec![f64::NEG_INFINITY; count];
        let mut high = vec![f64::INFINITY; count];
        let mut set = |from: usize, limits: &[Vec<f64>; 2]| {
            low[from..from + limits[0].len()].copy_from_slice(&limits[0]);
            high[from..from + limits[1].len()].copy_from_slice(&limits[1]);
        };
        set(0, &task.x_limits);
        for k in 0..layout.intervals {
            for j in 0..POINTS {
                set(layout.point(k, j), &task.x_limits);
                set(layout.point(k, j) + n, &task.u_limits);
            }
        }
        let is_free = matches!(task.problem.time, FinalTime::Free { .. });
        if is_free {
            low[count - 1] = 0.0;
        }
        let fixed_of = |free: &[usize]| (0..n).filter(|i| !free.contains(i)).collect::<Vec<_>>();
        let fixed = fixed_of(&task.problem.end.free);
        for i in fixed_of(&task.problem.start.free) {
            (low[i], high[i], w[i]) = (f64::NEG_INFINITY, f64::INFINITY, task.problem.start.x[i]);
        }
        for &i in &fixed {
            let at = layout.node(layout.intervals) + i;
            (low[at], high[at], w[at]) = (f64::NEG_INFINITY, f64::INFINITY, task.problem.end.x[i]);
        }
        let mut free = task.problem.start.free.clone();
        free.sort_unstable();
        free.dedup();
        if is_free {
            free.push(n);
        }
        let first = mu.unwrap_or(BARRIER);
        let room = if mu.is_some() { 1e-3 * ROOM } else { ROOM };
        let (mut z_low, mut z_high) = (vec![0.0; count], vec![0.0; count]);
        for i in 0..count {
            let range = if (high[i] - low[i]).is_finite() { high[i] - low[i] } else { f64::INFINITY };
            let distance = |limit: f64| room * limit.abs().max(1.0).min(range);
            if low[i].is_finite() {
                w[i] = w[i].max(low[i] + distance(low[i]));
            }
            if high[i].is_finite() {
                w[i] = w[i].min(high[i] - distance(high[i]));
                z_high[i] = first / (high[i] - w[i]);
            }
            if low[i].is_finite() {
                z_low[i] = first / (w[i] - low[i]);
            }
        }
        Self {
            layout,
            radau: Radau::new(),
            lambda: vec![0.0; layout.intervals * POINTS * n],
            nu: vec![0.0; n],
            intervals: vec![Interval::new(n, layout.m); layout.intervals],
            recursion: Recursion::new(&layout),
            filter: Filter::default(),
            mu: first,
            damping: 0.0,
            definite: false,
            cost: f64::NAN,
            theta: f64::NAN,
            iterations: 0,
            widths,
            w,
            low,
            high,
            z_low,
            z_high,
            fixed,
            free,
        }
    }

    pub fn time(&self) -> f64 {
        self.w[self.layout.time()]
    }

    /// Cost, infeasibility and logarithms at w.
    fn figure<D: Dynamics<f64>, C: Cost<f64>>(
        &self,
        task: &mut DirectDynamics<D, C>,
        w: &[f64],
    ) -> Result<Figure, EvalError> {
        let Layout { n, m, .. } = self.layout;
        let time = w[self.layout.time()];
        let mut figure = Figure { cost: task.problem.cost.time * time, ..Figure::default() };
        for (k, h) in self.widths.iter().enumerate() {
            for j in 0..POINTS {
                let at = self.layout.point(k, j);
                let (x, u) = w[at..at + n + m].split_at(n);
                figure.cost += h * time * self.radau.weights[j] * task.running(x, u)?;
                let f = task.model.evaluate(x, u).map_err(eval_error)?;
                for (i, f) in f.iter().enumerate() {
                    let mut defect = self.radau.slopes[j][0] * w[self.layout.node(k) + i] - h * time * f;
                    for l in 0..POINTS {
                        defect += self.radau.slopes[j][l + 1] * w[self.layout.point(k, l) + i];
                    }
                    figure.theta += defect.abs();
                }
            }
        }
        let last = self.layout.node(self.layout.intervals);
        figure.theta += self.fixed.iter().map(|&i| (w[last + i] - task.problem.end.x[i]).abs()).sum::<f64>();
        for ((&w, &low), &high) in w.iter().zip(&self.low).zip(&self.high) {
            if low.is_finite() {
                figure.logarithms += (w - low).ln();
            }
            if high.is_finite() {
                figure.logarithms += (high - w).ln();
            }
        }
        Ok(figure)
    }

    /// Derivatives at the iterate; returns the largest error of stationarity.
    fn linearise<D: Dynamics<f64>, C: Cost<f64>>(
        &mut self,
        task: &mut DirectDynamics<D, C>,
    ) -> Result<f64, EvalError> {
        let layout = self.layout;
        let Layout { n, m, .. } = layout;
        let (size, time) = (n + m, self.time());
        let mut residual: Vec<f64> =
            self.z_high.iter().zip(&self.z_low).map(|(high, low)| high - low).collect();
        residual[layout.time()] += task.problem.cost.time;
        let (mut l_1, mut l_2, mut f_2) = (vec![0.0; size], vec![0.0; size * size], vec![0.0; size * size]);
        for k in 0..layout.intervals {
            let h = self.widths[k];
            let interval = &mut self.intervals[k];
            interval.gradient_t = 0.0;
            interval.by_states.fill(0.0);
            for j in 0..POINTS {
                let at = layout.point(k, j);
                let (x, u) = self.w[at..at + size].split_at(n);
                let l = task.running_derivatives(x, u, &mut l_1, &mut l_2)?;
                let lambda = &self.lambda[(k * POINTS + j) * n..][..n];
                let all = task.model.contract(x, u, lambda).map_err(eval_error)?;
                all.hessian(&mut f_2);
                let weight = h * self.radau.weights[j];
                for i in 0..size * size {
                    interval.hessian[j * size * size + i] = weight * time * l_2[i] - h * time * f_2[i];
                }
                interval.gradient_t += weight * l;
                residual[layout.time()] += weight * l;
                for i in 0..size {
                    interval.gradient[j * size + i] = weight * time * l_1[i];
                    interval.cross[j * size + i] = weight * l_1[i];
                    residual[at + i] += weight * time * l_1[i];
                }
                for (i, &y) in lambda.iter().enumerate() {
                    let row = j * n + i;
                    let f = all.first.f[i];
                    let mut defect = self.radau.slopes[j][0] * self.w[layout.node(k) + i] - h * time * f;
                    residual[layout.node(k) + i] += self.radau.slopes[j][0] * y;
                    for l in 0..POINTS {
                        let slope = self.radau.slopes[j][l + 1];
                        defect += slope * self.w[layout.point(k, l) + i];
                        interval.by_states[row * POINTS * n + l * n + i] += slope;
                        residual[layout.point(k, l) + i] += slope * y;
                    }
                    interval.defect[row] = defect;
                    interval.by_time[row] = -h * f;
                    residual[layout.time()] -= h * f * y;
                    for (c, f_x) in all.first.f_x.row(i).iter().enumerate() {
                        interval.by_states[row * POINTS * n + j * n + c] -= h * time * f_x;
                        interval.cross[j * size + c] -= h * y * f_x;
                        residual[at + c] -= h * time * y * f_x;
                    }
                    for (c, f_u) in all.first.f_u.row(i).iter().enumerate() {
                        interval.by_controls[row * m + c] = -h * time * f_u;
                        interval.cross[j * size + n + c] -= h * y * f_u;
                        residual[at + n + c] -= h * time * y * f_u;
                    }
                }
            }
        }
        let last = layout.node(layout.intervals);
        self.fixed.iter().for_each(|&i| residual[last + i] += self.nu[i]);
        // Components that are fixed at the start, and a fixed time, are no unknowns.
        (0..n).filter(|i| !self.free.contains(i)).for_each(|i| residual[i] = 0.0);
        if !self.free.contains(&n) {
            residual[layout.time()] = 0.0;
        }
        Ok(residual.iter().fold(0.0, |most: f64, value| most.max(value.abs())))
    }

    /// Curvature and force of the barrier of unknown i.
    fn barrier(&self, i: usize) -> (f64, f64) {
        let (mut curvature, mut force) = (0.0, 0.0);
        if self.low[i].is_finite() {
            let slack = self.w[i] - self.low[i];
            curvature += self.z_low[i] / slack;
            force -= self.mu / slack;
        }
        if self.high[i].is_finite() {
            let slack = self.high[i] - self.w[i];
            curvature += self.z_high[i] / slack;
            force += self.mu / slack;
        }
        (curvature, force)
    }

    /// Error of stationarity, defects and complementarity, by the size of the multipliers.
    fn error(&self, mu: f64, [stationarity, theta, size]: [f64; 3]) -> f64 {
        let mut most = (stationarity / size).max(theta);
        for i in 0..self.w.len() {
            let slacks = [self.w[i] - self.low[i], self.high[i] - self.w[i]];
            for (z, slack) in [self.z_low[i], self.z_high[i]].into_iter().zip(slacks) {
                if slack.is_finite() {
                    most = most.max((z * slack - mu).abs() / size);
                }
            }
        }
        most
    }

    /// Solves Newton's equations. The step of w, new multipliers of the defects and of the end.
    fn step<D, C>(&mut self, task: &DirectDynamics<D, C>) -> Option<[Vec<f64>; 3]> {
        let layout = self.layout;
        let Layout { n, m, .. } = layout;
        let (size, z) = (n + m, n + 1);
        for k in 0..layout.intervals {
            for j in 0..POINTS {
                for i in 0..size {
                    let (curvature, force) = self.barrier(layout.point(k, j) + i);
                    self.intervals[k].hessian[(j * size + i) * size + i] += curvature;
                    self.intervals[k].gradient[j * size + i] += force;
                }
            }
        }
        let last = layout.node(layout.intervals);
        let mut damping = 0.0;
        let first = loop {
            let (p, p_1) =
                (&mut self.recursion.p[layout.intervals], &mut self.recursion.p_1[layout.intervals]);
            p.fill(0.0);
            p_1.fill(0.0);
            for &i in &self.fixed {
                p[i * z + i] = END_WEIGHT;
                p_1[i] = self.nu[i] + END_WEIGHT * (self.w[last + i] - task.problem.end.x[i]);
            }
            let condensed =
                self.intervals.iter_mut().all(|interval| interval.condense(&layout, &self.radau, damping));
            if condensed && self.recursion.backward(&layout, &self.intervals) {
                for &i in &self.free {
                    let at = if i == n { layout.time() } else { i };
                    let (curvature, force) = self.barrier(at);
                    self.recursion.p[0][i * z + i] += curvature + damping;
                    self.recursion.p_1[0][i] += force + if i == n { task.problem.cost.time } else { 0.0 };
                }
                if let Some(step) = self.recursion.first(&self.free, z) {
                    break step;
                }
            }
            damping = if damping == 0.0 { (self.damping / 3.0).max(1e-6) } else { 8.0 * damping };
            if damping > MOST_DAMPING {
                return None;
            }
        };
        self.definite = damping == 0.0;
        if damping > 0.0 {
            self.damping = damping;
        }
        let mut step = vec![0.0; layout.count()];
        let mut lambda = vec![0.0; self.lambda.len()];
        step[..n].copy_from_slice(&first[..n]);
        step[layout.time()] = first[n];
        let (mut y, mut after) = (vec![0.0; z + POINTS * m], vec![0.0; n]);
        let mut state = first;
        for k in 0..layout.intervals {
            y[..z].copy_from_slice(&state);
            self.recursion.controls(k, &mut y, z);
            let range = layout.point(k, 0)..layout.point(k + 1, 0);
            self.intervals[k].expand(&layout, &y, &mut step[range.clone()]);
            state[..n].copy_from_slice(&step[layout.node(k + 1)..][..n]);
            self.recursion.gradient(k + 1, &state, &mut after);
            let out = &mut lambda[k * POINTS * n..(k + 1) * POINTS * n];
            self.intervals[k].multipliers(&layout, &step[range], state[n], damping, &after, out);
        }
        let mut nu = vec![0.0; n];
        for &i in &self.fixed {
            nu[i] = after[i];
        }
        Some([step, lambda, nu])
    }

    /// Iterates until the error of the barrier problem is below the tolerance.
    pub fn solve<D: Dynamics<f64>, C: Cost<f64>>(
        &mut self,
        task: &mut DirectDynamics<D, C>,
        tolerance: f64,
        most: usize,
        deadline: Option<Instant>,
    ) -> Result<(), Status> {
        let failed = |error: EvalError| Status::EvaluationFailed(error.into());
        let mut now = self.figure(task, &self.w.clone()).map_err(failed)?;
        let mut failures = 0;
        for _ in 0..most {
            if deadline.is_some_and(|deadline| Instant::now() >= deadline) {
                return Err(Status::TimeLimit);
            }
            let stationarity = self.linearise(task).map_err(failed)?;
            (self.cost, self.theta) = (now.cost, now.theta);
            let size = self.lambda.iter().fold(1.0, |most: f64, y| most.max(0.01 * y.abs()));
            let theta = now.theta;
            if self.error(0.0, [stationarity, theta, size]) <= tolerance && self.iterations > 0 {
                return Ok(());
            }
            while self.error(self.mu, [stationarity, theta, size]) <= 10.0 * self.mu
                && self.mu > 0.1 * tolerance
            {
                self.mu = (0.2 * self.mu).min(self.mu.powf(1.5)).max(0.1 * tolerance);
                self.filter.clear();
            }
            let Some([step, lambda, nu]) = self.step(task) else { return Err(Status::Singular) };
            self.iterations += 1;
            let boundary = (1.0 - self.mu).max(0.99);
            let (mut alpha, mut dual, mut slope) = (1.0_f64, 1.0_f64, 0.0);
            let (mut dz_low, mut dz_high) = (vec![0.0; step.len()], vec![0.0; step.len()]);
            for i in 0..step.len() {
                let (_, force) = self.barrier(i);
                slope += force * step[i];
                if self.low[i].is_finite() {
                    let slack = self.w[i] - self.low[i];
                    dz_low[i] = (self.mu - self.z_low[i] * step[i]) / slack - self.z_low[i];
                    if step[i] < 0.0 {
                        alpha = alpha.min(-boundary * slack / step[i]);
                    }
                    if dz_low[i] < 0.0 {
                        dual = dual.min(-boundary * self.z_low[i] / dz_low[i]);
                    }
                }
                if self.high[i].is_finite() {
                    let slack = self.high[i] - self.w[i];
                    dz_high[i] = (self.mu + self.z_high[i] * step[i]) / slack - self.z_high[i];
                    if step[i] > 0.0 {
                        alpha = alpha.min(boundary * slack / step[i]);
                    }
                    if dz_high[i] < 0.0 {
                        dual = dual.min(-boundary * self.z_high[i] / dz_high[i]);
                    }
                }
            }
            // The gradient of the points has that of the barrier already.
            slope = self.slope(task, &step, slope);
            let (whole, rounding) = (alpha, 1e-12 * now.value(self.mu).abs().max(1.0));
            let mut trial = self.w.clone();
            let taken = loop {
                for ((trial, w), step) in trial.iter_mut().zip(&self.w).zip(&step) {
                    *trial = w + alpha * step;
                }
                if let Ok(new) = self.figure(task, &trial) {
                    let (value, old) = (new.value(self.mu), now.value(self.mu));
                    let descends =
                        slope < 0.0 && now.theta < 1e-4 && alpha * (-slope).powf(2.3) > now.theta.powf(1.1);
                    let negligible = new.theta <= 1e-11 && now.theta <= 1e-11;
                    let fine = if descends || negligible {
                        value <= old + 1e-4 * alpha * slope.min(0.0) + rounding
                    } else {
                        is_better(&new, &now, self.mu, rounding)
                    };
                    if value.is_finite() && fine && self.filter.accepts(&new, self.mu, rounding) {
                        if !descends {
                            self.filter.add(now);
                        }
                        break Some(new);
                    }
                }
                alpha *= 0.5;
                if alpha < 1e-8 * whole {
                    break None;
                }
            };
            let Some(new) = taken else {
                failures += 1;
                if self.error(0.0, [stationarity, theta, size]) <= 100.0 * tolerance {
                    return Ok(());
                }
                if failures > 5 {
                    return Err(Status::NewtonFailed);
                }
                // Multipliers far off curve the model wrongly: begin them anew.
                self.filter.clear();
                self.lambda.fill(0.0);
                self.nu.fill(0.0);
                self.mu = (10.0 * self.mu).min(BARRIER);
                continue;
            };
            now = new;
            self.w = trial;
            self.lambda.iter_mut().zip(&lambda).for_each(|(old, new)| *old += alpha * (new - *old));
            self.nu.iter_mut().zip(&nu).for_each(|(old, new)| *old += alpha * (new - *old));
            for i in 0..step.len() {
                // Within a factor of mu / slack, as Waechter and Biegler, equation 16.
                for (z, dz, slack) in [
                    (&mut self.z_low[i], dz_low[i], self.w[i] - self.low[i]),
                    (&mut self.z_high[i], dz_high[i], self.high[i] - self.w[i]),
                ] {
                    if slack.is_finite() {
                        let centre = self.mu / slack;
                        *z = (*z + dual * dz).clamp(1e-10 * centre, 1e10 * centre);
                    }
                }
            }
        }
        Err(Status::IterationLimit)
    }

    /// Slope of cost and barrier along a step, by that of the barrier.
    fn slope<D, C>(&self, task: &DirectDynamics<D, C>, step: &[f64], barrier: f64) -> f64 {
        let Layout { n, m, .. } = self.layout;
        let mut slope = barrier + task.problem.cost.time * step[self.layout.time()];
        for (k, interval) in self.intervals.iter().enumerate() {
            slope += interval.gradient_t * step[self.layout.time()];
            let first = self.layout.point(k, 0);
            for (i, gradient) in interval.gradient.iter().enumerate() {
                let (_, force) = self.barrier(first + i);
                slope += (gradient - force) * step[first + i];
            }
            debug_assert_eq!(interval.gradient.len(), POINTS * (n + m));
        }
        slope
    }
}
