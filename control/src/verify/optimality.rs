//! The conditions of first order between the points of the solver, as a bound on what a motion costs too
//! much.
//!
//! A motion z = (q, v, a) with torques tau(z) minimises $\int l\\, dt$ under limits whose multipliers are
//! $\eta \ge 0$, each with the function h and the distance $d = \sigma (h - b) \ge 0$. With
//! $L = l - \sum \sigma \eta h$, all torques inside $U(v)$ (box, power and speed of their motors), and
//! $y = l_\tau$ less the multipliers of U,
//!
//! $$ \lambda_v = \tau_a^\top y - \sum \sigma \eta h_a, \qquad
//!    \dot\lambda_q = l_q + \tau_q^\top y - \sum \sigma \eta h_q, \qquad
//!    \dot\lambda_v = l_v + \tau_v^\top y - \sum \sigma \eta h_v - \lambda_q $$
//!
//! where l_q, l_v are those at constant torques. Given the multipliers of h, these equations are linear in
//! the costates, y being a function of $\lambda_v$. They are integrated along the motion, and nothing but
//! their values at a few nodes is taken from the solver.
//!
//! The maximum principle then says that each torque gains most: with $g_i(w) = y_i w - l_i(w)$ the *gap*
//!
//! $$ G(t) = \sum_i \left( \max_{w \in U_i} g_i(w) - g_i(\tau_i) \right) + \sum \eta d $$
//!
//! is zero. Where a torque is inside its limits, $l_i = \tfrac12 r_i w^2$, this is
//! $\tfrac12 H_{u,i}^2 / r_i$ with $H_u = y - l_\tau$; at a bound it is zero if the sign of H_u is right; and
//! so it is without effort, where it is the gain of switching. In a convex problem no motion with the same
//! states at the ends of its phases and the same times of them costs less than $J - \int G\\, dt$ (weak
//! duality: for another motion with the control u', $J' - J \ge -\int (\max_w H - H)$ since the terms of
//! first order in x cancel by the equations of the costates); elsewhere this is so to second order near the
//! motion. Ends, the final time and free times are taken as they are found: transversality is not checked.
//! So the integral of G is an error of the cost, and its tolerance that of the cost. Torques outside U make G
//! negative: what they gain against the law.

use super::dynamics::InverseDynamics;
use super::path::{Path, Piece};
use super::running::Running;
use super::splits::Splits;
use crate::numerics::lu;
use crate::numerics::radau::{self, Failed, Radau, System};
use crate::numerics::random::Random;
use crate::problem::limits::JointLimits;
use costate::EvalError;

/// Tolerance of a step of the costates, relative to the root of that of the cost: the gap is a square.
const STEP: f64 = 1e-2;
/// Bounds of this tolerance.
const STEPS: [f64; 2] = [1e-8, 1e-4];
/// Differences of costates from those of the solver that are smaller than this part of the root of the
/// tolerance are errors of interpolation.
const CARRIED: f64 = 0.1;
/// Larger ones go on over nodes until the equations have made them grow by this factor: one that does not grow
/// is a defect of the motion, which counts over all that lies before it; one that grows is what an unstable
/// motion makes of an error.
const GROWN: f64 = std::f64::consts::E;
/// Parts of a motion over which gaps of either sign are added before their magnitudes are: those of which the
/// motion is integrated again where it is unstable ([`direct::PARTS`](crate::constants::direct::PARTS)), so
/// that both checks see errors over the same time.
const PARTS: usize = crate::constants::direct::PARTS as usize;
/// Where the random place in a piece lies that ends a step.
const MIDDLE: [f64; 2] = [0.35, 0.65];
/// Costates of a joint are measured by the largest ones of all joints of this part at least.
const LEAST_SCALE: f64 = 1e-3;

/// The costates of (q, v) at the ends of the pieces, 2n each, from the solver.
#[derive(Clone, Debug, Default)]
pub(crate) struct Costates {
    /// At the start of each piece, behind what makes them jump there.
    pub left: Vec<Vec<f64>>,
    /// At the end of each piece, before that.
    pub right: Vec<Vec<f64>>,
    /// By what the multipliers of limits at the start of a piece alone make them jump there, if they do:
    /// $-\sum \sigma \eta h_x$. Not at ends of phases, where integrations begin.
    pub jumps: Vec<Option<Vec<f64>>>,
}

/// What limits with multipliers add at one place.
#[derive(Clone, Debug, Default)]
pub(crate) struct Prices {
    /// $-\sum \sigma \eta h_z$, 3n, at constant torques.
    pub by_z: Vec<f64>,
    /// The same by the torques, of limits on several torques together alone; others are U.
    pub by_torque: Vec<f64>,
    /// $\sum \eta d$.
    pub slack: f64,
}

