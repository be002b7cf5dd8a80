//! What the conditions of first order need at one place of a motion, whatever its controls are.

use super::dynamics::InverseDynamics;
use super::path::{Path, Piece};
use super::running::Running;
use super::splits::Splits;
use crate::numerics::lu;
use crate::numerics::radau::{self, System};
use crate::problem::limits::JointLimits;
use costate::EvalError;

/// A control is inside its limits where it is this part of their range away from both.
pub(crate) const INSIDE: f64 = 1e-2;

/// So far from an end of a segment, relative to its length, multipliers are those of its inside.
const EDGE: f64 = 1e-9;

/// What limits with multipliers add at one place.
#[derive(Clone, Debug, Default)]
pub(crate) struct Prices {
    /// $-\sum \sigma \eta h_z$, 3n, at constant torques.
    pub by_z: Vec<f64>,
    /// The same by the torques. With torques as controls of limits on several of them together alone, others
    /// being U; with jerks of all.
    pub by_torque: Vec<f64>,
    /// $\sum \eta d$.
    pub slack: f64,
}

/// The multipliers of all limits but those of the controls.
pub(crate) trait Multipliers {
    /// Those at the part x of a piece, added to `to`, at this z and these torques.
    ///
    /// # Errors
    /// States that cannot be evaluated.
    fn add(&mut self, piece: usize, x: f64, z: &[f64], tau: &[f64], to: &mut Prices)
    -> Result<(), EvalError>;

    /// Whether the gap counts on a piece. It does not where a multiplier is given as impulses at the ends, as
    /// those of rates are on an arc: costates are a sawtooth there, and without effort the gap is of first
    /// order in its height, however good the motion is.
    fn counts(&self, _piece: usize) -> bool {
        true
    }

    /// The parts of each piece, rising, at which multipliers jump.
    fn breaks(&self) -> &[f64] {
        &[]
    }

    /// Those of rates of torques, where these are limited: adds $-\sum \sigma \eta$ of each joint to
    /// `prices` and returns $\sum \eta d$.
    fn add_rates(&mut self, _piece: usize, _x: f64, _rates: &[f64], _prices: &mut [f64]) -> f64 {
        0.0
    }
}

/// What the conditions are checked for.
pub(crate) struct Conditions<'a> {
    pub path: &'a Path,
    pub splits: &'a Splits,
    pub dynamics: &'a mut dyn InverseDynamics,
    pub running: &'a mut Running,
    pub multipliers: &'a mut dyn Multipliers,
    /// Those of all coordinates.
    pub limits: &'a [JointLimits],
    /// Whether the search is to stop.
    pub stops: &'a mut dyn FnMut() -> bool,
}

/// Costates as functions of the part x of a piece, with the gap that they leave.
pub(super) trait Adjoint<'a>: System {
    fn place(&mut self) -> &mut Place<'a>;

    /// Takes other costates that obey the same equations, where these leave smaller gaps of the pieces.
    fn settle(&mut self, _gaps: &mut [f64]) {}
}

/// What the stages of all steps have shown.
#[derive(Clone, Debug, Default)]
pub(super) struct Gaps {
    /// $\int G\\, dt$ over the piece.
    pub gap: f64,
    /// For each coordinate the largest residual of a control inside its limits with its time, and the largest
    /// of what it consists of.
    pub worst: Vec<(f64, f64)>,
    pub largest: Vec<f64>,
}

/// A motion at one place, its torques, and what the running cost and the limits make of them.
pub(super) struct Place<'a> {
    pub path: &'a Path,
    pub dynamics: &'a mut dyn InverseDynamics,
    pub running: &'a mut Running,
    pub multipliers: &'a mut dyn Multipliers,
    pub limits: &'a [JointLimits],
    pub stops: &'a mut dyn FnMut() -> bool,
    pub number: usize,
    pub counts: bool,
    /// The places between which the motion is looked at, rising: multipliers are those inside of them.
    pub inside: [f64; 2],
    /// (q, v, a, jerk).
    pub z: Vec<f64>,
    pub tau: Vec<f64>,
    pub tau_z: Vec<f64>,
    pub prices: Prices,
    /// tau_a and its factors.
    pub mass: Vec<f64>,
    pub exchanges: Vec<usize>,
    pub found: Gaps,
}

impl<'a> Place<'a> {
    pub fn new(conditions: Conditions<'a>) -> Self {
        let Conditions { path, dynamics, running, multipliers, limits, stops, .. } = conditions;
        let (n, zeros) = (path.dof, |count: usize| vec![0.0; count]);
        Self {
            path,
            dynamics,
            running,
            multipliers,
            limits,
            stops,
            number: 0,
            counts: true,
            inside: [0.0, 1.0],
            z: zeros(4 * n),
            tau: zeros(n),
            tau_z: zeros(3 * n * n),
            prices: Prices { by_z: zeros(3 * n), by_torque: zeros(n), slack: 0.0 },
            mass: zeros(n * n),
            exchanges: vec![0; n],
            found: Gaps { gap: 0.0, worst: vec![(0.0, 0.0); n], largest: zeros(n) },
        }
    }

    pub fn piece(&self) -> &'a Piece {
        &self.path.pieces[self.number]
    }

    /// The stages of a step that goes so far from a part of the piece: their parts, and what they count in
    /// the integral over time (s); none where the gap does not count.
    pub fn stages(&self, from: f64, length: f64) -> impl Iterator<Item = [f64; 2]> + use<> {
        let whole = length.abs() * self.piece().length;
        let all = radau::PLACES.iter().zip(radau::WEIGHTS).take(if self.counts { 3 } else { 0 });
        all.map(move |(place, weight)| [from + place * length, weight * whole])
    }

    /// Goes on in another piece, with a gap of zero; whether the gap counts there.
    pub fn enter(&mut self, piece: usize) -> bool {
        self.found.gap = 0.0;
        (self.number, self.counts) = (piece, self.multipliers.counts(piece));
        self.counts
    }

    /// The motion, its torques and what limits make of them, with the factors of tau_a.
    pub fn take(&mut self, x: f64) -> Result<(), EvalError> {
        let (n, piece) = (self.tau.len(), self.piece());
        piece.at(x, &mut self.z);
        self.dynamics.linearise(piece.phase, &self.z, &mut self.tau, &mut self.tau_z)?;
        self.running.differentiate(piece.time(x), &self.z, &self.tau)?;
        let Prices { by_z, by_torque, slack } = &mut self.prices;
        by_z.fill(0.0);
        by_torque.fill(0.0);
        *slack = 0.0;
        let [from, to] = self.inside;
        let edge = EDGE * (to - from);
        let inside = x.max(from + edge).min(to - edge);
        self.multipliers.add(self.number, inside, &self.z[..3 * n], &self.tau, &mut self.prices)?;
        for (i, row) in self.tau_z.chunks_exact(3 * n).enumerate() {
            self.mass[n * i..n * (i + 1)].copy_from_slice(&row[2 * n..]);
        }
        match lu::eliminate(&mut self.mass, n, n, &mut self.exchanges) {
            true => Ok(()),
            false => Err(super::singular()),
        }
    }
}
