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
        /// What is at its limit, and which derivative leads beyond it.
        leads: Leads,
        /// The limit (rad, m, rad/s, m/s).
        limit: f64,
        /// The derivative: a rate or an acceleration.
        slope: f64,
    },
    /// An acceleration where neither jerks nor rates of torques are limited or cost anything: an optimal
    /// motion leaves it at once by a jump, which no solver finds.
    AccelerationJumps {
        /// The first joint of which neither is.
        joint: String,
    },
}

/// Which derivative leads which quantity beyond its limit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Leads {
    /// A rate the position.
    PositionByRate,
    /// An acceleration the position, at a rate of zero.
    PositionByAcceleration,
    /// An acceleration the rate.
    RateByAcceleration,
}

impl Leads {
    /// The quantity and the derivative.
    fn words(self) -> [&'static str; 2] {
        match self {
            Self::PositionByRate => ["position", "rate"],
            Self::PositionByAcceleration => ["position", "acceleration"],
            Self::RateByAcceleration => ["rate", "acceleration"],
        }
    }
}

impl fmt::Display for EndError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Leaves { joint, leads, limit, slope } => {
                let [quantity, derivative] = leads.words();
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
