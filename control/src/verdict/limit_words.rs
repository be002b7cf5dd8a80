//! Names of limits.

use crate::result::limit_use::ALL_JOINTS;
use costate::robot::printable;

/// What a kind of limits limits, in words.
pub(super) fn quantity(kind: &str) -> String {
    match kind {
        // Where a motor drives fast, its torque is limited to less.
        "torque_speed" => "torque".into(),
        "torque_rate" => "rate of the torque".into(),
        kind => kind.replace('_', " "),
    }
}

/// What the ground does to a foot, if that is what a kind of limits limits.
pub(super) fn of_ground(kind: &str) -> Option<&'static str> {
    match kind {
        "ground_force" => Some("the force of the ground"),
        "landing_impulse" => Some("the impulse of the landing"),
        _ => None,
    }
}

/// Of a joint, or of all.
pub(super) fn whose(name: &str) -> String {
    if name == ALL_JOINTS { name.into() } else { format!("joint '{}'", printable(name)) }
}
