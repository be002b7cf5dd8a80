//! The cost of a motion by adaptive quadrature.

use super::dynamics::InverseDynamics;
use super::path::Path;
use super::running::Running;
use super::splits::Splits;
use crate::numerics::dormand_prince::Stopped;
use crate::numerics::gauss_kronrod::{Integral, integrate};

/// Error of the quadrature, relative to the tolerance of the motion: it is the motion that is judged.
const SHARPER: f64 = 1e-2;
/// Smallest relative error that is asked for: rounding of inverse dynamics is about a hundredth of it.
const SHARPEST: f64 = 1e-12;
/// Evaluations for each piece of the motion, beside [`EVALUATIONS`] for all.
const OF_PIECE: usize = 300;
const EVALUATIONS: usize = 20_000;

/// What the quadrature of a cost of this size is asked for: its absolute and relative error, and the most
/// evaluations.
pub(crate) fn asked([tolerance, size]: [f64; 2], pieces: usize) -> ([f64; 2], usize) {
    ([(SHARPER * tolerance).max(SHARPEST) * size, 0.0], EVALUATIONS + OF_PIECE * pieces)
}

/// $J = \int_0^T l(t, q, v, \tau(q, v, a))\\, dt$ along a motion, with torques from inverse dynamics, between
/// [places](Splits) at which l is not smooth; and the integral of the penalties. `of_cost` are its
/// tolerance and size; the error is at most a hundredth of their product, unless that takes too many
/// evaluations.
///
/// # Errors
/// States that cannot be evaluated; `stops`, which says whether the search is to stop.
pub(crate) fn cost(
    path: &Path,
    splits: &Splits,
    dynamics: &mut dyn InverseDynamics,
    running: &mut Running,
    of_cost: [f64; 2],
    stops: &mut dyn FnMut() -> bool,
) -> Result<[Integral; 2], Stopped> {
    let n = path.dof;
    let (mut z, mut tau) = (vec![0.0; 4 * n], vec![0.0; n]);
    let mut rates = vec![0.0; if running.costs_torque_rates() { n } else { 0 }];
    let mut tau_z = vec![0.0; 3 * n * rates.len()];
    let (asked, most) = asked(of_cost, path.pieces.len());
    let mut penalties = false;
    let mut at = |k: usize, x: f64, running: &mut Running| -> Result<[f64; 2], Stopped> {
        if stops() {
            return Err(Stopped::Interrupted);
        }
        let piece = &path.pieces[k];
        piece.at(x, &mut z);
        if rates.is_empty() {
            dynamics.torques(piece.phase, &z, &mut tau)?;
        } else {
            dynamics.linearise(piece.phase, &z, &mut tau, &mut tau_z)?;
            for (rate, row) in rates.iter_mut().zip(tau_z.chunks_exact(3 * n)) {
                *rate = row.iter().zip(&z[n..]).map(|(a, b)| a * b).sum();
            }
        }
        let found = running.rate(piece.time(x), &z, &tau, &rates)?;
        Ok(found.map(|rate| piece.length * rate))
    };
    let cost = integrate(splits.segments(), asked, most, |k, x| {
        let [cost, penalty] = at(k, x, running)?;
        penalties |= penalty != 0.0;
        Ok::<_, Stopped>(cost)
    })?;
    let penalty = match penalties {
        true => integrate(splits.segments(), asked, most, |k, x| Ok::<_, Stopped>(at(k, x, running)?[1]))?,
        false => Integral::default(),
    };
    Ok([cost, penalty])
}
