//! Why a parameter of a continuation cannot have a value.

use costate::robot::RobotError;
use std::fmt;
use std::sync::Arc;

/// Why a problem was refused for a continuation. Prints with its remedy.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum ContinuationCause {
    /// The first value is also the last one.
    SameValue,
    /// An infinite or undefined value.
    NotFinite,
    /// A value that must be positive.
    NotPositive,
    /// A weight of penalties, where there are none.
    NoPenalties,
    /// A smoothing, where every control has a weight of its effort.
    NothingToSmooth,
    /// A factor of bounds, where there are none.
    NoBounds,
    /// A final time, where it is free.
    FreeTime,
    /// Hard limits, which a continuation does not keep.
    Limits,
    /// Tools or obstacles, which a continuation does not take.
    Task,
    /// A cost of energy, which a continuation does not take.
    Energy,
    /// Costs of jerks or rates of torques, or given accelerations, which a continuation does not take.
    Rates,
    /// Vias or a periodic motion, which a continuation does not take.
    Phases,
    /// The robot that would have this value is refused.
    Robot(Arc<RobotError>),
}

impl fmt::Display for ContinuationCause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::SameValue => "the last value must be elsewhere than the first",
            Self::NotFinite => "the value must be finite",
            Self::NotPositive => "it must be positive",
            Self::NoPenalties => "the problem has no penalties; add [penalty]",
            Self::NothingToSmooth => "every control has a weight of its effort: nothing is to be smoothed",
            Self::NoBounds => "the problem has no bounds; add [bounds]",
            Self::FreeTime => "the final time is free; give time.final",
            Self::Limits => {
                "a continuation keeps no hard limits; remove [limits], or use [bounds] and [penalty]"
            }
            Self::Task => "a continuation takes neither tools nor obstacles; remove them",
            Self::Energy => "a continuation takes no cost of energy; remove cost.energy",
            Self::Rates => {
                "a continuation takes neither costs of jerks or rates of torques nor given accelerations; remove \
                 cost.jerk, cost.torque_rate, start.a and end.a"
            }
            Self::Phases => "a continuation takes neither vias nor periodic motions; remove them",
            Self::Robot(error) => return error.fmt(f),
        })
    }
}

impl std::error::Error for ContinuationCause {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            // Its message is this one.
            Self::Robot(error) => error.source(),
            _ => None,
        }
    }
}

/// Errors of robots are equal if their messages are.
impl PartialEq for ContinuationCause {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Robot(a), Self::Robot(b)) => a.to_string() == b.to_string(),
            _ => std::mem::discriminant(self) == std::mem::discriminant(other),
        }
    }
}
