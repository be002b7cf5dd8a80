//! What is wrong with the torque-speed limits of motors.

use costate::robot::{printable, printable_number as number};
use std::fmt;

/// Why the speeds of motors were refused: those of
/// [`MotionLimits::corner_speed`](crate::MotionLimits::corner_speed). Prints with its remedy.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum TorqueSpeedError {
    /// One of the two lists without the other.
    Alone,
    /// A corner speed that is not below the no-load speed.
    NotBelow {
        /// The joint.
        joint: String,
        /// Its corner speed.
        corner: f64,
        /// Its no-load speed.
        no_load: f64,
    },
    /// Speeds of a joint without a torque limit.
    NoTorqueLimit {
        /// The joint.
        joint: String,
    },
}

impl fmt::Display for TorqueSpeedError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Alone => f.write_str("give both limits.corner_speed and limits.no_load_speed, or neither"),
            Self::NotBelow { joint, corner, no_load } => write!(
                f,
                "the corner speed {} of joint '{}' must be below its no-load speed, {}",
                number(*corner),
                printable(joint),
                number(*no_load)
            ),
            Self::NoTorqueLimit { joint } => write!(
                f,
                "joint '{}' has a no-load speed, but no finite torque limit below the corner speed; give \
                 limits.torque_max",
                printable(joint)
            ),
        }
    }
}

impl std::error::Error for TorqueSpeedError {}
