//! Laws of physics that a motion does not keep, in words.

use super::numbers::short;
use crate::problem::Problem;
use crate::result::limit_use::LimitViolation;

/// That a joint without a motor would need a torque, or that a constraint is not kept; `None` for a limit,
/// which could be widened.
pub(super) fn not_kept(problem: &Problem, kind: &str, worst: &LimitViolation) -> Option<String> {
    if kind != "torque" || worst.limit != 0.0 {
        return None;
    }
    let LimitViolation { name, unit, .. } = worst;
    let (value, time) = (short(worst.value, 4), short(worst.time, 4));
    Some(match problem.robot.joints().iter().any(|joint| joint.name == *name) {
        true => format!("joint '{name}', which has no motor, would need {value} {unit} at t = {time} s"),
        false => format!("the constraint '{name}' is not kept at t = {time} s"),
    })
}
