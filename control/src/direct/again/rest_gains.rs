//! The gains of the optimal feedback: what the rest of a motion makes of a state on its way.
//!
//! The rest of a motion behind a node is a motion of its own, whose start is given ([`Rest`]). Its control at
//! the start by its state there is the gain at the node. Inside of an interval, at the part x of it, the
//! state at the node before leads to one state and one control, and
//!
//! $$ K = U(x) X(x)^{-1}, \qquad X(x) = \frac{\partial x(t)}{\partial x_k}, \quad U(x) = \frac{\partial
//!    u(t)}{\partial x_k} $$
//!
//! X is the identity at the node, and within an interval it stays far from singular, unless a limit of the
//! state becomes active there: such intervals have the gains of their nodes with what is linear between them.

use super::feedback::Feedback;
use crate::direct::interior::iterate::Interior;
use crate::direct::motion::shape::{PLACES, POINTS};
use crate::direct::newton::rests::Rest;
use crate::direct::points::values::PointDynamics;
use crate::numerics::chain::dot;
use crate::numerics::lagrange::values;
use crate::numerics::lu;

impl<D: PointDynamics> Interior<D> {
    /// Fills the gains. The equations are factorised before and afterwards.
    pub(super) fn fill_gains(&mut self, feedback: &mut Feedback) {
        let is_smooth = self.spline.mesh.shape.is_smooth();
        let Some(mut rest) = feedback.rest.take().filter(|rest| rest.fits(&self.spline)) else {
            feedback.rest = Some(Rest::new(&self.spline, &self.ends));
            return self.fill_gains(feedback);
        };
        let mut is_known = !is_smooth || self.running.rates.cost_all(self.spline.dof);
        rest.choose_differences(&self.spline, &self.ends);
        std::mem::swap(&mut self.spline.differences, &mut rest.differences);
        let Self { system, spline, points, barrier, running, .. } = self;
        system.begin_rests((spline, points, barrier), running, &mut rest);
        for k in (0..self.spline.mesh.intervals()).rev() {
            let Self { system, spline, points, barrier, running, ends, .. } = self;
            is_known = is_known && system.add_to_rest(k, (spline, points, barrier), running, ends, &mut rest);
            // Gains of jerks are computed for given times.
            let are_times_given = rest.parameters(self.spline.mesh.phase(k)) == 0;
            if is_known && rest.is_minimum && (are_times_given || !is_smooth) {
                self.take_interval(k, &mut rest, feedback);
            } else {
                feedback.fill_interval(k, f64::NAN);
            }
        }
        std::mem::swap(&mut self.spline.differences, &mut rest.differences);
        feedback.rest = Some(rest);
        self.assemble();
        self.factorise(0.0);
    }

    /// The gains at a node and at Gauss's points of the interval behind it.
    fn take_interval(&mut self, k: usize, rest: &mut Rest, feedback: &mut Feedback) {
        let (n, m) = (self.spline.dof, self.spline.node());
        for j in 0..m {
            self.take_column(k, j, rest, feedback);
        }
        let at_node = values(&PLACES, 0.0);
        let Feedback { own_controls, node_gains, gains, own_states, work, exchanges, .. } = feedback;
        let node_gain = &mut node_gains[n * m * k..][..n * m];
        node_gain.fill(0.0);
        for (factor, controls) in at_node.into_iter().zip(own_controls.chunks_exact(n * m)) {
            node_gain.iter_mut().zip(controls).for_each(|(to, from)| *to += factor * from);
        }
        let parts = own_states.chunks_exact(m * m).zip(own_controls.chunks_exact(n * m));
        for (j, (states, controls)) in parts.enumerate() {
            let gain = &mut gains[n * m * (POINTS * k + j)..][..n * m];
            if !divide((controls, states), [n, m], work, exchanges, gain) {
                gain.fill(f64::NAN);
            }
        }
        if self.spline.mesh.shape.is_smooth() && !self.keeps_states(k) {
            self.take_node_gain(k, feedback);
        }
        self.keep_active_rows(k, rest, feedback);
    }

