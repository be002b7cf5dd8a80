//! First and second derivatives of the Lagrangian of the barrier problem at one point, in z = (q, v, a).

use super::interval::row_length;
use super::side_terms::entry_terms;
use crate::direct::limits::barrier::Barrier;
use crate::direct::limits::ends::Ends;
use crate::direct::limits::side::Limited;
use crate::direct::motion::shape::MOST_COEFFICIENTS;
use crate::direct::motion::spline::{Spline, TimeDerivative};
use crate::direct::points::running::{ByClock, Running};
use crate::direct::points::values::Points;
use crate::numerics::padded::{add_rows, add_squares, pad};
use costate_numerics::in_widest;

/// What is collected of the Hessian of a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Second {
    All,
    /// Without second derivatives of torques and rows.
    Squares,
    Nothing,
}

/// Which gradients of a point are collected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Gradients {
    All,
    /// The one at mu = 0 alone, of a barrier whose [entries are apart](Barrier::is_apart): that of the cost.
    /// The other ones are not complete.
    OfCost,
}

impl Gradients {
    /// Those of a program with such ends: derivatives by times need the other ones too.
    pub fn for_times(ends: &Ends) -> Self {
        if ends.times.count() > 0 { Self::All } else { Self::OfCost }
    }
}

/// A limit that is touched for an instant ([`touches`](super::touches)).
#[derive(Clone, Debug)]
pub(crate) struct Touch {
    /// The interval, and the part of it.
    pub k: usize,
    pub x: f64,
    /// The gradients of d and of its derivative in time, in z = (q, v, a).
    pub rows: [Vec<f64>; 2],
    /// What their squares count: how stiff the limit is, and $M / \ddot d$.
    pub curvatures: [f64; 2],
}

/// Arrays of one point.
#[derive(Clone, Debug, Default)]
pub(crate) struct Work {
    /// Gradients in z: with the multipliers, at mu = 0, factor of mu, and H z_T; each of [`row_length`].
    pub z: [Vec<f64>; 4],
    /// The same in the rows of this point, without the last one: torques, rows of tasks, rows of powers.
    rows: [Vec<f64>; 3],
    /// Second derivatives by limits of z, 3n, and of rows, with the effort.
    curvature: Vec<f64>,
    row_curvature: Vec<f64>,
    /// The gradients of the rows in z, each of [`row_length`].
    row_z: Vec<f64>,
    /// 3n rows of [`row_length`]: with the limits and the squares of the torques.
    pub hessian: Vec<f64>,
    /// Its product with dz/dT, a row of it.
    pub product: Vec<f64>,
    /// dz/dT at constant unknowns, and the second derivative.
    pub z_t: Vec<f64>,
    pub z_tt: Vec<f64>,
    /// Derivatives by the time since the start of the motion, where there are references.
    pub clock: ByClock,
    /// Numbers of rows of tasks and of powers.
    counts: [usize; 2],
}

impl Work {
    /// Room for n joints and so many rows of tasks and of powers.
    pub fn new(n: usize, counts: [usize; 2]) -> Self {
        let (width, rows) = (row_length(n), n + counts[0] + counts[1]);
        let zeros = |length: usize| vec![0.0; length];
        Self {
            z: [zeros(width), zeros(width), zeros(width), zeros(width)],
            rows: [zeros(rows), zeros(rows), zeros(rows)],
            curvature: zeros(3 * n),
            row_curvature: zeros(rows),
            row_z: zeros(rows * width),
            hessian: zeros(3 * n * width),
            product: zeros(width),
            z_t: zeros(3 * n),
            z_tt: zeros(3 * n),
            clock: ByClock { mixed: zeros(3 * n), ..ByClock::default() },
            counts,
        }
    }

    /// Gradients and Hessian of a point in z. Its weight in the integral over s, and its running cost.
    #[inline(never)]
    pub fn collect(
        &mut self,
        p: usize,
        (second, gradients): (Second, Gradients),
        spline: &Spline,
        points: &Points,
        barrier: &Barrier,
        running: &mut Running,
    ) -> (f64, f64) {
        in_widest!(self.collect_terms(p, (second, gradients), spline, points, barrier, running))
    }

