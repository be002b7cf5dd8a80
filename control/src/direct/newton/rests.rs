//! Newton's equations of the rest of a motion behind each node, from the last one on.
//!
//! The rest of a motion behind node k is an optimal motion of its own: its start, all of the state at the
//! node, is given, and so are the times that are over. Its equations hold the intervals behind the node,
//! limits at later nodes and rows at later ends. So they are assembled from the end on, and what is behind a
//! node is eliminated when the next interval is added ([`ChainEnd`]).

use super::system::System;
use crate::direct::limits::barrier::Barrier;
use crate::direct::limits::ends::Ends;
use crate::direct::motion::spline::Spline;
use crate::direct::motion::times::FreeTimes;
use crate::direct::points::running::Running;
use crate::direct::points::values::Points;
use crate::numerics::chain_end::ChainEnd;
use crate::numerics::cholesky;
use crate::numerics::lu::eliminate;

/// The rest of a motion behind a node.
#[derive(Clone, Debug)]
pub(crate) struct Rest {
    end: ChainEnd,
    /// Second derivatives by the times and the delay.
    corner: Vec<f64>,
    /// Unknowns of the node, times and delay by the state at the node and the parameters of times, row by
    /// row.
    kept: Vec<f64>,
    /// Second derivatives of the least cost by state and parameters.
    hessian: Vec<f64>,
    /// Parameters by the state, as the elimination leaves them: `[S_pp S_px]`.
    parameters: Vec<f64>,
    exchanges: Vec<usize>,
    column: Vec<f64>,
    /// For each phase the times that are free behind its start.
    times: Vec<FreeTimes>,
    /// Whether the rest is a strict minimum in its times.
    pub is_minimum: bool,
}

impl Rest {
    /// Room for the rests of a motion.
    pub fn new(spline: &Spline, ends: &Ends) -> Self {
        let (node, phases) = (spline.node(), spline.mesh.phases());
        let inner = spline.mesh.shape.inner() * spline.dof;
        let kept = node + phases + 1;
        // A phase has one parameter at most.
        let free = node + phases;
        Self {
            end: ChainEnd::new(node, inner, phases + 1),
            corner: vec![0.0; (phases + 1) * (phases + 1)],
            kept: vec![0.0; kept * free],
            hessian: vec![0.0; free * free],
            parameters: vec![0.0; phases * free],
            exchanges: vec![0; phases],
            column: vec![0.0; kept],
            times: (0..phases).map(|phase| ends.times.after(phase)).collect(),
            is_minimum: true,
        }
    }

    /// Whether there is room for the rests of this motion.
    pub fn fits(&self, spline: &Spline) -> bool {
        let phases = spline.mesh.phases();
        self.times.len() == phases && self.column.len() == spline.node() + phases + 1
    }

    /// Number of the parameters of times that are free behind a phase.
    pub fn parameters(&self, phase: usize) -> usize {
        self.times[phase].count()
    }

    /// Second derivatives of the least cost by the state (q, v, with continuous accelerations a) at the node,
    /// of m entries, row by row; times follow.
    pub fn cost_hessian(&self, m: usize, i: usize, j: usize) -> f64 {
        self.hessian[m * i + j]
    }

    /// How the next interval changes with entry `j` of the state at node `k`: its inner unknowns, then those
    /// of its nodes, and the time of its phase.
    pub fn respond(&mut self, k: usize, j: usize, spline: &Spline, step: &mut Vec<f64>) -> f64 {
        let (m, phase) = (spline.node(), spline.mesh.phase(k));
        let free = self.parameters(phase);
        let width = m + free;
        for (to, row) in self.column.iter_mut().zip(self.kept.chunks_exact(width)) {
            let by_parameters = row[m..].iter().enumerate();
            let sum: f64 =
                by_parameters.map(|(i, entry)| entry * self.parameters[width * i + free + j]).sum();
            *to = row[j] - sum;
        }
        let inner = spline.mesh.shape.inner() * spline.dof;
        let found = self.end.respond(&self.column);
        let [next, own] = [inner, inner + m].map(|first| &found[first..first + m]);
        step.clear();
        step.extend_from_slice(&found[..inner]);
        step.extend_from_slice(own);
        step.extend_from_slice(next);
        self.column[m + phase]
    }
}

impl System {
    /// Begins the rests of a motion, with what its end adds.
    pub(crate) fn begin_rests(
        &mut self,
        (spline, points, barrier): (&Spline, &Points, &Barrier),
        running: &mut Running,
        rest: &mut Rest,
    ) {
        self.begin(spline, running);
        self.is_rest = true;
        rest.end.begin();
        self.add_end_of_interval(spline.mesh.intervals(), spline, points, barrier);
    }

    /// Adds a node, and an end of a phase there.
    fn add_end_of_interval(&mut self, node: usize, spline: &Spline, points: &Points, barrier: &Barrier) {
        self.add_node(node, spline, barrier);
        if let Some(end) = spline.mesh.end_at(node) {
            self.add_ends(spline, points, barrier, |other| other == end);
        }
    }

