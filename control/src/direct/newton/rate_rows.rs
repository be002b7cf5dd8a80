//! Derivatives of jerks and rates of torques, and of coefficients of what is limited, by the unknowns of an
//! interval and by T.

use super::point_terms::Work;
use super::side_terms::add_row;
use crate::direct::limits::barrier::Barrier;
use crate::direct::limits::hull::COEFFICIENTS;
use crate::direct::limits::side::{Limited, Side};
use crate::direct::motion::shape::{MOST_COEFFICIENTS, MOST_POINTS, POINTS};
use crate::direct::motion::spline::{Spline, TimeDerivative};
use crate::direct::points::rates::SLOPES;
use crate::direct::points::values::Points;
use crate::numerics::chain::dot;

/// Room for the rows of an interval.
#[derive(Clone, Debug, Default)]
pub(crate) struct RateRows {
    /// Derivatives of the torques at the points by the unknowns of the interval, n rows a point, and by T.
    by_unknowns: Vec<f64>,
    by_time: Vec<f64>,
    /// The derivative of one value.
    pub row: Vec<f64>,
    /// That of a coefficient, while it is summed.
    sum: Vec<f64>,
    work: Work,
}

impl RateRows {
    /// For n joints.
    pub fn new(n: usize) -> Self {
        Self { work: Work::new(n, [0; 2]), ..Self::default() }
    }

    /// Hands over each entry of jerks and rates of torques of an interval that is `wanted`: its number among
    /// all, that of its side among those of rates, the derivatives of its value by the unknowns of the
    /// interval, and the one by T.
    pub fn for_each(
        &mut self,
        k: usize,
        (spline, points, barrier): (&Spline, &Points, &Barrier),
        wanted: impl Fn(usize) -> bool,
        mut take: impl FnMut(usize, usize, &[f64], f64),
    ) {
        let is_wanted = |at: usize, limited: Limited| barrier.side(at).limited == limited && wanted(at);
        let mut entries = (POINTS * k..POINTS * (k + 1)).flat_map(|p| barrier.at_gauss_point(p));
        if entries.any(|at| is_wanted(at, Limited::TorqueRate)) {
            self.differentiate_torques(k, spline, points);
        }
        for j in 0..POINTS {
            // Both sides of a limit stand together.
            let (mut last, mut by_time) = (None, 0.0);
            for (i, at) in barrier.at_gauss_point(POINTS * k + j).enumerate().filter(|&(_, at)| wanted(at)) {
                let side = &barrier.rate_sides()[i];
                if last.replace((side.limited, side.joint)) != Some((side.limited, side.joint)) {
                    by_time = match barrier.is_hull(barrier.sides().len() + i) {
                        true => self.take_coefficient(k, j, side, spline, points),
                        false => self.take_value(k, j, side, spline, points),
                    };
                }
                take(at, i, &self.row, by_time);
            }
        }
    }

    /// Derivatives of coefficient `c` of what a side limits ([`COEFFICIENTS`]) by the unknowns of the
    /// interval, as the row; the one by T. Rates of torques come after the torques.
    pub fn take_coefficient(
        &mut self,
        k: usize,
        c: usize,
        side: &Side,
        spline: &Spline,
        points: &Points,
    ) -> f64 {
        let (mut sum, mut by_time) = (std::mem::take(&mut self.sum), 0.0);
        sum.clear();
        sum.resize(spline.mesh.shape.coefficients() * spline.dof, 0.0);
        for (j, factor) in COEFFICIENTS[c].into_iter().enumerate() {
            by_time += factor * self.take_value(k, j, side, spline, points);
            sum.iter_mut().zip(&self.row).for_each(|(sum, entry)| *sum += factor * entry);
        }
        self.sum = std::mem::replace(&mut self.row, sum);
        by_time
    }

    /// The same of its value at one of Gauss's points.
    pub fn take_value(&mut self, k: usize, j: usize, side: &Side, spline: &Spline, points: &Points) -> f64 {
        match side.limited {
            Limited::Jerk => self.take_jerk(k, j, side.joint, spline, points)[0],
            Limited::TorqueRate => self.take_torque_rate(k, j, side.joint, spline, points),
            _ => self.take_at_point(k, j, side, spline, points),
        }
    }

    /// The same of what is no rate.
    fn take_at_point(&mut self, k: usize, j: usize, side: &Side, spline: &Spline, points: &Points) -> f64 {
        let factors = self.go_to((k, j), spline, points);
        self.take_row(spline.mesh.first_point(k) + j, &factors, side, spline, points)
    }

    /// Goes to a point of interval `k`: what z depends on there.
    pub fn go_to(
        &mut self,
        (k, j): (usize, usize),
        spline: &Spline,
        points: &Points,
    ) -> [[f64; MOST_COEFFICIENTS]; 3] {
        let factors = spline.factors(k, j);
        let p = spline.mesh.first_point(k) + j;
        self.work.differentiate_in_time(points.z(p), spline, k, &factors);
        factors
    }