    #[inline(always)]
    fn collect_terms<const FUSED: bool>(
        &mut self,
        p: usize,
        (second, gradients): (Second, Gradients),
        spline: &Spline,
        points: &Points,
        barrier: &Barrier,
        running: &mut Running,
    ) -> (f64, f64) {
        let (n, width) = (points.dof, row_length(points.dof));
        let time = spline.clock(spline.mesh.interval_of(p).0);
        let (_, weight) = spline.mesh.point(p);
        let (z, tau) = (points.z(p), points.tau(p));
        self.z.iter_mut().chain(&mut self.rows).for_each(|vector| vector.fill(0.0));
        self.curvature.fill(0.0);
        self.row_curvature.fill(0.0);
        self.take_rows(p, points);
        // The running cost, then its effort and its energy.
        match second {
            Second::All => pad(points.hessian(p), 3 * n, &mut self.hessian, width),
            Second::Squares | Second::Nothing => self.hessian.fill(0.0),
        }
        let [gradient, _, _, slope] = &mut self.z;
        let mut cost = running.add_terms(z, [weight, time], gradient, slope, &mut self.hessian);
        if running.references.any() {
            let (at, own) = ((spline.time_of(p), z), running.panels.weight(spline, p));
            let (hessian, clock) = (&mut self.hessian, &mut self.clock);
            let value = running.add_references(at, [own, time], gradient, slope, hessian, clock);
            cost += if own > 0.0 { own / weight * value } else { 0.0 };
        }
        for (i, row) in self.row_z[..n * width].chunks_exact(width).enumerate() {
            let force = running.effort[i] * tau[i];
            cost += 0.5 * force * tau[i];
            self.rows[0][i] = time * weight * force;
            self.row_curvature[i] = time * weight * running.effort[i];
            add_rows::<FUSED>(&mut self.z[3], &[weight * force], row);
        }
        cost += self.add_energy::<FUSED>(p, [weight, time], points, running);
        let [gradient, at_zero, ..] = &mut self.z;
        at_zero.copy_from_slice(gradient);
        let [gradient, at_zero, _] = &mut self.rows;
        at_zero.copy_from_slice(gradient);
        let wanted = match gradients {
            Gradients::All => {
                self.add_sides(p, spline.mesh.interval_of(p), n, barrier);
                0..3
            }
            Gradients::OfCost => 1..2,
        };
        for variant in wanted {
            let (rows, by_torques) = (&mut self.rows[variant], &points.rates.by_torques[variant]);
            if points.rates.has_torques {
                rows[..n].iter_mut().zip(&by_torques[n * p..]).for_each(|(tau, by_rate)| *tau += by_rate);
            }
            add_rows::<FUSED>(&mut self.z[variant], rows, &self.row_z);
        }
        if second != Second::Nothing {
            self.add_squares_of_rows::<FUSED>(p, points);
        }
        for i in 0..3 * n {
            self.hessian[width * i + i] += self.curvature[i];
        }
        (weight, cost)
    }

    /// The same of references alone at a time since the start of the motion, with this weight in the integral
    /// over s, in a phase that takes `clock` seconds. Their cost per second.
    pub fn collect_references(
        &mut self,
        (time_since, z): (f64, &[f64]),
        [weight, clock]: [f64; 2],
        running: &mut Running,
    ) -> f64 {
        self.z.iter_mut().for_each(|vector| vector.fill(0.0));
        self.hessian.fill(0.0);
        let ([gradient, at_zero, _, slope], hessian) = (&mut self.z, &mut self.hessian);
        let at = (time_since, z);
        let value = running.add_references(at, [weight, clock], gradient, slope, hessian, &mut self.clock);
        at_zero.copy_from_slice(gradient);
        value
    }

    /// The squares of two rows, of 3n, with these second derivatives; no gradient.
    pub fn collect_squares(&mut self, rows: &[Vec<f64>; 2], curvatures: [f64; 2]) {
        self.z.iter_mut().for_each(|vector| vector.fill(0.0));
        self.hessian.fill(0.0);
        for (row, curvature) in rows.iter().zip(curvatures) {
            let width = self.hessian.len() / row.len();
            for (i, to) in self.hessian.chunks_exact_mut(width).enumerate() {
                to.iter_mut().zip(row).for_each(|(to, entry)| *to += curvature * row[i] * entry);
            }
        }
    }

