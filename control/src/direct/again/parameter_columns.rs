//! How the equations change with a number of the problem: a limit, a mass.
//!
//! At a solution the gradient F(x; theta) of the Lagrange function of the barrier problem vanishes in the
//! free unknowns x. With slacks and multipliers eliminated, a distance that changes by d_theta changes its
//! multiplier by $-\sigma d\_\theta$, $\sigma = \eta / s$, so that
//!
//! $$ K x\_\theta = -F\_\theta, \qquad F\_\theta = \sum \textrm{sign} \\, \sigma d\_\theta \nabla g +
//! F\_\theta|\_\eta $$
//!
//! The barrier stays where it is, mu, for which the products of slacks and multipliers must be equal: see
//! [`MotionDerivative`](super::motion_derivative::MotionDerivative).

use crate::direct::interior::iterate::Interior;
use crate::direct::limits::side::{Limited, Side};
use crate::direct::motion::shape::POINTS;
use crate::direct::newton::interval::{add_gradient, add_local};
use crate::direct::newton::point_terms::Work;
use crate::direct::newton::rate_rows::RateRows;
use crate::direct::newton::side_terms::add_row;
use crate::direct::points::rates::Term;
use crate::direct::points::values::{PointDynamics, Points};
use crate::numerics::chain::dot;

/// Minus the derivative of the gradient by the number, in the unknowns and the times of phases, and the
/// derivative of the cost.
#[derive(Clone, Debug, Default)]
pub(super) struct Column {
    pub unknowns: Vec<f64>,
    pub times: Vec<f64>,
    pub cost: f64,
}

impl Column {
    pub(super) fn reset(&mut self, unknowns: usize, times: usize) {
        for (list, count) in [(&mut self.unknowns, unknowns), (&mut self.times, times)] {
            list.clear();
            list.resize(count, 0.0);
        }
        self.cost = 0.0;
    }
}

impl<D: PointDynamics> Interior<D> {
    /// The column of a number by which the distance to each side changes like this.
    pub(super) fn limit_column(&mut self, change: impl Fn(&Side) -> f64, column: &mut Column) {
        let mut rows = std::mem::take(&mut self.system.rate_rows);
        let (spline, points, barrier) = (&self.spline, &self.points, &self.barrier);
        let (n, node) = (spline.dof, spline.node());
        column.reset(spline.unknowns.len(), spline.times.len());
        let mut work = Work::new(n, self.model.tasks.rows());
        // The price of a distance at constant multipliers, and what its change makes of the multiplier.
        let entry = |at: usize, side: &Side| {
            let by = change(side);
            let counts = by != 0.0 && barrier.is_on(at);
            counts.then(|| (-barrier.multiplier[at] * by, -side.sign * barrier.curvature(at) * by))
        };
        for p in 0..points.count() {
            let (k, j) = spline.mesh.interval_of(p);
            work.z[0].fill(0.0);
            for (at, side) in barrier.at_point(p).zip(barrier.sides()) {
                let Some((cost, factor)) = entry(at, side) else { continue };
                column.cost += cost;
                add_row(points, p, side, factor, &mut work.z[0]);
            }
            let factors = spline.factors(k, j);
            work.differentiate_in_time(points.z(p), spline, k, &factors);
            add_gradient(spline, k, &factors, &work.z[0], &mut column.unknowns);
            column.times[spline.mesh.phase(k)] += dot(&work.z[0], &work.z_t);
        }
        for k in 0..spline.mesh.nodes.len() {
            let inverse = 1.0 / spline.clock_at(k);
            for at in barrier.at_node(k) {
                let side = barrier.side(at);
                let Some((cost, factor)) = entry(at, side) else { continue };
                column.cost += cost;
                let place = node * k + side.index(n);
                if side.limited == Limited::Rate {
                    column.unknowns[place] += inverse * factor;
                    if !spline.mesh.is_end(k) {
                        column.times[spline.mesh.phase(k)] -=
                            inverse * inverse * spline.unknowns[place] * factor;
                    }
                } else {
                    column.unknowns[place] += factor;
                }
            }
        }
        for k in 0..if barrier.rate_sides().is_empty() { 0 } else { spline.mesh.intervals() } {
            let wanted = |at: usize| entry(at, barrier.side(at)).is_some();
            rows.for_each(k, (spline, points, barrier), wanted, |at, i, row, by_time| {
                let Some((cost, factor)) = entry(at, &barrier.rate_sides()[i]) else { return };
                column.cost += cost;
                add_local(spline, k, row, factor, &mut column.unknowns);
                column.times[spline.mesh.phase(k)] += by_time * factor;
            });
        }
        self.system.rate_rows = rows;
    }

