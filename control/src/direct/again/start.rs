//! A solved motion as the start of the next problem: other ends, later times.

use crate::constants::direct as constants;
use crate::direct::interior::iterate::Interior;
use crate::direct::limits::entries::complementarity;
use crate::direct::motion::shape::POINTS;
use crate::direct::motion::spline::Spline;
use crate::direct::points::values::PointDynamics;
use costate::EvalError;
use std::ops::Range;

/// Room for a warm start.
#[derive(Clone, Debug, Default)]
pub(crate) struct Again {
    /// How far the unknowns at each end of a phase are off.
    changes: Vec<Vec<f64>>,
    /// q and its first two derivatives in s at a place.
    z: Vec<f64>,
    /// Multipliers at other times.
    multipliers: Vec<f64>,
}

impl Again {
    /// For n joints and the unknowns at these ends of phases.
    pub fn new(n: usize, ends: &[Vec<f64>]) -> Self {
        Self { changes: ends.to_vec(), z: vec![0.0; 3 * n], multipliers: Vec::new() }
    }
}

impl<D: PointDynamics> Interior<D> {
    /// Makes room for what the first solve may not need and a later one does: damping, entries of the filter,
    /// multipliers of warm starts and of later times.
    pub fn reserve(&mut self, again: &mut Again) {
        self.filter.reserve();
        self.system.reserve_damping(self.spline.mesh.intervals());
        self.multipliers.fill(&self.spline, &self.barrier);
        again.multipliers.clone_from(&self.barrier.multiplier);
        self.trial.spline.copy_from(&self.spline);
    }

    /// Takes the motion to other unknowns at the ends of its phases (those that are free do not count), along
    /// the optimal motions nearby if the equations are factorised, and puts slacks and multipliers near the
    /// central path at the barrier where it stands; farther from it where limits are exceeded.
    pub fn follow(&mut self, states: &[Vec<f64>], predict: bool, again: &mut Again) -> Result<(), EvalError> {
        for (end, (state, change)) in states.iter().zip(&mut again.changes).enumerate() {
            let now = &self.spline.unknowns[self.spline.end_unknowns(end)];
            for (i, change) in change.iter_mut().enumerate() {
                *change = if self.ends.given[end][i] { state[i] - now[i] } else { 0.0 };
            }
        }
        let (gap, size) = (self.figures.gap, self.figures.size);
        let count = self.barrier.count();
        self.changes[0].resize(count, 0.0);
        self.changes[0].fill(0.0);
        if predict {
            self.respond(&again.changes);
            let mut times = self.spline.times.iter().zip(&self.time_steps[0]);
            if times.all(|(time, dt)| time + dt > constants::SHORTEST_TIME * time) {
                self.change_distances(0);
                self.spline.unknowns.iter_mut().zip(&self.steps[0]).for_each(|(x, dx)| *x += dx);
                self.spline.times.iter_mut().zip(&self.time_steps[0]).for_each(|(time, dt)| *time += dt);
            }
        }
        self.put_ends(states);
        let multipliers = self.barrier.multiplier.iter_mut().zip(&self.barrier.slack);
        for ((multiplier, &slack), change) in multipliers.zip(&self.changes[0]) {
            if slack > 0.0 && slack.is_finite() {
                *multiplier *= (1.0 - change / slack).max(constants::KEPT);
            }
        }
        self.evaluate()?;
        self.measure_figures();
        let total = self.barrier.total_weight().max(f64::MIN_POSITIVE);
        let rough = self.figures.violation.min(1.0);
        self.mu = gap.max(rough * size) / total;
        for at in 0..count {
            if !self.barrier.is_limit(at) {
                continue;
            }
            let least = self.barrier.slack[at].min(constants::LEAST_SLACK / self.barrier.unit[at]);
            let slack = self.barrier.distance[at].max(least);
            let central = self.mu * self.barrier.weight[at] / slack;
            self.barrier.slack[at] = slack;
            let near = [central / constants::OFF_CENTRE, constants::OFF_CENTRE * central];
            self.barrier.multiplier[at] = self.barrier.multiplier[at].clamp(near[0], near[1]);
        }
        self.figures.gap = complementarity(&self.barrier, None);
        Ok(())
    }

    /// Puts what is given at the ends of phases into the unknowns.
    pub fn put_ends(&mut self, states: &[Vec<f64>]) {
        for (end, state) in states.iter().enumerate() {
            let place = self.spline.end_unknowns(end);
            let unknowns = self.spline.unknowns[place].iter_mut().zip(state);
            for ((unknown, value), _) in unknowns.zip(&self.ends.given[end]).filter(|(_, given)| **given) {
                *unknown = *value;
            }
        }
    }

