//! How motions of robots with floating and spherical joints use their limits.

use super::task::FreeTask;
use crate::constants::direct::{ACTIVE, VIOLATION_ACCEPTED};
use crate::direct_states::solution::StateMotion;
use crate::result::limit_use::{ActiveLimit, LimitReport, LimitUse, LimitViolation};
use costate::robot::JointKind;

/// x and u.
type State = (Vec<f64>, Vec<f64>);

/// Positions and torques.
pub(super) fn limits(task: &FreeTask<'_>, found: &StateMotion) -> LimitReport {
    let (robot, gain) = (&task.problem.robot, &task.problem.gain);
    let joint = |i: usize| &robot.joints()[robot.independent_indices()[i]];
    let name = |i: usize, [rotation, translation]: [&'static str; 2]| {
        let unit = if joint(i).kind == JointKind::Prismatic { translation } else { rotation };
        (joint(i).name.clone(), unit)
    };
    let mut report = LimitReport::default();
    let positions = robot.plain_entries().map(|(entry, i)| {
        let position = move |(x, _): &State| x[entry];
        (name(i, ["rad", "m"]), task.limits[i].q, position)
    });
    report.position = usage(found, positions);
    let torques = task.driven.iter().enumerate().map(|(k, &i)| {
        let torque = move |(_, u): &State| gain[i] * u[k];
        (name(i, ["N m", "N"]), task.limits[i].torque, torque)
    });
    report.torque = usage(found, torques);
    report
}

/// The use of limits of one kind: at the points, and halfway between them by the polynomials.
fn usage<F: Fn(&State) -> f64>(
    found: &StateMotion,
    limited: impl Iterator<Item = ((String, &'static str), [f64; 2], F)>,
) -> Option<LimitUse> {
    let at_points: Vec<State> = found.x.iter().cloned().zip(found.u.iter().cloned()).collect();
    let halfway = found.t.windows(2).map(|pair| found.uncut_at(0.5 * (pair[0] + pair[1])));
    let between: Vec<State> = halfway.collect();
    let (mut usage, mut worst): (Option<LimitUse>, f64) = (None, VIOLATION_ACCEPTED);
    for ((name, unit), [low, high], value) in
        limited.filter(|(_, [low, high], _)| low.is_finite() || high.is_finite())
    {
        let all = usage.get_or_insert_default();
        let excess = |states: &[State]| {
            let excesses = states.iter().map(|state| (low - value(state)).max(value(state) - high));
            excesses.fold(0.0, f64::max)
        };
        all.at_points = all.at_points.max(excess(&at_points));
        all.between = all.between.max(excess(&between));
        let range = if (high - low).is_finite() { high - low } else { low.abs().min(high.abs()).max(1.0) };
        for (side, limit, sign) in [("min", low, 1.0), ("max", high, -1.0)] {
            for (&time, state) in found.t.iter().zip(&at_points) {
                let (value, excess) = (value(state), sign * (limit - value(state)));
                if excess > worst * range {
                    worst = excess / range;
                    let (name, unit) = (name.clone(), unit.into());
                    all.worst = Some(LimitViolation {
                        name,
                        time,
                        excess,
                        part: worst,
                        jumps: false,
                        unit,
                        value,
                        limit,
                        rate: None,
                    });
                }
            }
            let places = found.t.iter().zip(&at_points);
            let times = places.map(|(&t, state)| (t, sign * (value(state) - limit) <= ACTIVE * range));
            all.active.extend(ActiveLimit::spans(&name, side, times));
        }
    }
    usage
}