/// The multipliers of all limits but those of single torques.
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
}

/// What was found.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Optimality {
    /// $\int G\\, dt$ over each piece, in units of cost.
    pub gaps: Vec<f64>,
    /// For each piece the square of the difference of the costates from those of the solver that arises in
    /// it, relative to the largest ones.
    pub defects: Vec<f64>,
    /// $\sum |\int G\\, dt|$ over [`PARTS`] parts of the motion. Within a part, torques that overshoot their
    /// limits beside a jump, which no polynomial follows, gain what those before the jump lose.
    pub gap: f64,
    /// The largest $|H_{u,i}|$ of a torque inside its limits, relative to the largest $|l_{\tau,i}|$ and
    /// $|y_i|$ along the motion; and where: time (s) and coordinate.
    pub stationarity: f64,
    pub worst: Option<(f64, usize)>,
    /// The largest difference of the costates at a node from those of the solver, relative to the largest
    /// ones.
    pub defect: f64,
}

impl Optimality {
    /// The sum of the magnitudes of the gaps of all parts of a motion.
    fn of_parts(&self, path: &Path) -> f64 {
        let mut parts = [0.0; PARTS];
        let duration = path.duration();
        for (piece, gap) in path.pieces.iter().zip(&self.gaps) {
            let part = PARTS as f64 * piece.time(0.5) / duration;
            parts[(part as usize).min(PARTS - 1)] += gap;
        }
        parts.iter().map(|gap: &f64| gap.abs()).sum()
    }

    /// For each piece the magnitude of the gap that it causes: that of its own, or, where costates have
    /// defects, what arises in it of the difference that makes the gaps before it.
    pub fn causes(&self, tolerance: f64) -> Vec<f64> {
        let all: f64 = self.defects.iter().sum();
        match self.defect > CARRIED * tolerance.sqrt() && all > 0.0 {
            true => self.defects.iter().map(|part| self.gap * part / all).collect(),
            false => self.gaps.iter().map(|gap| gap.abs()).collect(),
        }
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
}

/// Integrates the costates backwards, from the end of each phase, by Radau's method on pieces that end at
/// [splits](Splits) and at random places.
///
/// Backwards they are as stable as the motion of the robot is forwards: friction, which damps that, would let
/// them grow in the other direction, by $e^{c h / m}$ in h seconds with the slope c of a narrow transition.
/// At a node they take the [jumps](Costates::jumps), and go on with what they have until the difference from
/// those of the solver is [large](CARRIED) and has [grown](GROWN). So a defect counts in the gaps of all
/// pieces before it, however short the piece in which it arises: a stop under dry friction takes a part of a
/// thousand of the motion whose end it is. What an unstable motion makes of small differences does not add
/// up.
///
/// # Errors
/// States that cannot be evaluated, or at which tau_a is singular.
pub(crate) fn check(
    conditions: Conditions<'_>,
    costates: &Costates,
    tolerance: f64,
    seed: u64,
) -> Result<Optimality, Failed> {
    let Conditions { path, splits, dynamics, running, multipliers, limits } = conditions;
    let n = path.dof;
    let root = tolerance.sqrt();
    let mut radau = Radau::new(2 * n, (STEP * root).clamp(STEPS[0], STEPS[1]));
    radau.sizes = sizes(costates, n);
    let mut equations = Equations::new(path, dynamics, running, multipliers, limits);
    let mut random = Random::new(seed);
    let zeros = vec![0.0; path.pieces.len()];
    let mut found = Optimality { gaps: zeros.clone(), defects: zeros, ..Optimality::default() };
    let mut costate = vec![0.0; 2 * n];
    let mut other = costate.clone();
    // The difference at the node before, and by how much the equations have made it grow while it was large.
    let (mut before, mut growth) = (0.0_f64, 1.0_f64);
    for (k, piece) in path.pieces.iter().enumerate().rev() {
        let next = path.pieces.get(k + 1);
        if next.is_none_or(|next| next.phase != piece.phase) {
            costate.copy_from_slice(&costates.right[k]);
            (before, growth) = (0.0, 1.0);
        } else {
            if let Some(jumps) = &costates.jumps[k + 1] {
                costate.iter_mut().zip(jumps).for_each(|(costate, jump)| *costate -= jump);
            }
            let most = difference(&costate, &costates.right[k], &radau.sizes);
            found.defect = found.defect.max(most);
            found.defects[k + 1] = (most * most - before * before).max(0.0);
            before = most;
            if most <= CARRIED * root {
                growth = 1.0;
            } else if growth > GROWN || !equations.multipliers.counts(k + 1) {
                costate.copy_from_slice(&costates.right[k]);
                (before, growth) = (0.0, 1.0);
            }
        }
        let mut places = splits.of(k).to_vec();
        if places.len() == 2 {
            places.insert(1, MIDDLE[0] + (MIDDLE[1] - MIDDLE[0]) * random.uniform());
        }
        (equations.piece, equations.number, equations.gap) = (piece, k, 0.0);
        equations.counts = equations.multipliers.counts(k);
        for pair in places.windows(2).rev() {
            radau.integrate(&mut costate, pair[1]..pair[0], 1.0, &mut equations)?;
        }
        found.gaps[k] = equations.gap;
        if before > CARRIED * root {
            other.copy_from_slice(&costates.right[k]);
            equations.counts = false;
            for pair in places.windows(2).rev() {
                radau.integrate(&mut other, pair[1]..pair[0], 1.0, &mut equations)?;
            }
            growth *= difference(&costate, &other, &radau.sizes) / before;
        }
    }
    found.gap = found.of_parts(path);
    if let Some(first) = costates.left.first() {
        found.defect = found.defect.max(difference(&costate, first, &radau.sizes));
    }
    let most = equations.worst.iter().zip(&equations.largest).enumerate();
    for (i, (&(residual, time), largest)) in most.filter(|(_, (_, largest))| **largest > 0.0) {
        if residual / largest > found.stationarity {
            found.stationarity = residual / largest;
            found.worst = Some((time, i));
        }
    }
    Ok(found)
}

/// The largest difference of two costates, relative to these sizes.
fn difference(one: &[f64], other: &[f64], sizes: &[f64]) -> f64 {
    let parts = one.iter().zip(other).zip(sizes);
    parts.map(|((a, b), size)| ((a - b) / size).abs()).fold(0.0, f64::max)
}

/// The largest magnitude of each costate at the nodes, at least [`LEAST_SCALE`] of the largest one of its
/// kind.
fn sizes(costates: &Costates, n: usize) -> Vec<f64> {
    let mut sizes = vec![0.0_f64; 2 * n];
    for row in costates.left.iter().chain(&costates.right) {
        sizes.iter_mut().zip(row).for_each(|(size, y)| *size = size.max(y.abs()));
    }
    for kind in sizes.chunks_exact_mut(n) {
        let most = kind.iter().fold(f64::MIN_POSITIVE, |most, size| most.max(*size));
        kind.iter_mut().for_each(|size| *size = size.max(LEAST_SCALE * most));
    }
    sizes
}

/// The costates of a piece as functions of the part x of it.
struct Equations<'a> {
    dynamics: &'a mut dyn InverseDynamics,
    running: &'a mut Running,
    multipliers: &'a mut dyn Multipliers,
    limits: &'a [JointLimits],
    piece: &'a Piece,
    number: usize,
    gap: f64,
    counts: bool,
    /// For each coordinate the largest residual H_u inside of the limits with its time, and the largest of
    /// l_tau and y.
    worst: Vec<(f64, f64)>,
    largest: Vec<f64>,
    z: Vec<f64>,
    tau: Vec<f64>,
    tau_z: Vec<f64>,
    prices: Prices,
    /// tau_a, its factors, and tau_a^-1 (tau_q, tau_v).
    mass: Vec<f64>,
    exchanges: Vec<usize>,
    solved: Vec<f64>,
    price: Vec<f64>,
}

