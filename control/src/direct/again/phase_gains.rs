//! The gains of the optimal feedback: what the rest of a motion makes of a state on its way.
//!
//! The rest of a motion from a place in a phase on is a motion of its own, whose start is given. A state at
//! the start of the phase, all of it given, leads to one state and one control at each place behind it, and
//! the control by the state there is the gain. What was before the start of the phase is over: its times are
//! given too.

use super::feedback::Feedback;
use crate::direct::interior::iterate::Interior;
use crate::direct::limits::ends::Ends;
use crate::direct::motion::shape::{PLACES, POINTS};
use crate::direct::points::values::PointDynamics;
use crate::numerics::chain::dot;
use crate::numerics::lu::eliminate;

impl Ends {
    /// What is given at the ends of phases where all of the state at the start of a phase is, and its time.
    /// The end of a periodic motion is where it is.
    fn behind(&self, phase: usize) -> Self {
        let mut ends = self.clone();
        ends.given[phase].fill(true);
        if self.is_periodic {
            ends.given.iter_mut().last().into_iter().for_each(|given| given.fill(true));
        }
        ends.tied.clear();
        ends.times = self.times.after(phase);
        ends
    }
}

impl<D: PointDynamics> Interior<D> {
    /// Fills the gains of all phases. The equations are factorised before and afterwards.
    pub(super) fn fill_gains(&mut self, feedback: &mut Feedback) {
        let phases = self.spline.times.len();
        let is_smooth = self.spline.mesh.shape.is_smooth();
        if is_smooth && !self.running.rates.cost_all(self.spline.dof) {
            feedback.gains.fill(f64::NAN);
            return;
        }
        let is_given = !self.ends.is_periodic && self.ends.given[0].iter().all(|given| *given);
        // The equations of the motion are those of the first phase then.
        let is_whole = is_given && !is_smooth;
        let mut given = std::mem::take(&mut feedback.given);
        if given.len() != phases {
            given = (0..phases).map(|phase| self.ends.behind(phase)).collect();
        }
        for phase in (if is_whole { 1 } else { 0 }..phases).rev() {
            std::mem::swap(&mut self.ends, &mut given[phase]);
            self.assemble();
            let is_known = match is_smooth {
                true => self.ends.times.count() == 0 && self.take_rests(phase, feedback),
                // A part of a positive definite matrix is so too.
                false => self.factorise(0.0),
            };
            if is_known && !is_smooth {
                self.take_phase(phase, feedback);
            }
            std::mem::swap(&mut self.ends, &mut given[phase]);
            self.fill_gains_of(phase, is_known, feedback);
        }
        feedback.given = given;
        if !is_whole || phases > 1 {
            self.assemble();
            self.factorise(0.0);
        }
        if is_whole {
            self.take_phase(0, feedback);
            self.fill_gains_of(0, true, feedback);
        }
    }

    /// States and controls at Gauss's points of a phase by the state at its start.
    fn take_phase(&mut self, phase: usize, feedback: &mut Feedback) {
        let (n, m, mesh) = (self.spline.dof, self.spline.node(), self.spline.mesh.clone());
        for j in 0..m {
            feedback.changes[phase][j] = 1.0;
            self.respond(&feedback.changes);
            feedback.changes[phase][j] = 0.0;
            for p in POINTS * mesh.ends()[phase]..POINTS * mesh.ends()[phase + 1] {
                self.change_of_z(p, 0);
                self.hold_time(p, phase, &mut feedback.z);
                let states = &mut feedback.own_states[m * m * p..][..m * m];
                states.chunks_exact_mut(m).zip(&self.trial.dz).for_each(|(row, dx)| row[j] = *dx);
                let controls = feedback.own_controls[n * m * p..][..n * m].chunks_exact_mut(m);
                for (row, tau_z) in controls.zip(self.points.tau_z(p).chunks_exact(3 * n)) {
                    row[j] = dot(tau_z, &self.trial.dz);
                }
            }
        }
    }

    /// Turns changes at the same part of the time of a phase, in the trial, into those at the same time since
    /// its start, where times are given later on: what is left of the time matters then.
    fn hold_time(&mut self, p: usize, phase: usize, z: &mut [f64]) {
        let (n, k, step) = (self.spline.dof, p / POINTS, self.time_steps[0][phase]);
        let matters = self.ends.times.is_given_after(phase) || self.running.references.any();
        if step == 0.0 || !matters {
            return;
        }
        let x = PLACES[p % POINTS];
        let place = self.spline.mesh.nodes[k] + x * self.spline.mesh.width(k) - phase as f64;
        let dt = place * step;
        self.spline.in_interval(k, x, z);
        self.trial.dz.iter_mut().zip(&z[n..]).for_each(|(dz, rate)| *dz -= dt * rate);
    }

    /// `K = u_x0 X^-1` at Gauss's points of a phase, with X the derivative of the state there and u_x0 that
    /// of the control; NaN where they are not known.
    fn fill_gains_of(&self, phase: usize, is_known: bool, feedback: &mut Feedback) {
        let (n, m, ends) = (self.spline.dof, self.spline.node(), self.spline.mesh.ends());
        let width = m + n;
        let Feedback { own_states, own_controls, gains, work, exchanges, .. } = feedback;
        for p in POINTS * ends[phase]..POINTS * ends[phase + 1] {
            let (states, controls) = (&own_states[m * m * p..], &own_controls[n * m * p..]);
            let gain = &mut gains[n * m * p..][..n * m];
            // X'K' = u_x0'.
            for (i, row) in work.chunks_exact_mut(width).enumerate() {
                let (left, right) = row.split_at_mut(m);
                left.iter_mut().enumerate().for_each(|(l, entry)| *entry = states[m * l + i]);
                right.iter_mut().enumerate().for_each(|(l, entry)| *entry = controls[m * l + i]);
            }
            if !is_known || !eliminate(work, width, m, exchanges) {
                gain.fill(f64::NAN);
                continue;
            }
            for l in 0..n {
                for i in (0..m).rev() {
                    let row = &work[width * i..width * (i + 1)];
                    let known: f64 = (i + 1..m).map(|k| row[k] * gain[m * l + k]).sum();
                    gain[m * l + i] = (row[m + l] - known) / row[i];
                }
            }
        }
    }
}