    /// Adds interval k to the rest behind it, which becomes that behind node k. Whether its equations are
    /// positive definite.
    pub(crate) fn add_to_rest(
        &mut self,
        k: usize,
        (spline, points, barrier): (&Spline, &Points, &Barrier),
        running: &mut Running,
        ends: &Ends,
        rest: &mut Rest,
    ) -> bool {
        if k + 1 < spline.mesh.intervals() {
            self.add_end_of_interval(k + 1, spline, points, barrier);
        }
        let (first, own) = (spline.mesh.first_point(k), spline.mesh.own_points(k));
        for p in first..first + own {
            self.add_point(p, spline, points, barrier, running);
        }
        self.add_panels(k..k + 1, spline, running);
        self.add_rates(k..k + 1, spline, points);
        self.add_hulls(k..k + 1, spline, points, barrier);
        let phases = spline.mesh.phases();
        let (by_times, count) = (&self.by_times, phases + 1);
        for (to, from) in rest.corner.chunks_exact_mut(count).zip(by_times.second.chunks_exact(phases)) {
            to[..phases].copy_from_slice(from);
        }
        for (i, &entry) in by_times.delay[1].iter().enumerate() {
            (rest.corner[count * i + phases], rest.corner[count * phases + i]) = (entry, entry);
        }
        let column = |j: usize| by_times.columns.get(j).unwrap_or(&by_times.delay[0]).as_slice();
        let end = spline.mesh.end_at(k + 1);
        let is_last = k + 1 == spline.mesh.intervals();
        // The end of a periodic motion is where it is.
        let removed = |i: usize| match end {
            Some(end) => ends.given[end][i] || (is_last && ends.is_periodic),
            None => false,
        };
        let is_positive = rest.end.take(k, &self.matrix, column, &rest.corner, removed).is_ok();
        rest.is_minimum = is_positive && self.free_times(k, spline, rest);
        is_positive
    }

    /// From unknowns of node k and times to the state there and the times that are free. Inside of a phase
    /// the unknowns are derivatives in s, T^m times those in time. What is left of the time of the phase is
    /// free, the part 1 - x of T behind the part x; and a longer T begins before the node by x dT, which is a
    /// delay of
    /// -x dT.
    fn free_times(&self, k: usize, spline: &Spline, rest: &mut Rest) -> bool {
        let (n, m, phase) = (spline.dof, spline.node(), spline.mesh.phase(k));
        let (phases, free) = (spline.mesh.phases(), rest.parameters(phase));
        let (width, count) = (m + free, m + phases + 1);
        let part = spline.mesh.nodes[k] - phase as f64;
        let times = &rest.times[phase];
        let factor =
            |other: usize, j: usize| times.factor(other, j) / if other == phase { 1.0 - part } else { 1.0 };
        let (clock, unknowns) = (spline.clock(k), &spline.unknowns[m * k..m * (k + 1)]);
        rest.kept.fill(0.0);
        for (i, unknown) in unknowns.iter().enumerate() {
            let order = (i / n) as i32;
            let inside = !spline.mesh.is_end(k);
            rest.kept[width * i + i] = if inside { clock.powi(order) } else { 1.0 };
            for j in 0..if inside { free } else { 0 } {
                rest.kept[width * i + m + j] = f64::from(order) * unknown / clock * factor(phase, j);
            }
        }
        for j in 0..free {
            for other in phase..phases {
                rest.kept[width * (m + other) + m + j] = factor(other, j);
            }
            rest.kept[width * (m + phases) + m + j] = -part * factor(phase, j);
        }
        let schur = rest.end.schur();
        for b in 0..width {
            for (i, to) in rest.column.iter_mut().enumerate() {
                let entries = rest.kept.iter().skip(b).step_by(width);
                *to = schur[count * i..count * (i + 1)].iter().zip(entries).map(|(s, x)| s * x).sum();
            }
            for a in 0..width {
                let entries = rest.kept.iter().skip(a).step_by(width);
                rest.hessian[width * a + b] = rest.column.iter().zip(entries).map(|(s, x)| s * x).sum();
            }
        }
        // The gradient by derivatives in s times their own second derivative, by a derivative in time and T.
        if !spline.mesh.is_end(k) {
            for i in n..m.min(2 * n) {
                for j in 0..free {
                    let mixed = self.at_ends.gradient[m * k + i] * factor(phase, j);
                    rest.hessian[width * i + m + j] += mixed;
                    rest.hessian[width * (m + j) + i] += mixed;
                }
            }
        }
        let Rest { parameters, hessian, exchanges, .. } = rest;
        for (i, row) in parameters.chunks_exact_mut(width).take(free).enumerate() {
            let from = &hessian[width * (m + i)..width * (m + i + 1)];
            row[..free].copy_from_slice(&from[m..]);
            row[free..].copy_from_slice(&from[..m]);
        }
        // The times of a minimum have a positive definite block, whose rows of `hessian` are free now.
        let block = &mut hessian[width * m..][..free * free];
        for (to, from) in block.chunks_exact_mut(free.max(1)).zip(parameters.chunks_exact(width)) {
            to.copy_from_slice(&from[..free]);
        }
        let is_minimum = cholesky::factorise(block, free);
        if free > 0 && !(is_minimum && solve(&mut parameters[..width * free], width, free, exchanges)) {
            return false;
        }
        // Those by the state alone, one after the other at the front.
        for i in 0..m {
            for j in 0..m {
                let times: f64 =
                    (0..free).map(|l| hessian[width * i + m + l] * parameters[width * l + free + j]).sum();
                hessian[m * i + j] = hessian[width * i + j] - times;
            }
        }
        true
    }
}

/// Turns `[A B]` into `[.. A^-1 B]`, with `columns` of A. False if A is singular.
fn solve(rows: &mut [f64], width: usize, columns: usize, exchanges: &mut [usize]) -> bool {
    if !eliminate(rows, width, columns, exchanges) {
        return false;
    }
    for c in columns..width {
        for i in (0..columns).rev() {
            let known: f64 = (i + 1..columns).map(|l| rows[width * i + l] * rows[width * l + c]).sum();
            rows[width * i + c] = (rows[width * i + c] - known) / rows[width * i + i];
        }
    }
    true
}
