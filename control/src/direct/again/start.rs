//! A solved motion as the start of the next problem: other ends, later times.

use crate::constants::direct as constants;
use crate::direct::interior::iterate::Interior;
use crate::direct::limits::entries::complementarity;
use crate::direct::motion::spline::Spline;
use crate::direct::points::values::PointDynamics;
use costate::EvalError;

/// Room for a warm start.
#[derive(Clone, Debug, Default)]
pub(crate) struct Again {
    /// How far the states at both ends are off.
    changes: [Vec<f64>; 2],
    /// q, dq/ds of the middle of an interval, and z there.
    z: Vec<f64>,
    /// Multipliers at other times.
    multipliers: Vec<f64>,
}

impl Again {
    /// For n joints.
    pub fn new(n: usize) -> Self {
        let zeros = |count: usize| vec![0.0; count];
        Self { changes: [zeros(2 * n), zeros(2 * n)], z: zeros(3 * n), multipliers: Vec::new() }
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

    /// Takes the motion to other states at its ends (those of what is free do not count), along the optimal
    /// motions nearby if the equations are factorised, and puts slacks and multipliers near the central path
    /// at the barrier where it stands; farther from it where limits are exceeded.
    pub fn follow(&mut self, states: [&[f64]; 2], predict: bool, again: &mut Again) -> Result<(), EvalError> {
        let n = self.spline.dof;
        for (end, state) in states.into_iter().enumerate() {
            let change = &mut again.changes[end];
            self.spline.end(end, change);
            for (i, change) in change.iter_mut().enumerate() {
                let given = self.ends.given[end][i];
                *change = if given { state[i] - *change } else { 0.0 };
            }
        }
        let (gap, size) = (self.figures.gap, self.figures.size);
        let count = self.barrier.count();
        self.changes[0].resize(count, 0.0);
        self.changes[0].fill(0.0);
        if predict {
            let changes = again.changes.each_ref().map(|change| &change[..]);
            let dt = self.respond(changes);
            let time = self.spline.times[0];
            if time + dt > constants::SHORTEST_TIME * time {
                self.change_distances(0);
                self.spline.unknowns.iter_mut().zip(&self.steps[0]).for_each(|(x, dx)| *x += dx);
                self.spline.times[0] += dt;
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
            let near = [central / constants::OFF_CENTRE_AGAIN, constants::OFF_CENTRE_AGAIN * central];
            self.barrier.multiplier[at] = self.barrier.multiplier[at].clamp(near[0], near[1]);
        }
        self.figures.gap = complementarity(&self.barrier, None);
        debug_assert_eq!(
            self.spline.unknowns.len(),
            Spline::size(n, self.spline.mesh.intervals(), self.spline.mesh.shape)
        );
        Ok(())
    }

    /// Puts the given states into the unknowns.
    pub fn put_ends(&mut self, states: [&[f64]; 2]) {
        for (end, state) in states.into_iter().enumerate() {
            let place = self.spline.end_unknowns(end);
            let unknowns = self.spline.unknowns[place].iter_mut().zip(state);
            for ((unknown, value), _) in unknowns.zip(&self.ends.given[end]).filter(|(_, given)| **given) {
                *unknown = *value;
            }
        }
    }

    /// Begins the motion later by `dt` (s). With a free time the rest remains; with a fixed one the motion
    /// goes on beyond its end at the rates there, and the mesh moves by whole intervals: between the nodes of
    /// a coarse mesh another spline has other accelerations, which cost more than what a part of an interval
    /// gains. On a mesh whose intervals are not equal it moves by dt.
    pub fn shift(&mut self, dt: f64, again: &mut Again) {
        let (n, time) = (self.spline.dof, self.spline.duration());
        let intervals = self.spline.mesh.intervals() as f64;
        let width = self.spline.mesh.width(0);
        let equal =
            (0..self.spline.mesh.intervals()).all(|k| (self.spline.mesh.width(k) / width - 1.0).abs() < 1e-6);
        let whole = if equal { (dt / time * intervals).round() / intervals } else { dt / time };
        if whole == 0.0 {
            return;
        }
        let (first, rest) = if self.ends.times.count() > 0 {
            let first = (dt / time).min(constants::LATEST);
            (first, 1.0 - first)
        } else {
            (whole, 1.0)
        };
        let (old, new) = (&self.spline, &mut self.trial.spline);
        new.copy_from(old);
        new.times.iter_mut().for_each(|time| *time *= rest);
        let nodes = &old.mesh.nodes;
        let place = |s: f64| first + rest * s;
        for (k, &s) in nodes.iter().enumerate() {
            let state = &mut new.unknowns[2 * n * k..2 * n * (k + 1)];
            beyond(old, place(s), rest, &mut again.z);
            state.copy_from_slice(&again.z[..2 * n]);
            if old.mesh.is_end(k) {
                // The time becomes shorter by the same factor.
                state[n..].iter_mut().for_each(|rate| *rate /= rest * time);
            }
        }
        for k in 0..old.mesh.intervals() {
            let h = old.mesh.width(k);
            let bubble = 2 * n * nodes.len() + n * k;
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

    /// Multipliers of limits over their weights, linear between points, at later places.
    fn shift_multipliers(&mut self, place: impl Fn(f64) -> f64, again: &mut Again) {
        let (barrier, mesh) = (&self.barrier, &self.spline.mesh);
        let (points, nodes) = (mesh.points(), mesh.nodes.len());
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
        let mut right = 0;
        for p in 0..points {
            let s = place(mesh.point(p).0);
            while right + 1 < points && mesh.point(right).0 < s {
                right += 1;
            }
            let left = right.saturating_sub(1);
            for (i, at) in barrier.at_point(p).enumerate() {
                let of = |p: usize| (barrier.at_point(p).start + i, mesh.point(p).0);
                fill(at, [of(left), of(right)], s);
            }
        }
        let mut right = 0;
        for k in 0..nodes {
            let s = place(mesh.nodes[k]);
            while right + 1 < nodes && mesh.nodes[right] < s {
                right += 1;
            }
            let left = right.saturating_sub(1);
            for (i, at) in barrier.at_node(k).enumerate() {
                let of = |k: usize| (barrier.at_node(k).start + i, mesh.nodes[k]);
                fill(at, [of(left), of(right)], s);
            }
        }
        std::mem::swap(&mut self.barrier.multiplier, &mut again.multipliers);
    }
}

/// q and dq/ds, times `scale`, at a place of a motion that goes on at the rates of its end.
fn beyond(spline: &Spline, s: f64, scale: f64, z: &mut [f64]) {
    let n = spline.dof;
    let (k, x) = spline.mesh.place(s.min(1.0));
    spline.in_parts(k, x, z);
    let (q, rates) = z.split_at_mut(n);
    for (q, rate) in q.iter_mut().zip(rates) {
        *q += (s - 1.0).max(0.0) * *rate;
        *rate *= scale;
    }
}
