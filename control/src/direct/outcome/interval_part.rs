//! What an interval adds to the Lagrange function, as a function of the states at its ends and of its
//! duration.

use crate::direct::interior::iterate::Interior;
use crate::direct::motion::shape::POINTS;
use crate::direct::motion::spline::Spline;
use crate::direct::newton::interval::{add_gradient, add_local};
use crate::direct::newton::point_terms::{Gradients, Second, Work};
use crate::direct::newton::rate_rows::RateRows;
use crate::direct::points::values::PointDynamics;

/// The derivatives of the part of one interval, with the multipliers.
///
/// The Lagrange function of what remains of a motion is a value function: minus its derivatives by the state
/// at a node are the costates there, and its derivative by the time that remains, at constant states, is
/// -H*. All else that an interval depends on is stationary, however it is scaled with the duration. So minus
/// the derivative of its part by its duration is the mean of H* on it, and the sum over a phase is that by
/// the time of the phase, exactly for this mesh.
pub(super) struct IntervalPart {
    work: Work,
    rows: RateRows,
    /// By the unknowns of the motion.
    gradient: Vec<f64>,
    /// Sums of the magnitudes of what the points add to that.
    terms: Vec<f64>,
    /// Derivatives of the Lagrange function per second by (q, v, a), 3n for each point of the interval.
    densities: Vec<f64>,
    /// By the duration of the interval: minus the mean of H* on it.
    pub by_duration: f64,
    scaled: Vec<f64>,
    magnitudes: Vec<f64>,
}

impl IntervalPart {
    /// Room for n joints and so many rows of tasks and powers.
    pub fn new(spline: &Spline, rows: [usize; 2]) -> Self {
        let n = spline.dof;
        Self {
            work: Work::new(n, rows),
            rows: RateRows::new(n),
            gradient: vec![0.0; spline.unknowns.len()],
            terms: vec![0.0; spline.unknowns.len()],
            densities: vec![0.0; 3 * n * spline.mesh.shape.places().len()],
            by_duration: 0.0,
            scaled: vec![0.0; 3 * n],
            magnitudes: vec![0.0; 3 * n],
        }
    }

