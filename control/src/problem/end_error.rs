//! What is wrong with an end of a motion.

use super::rounded::rounded;
use costate::robot::{printable, printable_number as number};
use std::fmt;

/// Why what is given at an end, or at a via, was refused.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum EndError {
    /// A position or a rate at its limit, whose derivative leads beyond it: every motion exceeds the limit
    /// right beside this end.
    Leaves {
        /// The joint.
        joint: String,
        /// "position" or "rate".
        quantity: &'static str,
        /// The limit (rad, m, rad/s, m/s).
        limit: f64,
        /// "rate" or "acceleration".
        derivative: &'static str,
        /// Its value.
        slope: f64,
    },
    /// An acceleration where neither jerks nor rates of torques are limited or cost anything: an optimal
    /// motion leaves it at once by a jump, which no solver finds.
    AccelerationJumps {
        /// The first joint of which neither is.
        joint: String,
    },
}

impl fmt::Display for EndError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Leaves { joint, quantity, limit, derivative, slope } => {
                write!(
                    f,
                    "the {quantity} of joint '{}' is at its limit {} here, and the {derivative} {} leads beyond it; \
                     change one of the two, leave one free, or widen the limit",
                    printable(joint),
                    number(*limit),
                    rounded(*slope)
                )
            }
            Self::AccelerationJumps { joint } => write!(
                f,
                "neither the jerk of joint '{}' nor the rate of its torque is limited or costs anything, so its \
                 acceleration would jump right beside this end; give limits.jerk_max, limits.torque_rate_max, \
                 cost.jerk or cost.torque_rate for it, or remove the accelerations",
                printable(joint)
            ),
        }
    }
}

impl std::error::Error for EndError {}
