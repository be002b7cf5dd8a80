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

use super::adjoint::{Adjoint, Conditions, Gaps, Place};
use super::jerk_optimality::JerkEquations;
use super::path::Path;
use super::splits::Splits;
use super::torque_optimality::TorqueEquations;
use crate::numerics::dormand_prince::Stopped;
use crate::numerics::radau::Radau;
use crate::numerics::random::Random;

/// Tolerance of a step of the costates, relative to the root of that of the cost: the gap is a square.
const STEP: f64 = 1e-2;
/// Bounds of this tolerance.
const STEPS: [f64; 2] = [1e-8, 1e-4];
/// Differences of costates from those of the solver that are smaller than this part of the root of the
/// tolerance are errors of interpolation.
const CARRIED: f64 = 0.1;
/// Larger ones go on over nodes until the equations have made them grow by this factor: one that does not
/// grow is a defect of the motion, which counts over all that lies before it; one that grows is what an
/// unstable motion makes of an error.
const GROWN: f64 = std::f64::consts::E;
/// Parts of a motion over which gaps of either sign are added before their magnitudes are: those of which the
/// motion is integrated again where it is unstable ([`direct::PARTS`](crate::constants::direct::PARTS)), so
/// that both checks see errors over the same time.
const PARTS: usize = crate::constants::direct::PARTS as usize;
/// Where the random place in a piece lies that ends a step.
const MIDDLE: [f64; 2] = [0.35, 0.65];
/// Costates of a joint are measured by the largest ones of all joints of this part at least.
pub(crate) const LEAST_SCALE: f64 = 1e-3;

/// Tolerance of a step of the costates of a motion with this tolerance.
pub(crate) fn step_error(tolerance: f64) -> f64 {
    (STEP * tolerance.sqrt()).clamp(STEPS[0], STEPS[1])
}

/// A random place in a piece.
pub(crate) fn place_inside(random: &mut Random) -> f64 {
    MIDDLE[0] + (MIDDLE[1] - MIDDLE[0]) * random.uniform()
}

/// The costates at the ends of the pieces, from the solver: of (q, v), 2n each; of (q, v, a), 3n each, where
/// accelerations are continuous ([`jerk_optimality`](super::jerk_optimality)).
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
    /// The part of the time whose gap counts.
    pub counted: f64,
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

/// Checks the conditions of a motion: those of its torques, or of its jerks where the costates are those of
/// accelerations too.
///
/// # Errors
/// States that cannot be evaluated, or at which tau_a is singular; a search that is to stop.
pub(crate) fn check(
    conditions: Conditions<'_>,
    costates: &Costates,
    tolerance: f64,
    seed: u64,
) -> Result<Optimality, Stopped> {
    let (path, splits) = (conditions.path, conditions.splits);
    let is_smooth = costates.left.first().is_some_and(|costate| costate.len() == 3 * path.dof);
    let place = Place::new(conditions);
    let breaks = place.multipliers.breaks().to_vec();
    let of = (path, splits, &breaks[..]);
    match is_smooth {
        true => follow(of, &mut JerkEquations::new(place), costates, tolerance, seed),
        false => follow(of, &mut TorqueEquations::new(place), costates, tolerance, seed),
    }
}

/// Integrates the costates backwards, from the end of each phase, by Radau's method on pieces that end at
/// [splits](Splits), where multipliers jump, and at random places.
///
/// Backwards they are as stable as the motion of the robot is forwards: friction, which damps that, would let
/// them grow in the other direction, by $e^{c h / m}$ in h seconds with the slope c of a narrow transition.
/// At a node they take the [jumps](Costates::jumps), and go on with what they have until the difference from
/// those of the solver is [large](CARRIED) and has [grown](GROWN). So a defect counts in the gaps of all
/// pieces before it, however short the piece in which it arises: a stop under dry friction takes a part of a
/// thousand of the motion whose end it is. What an unstable motion makes of small differences does not add
/// up.
fn follow<'a>(
    (path, splits, breaks): (&Path, &Splits, &[f64]),
    equations: &mut impl Adjoint<'a>,
    costates: &Costates,
    tolerance: f64,
    seed: u64,
) -> Result<Optimality, Stopped> {
    let (n, root) = (path.dof, tolerance.sqrt());
    let mut costate = costates.right.last().cloned().unwrap_or_default();
    let mut radau = Radau::new(costate.len(), step_error(tolerance));
    radau.sizes = sizes(costates, n, costate.len());
    let mut random = Random::new(seed);
    let zeros = vec![0.0; path.pieces.len()];
    let mut found = Optimality { gaps: zeros.clone(), defects: zeros, ..Optimality::default() };
    let mut other = costate.clone();
    // The difference at the node before, and by how much the equations have made it grow while it was large.
    let (mut before, mut growth) = (0.0_f64, 1.0_f64);
    // Whether the piece behind counts.
    let mut counted = true;
    let mut places = Vec::new();
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
            } else if growth > GROWN || !counted {
                costate.copy_from_slice(&costates.right[k]);
                (before, growth) = (0.0, 1.0);
            }
        }
        places.clear();
        places.extend_from_slice(splits.of(k));
        places.extend_from_slice(breaks);
        if places.len() == 2 {
            places.push(place_inside(&mut random));
        }
        places.sort_by(f64::total_cmp);
        places.dedup();
        counted = equations.place().enter(k);
        for pair in places.windows(2).rev() {
            equations.place().inside = [pair[0], pair[1]];
            radau.integrate(&mut costate, pair[1]..pair[0], 1.0, equations)?;
        }
        found.gaps[k] = equations.place().found.gap;
        found.counted += if counted { piece.length / path.duration() } else { 0.0 };
        if before > CARRIED * root {
            other.copy_from_slice(&costates.right[k]);
            equations.place().counts = false;
            for pair in places.windows(2).rev() {
                equations.place().inside = [pair[0], pair[1]];
                radau.integrate(&mut other, pair[1]..pair[0], 1.0, equations)?;
            }
            growth *= difference(&costate, &other, &radau.sizes) / before;
        }
    }
    equations.settle(&mut found.gaps);
    found.gap = found.of_parts(path);
    if let Some(first) = costates.left.first() {
        found.defect = found.defect.max(difference(&costate, first, &radau.sizes));
    }
    let Gaps { worst, largest, .. } = &equations.place().found;
    let most = worst.iter().zip(largest).enumerate();
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
fn sizes(costates: &Costates, n: usize, count: usize) -> Vec<f64> {
    let mut sizes = vec![0.0_f64; count];
    for row in costates.left.iter().chain(&costates.right) {
        sizes.iter_mut().zip(row).for_each(|(size, y)| *size = size.max(y.abs()));
    }
    for kind in sizes.chunks_exact_mut(n) {
        let most = kind.iter().fold(f64::MIN_POSITIVE, |most, size| most.max(*size));
        kind.iter_mut().for_each(|size| *size = size.max(LEAST_SCALE * most));
    }
    sizes
}