    /// Adds the squares of the rows to the Hessian.
    #[inline(always)]
    fn add_squares_of_rows<const FUSED: bool>(&mut self, p: usize, points: &Points) {
        let (n, width) = (points.dof, row_length(points.dof));
        let (of_torques, others) = self.row_curvature.split_at(n);
        let (of_tasks, of_powers) = others.split_at(self.counts[0]);
        let (torques, others) = self.row_z.split_at(n * width);
        let (tasks, powers) = others.split_at(self.counts[0] * width);
        // Most rows of tasks depend on positions alone.
        let rates = points.g_x(p).chunks_exact(2 * n).flat_map(|row| &row[n..]);
        let of_states = if rates.copied().all(|entry| entry == 0.0) { n } else { 2 * n };
        let parts = [(of_torques, torques, 3 * n), (of_tasks, tasks, of_states), (of_powers, powers, 3 * n)];
        for (curvatures, rows, columns) in parts {
            add_squares::<FUSED>(&mut self.hessian, [width, columns], curvatures, rows);
        }
    }

    /// Takes the gradients of the rows of a point.
    #[inline(always)]
    fn take_rows(&mut self, p: usize, points: &Points) {
        let (n, width) = (points.dof, row_length(points.dof));
        let (tau_z, others) = self.row_z.split_at_mut(n * width);
        let (g_x, h_z) = others.split_at_mut(self.counts[0] * width);
        pad(points.tau_z(p), 3 * n, tau_z, width);
        pad(points.g_x(p), 2 * n, g_x, width);
        pad(points.h_z(p), 3 * n, h_z, width);
    }

    /// The cost of energy at a point, a function of the first rows h. Its value.
    #[inline(always)]
    fn add_energy<const FUSED: bool>(
        &mut self,
        p: usize,
        [weight, time]: [f64; 2],
        points: &Points,
        running: &Running,
    ) -> f64 {
        let (width, first, mut cost) = (row_length(points.dof), points.dof + self.counts[0], 0.0);
        for i in 0..running.energy.weights.len() {
            let term = running.energy.term(i, points.h(p)[i]);
            cost += term.value;
            self.rows[0][first + i] = time * weight * term.first;
            self.row_curvature[first + i] = time * weight * term.second;
            let row = &self.row_z[width * (first + i)..width * (first + i + 1)];
            add_rows::<FUSED>(&mut self.z[3], &[weight * term.first], row);
        }
        cost
    }

    /// The limits of a point.
    #[inline(always)]
    fn add_sides(&mut self, p: usize, place: (usize, usize), n: usize, barrier: &Barrier) {
        for ((i, side), at) in barrier.sides().iter().enumerate().zip(barrier.at_point(p)) {
            let (parts, sigma) = entry_terms(barrier, place, i, at);
            let (gradients, curvatures, index) = match side.limited {
                Limited::Torque => (&mut self.rows[..], &mut self.row_curvature, side.joint),
                Limited::Task => (&mut self.rows[..], &mut self.row_curvature, n + side.joint),
                Limited::Power | Limited::TorqueSpeed | Limited::ToolAcceleration => {
                    (&mut self.rows[..], &mut self.row_curvature, n + self.counts[0] + side.joint)
                }
                _ => (&mut self.z[..], &mut self.curvature, side.index(n)),
            };
            gradients.iter_mut().zip(parts).for_each(|(to, part)| to[index] += part);
            curvatures[index] += sigma;
        }
    }

    /// Derivatives of z = (q, q'/T, q''/T^2) in the time T of the phase of interval `k`, at constant
    /// unknowns. Those that are derivatives in time, of the order m, are in z with the powers `T^(m - s)`,
    /// s = 0, 1, 2.
    #[inline(never)]
    pub fn differentiate_in_time(
        &mut self,
        z: &[f64],
        spline: &Spline,
        k: usize,
        factors: &[[f64; MOST_COEFFICIENTS]; 3],
    ) {
        let (n, inverse) = (z.len() / 3, 1.0 / spline.clock(k));
        let square = inverse * inverse;
        for i in 0..n {
            let (v, a) = (z[n + i], z[2 * n + i]);
            (self.z_t[i], self.z_t[n + i], self.z_t[2 * n + i]) = (0.0, -inverse * v, -2.0 * inverse * a);
            (self.z_tt[i], self.z_tt[n + i], self.z_tt[2 * n + i]) =
                (0.0, 2.0 * square * v, 6.0 * square * a);
        }
        for TimeDerivative { column, order, first } in spline.time_derivatives(k) {
            for (s, factors) in factors.iter().enumerate() {
                let part = factors[column] * order;
                let second = part * square * (order - 1.0 - 2.0 * s as f64);
                for (i, x) in spline.unknowns[first..first + n].iter().enumerate() {
                    self.z_t[s * n + i] += part * inverse * x;
                    self.z_tt[s * n + i] += second * x;
                }
            }
        }
    }
}
