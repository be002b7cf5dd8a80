//! What is wrong with a motion of a robot whose loops are closed.

use super::key::Key;
use super::rounded::{coordinate, rounded};
use costate::constraints::ConstraintError;
use costate::robot::{ConstraintRow, printable, printable_number as number};
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
    /// No rates that keep the loops closed have those that are given.
    Rates {
        /// `end.v`.
        key: Key,
        /// The rate that misses most, and what would fit.
        unfit: Box<UnfitRates>,
    },
    /// A row that holds near the start depends on others at the start alone.
    Singular {
        /// `start.q`.
        key: Key,
        /// The constraint with this row.
        constraint: String,
        /// What the row holds; none for a distance or a coupling.
        row: Option<ConstraintRow>,
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

/// Rates that no motion with closed loops has.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct UnfitRates {
    /// The joint whose rate misses most.
    pub joint: String,
    /// Its entry in v.
    pub entry: usize,
    /// Its rate as it is given (rad/s, m/s).
    pub rate: f64,
    /// The rates with J v = 0 that are nearest to all that are given (rad/s, m/s).
    pub nearest: Vec<f64>,
}

impl LoopError {
    /// The field at fault.
    pub fn key(&self) -> Key {
        match *self {
            Self::Open { key, .. }
            | Self::Leads { key, .. }
            | Self::Rates { key, .. }
            | Self::Singular { key, .. }
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
                        listed(q)
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
            Self::Rates { unfit, .. } => write!(
                f,
                "no motion that keeps the loops closed has the rates that are given: that of joint '{}' is {}, and \
                 {} in the nearest ones, v = [{}] (rad/s, m/s); give these, or name further joints in end.v_free",
                printable(&unfit.joint),
                number(unfit.rate),
                unfit.nearest.get(unfit.entry).map_or_else(String::new, |rate| rounded(*rate)),
                listed(&unfit.nearest)
            ),
            Self::Singular { constraint, row, .. } => write!(
                f,
                "this is a singular pose: {} of constraint '{}' counts nearby and depends on other rows here; begin \
                 elsewhere",
                row.map_or_else(|| "the row".to_owned(), |row| format!("row {}", row.name())),
                printable(constraint)
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

/// Numbers that can be given as they are shown.
fn listed(numbers: &[f64]) -> String {
    numbers.iter().map(|number| coordinate(*number)).collect::<Vec<_>>().join(", ")
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
