//! First guesses of robots whose loops are closed.

use crate::problem::loop_rows::Loops;
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