    /// Takes interval `k` of an iterate whose points are contracted.
    pub fn take<D: PointDynamics>(&mut self, interior: &mut Interior<D>, k: usize) {
        let Interior { spline, points, barrier, running, .. } = interior;
        let (n, node, mesh) = (spline.dof, spline.node(), &spline.mesh);
        // That of the interval alone, which nothing else reads.
        let (inner, first) = (mesh.shape.inner() * n, node * mesh.nodes.len());
        for vector in [&mut self.gradient, &mut self.terms] {
            vector[node * k..node * (k + 2)].fill(0.0);
            vector[first + inner * k..first + inner * (k + 1)].fill(0.0);
        }
        // The cost of time, which does not depend on the unknowns.
        let (time, mut by_time) = (spline.clock(k), running.time * mesh.width(k));
        // Those of rates of torques are added afterwards.
        let has_torques = std::mem::replace(&mut points.rates.has_torques, false);
        for (j, part) in mesh.shape.weights().iter().enumerate() {
            let p = mesh.first_point(k) + j;
            let (work, points) = (&mut self.work, &*points);
            let (weight, cost) =
                work.collect(p, (Second::Nothing, Gradients::All), spline, points, barrier, running);
            // A node that is a point belongs to the intervals beside it in proportion to their widths.
            let own = part * mesh.width(k) / weight;
            let factors = spline.factors(k, j);
            self.work.differentiate_in_time(points.z(p), spline, k, &factors);
            self.scaled.iter_mut().zip(&self.work.z[0]).for_each(|(to, from)| *to = own * from);
            by_time += own * weight * cost;
            by_time += self.scaled.iter().zip(&self.work.z_t).map(|(a, b)| a * b).sum::<f64>();
            add_gradient(spline, k, &factors, &self.scaled, &mut self.gradient);
            self.magnitudes.iter_mut().zip(&self.scaled).for_each(|(to, from)| *to = from.abs());
            let factors = factors.map(|row| row.map(f64::abs));
            add_gradient(spline, k, &factors, &self.magnitudes, &mut self.terms);
            let densities = self.densities[3 * n * j..].iter_mut().zip(&self.work.z[0]);
            densities.for_each(|(to, from)| *to = from / (weight * time));
        }
        points.rates.has_torques = has_torques;
        if has_torques {
            self.rows.differentiate_torques(k, spline, points);
        }
        let rates = if mesh.shape.is_smooth() { POINTS } else { 0 };
        for (j, i) in (0..rates).flat_map(|j| (0..n).map(move |i| (j, i))) {
            let (rates, p) = (&points.rates, n * (POINTS * k + j) + i);
            let [first, _] = self.rows.take_jerk(k, j, i, spline, points);
            let of_jerk = rates.jerk_terms[p].first[0];
            add_local(spline, k, &self.rows.row, of_jerk, &mut self.gradient);
            self.rows.row.iter_mut().for_each(|entry| *entry = entry.abs());
            add_local(spline, k, &self.rows.row, of_jerk.abs(), &mut self.terms);
            by_time += rates.jerk_terms[p].cost + rates.jerk_terms[p].first[0] * first;
            if has_torques {
                let first = self.rows.take_torque_rate(k, j, i, spline, points);
                let of_torque = rates.torque_terms[p].first[0];
                add_local(spline, k, &self.rows.row, of_torque, &mut self.gradient);
                self.rows.row.iter_mut().for_each(|entry| *entry = entry.abs());
                add_local(spline, k, &self.rows.row, of_torque.abs(), &mut self.terms);
                by_time += rates.torque_terms[p].cost + rates.torque_terms[p].first[0] * first;
            }
        }
        // v and a are constant: q' = T v, q'' = T^2 a.
        let states = self.gradient.iter().zip(&spline.unknowns).enumerate().skip(node * k).take(2 * node);
        for (i, (g, x)) in states.filter(|(i, _)| !mesh.is_end(i / node)) {
            by_time += [0.0, 1.0, 2.0][i % node / n] * g * x / time;
        }
        self.by_duration = by_time / mesh.width(k);
    }

    /// Adds the derivatives by the unknowns of interval `k`, and the sums of magnitudes.
    pub fn add_to(&self, spline: &Spline, k: usize, to: [&mut Vec<f64>; 2]) {
        let (node, inner) = (spline.node(), spline.mesh.shape.inner() * spline.dof);
        let first = node * spline.mesh.nodes.len() + inner * k;
        for (to, from) in to.into_iter().zip([&self.gradient, &self.terms]) {
            for range in [node * k..node * (k + 2), first..first + inner] {
                to[range.clone()].iter_mut().zip(&from[range]).for_each(|(to, from)| *to += from);
            }
        }
    }

    /// Derivatives by q and v at a node, 2n, times `sign`.
    pub fn by_state(&self, spline: &Spline, k: usize, sign: f64) -> Vec<f64> {
        let mut all = self.by_node(spline, k, sign);
        all.truncate(2 * spline.dof);
        all
    }

    /// Derivatives by q, v and, where it is continuous, a at a node, n each, times `sign`, from those by the
    /// unknowns: v = x/T, a = x/T^2.
    pub fn by_node(&self, spline: &Spline, k: usize, sign: f64) -> Vec<f64> {
        let (n, node, time) = (spline.dof, spline.node(), spline.clock_at(k));
        let entries = self.gradient[node * k..node * (k + 1)].iter().enumerate();
        entries.map(|(i, g)| sign * time.powi((i / n) as i32) * g).collect()
    }

    /// Derivatives of the Lagrange function per second by (q, v, a) at point `j`.
    pub fn densities(&self, j: usize) -> &[f64] {
        let width = self.scaled.len();
        &self.densities[width * j..width * (j + 1)]
    }
}