    /// Derivatives of the value of a side at point p, gone to last, by the unknowns of the interval, as the
    /// row; the one by T.
    pub fn take_row(
        &mut self,
        p: usize,
        factors: &[[f64; MOST_COEFFICIENTS]; 3],
        side: &Side,
        spline: &Spline,
        points: &Points,
    ) -> f64 {
        let n = spline.dof;
        let count = spline.mesh.shape.coefficients();
        self.row.clear();
        if side.limited <= Limited::Acceleration {
            // An entry of z.
            self.row.resize(count * n, 0.0);
            let factors = &factors[side.limited as usize][..count];
            self.row
                .iter_mut()
                .skip(side.joint)
                .step_by(n)
                .zip(factors)
                .for_each(|(to, factor)| *to = *factor);
            return self.work.z_t[side.index(n)];
        }
        let z = &mut self.work.z[0];
        z.fill(0.0);
        add_row(points, p, side, 1.0, z);
        let [values, rates, accelerations] = factors;
        for ((f, g), h) in values[..count].iter().zip(rates).zip(accelerations) {
            self.row.extend((0..n).map(|l| f * z[l] + g * z[n + l] + h * z[2 * n + l]));
        }
        dot(&z[..3 * n], &self.work.z_t)
    }

    /// Derivatives of a jerk at one of Gauss's points by the unknowns of the interval, as the row; the first
    /// and the second one by T.
    pub fn take_jerk(&mut self, k: usize, j: usize, i: usize, spline: &Spline, points: &Points) -> [f64; 2] {
        let (n, inverse) = (spline.dof, 1.0 / spline.clock(k));
        let count = spline.mesh.shape.coefficients();
        self.row.clear();
        self.row.resize(count * n, 0.0);
        for (b, factor) in spline.gauss_basis_of_changes(k, j).rows[3][..count].iter().enumerate() {
            self.row[b * n + i] = factor * inverse * inverse * inverse;
        }
        let jerk = points.rates.jerk[n * (POINTS * k + j) + i];
        let (mut by_time, mut second) = (-3.0 * jerk, 12.0 * jerk);
        // Terms with the powers T^(m - 3).
        for TimeDerivative { column, order, first } in spline.time_derivatives(k) {
            let part = order * self.row[column * n + i] * spline.unknowns[first + i];
            by_time += part;
            second += part * (order - 7.0);
        }
        [inverse * by_time, inverse * inverse * second]
    }

    /// The same of the rate of a torque, after the torques.
    pub fn take_torque_rate(
        &mut self,
        k: usize,
        j: usize,
        i: usize,
        spline: &Spline,
        points: &Points,
    ) -> f64 {
        let (n, inverse) = (spline.dof, 1.0 / spline.clock(k));
        let size = spline.mesh.shape.coefficients() * n;
        let (scale, mut by_time) = (inverse / spline.mesh.width(k), 0.0);
        self.row.clear();
        self.row.resize(size, 0.0);
        for (m, slope) in SLOPES[j].iter().enumerate() {
            let by_unknowns = &self.by_unknowns[size * (n * m + i)..][..size];
            self.row.iter_mut().zip(by_unknowns).for_each(|(to, entry)| *to += scale * slope * entry);
            by_time += scale * slope * self.by_time[n * m + i];
        }
        by_time - inverse * points.rates.torque[n * (POINTS * k + j) + i]
    }

    /// Derivatives of the torques at the points of an interval.
    pub fn differentiate_torques(&mut self, k: usize, spline: &Spline, points: &Points) {
        let (n, mesh) = (spline.dof, &spline.mesh);
        let count = mesh.shape.coefficients();
        self.by_unknowns.clear();
        self.by_unknowns.resize(MOST_POINTS * n * count * n, 0.0);
        self.by_time.clear();
        for m in 0..MOST_POINTS {
            let p = mesh.first_point(k) + m;
            let (factors, tau_z) = (spline.factors(k, m), points.tau_z(p));
            self.work.differentiate_in_time(points.z(p), spline, k, &factors);
            for (i, tau_z) in tau_z.chunks_exact(3 * n).enumerate() {
                self.by_time.push(tau_z.iter().zip(&self.work.z_t).map(|(a, b)| a * b).sum());
                let row = &mut self.by_unknowns[count * n * (n * m + i)..][..count * n];
                for (b, row) in row.chunks_exact_mut(n).enumerate() {
                    for (l, entry) in row.iter_mut().enumerate() {
                        *entry = factors[0][b] * tau_z[l]
                            + factors[1][b] * tau_z[n + l]
                            + factors[2][b] * tau_z[2 * n + l];
                    }
                }
            }
        }
    }
}
