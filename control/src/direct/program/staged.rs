//! Values and derivatives of a motion on one mesh, as [`StagedProblem`] wants them.

use super::structure::{Column, Row, Structure};
use crate::direct::limits::at_node::AtNode;
use crate::direct::limits::barrier::Barrier;
use crate::direct::limits::ends::Ends;
use crate::direct::limits::model::Model;
use crate::direct::limits::side::Limited;
use crate::direct::motion::shape::{MOST_COEFFICIENTS, POINTS};
use crate::direct::motion::spline::Spline;
use crate::direct::newton::metric::weigh_torques;
use crate::direct::newton::point_terms::Gradients;
use crate::direct::newton::side_terms::weigh;
use crate::direct::newton::system::System;
use crate::direct::newton::torque_rows::{Order, TorqueRows};
use crate::direct::points::running::Running;
use crate::direct::points::values::{PointDynamics, Points};
use crate::numerics::chain::ChainMatrix;
use costate::EvalError;
use costate_nlp::{Block, Blocks, Dense, Element, Layout, Scales, StagedProblem, Values, Weights};

/// The program of a motion: its functions are those of the bricks that it borrows.
///
/// The entries of a point are the free unknowns of the spline in the order of the nodes, then the parameters
/// of the times and what both ends share. Where the motion goes backward in time, or cannot be evaluated, the
/// functions have no values.
pub(crate) struct Program<'a, D> {
    pub spline: &'a mut Spline,
    pub points: &'a mut Points,
    pub barrier: &'a mut Barrier,
    pub running: &'a mut Running,
    pub model: &'a mut Model<D>,
    pub system: &'a mut System,
    pub ends: &'a Ends,
    pub structure: &'a Structure,
    pub work: &'a mut Work,
}

/// A factor of the cost below this counts as none, and is not divided by.
const LEAST_COST: f64 = 1e-150;

/// Room of a [`Program`].
#[derive(Clone, Debug, Default)]
pub(crate) struct Work {
    /// The point at which the program was made, the spline there, and its changes.
    pub origin: Vec<f64>,
    spline: Spline,
    times: Vec<f64>,
    /// Changes of the shared unknowns since then.
    changes: Vec<f64>,
    /// The point of the last values, and whether it has any.
    last: Vec<f64>,
    has_values: bool,
    /// Weights of torques in the metric, and whether it is that of the last derivatives.
    weights: Vec<f64>,
    has_metric: bool,
    torques: TorqueRows,
}

impl Work {
    /// For the program of a motion, whose entries of the barrier are its rows from now on.
    pub fn new(spline: &Spline, barrier: &mut Barrier, ends: &Ends, structure: &Structure) -> Self {
        barrier.is_apart = true;
        let mut origin: Vec<f64> =
            structure.unknowns.iter().map(|&unknown| spline.unknowns[unknown]).collect();
        origin.extend(ends.times.values(&spline.times));
        origin.extend(ends.tied.iter().map(|tie| spline.unknowns[tie.start]));
        Self {
            origin,
            spline: spline.clone(),
            weights: vec![0.0; spline.dof],
            torques: TorqueRows::new(spline.dof, spline.mesh.shape),
            ..Self::default()
        }
    }
}

