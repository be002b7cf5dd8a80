//! What a motion does between its points, in words.

use super::limit_words::{of_ground, quantity, whose};
use super::numbers::short;
use super::remark::{Remark, RemarkKey, Severity};
use crate::constants::task::MEETING;
use crate::result::limit_use::LimitViolation;
use crate::result::solution::Solution;
use crate::task::row::CLEARANCE;

/// Torques that are cut by less than this part of their limit are not worth a remark.
const NOTICED: f64 = 0.01;

/// Which limit is exceeded between the points of a motion, where, by how much.
pub(super) fn between(kind: &str, worst: &LimitViolation) -> String {
    let (by, unit, time) = (short(worst.excess, 2), &worst.unit, short(worst.time, 4));
    match (kind, of_ground(kind)) {
        ("task", _) => {
            let through = if meets(worst) { ": the motion passes through" } else { "" };
            format!("between its points the {} is off by {by} {unit} at t = {time} s{through}", worst.name)
        }
        (_, Some(what)) => {
            let name = &worst.name;
            format!(
                "between its points {what} is {by} {unit} beyond its friction cone, as '{name}', at t = {time} s"
            )
        }
        (kind, None) => format!(
            "between its points the {} of {} is {by} {unit} beyond its limit {} {unit} at t = {time} s",
            quantity(kind),
            whose(&worst.name),
            short(worst.limit, 4)
        ),
    }
}

/// Whether the bodies of a clearance pass through each other.
fn meets(worst: &LimitViolation) -> bool {
    worst.part >= MEETING && worst.name.starts_with(CLEARANCE)
}

/// Which torque is cut to its limit between the points of a motion, where most, by how much, and what that
/// means; only where it is a part of the limit that one notices.
pub(super) fn cut(solution: &Solution) -> Option<Remark> {
    let exceeds = solution.motion.status.exceeds_limits();
    let worst = solution.limits.worst_cut().filter(|_| !solution.is_extremal() && !exceeds)?;
    let LimitViolation { name, time, excess, unit, limit, .. } = worst;
    if *excess <= NOTICED * limit.abs() {
        return None;
    }
    let text = format!(
        "between its points the torque of joint '{name}' jumps at t = {} s, where the polynomial is beyond the limit by \
         {} {unit}: torques are cut to their limits there, in --sample too, so the limits are kept; a smaller tolerance \
         makes that less, and so does --polish, where nothing but torques is at a limit",
        short(*time, 4),
        short(*excess, 2)
    );
    Some(Remark::new(RemarkKey::TorqueCut, Severity::Warning, text).of_violation("torque", worst))
}
