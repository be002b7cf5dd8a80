//! Why a parameter was refused.

use crate::error::LengthError;
use crate::robot::{RobotError, list_names, printable};

/// Why a parameter was refused.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ParameterError {
    /// The robot has no such joint.
    #[error("the robot has no joint '{}'{}", printable(joint), offer(nearest))]
    UnknownJoint {
        /// The name that was asked for.
        joint: String,
        /// The names of joints that resemble it.
        nearest: Vec<String>,
    },
    /// The robot has no such frame.
    #[error("the robot has no frame '{}'{}", printable(frame), offer(nearest))]
    UnknownFrame {
        /// The name that was asked for.
        frame: String,
        /// The names of frames that resemble it.
        nearest: Vec<String>,
    },
    /// A payload at a frame that no joint moves.
    #[error(
        "payload '{}' is at frame '{}', which no joint moves: no quantity depends on it; choose a frame of a \
         link that moves",
        printable(name),
        printable(frame)
    )]
    FixedFrame {
        /// The payload.
        name: String,
        /// The frame.
        frame: String,
    },
    /// No parameter has this name.
    #[error(
        "there is no parameter '{}'{}; names are a joint, a dot and one of {entries} (elbow.mass), two joints \
         and .armature (a, b.armature), or gravity_x, gravity_y, gravity_z",
        printable(name),
        offer(nearest)
    )]
    UnknownParameter {
        /// The name that was asked for.
        name: String,
        /// The names of parameters that resemble it.
        nearest: Vec<String>,
        /// What may follow the joint.
        entries: String,
    },
    /// A parameter that is in the set already.
    #[error("parameter '{}' is in the set already; give each parameter once", printable(name))]
    Duplicate {
        /// Its name.
        name: String,
    },
    /// An axis without direction, or with a number that is not finite.
    #[error(
        "displacement '{}' has the axis {axis}; an axis needs three finite numbers, not all zero",
        printable(name)
    )]
    BadAxis {
        /// The parameter.
        name: String,
        /// The axis.
        axis: String,
    },
    /// As many values as the set has parameters are needed.
    #[error(transparent)]
    WrongLength(#[from] LengthError),
    /// Values that no robot can have.
    #[error("no robot has these values: {0}")]
    Robot(#[from] RobotError),
}

/// Names to use instead of an unknown one.
fn offer(nearest: &[String]) -> String {
    match nearest {
        [] => String::new(),
        nearest => format!("; did you mean '{}'?", list_names(nearest, "' or '")),
    }
}