impl<'a> Equations<'a> {
    fn new(
        path: &'a Path,
        dynamics: &'a mut dyn InverseDynamics,
        running: &'a mut Running,
        multipliers: &'a mut dyn Multipliers,
        limits: &'a [JointLimits],
    ) -> Self {
        let (n, zeros) = (path.dof, |count: usize| vec![0.0; count]);
        let prices = Prices { by_z: zeros(3 * n), by_torque: zeros(n), slack: 0.0 };
        Self {
            dynamics,
            running,
            multipliers,
            limits,
            piece: &path.pieces[0],
            number: 0,
            gap: 0.0,
            counts: true,
            worst: vec![(0.0, 0.0); n],
            largest: zeros(n),
            z: zeros(3 * n),
            tau: zeros(n),
            tau_z: zeros(3 * n * n),
            prices,
            mass: zeros(n * n),
            exchanges: vec![0; n],
            solved: zeros(2 * n * n),
            price: zeros(n),
        }
    }

    /// The motion, its torques and what limits make of them, with the factors of tau_a.
    fn place(&mut self, x: f64) -> Result<(), EvalError> {
        let n = self.tau.len();
        self.piece.at(x, &mut self.z);
        self.dynamics.linearise(self.piece.phase, &self.z, &mut self.tau, &mut self.tau_z)?;
        self.running.differentiate(self.piece.time(x), &self.z, &self.tau)?;
        let Prices { by_z, by_torque, slack } = &mut self.prices;
        by_z.fill(0.0);
        by_torque.fill(0.0);
        *slack = 0.0;
        self.multipliers.add(self.number, x, &self.z, &self.tau, &mut self.prices)?;
        for (i, row) in self.tau_z.chunks_exact(3 * n).enumerate() {
            self.mass[n * i..n * (i + 1)].copy_from_slice(&row[2 * n..]);
        }
        match lu::eliminate(&mut self.mass, n, n, &mut self.exchanges) {
            true => Ok(()),
            false => Err(super::singular()),
        }
    }