    /// The gain at the node of an interval from those at Gauss's points, where all of them are finite: the
    /// parabola through what [`Feedback::gain`] interpolates. A jerk may change within an interval by as much
    /// as cheap jerks settle, and is then off at the node, while K is smooth.
    fn take_node_gain(&self, k: usize, feedback: &mut Feedback) {
        let (mesh, n, m) = (&self.spline.mesh, self.spline.dof, self.spline.node());
        let size = n * m;
        let Feedback { gains, node_gains, .. } = feedback;
        let gains = &gains[size * POINTS * k..size * POINTS * (k + 1)];
        if gains.iter().any(|entry| !entry.is_finite()) {
            return;
        }
        let node_gain = &mut node_gains[size * k..size * (k + 1)];
        node_gain.fill(0.0);
        let left = (mesh.phase(k) + 1) as f64 - mesh.nodes[k];
        for (j, factor) in values(&PLACES, 0.0).into_iter().enumerate() {
            let ratio = (left - PLACES[j] * mesh.width(k)) / left;
            let known = &gains[size * j..size * (j + 1)];
            for (to, from) in node_gain.chunks_exact_mut(m).zip(known.chunks_exact(m)) {
                let mut scale = factor;
                for (to, from) in to.chunks_exact_mut(n).zip(from.chunks_exact(n)).rev() {
                    scale *= ratio;
                    to.iter_mut().zip(from).for_each(|(to, from)| *to += scale * from);
                }
            }
        }
    }

    /// States and controls at Gauss's points of an interval by entry `j` of the state at its node.
    fn take_column(&mut self, k: usize, j: usize, rest: &mut Rest, feedback: &mut Feedback) {
        let (spline, n, m) = (&self.spline, self.spline.dof, self.spline.node());
        let (inner, rate) = (spline.mesh.shape.inner() * n, 1.0 / spline.clock(k));
        let phase = spline.mesh.phase(k);
        let Feedback { step, z, dz, own_states, own_controls, .. } = feedback;
        let dt = rest.respond(k, j, spline, step);
        let ends = step.split_at(inner);
        // What is left of the time matters where a later one is given.
        let clock = self.ends.times.is_given_after(phase) || self.running.references.any();
        for (i, &x) in PLACES.iter().enumerate() {
            if spline.mesh.shape.is_smooth() {
                let basis = spline.gauss_basis_of_changes(k, i);
                spline.change((k, &basis), ends, 0.0, self.points.z(0), dz);
                dz[3 * n..].iter_mut().for_each(|jerk| *jerk *= rate * rate * rate);
            } else {
                let (p, basis) = (POINTS * k + i, spline.basis_of_changes(k, i));
                spline.change((k, &basis), ends, dt, self.points.z(p), dz);
                if clock && dt != 0.0 {
                    spline.in_interval(k, x, z);
                    let late = x * spline.mesh.width(k) * dt;
                    dz.iter_mut().zip(&z[n..]).for_each(|(dz, rate)| *dz -= late * rate);
                }
            }
            let states = own_states[m * m * i..][..m * m].chunks_exact_mut(m);
            states.zip(&*dz).for_each(|(row, dx)| row[j] = *dx);
            let controls = own_controls[n * m * i..][..n * m].chunks_exact_mut(m);
            if spline.mesh.shape.is_smooth() {
                controls.zip(&dz[3 * n..]).for_each(|(row, jerk)| row[j] = *jerk);
            } else {
                let tau_z = self.points.tau_z(POINTS * k + i).chunks_exact(3 * n);
                controls.zip(tau_z).for_each(|(row, tau_z)| row[j] = dot(tau_z, dz));
            }
        }
    }
}

/// `K = U X^-1` of n x m and m x m entries. False where X is singular.
fn divide(
    (controls, states): (&[f64], &[f64]),
    [n, m]: [usize; 2],
    work: &mut [f64],
    exchanges: &mut [usize],
    gain: &mut [f64],
) -> bool {
    // X'K' = U'.
    let (left, right) = work[..m * (m + n)].split_at_mut(m * m);
    for i in 0..m {
        (0..m).for_each(|l| left[m * i + l] = states[m * l + i]);
        (0..n).for_each(|l| right[n * i + l] = controls[m * l + i]);
    }
    if !lu::eliminate(left, m, m, exchanges) {
        return false;
    }
    lu::solve(left, m, exchanges, right, n);
    for (l, row) in gain.chunks_exact_mut(m).enumerate() {
        row.iter_mut().enumerate().for_each(|(i, entry)| *entry = right[n * i + l]);
    }
    true
}
