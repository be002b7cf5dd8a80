//! Newton's equations of the rest of a motion behind each node, from the last one on.
//!
//! The rest of a motion behind node k is an optimal motion of its own: its start, all of the state at the
//! node, is given, and so are the times that are over. Its equations hold the intervals behind the node,
//! limits at later nodes and rows at later ends. So they are assembled from the end on, and what is behind a
//! node is eliminated when the next interval is added ([`ChainEnd`]).

use super::point_terms::Gradients;
use super::system::System;
use crate::direct::limits::barrier::Barrier;
use crate::direct::limits::ends::Ends;
use crate::direct::motion::spline::Spline;
use crate::direct::motion::times::FreeTimes;
use crate::direct::points::running::Running;
use crate::direct::points::values::Points;
use crate::numerics::chain_end::ChainEnd;
use crate::numerics::cholesky;

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
    /// Minus the derivatives of the parameters by the state, `S_pp^-1 S_px`, column by column.
    parameters: Vec<f64>,
    column: Vec<f64>,
    /// For each phase the times that are free behind its start.
    times: Vec<FreeTimes>,
    /// Whether the rest is a strict minimum in its times.
    pub is_minimum: bool,
    /// What the motion takes as differences while its rests are computed ([`Spline::differences`]).
    pub differences: Vec<[bool; 3]>,
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
            parameters: vec![0.0; phases * node],
            column: vec![0.0; kept],
            times: (0..phases).map(|phase| ends.times.after(phase)).collect(),
            is_minimum: true,
            differences: Vec::with_capacity(spline.mesh.nodes.len()),
        }
    }

    /// Whether there is room for the rests of this motion.
    pub fn fits(&self, spline: &Spline) -> bool {
        let phases = spline.mesh.phases();
        self.times.len() == phases && self.column.len() == spline.node() + phases + 1
    }

    /// Chooses what is taken as differences: all unknowns of nodes inside of phases, and those of vias whose
    /// order is given for no joint. None where a time is free: what depends on it has unknowns.
    ///
    /// Intervals on an arc at a limit are stiffer than the rest of the motion, by h^-4 and more for
    /// accelerations where jerks cost. In unknowns the entries of a motion along which the highest derivative
    /// is constant cancel, and what the rest costs is lost to their rounding.
    pub fn choose_differences(&mut self, spline: &Spline, ends: &Ends) {
        self.differences.clear();
        if self.times.iter().any(|times| times.count() > 0) {
            return;
        }
        let (n, mesh, last) = (spline.dof, &spline.mesh, spline.mesh.intervals());
        let is_given = |order: usize, end: usize| {
            let mut own = ends.given[end].iter().skip(n * order).take(n);
            own.any(|is_given| *is_given)
        };
        let of_node = |k: usize| {
            let is_inside = k > 0 && k < last;
            [0, 1, 2].map(|order| is_inside && mesh.end_at(k).is_none_or(|end| !is_given(order, end)))
        };
        self.differences.extend((0..=last).map(of_node));
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
    /// of its nodes, or differences at the right one, and the time of its phase.
    pub fn respond(&mut self, k: usize, j: usize, spline: &Spline, step: &mut Vec<f64>) -> f64 {
        let (m, phase) = (spline.node(), spline.mesh.phase(k));
        let free = self.parameters(phase);
        let width = m + free;
        for (to, row) in self.column.iter_mut().zip(self.kept.chunks_exact(width)) {
            let by_state = &self.parameters[free * j..free * (j + 1)];
            let sum: f64 = row[m..].iter().zip(by_state).map(|(entry, change)| entry * change).sum();
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
        self.gradients = Gradients::All;
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
        rest.end.take_next(k, &self.matrix);
        let (first, own) = (spline.mesh.first_point(k), spline.mesh.own_points(k));
        for p in first..first + own {
            self.add_point(p, spline, points, barrier, running);
        }
        self.add_panels(k..k + 1, spline, running);
        self.add_rates(k..k + 1, spline, points);
        self.add_hulls(k..k + 1, spline, points, barrier);
        self.add_touches(k, spline);
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
        let (order, flow) = (spline.mesh.shape.node(), spline.flow(k));
        let flow = flow.as_ref().map(|rows| &rows[..order]);
        let is_positive = rest.end.take(k, &self.matrix, column, &rest.corner, removed, flow).is_ok();
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
        let Rest { parameters, hessian, .. } = rest;
        for j in 0..m {
            (0..free).for_each(|i| parameters[free * j + i] = hessian[width * (m + i) + j]);
        }
        // The rows of the parameters in `hessian` are not needed any more: their block comes to the front.
        let of_parameters = &mut hessian[width * m..];
        for i in 0..free {
            of_parameters.copy_within(width * i + m..width * (i + 1), free * i);
        }
        let block = &mut of_parameters[..free * free];
        // The times of a minimum have a positive definite block.
        if !cholesky::factorise(block, free) {
            return false;
        }
        for column in parameters[..free * m].chunks_exact_mut(free.max(1)) {
            cholesky::solve(block, free, column);
        }
        // Those by the state alone, one after the other at the front.
        for i in 0..m {
            for j in 0..m {
                let by_parameters = hessian[width * i + m..width * (i + 1)].iter();
                let changes = &parameters[free * j..free * (j + 1)];
                let times: f64 = by_parameters.zip(changes).map(|(entry, change)| entry * change).sum();
                hessian[m * i + j] = hessian[width * i + j] - times;
            }
        }
        true
    }
}
