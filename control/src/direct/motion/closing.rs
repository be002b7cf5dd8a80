//! First guesses of robots whose loops are closed.

use crate::constants::checks::gait::{GUESSED_HEIGHT, GUESSED_IMPULSE, MOST_NOT_FOUND, NEAR};
use crate::problem::loop_rows::{Loops, Walk};
use costate::constraints::ConstrainedHamiltonian;
use std::cell::Cell;

/// Brings states to where the loops are closed.
pub(super) struct Closing {
    model: ConstrainedHamiltonian<f64>,
    held: Vec<bool>,
    q: Vec<f64>,
}

impl Closing {
    pub fn new(loops: &Loops) -> Self {
        let model = ConstrainedHamiltonian::new(&loops.robot);
        let n = model.dof();
        Self { model, held: vec![false; n], q: vec![0.0; n] }
    }

    /// Moves the joints to the nearest position that closes the loops, and their rates to those with J v = 0
    /// that are nearest in the metric of M. Where none is found they stay: the guess is open there.
    pub fn close(&mut self, q: &mut [f64], rate: &mut [f64]) {
        let Self { model, held, q: closed } = self;
        let n = held.len();
        closed.copy_from_slice(&q[..n]);
        if model.close(closed, held).is_err() {
            return;
        }
        let Ok(p) = model.momentum(closed, &rate[..n]).map(<[f64]>::to_vec) else { return };
        if let Ok((v, _)) = model.velocity(closed, &p) {
            rate[..n].copy_from_slice(v);
            q[..n].copy_from_slice(closed);
        }
    }
}

/// First guesses of a step.
pub(super) struct Stepping<'a> {
    loops: &'a Loops,
    walk: &'a Walk,
    /// Those of its phases (s).
    times: Vec<f64>,
    /// Positions that were not found, of which no more are looked for after a few.
    not_found: Cell<usize>,
}

impl<'a> Stepping<'a> {
    pub fn new(loops: &'a Loops, times: Vec<f64>) -> Option<Self> {
        Some(Self { loops, walk: loops.walk.as_ref()?, times, not_found: Cell::new(0) })
    }

    /// The duration of the step (s).
    fn time(&self) -> f64 {
        self.times.iter().sum()
    }

    /// The part of the step that all feet stand.
    fn double(&self) -> f64 {
        if self.walk.has_double_support() { self.times[0] / self.time() } else { 0.0 }
    }

    /// The state at a part of a phase, from positions of the joints at the parts of the step that say what it
    /// is near: first all feet stand, if they do, then those behind swing in an arch. The multipliers carry
    /// the weight.
    pub fn guess(
        &self,
        phase: usize,
        part: f64,
        near: impl Fn(f64, &mut [f64]),
        q: &mut [f64],
        rate: &mut [f64],
    ) {
        let n = self.walk.shift.len();
        let at = |s: f64| {
            let mut q = vec![0.0; n];
            near(s, &mut q);
            self.place(s, &mut q);
            q
        };
        let (time, double) = (self.time(), self.double());
        let first = self.times[..phase].iter().sum::<f64>() / time;
        let length = self.times[phase] / time;
        let s = first + length * part;
        let (before, after) = ((s - NEAR).max(first), (s + NEAR).min(first + length));
        q[..n].copy_from_slice(&at(s));
        for ((rate, from), to) in rate.iter_mut().zip(at(before)).zip(at(after)) {
            *rate = length * (to - from) / (after - before);
        }
        let (both, one) = (s.min(double), (s - double).max(0.0));
        for (k, lift) in self.walk.lift.iter().enumerate() {
            let stands = f64::from(k < self.walk.stance_rows());
            let lift = lift * time * time;
            // Two feet bear half each.
            let (begins, ends) = if double > 0.0 { (0.0, 0.5 * both) } else { (GUESSED_IMPULSE, 0.0) };
            let (at_lift_off, bears) = (begins + ends, stands);
            q[n + k] =
                lift * (begins * both + 0.25 * both * both + at_lift_off * one + 0.5 * bears * one * one);
            rate[n + k] = lift * length * (at_lift_off + bears * one);
        }
    }

    /// Moves the joints to the nearest position with all feet where they shall be, if there is one.
    fn place(&self, s: f64, q: &mut [f64]) {
        let (gait, double) = (&self.walk.gait, self.double());
        let swings = ((s - double) / (1.0 - double)).clamp(0.0, 1.0);
        // From rest to rest, where feet land without an impulse.
        let way = if double > 0.0 { swings * swings * (3.0 - 2.0 * swings) } else { swings };
        let part = 2.0 * way - 1.0;
        let [of_clearance, of_length] = GUESSED_HEIGHT;
        let height = of_clearance * gait.clearance + of_length * gait.length;
        let Some(standing) = self.loops.phases.last() else { return };
        let mut robot = standing.robot.clone();
        for (swings, [x, y]) in gait.swing.iter().zip(&self.walk.places) {
            let at = [x + part * gait.length, -y, height * (1.0 - part * part)];
            let Ok(with) = robot.with_constraint(gait.placed(swings, swings, at)) else { return };
            robot = with;
        }
        let (mut closed, held) = (q.to_vec(), vec![false; q.len()]);
        if self.not_found.get() >= MOST_NOT_FOUND {
            return;
        }
        match ConstrainedHamiltonian::<f64>::new(&robot).close(&mut closed, &held) {
            Ok(_) => q.copy_from_slice(&closed),
            Err(_) => self.not_found.set(self.not_found.get() + 1),
        }
    }
}