    /// What rates of torques add to the column of a mass: each is a sum of torques over T.
    fn add_torque_rates(&self, rows: &mut RateRows, heavier: &Points, column: &mut Column) {
        let (spline, points, n) = (&self.spline, &self.points, self.spline.dof);
        for k in 0..if points.rates.has_torques { spline.mesh.intervals() } else { 0 } {
            rows.differentiate_torques(k, spline, points);
            let (phase, inverse) = (spline.mesh.phase(k), 1.0 / spline.clock(k));
            for p in POINTS * k..POINTS * (k + 1) {
                for i in 0..n {
                    let at = n * p + i;
                    let change = heavier.rates.torque[at] - points.rates.torque[at];
                    let Term { first, second, slope, .. } = points.rates.torque_terms[at];
                    let by_time = rows.take_torque_rate(k, p % POINTS, i, spline, points);
                    add_local(spline, k, &rows.row, -second * change, &mut column.unknowns);
                    column.times[phase] -= (slope + second * by_time - inverse * first[0]) * change;
                }
            }
        }
    }

    /// The column of a mass, from the same points with one more kilogram: torques are linear in it.
    pub(super) fn mass_column(&mut self, heavier: &Points, column: &mut Column) {
        let (spline, points, barrier) = (&self.spline, &self.points, &self.barrier);
        let (n, powers) = (spline.dof, points.powers);
        column.reset(spline.unknowns.len(), spline.times.len());
        let mut work = Work::new(n, self.model.tasks.rows());
        let width = 3 * n;
        for p in 0..points.count() {
            let (k, j) = spline.mesh.interval_of(p);
            let (weight, v) = (spline.weight(p), &points.z(p)[n..2 * n]);
            let by_mass: Vec<f64> =
                heavier.tau(p).iter().zip(points.tau(p)).map(|(with, without)| with - without).collect();
            let z = &mut work.z[0][..width];
            z.fill(0.0);
            // l_theta without multipliers.
            let mut cost = 0.0;
            for (i, &change) in by_mass.iter().enumerate() {
                let factor = points.weights[n * p + i];
                column.cost += factor * change;
                let rows = heavier.tau_z(p)[width * i..].iter().zip(&points.tau_z(p)[width * i..]);
                z.iter_mut().zip(rows).for_each(|(z, (with, without))| *z -= factor * (with - without));
                let effort = self.running.effort[i];
                cost += effort * points.tau(p)[i] * change;
                let sides = barrier.at_point(p).zip(barrier.sides());
                let own = sides.filter(|(at, side)| {
                    side.limited == Limited::Torque && side.joint == i && barrier.is_on(*at)
                });
                let curvature = weight * effort + own.map(|(at, _)| barrier.curvature(at)).sum::<f64>();
                let row = &points.tau_z(p)[width * i..][..width];
                z.iter_mut().zip(row).for_each(|(z, row)| *z -= curvature * change * row);
            }
            for row in 0..self.model.powers.rows() {
                let change = self.model.powers.change(row, v, &by_mass);
                let energy = (row < self.running.energy.weights.len())
                    .then(|| self.running.energy.term(row, points.h(p)[row]));
                cost += energy.as_ref().map_or(0.0, |term| term.first * change);
                let sides = barrier.at_point(p).zip(barrier.sides());
                let own = sides.filter(|(at, side)| {
                    let is_power = matches!(side.limited, Limited::Power | Limited::TorqueSpeed);
                    is_power && side.joint == row && barrier.is_on(*at)
                });
                let curvature = energy.map_or(0.0, |term| weight * term.second)
                    + own.map(|(at, _)| barrier.curvature(at)).sum::<f64>();
                let slope = &points.h_z(p)[width * row..][..width];
                z.iter_mut().zip(slope).for_each(|(z, slope)| *z -= curvature * change * slope);
                let factor = -points.h_weights[powers * p + row];
                self.model.powers.add_products(row, factor, &by_mass, &mut z[n..2 * n]);
            }
            let factors = spline.factors(k, j);
            work.differentiate_in_time(points.z(p), spline, k, &factors);
            add_gradient(spline, k, &factors, &work.z[0], &mut column.unknowns);
            let part = spline.mesh.point(p).1;
            column.times[spline.mesh.phase(k)] += dot(&work.z[0], &work.z_t) - part * cost;
        }
        let mut rows = std::mem::take(&mut self.system.rate_rows);
        self.add_torque_rates(&mut rows, heavier, column);
        self.system.rate_rows = rows;
    }

    /// How the motion changes with a number, from its column and equations that are factorised at this
    /// iterate; to the first part of the step.
    pub(super) fn respond_to(&mut self, column: &mut Column) {
        let (dx, shared) = (&mut self.steps[0], &mut self.shared_steps[0]);
        dx.clone_from(&column.unknowns);
        shared.clear();
        shared.resize(self.ends.shared(), 0.0);
        self.ends.reduce(&self.spline.mesh, dx, &column.times, shared);
        self.system.finish_solution(dx, shared);
        self.ends.expand(&self.spline.mesh, shared, dx, &mut self.time_steps[0]);
    }
}
