//! Some limits of a joint.

use crate::robot::joint::Limits;

/// Limits of one joint that replace those it has; what is `None` stays.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LimitChange {
    /// Lower limit of the position (rad, m).
    pub lower: Option<f64>,
    /// Upper limit of the position (rad, m).
    pub upper: Option<f64>,
    /// Largest velocity (rad/s, m/s).
    pub velocity: Option<f64>,
    /// Largest effort (N m, N).
    pub effort: Option<f64>,
}

impl LimitChange {
    /// The limits of a joint that has those in `old`.
    pub fn of(self, old: Limits) -> Limits {
        Limits {
            lower: self.lower.unwrap_or(old.lower),
            upper: self.upper.unwrap_or(old.upper),
            velocity: self.velocity.unwrap_or(old.velocity),
            effort: self.effort.unwrap_or(old.effort),
        }
    }
}
