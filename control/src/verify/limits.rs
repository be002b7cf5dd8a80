//! Hard limits between the points of the solver.

use super::dynamics::InverseDynamics;
use super::path::{Path, Piece};
use super::splits::Splits;
use crate::numerics::dormand_prince::Stopped;
use crate::numerics::random::Random;
use crate::problem::Problem;
use crate::problem::limits::JointLimits;
use crate::task::build::TaskRows;
use crate::task::functions::PathFunction;

/// Random times in each piece, one in each of so many equal parts, beside the extrema of positions and their
/// derivatives.
const TIMES: usize = 8;

/// What is limited.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Quantity {
    Position,
    Rate,
    Acceleration,
    Jerk,
    Torque,
    TorqueRate,
    Power,
    TorqueSpeed,
    Task,
    ToolAcceleration,
}

/// The largest excess of one kind of limits.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Excess {
    pub quantity: Quantity,
    /// The coordinate; of tasks the row, those of accelerations last; `None` for all joints together.
    pub index: Option<usize>,
    /// The time (s) and the piece.
    pub time: f64,
    pub piece: usize,
    /// The value and the limit, and the excess relative to the range of the limit.
    pub value: f64,
    pub limit: f64,
    pub part: f64,
}

/// The largest excess of each kind; kinds that are not limited are not there. `joints` is the number of
/// coordinates that are joints.
///
/// Positions, rates, accelerations and jerks are polynomials: their extrema are found exactly. Everything
/// else is evaluated there, at both ends of each segment between [splits](Splits), and at random times.
/// Clearances are looked at in steps so short that no two bodies pass through each other between them.
///
/// # Errors
/// States that cannot be evaluated; `stops`, which says whether the search is to stop.
pub(crate) fn excesses(
    problem: &Problem,
    (path, splits): (&Path, &Splits),
    dynamics: &mut dyn InverseDynamics,
    rows: &TaskRows,
    joints: usize,
    seed: u64,
    stops: &mut dyn FnMut() -> bool,
) -> Result<Vec<Excess>, Stopped> {
    let n = path.dof;
    let limits = problem.joint_limits();
    let mut along = rows.along.clone();
    let mut accelerations = rows.accelerations.clone();
    let mut g = vec![0.0; along.rows() + accelerations.bounds().len()];
    let (mut z, mut tau, mut tau_z) = (vec![0.0; 4 * n], vec![0.0; n], vec![0.0; 3 * n * n]);
    let total = problem.limits.total_power_max.unwrap_or(f64::INFINITY);
    let has_rates = limits.iter().any(|limits| limits.torque_rate.is_finite());
    let has_forces = has_rates
        || total.is_finite()
        || limits[..joints]
            .iter()
            .any(|limits| limits.torque.iter().any(|torque| torque.is_finite()) || limits.power.is_finite());
    let mut random = Random::new(seed);
    let mut found = Found::default();
    let mut places = Vec::new();
    let (mut most, mut rates) = (vec![0.0; n], vec![0.0; n]);
    for (k, piece) in path.pieces.iter().enumerate() {
        if stops() {
            return Err(Stopped::Interrupted);
        }
        along.enter(Some(piece.phase));
        bound_piece(piece, [&mut most, &mut rates]);
        let swept = along.sweep([&most, &rates], &mut z[..n], |x, q| piece.at(x, q))?;
        if let Some(row) = along.bounds().get(swept.row).filter(|_| swept.part > 0.0) {
            let (quantity, index, time) = (Quantity::Task, Some(swept.row), piece.time(swept.place));
            let value = row.lower - swept.part * row.range;
            let excess = Excess { quantity, index, time, piece: k, value, limit: 0.0, part: 0.0 };
            found.add(excess, [row.lower, row.upper], Some(row.range));
        }
        places.clear();
        places.extend_from_slice(splits.of(k));
        places.extend((0..TIMES).map(|at| (at as f64 + random.uniform()) / TIMES as f64));
        for (i, limits) in limits[..joints].iter().enumerate() {
            let JointLimits { q, v, a, jerk, .. } = limits;
            let is_limited =
                [q.iter().any(|q| q.is_finite()), v.is_finite(), a.is_finite(), jerk.is_finite()];
            for order in (0..is_limited.len()).filter(|&order| is_limited[order]) {
                piece.add_extrema(i, order, &mut places);
            }
        }
        places.sort_by(f64::total_cmp);
        places.dedup();
        for &x in &places {
            piece.at(x, &mut z);
            let mut at = |quantity, index, value, [lower, upper]: [f64; 2], range| {
                found.add(
                    Excess { quantity, index, time: piece.time(x), piece: k, value, limit: 0.0, part: 0.0 },
                    [lower, upper],
                    range,
                );
            };
            for (i, limits) in limits[..joints].iter().enumerate() {
                let JointLimits { q, v, a, jerk, .. } = *limits;
                at(Quantity::Position, Some(i), z[i], q, None);
                at(Quantity::Rate, Some(i), z[n + i], [-v, v], None);
                at(Quantity::Acceleration, Some(i), z[2 * n + i], [-a, a], None);
                at(Quantity::Jerk, Some(i), z[3 * n + i], [-jerk, jerk], None);
            }
            if has_forces {
                match has_rates {
                    true => dynamics.linearise(piece.phase, &z, &mut tau, &mut tau_z)?,
                    false => dynamics.torques(piece.phase, &z, &mut tau)?,
                }
                let mut sum = 0.0;
                for (i, limits) in limits[..joints].iter().enumerate() {
                    let JointLimits {
                        torque: [lower, upper],
                        power,
                        speeds: [corner, no_load],
                        torque_rate,
                        ..
                    } = *limits;
                    let v = z[n + i];
                    sum += v * tau[i];
                    if lower < upper {
                        at(Quantity::Torque, Some(i), tau[i], [lower, upper], None);
                    }
                    at(Quantity::Power, Some(i), v * tau[i], [-power, power], None);
                    if no_load.is_finite() && lower < upper {
                        // Forwards, tau + k v <= k v_0 with k = tau_max/(v_0 - v_c).
                        let most = |most: f64, v: f64| most * (no_load - v) / (no_load - corner);
                        let lines = [-most(-lower, -v), most(upper, v)];
                        at(Quantity::TorqueSpeed, Some(i), tau[i], lines, Some(upper - lower));
                    }
                    if has_rates {
                        let row = &tau_z[3 * n * i..3 * n * (i + 1)];
                        let rate = row.iter().zip(&z[n..]).map(|(a, b)| a * b).sum();
                        at(Quantity::TorqueRate, Some(i), rate, [-torque_rate, torque_rate], None);
                    }
                }
                at(Quantity::Power, None, sum, [-total, total], None);
            }
            if !g.is_empty() {
                let own = along.rows();
                along.values(&z[..n], &z[n..2 * n], &mut g[..own])?;
                accelerations.values(&z[..3 * n], &mut g[own..])?;
                let bounds = along.bounds().iter().chain(accelerations.bounds());
                for (number, (row, g)) in bounds.zip(&g).enumerate() {
                    let quantity = if number < own { Quantity::Task } else { Quantity::ToolAcceleration };
                    at(quantity, Some(number), *g, [row.lower, row.upper], Some(row.range));
                }
            }
        }
    }
    Ok(found.0)
}