impl<D: PointDynamics> Program<'_, D> {
    /// Takes the spline of a point. Whether it goes forward in time.
    fn take(&mut self, point: &[f64]) -> bool {
        let Self { spline, ends, structure, work, .. } = self;
        let Work { origin, spline: first, times, changes, .. } = &mut **work;
        for (&value, &unknown) in point.iter().zip(&structure.unknowns) {
            spline.unknowns[unknown] = value;
        }
        let shared = structure.layout.shared();
        changes.clear();
        changes.extend(point[shared.clone()].iter().zip(&origin[shared]).map(|(now, origin)| now - origin));
        let (of_times, tied) = changes.split_at(ends.times.count());
        ends.times.expand(of_times, times);
        for (time, (first, change)) in spline.times.iter_mut().zip(first.times.iter().zip(&*times)) {
            *time = first + change;
        }
        let last = spline.node() * spline.mesh.intervals();
        for (tie, change) in ends.tied.iter().zip(tied) {
            spline.unknowns[tie.start] = first.unknowns[tie.start] + change;
            if let Some(end) = tie.end {
                spline.unknowns[last + end] = first.unknowns[last + end] + tie.sign * change;
            }
        }
        spline.times.iter().all(|time| *time > 0.0)
    }

    /// Evaluates the motion of a point. Whether it is one.
    pub(in crate::direct) fn place(&mut self, point: &[f64]) -> bool {
        let is_motion = self.take(point) && self.model.evaluate(self.spline, self.points).is_ok();
        self.work.last.clear();
        self.work.last.extend_from_slice(point);
        self.work.has_values = is_motion;
        is_motion
    }

    /// Gives the entries of the barrier the multipliers of the rows, times a factor.
    fn set_multipliers(&mut self, weights: Weights<'_>, factor: f64) {
        self.barrier.multiplier.fill(0.0);
        let Structure { equalities, ranges, .. } = self.structure;
        let pairs = [(equalities, weights.equalities), (ranges, weights.ranges)];
        for (rows, weights) in pairs {
            for (row, weight) in rows.iter().zip(weights) {
                self.barrier.multiplier[row.entry] = -row.sign * factor * weight;
            }
        }
    }

    /// Adds a multiple of the second derivatives that the equations have at these multipliers.
    fn add_hessian(&mut self, factor: f64, blocks: &mut Blocks) {
        let Self { spline, ends, structure, system, .. } = self;
        let last = structure.layout.intervals();
        for k in 0..last {
            let hessian = &mut blocks.of(Element::Interval(k)).hessian;
            add_interval(structure, &system.matrix, k, factor, hessian);
        }
        if structure.layout.shared().is_empty() {
            return;
        }
        let (times, by_times, phases) = (&ends.times, &system.by_times, spline.mesh.phases());
        for k in 0..if times.count() > 0 { last } else { 0 } {
            let (columns, first) = (structure.columns(k), structure.first_shared(k));
            let hessian = &mut blocks.of(Element::Interval(k)).hessian;
            for (slot, column) in columns.iter().enumerate() {
                let Some(unknown) = structure.unknown(k, slot).filter(|_| column.factor != 0.0) else {
                    continue;
                };
                for a in 0..times.count() {
                    let by = |phase: usize| times.factor(phase, a) * by_times.columns[phase][unknown];
                    let entry: f64 = (0..phases).map(by).sum();
                    let (i, j) = (column.at.min(first + a), column.at.max(first + a));
                    hessian[(i, j)] += factor * column.factor * entry;
                }
            }
        }
        let (first, hessian) = (structure.first_shared(0), &mut blocks.of(Element::Interval(0)).hessian);
        for a in 0..times.count() {
            for b in a..times.count() {
                let of = |at: usize| times.factor(at / phases, a) * times.factor(at % phases, b);
                let entry: f64 = by_times.second.iter().enumerate().map(|(at, second)| of(at) * second).sum();
                hessian[(first + a, first + b)] += factor * entry;
            }
        }
    }

    /// The gradient of the cost.
    fn set_gradient(&mut self, blocks: &mut Blocks) {
        let Self { ends, structure, system, .. } = self;
        for k in 0..structure.layout.intervals() {
            let gradient = &mut blocks.of(Element::Interval(k)).gradient;
            for (slot, column) in structure.columns(k).iter().enumerate() {
                if let Some(unknown) = structure.unknown(k, slot) {
                    column.add(system.gradient[0][unknown], gradient);
                }
            }
        }
        let first = structure.first_shared(0);
        let gradient = &mut blocks.of(Element::Interval(0)).gradient[first..];
        for (a, to) in gradient.iter_mut().enumerate().take(ends.times.count()) {
            let by_times = system.by_times.gradient[0].iter().enumerate();
            *to += by_times.map(|(phase, slope)| ends.times.factor(phase, a) * slope).sum::<f64>();
        }
    }

    /// The derivatives of the rows of an interval.
    fn set_rows(&mut self, k: usize, block: &mut Block) {
        let Self { spline, points, barrier, structure, system, ends, work, .. } = self;
        let torques = &mut work.torques;
        let (element, phase) = (Element::Interval(k), spline.mesh.phase(k));
        let jacobians = [&mut block.equalities, &mut block.ranges];
        let (first_point, columns) = (spline.mesh.first_point(k), structure.columns(k));
        let order = if structure.is_whole(k) { Order::LeftFirst } else { Order::InnerFirst };
        let add = |row: &[f64], to: &mut [f64]| {
            columns.iter().zip(row).for_each(|(column, entry)| column.add(*entry, to));
        };
        let mut differentiated = false;
        for (jacobian, rows) in jacobians.into_iter().zip(structure.rows_of(element)) {
            let mut place: Option<(usize, [[f64; MOST_COEFFICIENTS]; 3])> = None;
            for (i, Row { entry, .. }) in rows.iter().enumerate() {
                let side = barrier.side(*entry);
                let index = barrier.side_index(*entry).unwrap_or_default();
                let at_point = barrier.point_of(*entry).filter(|_| !barrier.is_hull(index));
                let rates = &mut system.rate_rows;
                let to = jacobian.row_mut(i);
                let by_time = if side.limited == Limited::Torque {
                    torques.take(k, order, spline, points);
                    let (row, by_time) = match at_point {
                        Some(p) => torques.at_point(p - first_point, side.joint),
                        None => torques.coefficient(barrier.place_in_interval(*entry) % POINTS, side.joint),
                    };
                    match order {
                        Order::LeftFirst => to[..row.len()].copy_from_slice(row),
                        Order::InnerFirst => add(row, to),
                    }
                    by_time
                } else if let Some(p) = at_point {
                    let factors = match place {
                        Some((last, factors)) if last == p => factors,
                        _ => rates.go_to((k, p - first_point), spline, points),
                    };
                    place = Some((p, factors));
                    let by_time = rates.take_row(p, &factors, side, spline, points);
                    add(&rates.row, to);
                    by_time
                } else {
                    place = None;
                    let j = barrier.place_in_interval(*entry) % POINTS;
                    if side.limited == Limited::TorqueRate && !std::mem::replace(&mut differentiated, true) {
                        rates.differentiate_torques(k, spline, points);
                    }
                    let by_time = match barrier.is_hull(index) {
                        true => rates.take_coefficient(k, j, side, spline, points),
                        false => rates.take_value(k, j, side, spline, points),
                    };
                    add(&rates.row, to);
                    by_time
                };
                let shared = to[structure.first_shared(k)..].iter_mut().take(ends.times.count());
                shared.enumerate().for_each(|(a, to)| *to += ends.times.factor(phase, a) * by_time);
            }
        }
    }

    /// The derivatives of the rows of a node.
    fn set_rows_at(&mut self, k: usize, block: &mut Block) {
        let Self { spline, points, barrier, structure, ends, .. } = self;
        let (element, n) = (Element::Node(k), spline.dof);
        let (at_node, free) = (AtNode::new(spline, k), structure.layout.node(k).len());
        let jacobians = [&mut block.equalities, &mut block.ranges];
        for (jacobian, rows) in jacobians.into_iter().zip(structure.rows_of(element)) {
            for (i, Row { entry, .. }) in rows.iter().enumerate() {
                let to = jacobian.row_mut(i);
                let side = barrier.side(*entry);
                if barrier.side_index(*entry).is_some() {
                    let value = at_node.of(side);
                    let column = structure.column_at(k, value.unknown - structure.node * k);
                    column.add(value.scale, to);
                    if let Some(by_time) = value.by_time {
                        for a in 0..ends.times.count() {
                            to[free + a] += ends.times.factor(by_time.phase, a) * by_time.first;
                        }
                    }
                    continue;
                }
                let row = entry - barrier.at_ends().start;
                for (l, slope) in points.ends.g_x[2 * n * row..][..2 * n].iter().enumerate() {
                    structure.column_at(k, l).add(*slope, to);
                }
            }
        }
    }

    /// The derivatives of the rows of both ends.
    fn set_rows_of_ends(&mut self, block: &mut Block) {
        let Self { spline, points, barrier, structure, .. } = self;
        let (element, n) = (Element::Ends, spline.dof);
        let jacobians = [&mut block.equalities, &mut block.ranges];
        for (jacobian, rows) in jacobians.into_iter().zip(structure.rows_of(element)) {
            for (i, Row { entry, .. }) in rows.iter().enumerate() {
                let (to, row) = (jacobian.row_mut(i), entry - barrier.at_ends().start);
                let own = 2 * n * row..2 * n * (row + 1);
                let both = points.ends.g_x[own.clone()].iter().zip(&points.ends.far[own]);
                for (l, (near, far)) in both.enumerate() {
                    let [start, end] = structure.columns_of_ends(l, l);
                    start.add(*near, to);
                    end.add(*far, to);
                }
            }
        }
    }
}

