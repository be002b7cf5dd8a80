//! Why a parameter was refused.

use crate::error::LengthError;
use crate::robot::{RobotError, list_names, printable};

/// Why a parameter was refused.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ParameterError {
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
    /// A joint or frame that the robot has not, or values that no robot can have.
    #[error(transparent)]
    Robot(#[from] RobotError),
}

/// Names to use instead of an unknown one.
fn offer(nearest: &[String]) -> String {
    match nearest {
        [] => String::new(),
        nearest => format!("; did you mean '{}'?", list_names(nearest, "' or '")),
    }
}
