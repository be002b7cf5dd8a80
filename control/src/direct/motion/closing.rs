//! First guesses of robots whose loops are closed.

use crate::constants::checks::gait::{GUESSED_HEIGHT, GUESSED_IMPULSE, NEAR};
use crate::problem::loop_rows::{Loops, Walk};
use costate::constraints::ConstrainedHamiltonian;

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
    /// The time of the step (s).
    time: f64,
}

impl<'a> Stepping<'a> {
    pub fn new(loops: &'a Loops, time: f64) -> Option<Self> {
        Some(Self { loops, walk: loops.walk.as_ref()?, time })
    }

    /// The state at the part s of a step, from positions of the joints that say what it is near: one foot
    /// stands, the other one swings in an arch. The multipliers carry the weight.
    pub fn guess(&self, s: f64, near: impl Fn(f64, &mut [f64]), q: &mut [f64], rate: &mut [f64]) {
        let n = self.walk.shift.len();
        let at = |s: f64| {
            let mut q = vec![0.0; n];
            near(s, &mut q);
            self.place(s, &mut q);
            q
        };
        let (before, after) = ((s - NEAR).max(0.0), (s + NEAR).min(1.0));
        q[..n].copy_from_slice(&at(s));
        for ((rate, from), to) in rate.iter_mut().zip(at(before)).zip(at(after)) {
            *rate = (to - from) / (after - before);
        }
        let (time, first) = (self.time, GUESSED_IMPULSE);
        for (k, lift) in self.walk.lift.iter().enumerate() {
            q[n + k] = lift * time * time * s * (first + 0.5 * s);
            rate[n + k] = lift * time * time * (first + s);
        }
    }

    /// Moves the joints to the nearest position with both feet where they shall be, if there is one.
    fn place(&self, s: f64, q: &mut [f64]) {
        let gait = &self.walk.gait;
        let part = 2.0 * s - 1.0;
        let [of_clearance, of_length] = GUESSED_HEIGHT;
        let height = of_clearance * gait.clearance + of_length * gait.length;
        let mut robot = self.loops.robot.clone();
        for (swings, [x, y]) in gait.swing.iter().zip(&self.walk.places) {
            let at = [x + part * gait.length, -y, height * (1.0 - part * part)];
            let Ok(with) = robot.with_constraint(gait.placed(swings, swings, at)) else { return };
            robot = with;
        }
        let (mut closed, held) = (q.to_vec(), vec![false; q.len()]);
        if ConstrainedHamiltonian::<f64>::new(&robot).close(&mut closed, &held).is_ok() {
            q.copy_from_slice(&closed);
        }
    }
}
