//! What jerks, rates of torques and coefficients of limits add to Newton's equations: squares of rows over an
//! interval.

use super::interval::add_local;
use super::rate_rows::RateRows;
use super::system::System;
use crate::direct::limits::barrier::Barrier;
use crate::direct::limits::side::{Limited, Side};
use crate::direct::motion::shape::POINTS;
use crate::direct::motion::spline::{Spline, TimeDerivative};
use crate::direct::points::rates::Term;
use crate::direct::points::values::Points;
use std::ops::Range;

/// How a value y = y(x, T) depends on T beside what the points already have: as a power of 1/T.
struct InTime {
    /// Derivative of y.
    first: f64,
    /// Factor of the derivative by the unknowns in the mixed derivative.
    mixed: f64,
    /// What the derivative by y is multiplied with in the second derivative.
    second: f64,
    /// What it is multiplied with in the first derivative.
    gradient: f64,
}

impl System {
    /// Adds jerks and rates of torques of these intervals. The points have added what the latter are by
    /// torques at constant factors 1/(h T) already.
    pub(super) fn add_rates(&mut self, intervals: Range<usize>, spline: &Spline, points: &Points) {
        let mut rows = std::mem::take(&mut self.rate_rows);
        let (has_jerks, has_torques) = (points.rates.has_jerks, points.rates.has_torques);
        for k in intervals {
            if has_jerks {
                self.add_jerks(k, spline, points, &mut rows);
            }
            if has_torques {
                self.add_torque_rates(k, spline, points, &mut rows);
            }
        }
        self.rate_rows = rows;
    }

    /// The jerk is linear in the coefficients, and a multiple of 1/T^3.
    fn add_jerks(&mut self, k: usize, spline: &Spline, points: &Points, rows: &mut RateRows) {
        let inverse = 1.0 / spline.clock(k);
        for j in 0..POINTS {
            for i in 0..spline.dof {
                let p = spline.dof * (POINTS * k + j) + i;
                let term = &points.rates.jerk_terms[p];
                let [first, second] = rows.take_jerk(k, j, i, spline, points);
                let in_time = InTime { first, mixed: -3.0 * inverse, second, gradient: first };
                for TimeDerivative { column, order, first } in spline.time_derivatives(k) {
                    let entry = order * inverse * rows.row[column * spline.dof + i];
                    self.by_times.columns[spline.mesh.phase(k)][first + i] += term.first[0] * entry;
                }
                self.add_row(k, spline, &rows.row, term, &in_time);
                let gradients = self.gradient.iter_mut().chain([&mut self.at_ends.gradient]);
                for (gradient, factor) in gradients.zip([term.first[1], term.first[2], term.first[0]]) {
                    add_local(spline, k, &rows.row, factor, gradient);
                }
            }
        }
    }

    /// Rates of torques are sums of torques over T.
    fn add_torque_rates(&mut self, k: usize, spline: &Spline, points: &Points, rows: &mut RateRows) {
        let inverse = 1.0 / spline.clock(k);
        rows.differentiate_torques(k, spline, points);
        for j in 0..POINTS {
            for i in 0..spline.dof {
                let p = spline.dof * (POINTS * k + j) + i;
                let (y, term) = (points.rates.torque[p], &points.rates.torque_terms[p]);
                let first = rows.take_torque_rate(k, j, i, spline, points);
                let second = -2.0 * inverse * first;
                let in_time = InTime { first, mixed: -inverse, second, gradient: -inverse * y };
                self.add_row(k, spline, &rows.row, term, &in_time);
            }
        }
    }

    /// Adds the squares of limits whose coefficients are limited, of these intervals. All else that they add
    /// is added by their values at the points.
    pub(super) fn add_hulls(
        &mut self,
        intervals: Range<usize>,
        spline: &Spline,
        points: &Points,
        barrier: &Barrier,
    ) {
        if !barrier.has_hulls() {
            return;
        }
        let mut rows = std::mem::take(&mut self.rate_rows);
        for k in intervals {
            let (mut has_torques, mut number) = (false, 0);
            while number < barrier.all_sides().count() {
                // Both sides of a limit stand together.
                let (first, side) = (number, barrier.numbered(number));
                let is_same = |other: &Side| (other.limited, other.joint) == (side.limited, side.joint);
                number += barrier.all_sides().skip(first).take_while(|other| is_same(other)).count();
                let own = || (first..number).filter(|&number| barrier.is_hull(number));
                if own().next().is_none() {
                    continue;
                }
                if side.limited == Limited::TorqueRate && !std::mem::replace(&mut has_torques, true) {
                    rows.differentiate_torques(k, spline, points);
                }
                for c in 0..POINTS {
                    let second: f64 =
                        own().map(|own| barrier.curvature(barrier.in_interval(k, own)[c])).sum();
                    if second == 0.0 {
                        continue;
                    }
                    let first = rows.take_coefficient(k, c, side, spline, points);
                    let in_time = InTime { first, mixed: 0.0, second: 0.0, gradient: 0.0 };
                    self.add_row(k, spline, &rows.row, &Term { second, ..Term::default() }, &in_time);
                }
            }
        }
        self.rate_rows = rows;
    }

    /// Adds the square of the derivatives of a value, by the unknowns of an interval and by T.
    fn add_row(&mut self, k: usize, spline: &Spline, row: &[f64], term: &Term, in_time: &InTime) {
        let Term { first: [first, at_zero, of_mu], second, slope, cost } = *term;
        let (phase, by_times) = (spline.mesh.phase(k), &mut self.by_times);
        by_times.gradient[0][phase] += cost + at_zero * in_time.gradient;
        by_times.gradient[1][phase] += of_mu * in_time.gradient;
        let by_time = (second * in_time.first + 2.0 * slope) * in_time.first + first * in_time.second;
        by_times.add_second([phase; 2], by_time);
        let factor = second * in_time.first + first * in_time.mixed + slope;
        add_local(spline, k, row, factor, &mut by_times.columns[phase]);
        if second != 0.0 {
            self.matrix.add_square(k, second, row);
        }
    }
}