/// The largest |q| and |dq/dx| of each coordinate of a piece, x the part of it.
fn bound_piece(piece: &Piece, [most, rates]: [&mut [f64]; 2]) {
    let (n, mut extrema) = (most.len(), Vec::new());
    let mut z = vec![0.0; 2 * n];
    for i in 0..n {
        (most[i], rates[i]) = (0.0, 0.0);
        extrema.clear();
        piece.add_extrema(i, 0, &mut extrema);
        piece.add_extrema(i, 1, &mut extrema);
        for &x in &extrema {
            piece.at(x, &mut z);
            most[i] = most[i].max(z[i].abs());
            rates[i] = rates[i].max(piece.length * z[n + i].abs());
        }
    }
}

/// The largest excess of each quantity.
#[derive(Default)]
struct Found(Vec<Excess>);

impl Found {
    /// Takes a value between two bounds, the range of which is that between them unless it is given.
    fn add(&mut self, at: Excess, [lower, upper]: [f64; 2], range: Option<f64>) {
        if !(lower.is_finite() || upper.is_finite()) {
            return;
        }
        let range = range.unwrap_or_else(|| match (upper - lower).is_finite() {
            true => upper - lower,
            false => [lower, upper]
                .into_iter()
                .filter(|bound| bound.is_finite())
                .fold(1.0, |a: f64, b| a.max(b.abs())),
        });
        let [below, above] = [lower - at.value, at.value - upper];
        let (excess, limit) = if below > above { (below, lower) } else { (above, upper) };
        let part = if excess.is_nan() { f64::INFINITY } else { (excess / range).max(0.0) };
        let new = Excess { limit, part, ..at };
        match self.0.iter_mut().find(|old| old.quantity == new.quantity) {
            Some(old) if old.part < new.part => *old = new,
            Some(_) => {}
            None => self.0.push(new),
        }
    }
}