/// Adds a matrix in the unknowns of the spline, of interval k with its left node, to the upper triangle of a
/// Hessian; that of the last node too.
fn add_interval(structure: &Structure, matrix: &ChainMatrix, k: usize, factor: f64, hessian: &mut Dense) {
    let (node, inner) = (structure.node, structure.inner);
    let (of_inner, left, right) = matrix.blocks(k);
    let is_last = k + 1 == structure.layout.intervals();
    let columns = structure.columns(k);
    let rows = [
        (of_inner, 0, inner, inner + 2 * node),
        (left, inner, node, 2 * node),
        (right, inner + node, if is_last { node } else { 0 }, 2 * node),
    ];
    if structure.is_whole(k) {
        // Columns: left node, inner ones, right node.
        for (i, row) in of_inner.chunks_exact((inner + 2 * node).max(1)).enumerate() {
            for (j, entry) in row[inner..inner + node].iter().enumerate() {
                hessian[(j, node + i)] += factor * entry;
            }
            let to = hessian.row_mut(node + i);
            add(&mut to[node + i..node + inner], factor, &row[i..inner]);
            add(&mut to[node + inner..][..node], factor, &row[inner + node..]);
        }
        for (i, row) in left.chunks_exact(2 * node).enumerate() {
            let to = hessian.row_mut(i);
            add(&mut to[i..node], factor, &row[i..node]);
            add(&mut to[node + inner..][..node], factor, &row[node..]);
        }
        return;
    }
    for (entries, first, count, width) in rows {
        for (i, row) in entries.chunks_exact(width.max(1)).take(count).enumerate() {
            let end = if first == inner + node { node } else { width };
            for (j, &entry) in row[..end].iter().enumerate().skip(i) {
                add_to(hessian, (columns[first + i], columns[first + j]), i == j, factor * entry);
            }
        }
    }
}

