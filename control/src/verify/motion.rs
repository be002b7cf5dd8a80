//! The equations of motion between nodes, by an implicit method.

use super::dynamics::InverseDynamics;
use super::path::{Path, Piece};
use super::splits::Splits;
use crate::numerics::dormand_prince::Stopped;
use crate::numerics::lu;
use crate::numerics::radau::{Radau, System};
use crate::problem::limits::JointLimits;
use costate::EvalError;

/// Tolerance of a step, relative to that of the sum of all defects.
const STEP: f64 = 1e-3;
/// Bounds of this tolerance.
const STEPS: [f64; 2] = [1e-9, 1e-5];

/// How far the motion is from what its torques make of it.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Defects {
    /// For each piece the largest difference of a position or rate at its end, relative to its size.
    pub pieces: Vec<f64>,
    /// The piece with the largest one, and the coordinate.
    pub worst: Option<(usize, usize)>,
}

impl Defects {
    /// Their sum: what is off at one node moves what follows by about as much.
    pub fn sum(&self) -> f64 {
        self.pieces.iter().sum()
    }
}

/// Integrates each piece of a motion from its own start with the torques of inverse dynamics, cut to their
/// limits: what has no motor has no torque, and constraints and contacts are kept by their own forces, whose
/// equations are those of further coordinates.
///
/// $\ddot q = a + \tau_a^{-1} (u(t) - \tau(q, \dot q, a))$ with the acceleration a of the motion, by Radau's
/// method from node to node: stiff joints take no more steps than others, and what is unstable grows over one
/// piece alone. `sizes` are those of (q, v), `joints` the number of coordinates that count.
///
/// # Errors
/// States that cannot be evaluated; steps that become too short; `stops`, which says whether the search is to
/// stop.
pub(crate) fn defects(
    (path, splits): (&Path, &Splits),
    dynamics: &mut dyn InverseDynamics,
    limits: &[JointLimits],
    sizes: &[f64],
    joints: usize,
    bound: f64,
    stops: &mut dyn FnMut() -> bool,
) -> Result<Defects, Stopped> {
    let n = path.dof;
    let mut radau = Radau::new(2 * n, (STEP * bound).clamp(STEPS[0], STEPS[1]));
    radau.sizes.copy_from_slice(sizes);
    let mut found = Defects { pieces: vec![0.0; path.pieces.len()], worst: None };
    let (mut x, mut z) = (vec![0.0; 2 * n], vec![0.0; 2 * n]);
    let mut largest = 0.0;
    let zeros = |count: usize| vec![0.0; count];
    let mut equations = Driven {
        dynamics,
        stops,
        limits,
        piece: &path.pieces[0],
        z: zeros(3 * n),
        tau: zeros(n),
        applied: zeros(n),
        tau_z: zeros(3 * n * n),
        mass: zeros(n * n),
        exchanges: vec![0; n],
        solved: zeros(2 * n * n),
    };
    for (k, piece) in path.pieces.iter().enumerate() {
        equations.piece = piece;
        piece.at(0.0, &mut x);
        for pair in splits.of(k).windows(2) {
            radau.integrate(&mut x, pair[0]..pair[1], 0.5, &mut equations)?;
        }
        piece.at(1.0, &mut z);
        for i in (0..2 * n).filter(|i| i % n < joints) {
            let part = ((x[i] - z[i]) / sizes[i]).abs();
            let part = if part.is_nan() { f64::INFINITY } else { part };
            found.pieces[k] = found.pieces[k].max(part);
            if part > largest {
                (largest, found.worst) = (part, Some((k, i % n)));
            }
        }
    }
    Ok(found)
}

/// A robot under the torques of a piece, over the part x of it.
struct Driven<'a> {
    dynamics: &'a mut dyn InverseDynamics,
    stops: &'a mut dyn FnMut() -> bool,
    limits: &'a [JointLimits],
    piece: &'a Piece,
    z: Vec<f64>,
    tau: Vec<f64>,
    applied: Vec<f64>,
    tau_z: Vec<f64>,
    mass: Vec<f64>,
    exchanges: Vec<usize>,
    solved: Vec<f64>,
}

impl System for Driven<'_> {
    fn linearise(
        &mut self,
        x: f64,
        state: &[f64],
        rate: &mut [f64],
        jacobian: &mut [f64],
    ) -> Result<(), EvalError> {
        let (n, h, phase) = (self.tau.len(), self.piece.length, self.piece.phase);
        self.piece.at(x, &mut self.z);
        self.dynamics.torques(phase, &self.z, &mut self.applied)?;
        for (tau, limit) in self.applied.iter_mut().zip(self.limits) {
            *tau = tau.max(limit.torque[0]).min(limit.torque[1]);
        }
        self.z[..2 * n].copy_from_slice(state);
        self.dynamics.linearise(phase, &self.z, &mut self.tau, &mut self.tau_z)?;
        for (i, row) in self.tau_z.chunks_exact(3 * n).enumerate() {
            self.mass[n * i..n * (i + 1)].copy_from_slice(&row[2 * n..]);
            self.solved[2 * n * i..2 * n * (i + 1)].copy_from_slice(&row[..2 * n]);
            self.applied[i] -= self.tau[i];
        }
        if !lu::eliminate(&mut self.mass, n, n, &mut self.exchanges) {
            return Err(super::singular());
        }
        lu::solve(&self.mass, n, &self.exchanges, &mut self.applied, 1);
        lu::solve(&self.mass, n, &self.exchanges, &mut self.solved, 2 * n);
        jacobian.fill(0.0);
        for i in 0..n {
            rate[i] = h * state[n + i];
            rate[n + i] = h * (self.z[2 * n + i] + self.applied[i]);
            jacobian[2 * n * i + n + i] = h;
            let row = &mut jacobian[2 * n * (n + i)..2 * n * (n + i + 1)];
            row.iter_mut().zip(&self.solved[2 * n * i..]).for_each(|(to, from)| *to = -h * from);
        }
        Ok(())
    }

    fn is_linear(&self) -> bool {
        false
    }

    fn stops(&mut self) -> bool {
        (self.stops)()
    }
}
