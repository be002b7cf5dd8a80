//! What is wrong with a via.

use costate::robot::{RobotError, printable_number as number};
use std::fmt;
use std::sync::Arc;

/// Why a [`Via`](crate::Via) was refused.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum ViaError {
    /// A time that is not later than the one before.
    NotLater {
        /// The time (s).
        time: f64,
        /// The last time that is given before it: of a via or the start (s).
        before: f64,
    },
    /// A time at which the motion is over, by its final time or the guess of that.
    BeyondEnd {
        /// The time (s).
        time: f64,
        /// The final time or its guess (s).
        last: f64,
    },
    /// Rates are given, and the robot shall stop.
    StopAndRates,
    /// Neither positions nor tools are given, the robot does not stop, nothing changes.
    NothingAsked,
    /// Joints are free by name, but nothing is given that they could be free of.
    NothingToFree {
        /// The key that would give the others.
        given: &'static str,
    },
    /// It asks nothing that the place before or after it does not ask too, at a time that is free: the
    /// phase between the two has no length.
    NoWay {
        /// The other place: "the start", "via 2", "the end".
        other: String,
        /// Whether the payload changes at this via.
        loads: bool,
    },
    /// A payload that the robot does not take.
    Payload(Arc<RobotError>),
    /// More vias than a problem may have.
    TooMany {
        /// Their number.
        found: usize,
        /// The most.
        most: usize,
    },
}

impl fmt::Display for ViaError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotLater { time, before } => write!(
                f,
                "the time {} s is not later than {} s, the one before; list vias as they are passed",
                number(*time),
                number(*before)
            ),
            Self::BeyondEnd { time, last } => write!(
                f,
                "the time {} s is not before the final time, or its guess, {} s; give an earlier one, or leave it out",
                number(*time),
                number(*last)
            ),
            Self::StopAndRates => f.write_str("the robot shall stop here and has rates; remove v or stop"),
            Self::NothingAsked => {
                f.write_str("nothing is asked of it: give q, a tool, stop = true or a payload")
            }
            Self::NothingToFree { given } => {
                write!(f, "frees joints, but the others have no values; give {given}, or remove this")
            }
            Self::NoWay { other, loads } => {
                let payload = if *loads { " and load its payload there" } else { "" };
                write!(
                    f,
                    "{other} is the same place, and the time between the two is free, so that it would be 0; remove \
                     this via{payload}, move it, or give it a time, until which or from which on the robot waits"
                )
            }
            Self::Payload(error) => error.fmt(f),
            Self::TooMany { found, most } => write!(f, "{found} vias; at most {most} are taken"),
        }
    }
}

impl std::error::Error for ViaError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            // Its message is this one.
            Self::Payload(error) => error.source(),
            _ => None,
        }
    }
}

/// Errors are equal if their messages are.
impl PartialEq for ViaError {
    fn eq(&self, other: &Self) -> bool {
        std::mem::discriminant(self) == std::mem::discriminant(other) && self.to_string() == other.to_string()
    }
}