    /// Begins the motion later by `dt` (s). With vias the first phase becomes shorter, up to a part of it;
    /// what follows stays. Otherwise with a free time the rest remains; with a fixed one the motion goes on
    /// beyond its end at the rates there, and the mesh moves by whole intervals: between the nodes of a
    /// coarse mesh another spline has other accelerations, which cost more than what a part of an interval
    /// gains. On a mesh whose intervals are not equal it moves by dt. A periodic motion stays.
    pub fn shift(&mut self, dt: f64, again: &mut Again) {
        if self.ends.is_periodic {
            return;
        }
        let (n, time) = (self.spline.dof, self.spline.times[0]);
        let node = self.spline.node();
        let is_rest = self.ends.times.count() > 0 || self.spline.mesh.phases() > 1;
        let (first, rest) = if is_rest {
            let first = (dt / time).min(constants::LATEST);
            (first, 1.0 - first)
        } else {
            let intervals = self.spline.mesh.intervals() as f64;
            let width = self.spline.mesh.width(0);
            let equal = (0..self.spline.mesh.intervals())
                .all(|k| (self.spline.mesh.width(k) / width - 1.0).abs() < 1e-6);
            (if equal { (dt / time * intervals).round() / intervals } else { dt / time }, 1.0)
        };
        if first == 0.0 {
            return;
        }
        let (old, new) = (&self.spline, &mut self.trial.spline);
        new.copy_from(old);
        new.times[0] *= rest;
        let nodes = &old.mesh.nodes;
        let last = old.mesh.ends()[1];
        let place = |s: f64| first + rest * s;
        // The via after the first phase stays.
        let moving = if old.mesh.phases() > 1 { last } else { last + 1 };
        for (k, &s) in nodes.iter().enumerate().take(moving) {
            let state = &mut new.unknowns[node * k..node * (k + 1)];
            beyond(old, place(s), rest, &mut again.z);
            state.copy_from_slice(&again.z[..node]);
            if old.mesh.is_end(k) {
                // The time becomes shorter by the same factor.
                let mut factor = 1.0;
                for derivatives in state.chunks_exact_mut(n).skip(1) {
                    factor /= rest * time;
                    derivatives.iter_mut().for_each(|derivative| *derivative *= factor);
                }
            }
        }
        for k in 0..if old.mesh.shape.inner() > 0 { last } else { 0 } {
            let h = old.mesh.width(k);
            let bubble = node * nodes.len() + n * k;
            new.unknowns[bubble..bubble + n].fill(0.0);
            new.in_parts(k, 0.5, &mut again.z);
            let bubble = &mut new.unknowns[bubble..bubble + n];
            bubble.iter_mut().zip(&again.z).for_each(|(bubble, cubic)| *bubble = -cubic);
            beyond(old, place(nodes[k] + 0.5 * h), rest, &mut again.z);
            bubble.iter_mut().zip(&again.z).for_each(|(bubble, q)| *bubble += q);
        }
        self.shift_multipliers(place, again);
        std::mem::swap(&mut self.spline, &mut self.trial.spline);
    }

    /// Multipliers of the limits of the first phase over their weights, linear between points, at later
    /// places.
    fn shift_multipliers(&mut self, place: impl Fn(f64) -> f64, again: &mut Again) {
        let (barrier, mesh) = (&self.barrier, &self.spline.mesh);
        let last = mesh.ends()[1];
        again.multipliers.clone_from(&barrier.multiplier);
        let mut fill = |at: usize, [(a, s_a), (b, s_b)]: [(usize, f64); 2], s: f64| {
            if !barrier.is_limit(at) {
                return;
            }
            let density = |at: usize| barrier.multiplier[at] / barrier.weight[at];
            let part = if s_b > s_a { ((s - s_a) / (s_b - s_a)).clamp(0.0, 1.0) } else { 0.0 };
            // What is given at an end has no multiplier there.
            let density = match [a, b].map(|at| barrier.is_limit(at)) {
                [true, true] => (1.0 - part) * density(a) + part * density(b),
                [true, false] => density(a),
                [false, true] => density(b),
                [false, false] => return,
            };
            again.multipliers[at] = barrier.weight[at] * density;
        };
        // So many places in a row, with the entries there.
        let mut shift = |count: usize, of: &dyn Fn(usize) -> (f64, Range<usize>)| {
            let mut right = 0;
            for p in 0..count {
                let (own, entries) = of(p);
                let s = place(own);
                while right + 1 < count && of(right).0 < s {
                    right += 1;
                }
                let beside = [right.saturating_sub(1), right].map(of);
                for (i, at) in entries.enumerate() {
                    fill(at, beside.each_ref().map(|(s, entries)| (entries.start + i, *s)), s);
                }
            }
        };
        shift(mesh.points_of_phase(0).end, &|p| (mesh.point(p).0, barrier.at_point(p)));
        shift(last + 1, &|k| (mesh.nodes[k], barrier.at_node(k)));
        let gauss_points = if mesh.gauss_points() > 0 { POINTS * last } else { 0 };
        shift(gauss_points, &|p| (mesh.gauss_point(p).0, barrier.at_gauss_point(p)));
        std::mem::swap(&mut self.barrier.multiplier, &mut again.multipliers);
    }
}

/// q, dq/ds times `scale` and the second derivative times its square, at a place of the first phase, which
/// goes on at the rates of its end.
fn beyond(spline: &Spline, s: f64, scale: f64, z: &mut [f64]) {
    let n = spline.dof;
    let (k, x) = spline.mesh.place_in(0, s.min(1.0));
    spline.in_parts(k, x, z);
    let (q, rates) = z.split_at_mut(n);
    let (rates, curvatures) = rates.split_at_mut(n);
    for ((q, rate), curvature) in q.iter_mut().zip(rates).zip(curvatures) {
        *q += (s - 1.0).max(0.0) * *rate;
        *rate *= scale;
        *curvature *= if s > 1.0 { 0.0 } else { scale * scale };
    }
}
