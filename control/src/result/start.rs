//! Where starts of a search led.

use crate::result::motion::Motion;
use crate::status::Status;
use serde::{Deserialize, Serialize};
use std::fmt;

/// Where one start led.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct StartResult {
    /// Cost and penalties.
    pub total: f64,
    /// How it ended.
    pub status: Status,
    /// Largest excess of a hard limit, relative to its range; 0 if all are kept.
    pub violation: f64,
    /// The guess that it began with: the best one of those that it looked at.
    pub guess: GuessKind,
    /// How many guesses it looked at: iterated on a coarse mesh, until it was clear which one is cheapest.
    pub looks: usize,
}

impl StartResult {
    pub(crate) fn of(motion: &Motion, violation: f64, guess: GuessKind, looks: usize) -> Self {
        Self { total: motion.total(), status: motion.status.clone(), violation, guess, looks }
    }
}

/// What a motion began as.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum GuessKind {
    /// Cubics in the joint coordinates from end to end of each phase; where the place of a tool is given, to
    /// the position of the joints that is near the one before, or near a given guess.
    #[default]
    Straight,
    /// The same to another position of the joints for the place of a tool.
    OtherPosition,
    /// The motion without obstacles.
    WithoutObstacles,
    /// Cubics with waves in some joints that vanish at the ends.
    Bent,
    /// Cubics with random waves in all joints: starts after the first one.
    Disturbed,
    /// A saved motion.
    Saved,
}

impl fmt::Display for GuessKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Straight => "straight",
            Self::OtherPosition => "other position of the joints",
            Self::WithoutObstacles => "motion without obstacles",
            Self::Bent => "bent",
            Self::Disturbed => "disturbed",
            Self::Saved => "saved motion",
        })
    }
}