fn add(to: &mut [f64], factor: f64, from: &[f64]) {
    to.iter_mut().zip(from).for_each(|(to, entry)| *to += factor * entry);
}

/// Adds an entry of a symmetric matrix in two unknowns, which are the same one or not, to the upper triangle
/// of one in their columns.
#[inline(always)]
fn add_to(hessian: &mut Dense, (a, b): (Column, Column), is_same: bool, entry: f64) {
    // What is given has no column.
    if a.factor == 0.0 || b.factor == 0.0 {
        return;
    }
    let value = a.factor * b.factor * entry;
    let twice = a.at == b.at && !is_same;
    hessian[(a.at.min(b.at), a.at.max(b.at))] += if twice { 2.0 * value } else { value };
}

impl<D: PointDynamics> StagedProblem for Program<'_, D> {
    type Error = EvalError;

    fn layout(&self) -> &Layout {
        &self.structure.layout
    }

    fn bounds(&self) -> [&[f64]; 2] {
        self.structure.bounds.each_ref().map(Vec::as_slice)
    }

    fn scales(&self) -> Option<&Scales> {
        Some(&self.structure.scales)
    }

    fn evaluate(&mut self, point: &[f64], values: &mut Values) -> Result<(), EvalError> {
        if !self.place(point) {
            values.cost = f64::NAN;
            values.equalities.fill(f64::NAN);
            values.ranges.fill(f64::NAN);
            return Ok(());
        }
        values.cost = self.running.cost(self.spline, self.points);
        let mut distance = std::mem::take(&mut self.barrier.distance);
        self.barrier.measure(self.spline, self.points, &mut distance);
        let lists = [
            (&mut values.equalities, &self.structure.equalities),
            (&mut values.ranges, &self.structure.ranges),
        ];
        for (values, rows) in lists {
            for (value, row) in values.iter_mut().zip(rows) {
                *value = row.sign * distance[row.entry] + row.offset;
            }
        }
        self.barrier.distance = distance;
        Ok(())
    }

    fn linearise(
        &mut self,
        point: &[f64],
        weights: Weights<'_>,
        blocks: &mut Blocks,
    ) -> Result<(), EvalError> {
        self.work.has_metric = false;
        let has_values = match self.work.last == point {
            true => self.work.has_values,
            false => self.place(point),
        };
        if !has_values {
            for element in self.structure.layout.elements() {
                let Block { gradient, hessian, equalities, ranges, .. } = blocks.of(element);
                let entries = [hessian.entries_mut(), equalities.entries_mut(), ranges.entries_mut()];
                entries.into_iter().chain([&mut gradient[..]]).for_each(|entries| entries.fill(f64::NAN));
            }
            return Ok(());
        }
        // The Lagrange function has the cost once. With hardly any: that with it less most of the cost alone.
        let parts = match weights.cost.abs() < LEAST_COST {
            true => [Some((1.0, 1.0)), Some((weights.cost - 1.0, 0.0))],
            false => [Some((weights.cost, 1.0 / weights.cost)), None],
        };
        for (part, (factor, of_weights)) in parts.into_iter().flatten().enumerate() {
            self.set_multipliers(weights, of_weights);
            let Self { spline, points, barrier, running, model, system, ends, .. } = self;
            weigh(spline, points, barrier, running);
            model.contract(spline, points)?;
            system.exact = true;
            system.collect(Gradients::for_times(ends), spline, points, barrier, running);
            self.add_hessian(factor, blocks);
            if part > 0 {
                continue;
            }
            self.work.torques.invalidate();
            for element in self.structure.layout.elements() {
                let block = blocks.of(element);
                match element {
                    Element::Interval(k) => self.set_rows(k, block),
                    Element::Node(k) => self.set_rows_at(k, block),
                    Element::Ends => self.set_rows_of_ends(block),
                }
            }
            self.set_gradient(blocks);
        }
        Ok(())
    }

    /// Gauss-Newton Hessians: without second derivatives of torques and rows. What depends on times and other
    /// costs than that of torques keeps its own, so they are positive semidefinite where times are fixed and
    /// only torques cost something. There are some where all torques do, without equations and without limits
    /// of jerks and rates of torques.
    fn convexify(&mut self, _: &[f64], weights: Weights<'_>, blocks: &mut Blocks) -> Result<bool, EvalError> {
        let is_smooth = self.spline.mesh.shape.is_smooth();
        let has_cost = weights.cost > LEAST_COST && self.running.effort.iter().all(|weight| *weight > 0.0);
        if is_smooth || !self.structure.equalities.is_empty() || !has_cost {
            return Ok(false);
        }
        let Self { spline, points, barrier, running, system, ends, .. } = self;
        system.exact = false;
        system.collect(Gradients::for_times(ends), spline, points, barrier, running);
        blocks.clear_hessians();
        self.add_hessian(weights.cost, blocks);
        self.system.exact = true;
        Ok(true)
    }

    /// That of accelerations, as torques ([`Metric`](crate::direct::newton::metric::Metric)); of the times
    /// the cost over their squares.
    fn add_metric(&mut self, _: &[f64], factor: f64, blocks: &mut Blocks) -> Result<(), EvalError> {
        let Self { spline, points, barrier, running, system, structure, ends, work, .. } = self;
        let cost = structure.scales.cost;
        if !std::mem::replace(&mut work.has_metric, true) {
            weigh_torques(running, barrier, cost / spline.duration(), &mut work.weights);
            system.collect_metric(spline, points, &work.weights);
        }
        let layout = &structure.layout;
        for k in 0..layout.intervals() {
            let hessian = &mut blocks.of(Element::Interval(k)).hessian;
            add_interval(structure, &system.damping, k, factor, hessian);
        }
        let (first, hessian) = (structure.first_shared(0), &mut blocks.of(Element::Interval(0)).hessian);
        for (a, time) in layout.shared().take(ends.times.count()).enumerate() {
            hessian[(first + a, first + a)] += factor * cost / structure.scales.steps[time].powi(2);
        }
        Ok(())
    }
}

#[cfg(test)]
#[path = "staged_tests.rs"]
mod tests;
