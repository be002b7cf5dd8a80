//! The border of Newton's equations in the elastic phase: columns and corner of what limits give.

use super::relaxation::{Relaxation, price};
use crate::direct::limits::at_node::{AtNode, NodeValue};
use crate::direct::limits::barrier::Barrier;
use crate::direct::limits::ends::Ends;
use crate::direct::motion::spline::Spline;
use crate::direct::newton::interval::{add_gradient, add_local};
use crate::direct::newton::point_terms::Work;
use crate::direct::newton::rate_rows::RateRows;
use crate::direct::newton::side_terms::{add_row, side_terms};
use crate::direct::points::values::Points;
use crate::numerics::chain::dot;

impl Relaxation {
    /// The border of Newton's equations at an iterate.
    pub fn assemble(&mut self, spline: &Spline, points: &Points, barrier: &Barrier, ends: &Ends) {
        if self.limits.is_empty() {
            return;
        }
        let size = spline.unknowns.len();
        if self.work.z_t.len() != 3 * spline.dof {
            (self.work, self.rates) = (Work::new(spline.dof, [0; 2]), RateRows::new(spline.dof));
        }
        let count = self.give.len();
        self.border.reset(count);
        self.by_times.resize_with(count, Vec::new);
        for (i, (column, by_times)) in self.border.columns.iter_mut().zip(&mut self.by_times).enumerate() {
            column.resize(size, 0.0);
            by_times.clear();
            by_times.resize(spline.mesh.phases(), 0.0);
            let [_, first, second] = price(self.give[i]).map(|value| self.price * value);
            (self.gradient[0][i], self.gradient[1][i]) = (first, 0.0);
            self.border.corner[count * i + i] = second;
        }
        for p in 0..points.count() {
            self.add_point(p, spline, points, barrier);
        }
        for k in 0..spline.mesh.nodes.len() {
            self.add_node(k, spline, barrier);
        }
        for k in 0..if barrier.rate_sides().is_empty() { 0 } else { spline.mesh.intervals() } {
            self.add_rates(k, spline, points, barrier);
        }
        for (column, by_times) in self.border.columns.iter_mut().zip(&self.by_times) {
            column.resize(size + ends.shared(), 0.0);
            let (by_unknowns, shared) = column.split_at_mut(size);
            ends.reduce(&spline.mesh, by_unknowns, by_times, shared);
        }
    }

    /// Adds an entry of a side to gradient and corner of its limit. Its curvature times its range and sign.
    fn add_entry(&mut self, limit: usize, side: usize, at: usize, barrier: &Barrier) -> f64 {
        let range = self.ranges[side];
        let ([_, at_zero, of_mu], sigma) = side_terms(barrier, at, 1.0);
        self.gradient[0][limit] += range * at_zero;
        self.gradient[1][limit] += range * of_mu;
        self.border.corner[(self.give.len() + 1) * limit] += range * range * sigma;
        sigma * range * barrier.numbered(side).sign
    }

    fn add_point(&mut self, p: usize, spline: &Spline, points: &Points, barrier: &Barrier) {
        let (k, j) = spline.mesh.interval_of(p);
        let factors = spline.factors(k, j);
        let sides = barrier.sides();
        let mut work = std::mem::take(&mut self.work);
        work.differentiate_in_time(points.z(p), spline, k, &factors);
        let z = &mut work.z[0];
        let mut i = 0;
        while i < sides.len() {
            let Some(limit) = self.limits[i] else {
                i += 1;
                continue;
            };
            // The sides of a limit stand together.
            z.fill(0.0);
            while i < sides.len() && self.limits[i] == Some(limit) {
                let side = &sides[i];
                let factor = self.add_entry(limit, i, barrier.at_point(p).start + i, barrier);
                add_row(points, p, side, factor, z);
                i += 1;
            }
            add_gradient(spline, k, &factors, z, &mut self.border.columns[limit]);
            self.by_times[limit][spline.mesh.phase(k)] += dot(z, &work.z_t);
        }
        self.work = work;
    }

    fn add_node(&mut self, k: usize, spline: &Spline, barrier: &Barrier) {
        let node = AtNode::new(spline, k);
        for (i, at) in barrier.at_node(k).enumerate() {
            let Some(limit) = self.limits[i] else { continue };
            let factor = self.add_entry(limit, i, at, barrier);
            let NodeValue { unknown, scale, by_time, .. } = node.of(&barrier.sides()[i]);
            self.border.columns[limit][unknown] += scale * factor;
            if let Some(by_time) = by_time {
                self.by_times[limit][by_time.phase] += by_time.first * factor;
            }
        }
    }

    fn add_rates(&mut self, k: usize, spline: &Spline, points: &Points, barrier: &Barrier) {
        let (mut rates, first) = (std::mem::take(&mut self.rates), barrier.sides().len());
        let phase = spline.mesh.phase(k);
        rates.for_each(
            k,
            (spline, points, barrier),
            |_| true,
            |at, i, row, by_time| {
                let Some(limit) = self.limits[first + i] else { return };
                let factor = self.add_entry(limit, first + i, at, barrier);
                add_local(spline, k, row, factor, &mut self.border.columns[limit]);
                self.by_times[limit][phase] += by_time * factor;
            },
        );
        self.rates = rates;
    }
}