    /// $y = \tau_a^{-\top} (\lambda_v + \sum \sigma \eta h_a)$; tau_a is symmetric.
    fn take_price(&mut self, costate: &[f64]) {
        let n = self.tau.len();
        for i in 0..n {
            self.price[i] = costate[n + i] - self.prices.by_z[2 * n + i];
        }
        lu::solve(&self.mass, n, &self.exchanges, &mut self.price, 1);
    }

    /// The torques that a motor can have at a rate.
    fn range(&self, i: usize, v: f64) -> [f64; 2] {
        let JointLimits { torque: [mut lower, mut upper], power, speeds: [corner, no_load], .. } =
            self.limits[i];
        if no_load.is_finite() {
            // Where it drives forwards, tau + k v <= k v_0 with k = tau_max/(v_0 - v_c).
            let of = |most: f64, v: f64| (most * (no_load - v) / (no_load - corner)).min(most);
            (lower, upper) = (
                if lower < 0.0 { -of(-lower, -v) } else { lower },
                if upper > 0.0 { of(upper, v) } else { upper },
            );
        }
        if power.is_finite() && v != 0.0 {
            let most = power / v.abs();
            (lower, upper) = (lower.max(-most), upper.min(most));
        }
        [lower, upper]
    }

    /// G, and the residuals of torques inside their limits.
    fn gap_at(&mut self, x: f64) -> f64 {
        let n = self.tau.len();
        let mut gap = self.prices.slack;
        for i in 0..n {
            let (v, tau) = (self.z[n + i], self.tau[i]);
            let price = self.price[i] - self.prices.by_torque[i];
            let [lower, upper] = self.range(i, v);
            if let Some(best) = self.running.best_torque(i, v, price, [lower, upper]) {
                gap += self.running.gain_of(i, v, price, best) - self.running.gain_of(i, v, price, tau);
            }
            let slope = self.running.by_torque[i];
            self.largest[i] =
                self.largest[i].max(slope.abs()).max(if lower < upper { price.abs() } else { 0.0 });
            let margin = INSIDE * (upper - lower);
            let is_inside = !margin.is_finite() || (lower + margin < tau && tau < upper - margin);
            if lower < upper && is_inside && (price - slope).abs() > self.worst[i].0 {
                self.worst[i] = ((price - slope).abs(), self.piece.time(x));
            }
        }
        gap
    }
}

/// A torque is inside its limits where it is this part of their range away from both.
const INSIDE: f64 = 1e-2;

impl System for Equations<'_> {
    fn linearise(
        &mut self,
        x: f64,
        costate: &[f64],
        rate: &mut [f64],
        jacobian: &mut [f64],
    ) -> Result<(), EvalError> {
        let (n, h) = (self.tau.len(), self.piece.length);
        self.place(x)?;
        for (i, row) in self.tau_z.chunks_exact(3 * n).enumerate() {
            self.solved[2 * n * i..2 * n * (i + 1)].copy_from_slice(&row[..2 * n]);
        }
        lu::solve(&self.mass, n, &self.exchanges, &mut self.solved, 2 * n);
        jacobian.fill(0.0);
        let (by_z, by_state) = (&self.prices.by_z, &self.running.by_state);
        for i in 0..2 * n {
            rate[i] = h * (by_state[i] + by_z[i]);
            for j in 0..n {
                let entry = h * self.solved[2 * n * j + i];
                jacobian[2 * n * i + n + j] = entry;
                rate[i] += entry * (costate[n + j] - by_z[2 * n + j]);
            }
        }
        for i in 0..n {
            jacobian[2 * n * (n + i) + i] = -h;
            rate[n + i] -= h * costate[i];
        }
        Ok(())
    }

    fn is_linear(&self) -> bool {
        true
    }

    fn accept(&mut self, from: f64, length: f64, stages: [&[f64]; 3]) -> Result<(), EvalError> {
        if !self.counts {
            return Ok(());
        }
        for ((place, weight), costate) in radau::PLACES.iter().zip(radau::WEIGHTS).zip(stages) {
            let x = from + place * length;
            self.place(x)?;
            self.take_price(costate);
            let gap = self.gap_at(x);
            self.gap += weight * length.abs() * self.piece.length * gap;
        }
        Ok(())
    }
}
