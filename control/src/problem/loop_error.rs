//! What is wrong with a motion of a robot whose loops are closed.

use super::key::Key;
use super::rounded::{coordinate, rounded};
use costate::constraints::ConstraintError;
use costate::robot::{printable, printable_number as number};
use std::fmt;

/// Why the motion of a robot with constraints was refused.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum LoopError {
    /// A position that is given does not satisfy a constraint.
    Open {
        /// `start.q` or `end.q`.
        key: Key,
        /// The constraint that misses most.
        constraint: String,
        /// By how much (m, rad).
        miss: f64,
        /// A position nearby that satisfies all constraints, with the joints that have motors as they are
        /// given if that is possible; or why none was found.
        closed: Box<Result<Vec<f64>, ConstraintError>>,
    },
    /// Rates that are given lead away from a constraint.
    Leads {
        /// `start.v` or `end.v`.
        key: Key,
        /// The constraint that changes most.
        constraint: String,
        /// Its rate (m/s, rad/s).
        rate: f64,
    },
    /// No position with what is given at the end satisfies all constraints.
    CannotClose {
        /// `end.q`.
        key: Key,
        /// The constraint and by how much it misses.
        cause: ConstraintError,
    },
    /// Something that motions with constraints do not take.
    NotTaken {
        /// What it is.
        key: Key,
        /// The first constraint of the robot.
        constraint: String,
    },
}

impl LoopError {
    /// The field at fault.
    pub fn key(&self) -> Key {
        match *self {
            Self::Open { key, .. }
            | Self::Leads { key, .. }
            | Self::CannotClose { key, .. }
            | Self::NotTaken { key, .. } => key,
        }
    }
}

impl fmt::Display for LoopError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Open { constraint, miss, closed, .. } => {
                let (constraint, miss) = (printable(constraint), rounded(*miss));
                write!(f, "constraint '{constraint}' is missed by {miss} (m, rad) here")?;
                match &**closed {
                    Ok(q) => write!(
                        f,
                        "; nearby the loops close at q = [{}]: give that, or another position that closes them",
                        q.iter().map(|q| coordinate(*q)).collect::<Vec<_>>().join(", ")
                    ),
                    Err(cause) => {
                        write!(f, ", and no position nearby was found that closes the loops: {cause}")
                    }
                }
            }
            Self::Leads { constraint, rate, .. } => write!(
                f,
                "these rates change constraint '{}' by {} (m/s, rad/s); give rates with J v = 0, or zeros",
                printable(constraint),
                number(*rate)
            ),
            Self::CannotClose { cause, .. } => {
                write!(f, "with what is given here the loops cannot be closed: {cause}")
            }
            Self::NotTaken { constraint, .. } => write!(
                f,
                "the robot has the constraint '{}', and motions of robots with constraints do not take this; \
                 remove it",
                printable(constraint)
            ),
        }
    }
}

impl std::error::Error for LoopError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::CannotClose { cause, .. } => Some(cause),
            Self::Open { closed, .. } => match &**closed {
                Ok(_) => None,
                Err(cause) => Some(cause),
            },
            _ => None,
        }
    }
}
