//! What became of the polish of a motion that the direct method found.

use crate::status::Status;
use serde::{Deserialize, Serialize};

/// Which motion a solution shows, that of the direct method or its polished form, and why.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct PolishReport {
    /// Why this one is shown.
    pub outcome: PolishOutcome,
    /// Cost and penalties of the motion of the direct method; `None` where they are not finite.
    #[serde(default)]
    pub direct_total: Option<f64>,
    /// Cost and penalties of the polished motion, if there is one.
    #[serde(default)]
    pub polished_total: Option<f64>,
    /// What keeps the motion from being polished, with [`PolishOutcome::Limited`], or from being shown, with
    /// [`PolishOutcome::NotVerified`].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cause: Option<String>,
    /// How the polish ended, if it was tried.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub status: Option<Status>,
}

impl PolishReport {
    /// Which motion is shown, and why, in words.
    pub fn reason(&self) -> String {
        match &self.cause {
            Some(cause) => format!("direct: {cause}"),
            None => self.outcome.reason().into(),
        }
    }
}

/// What became of a polish.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum PolishOutcome {
    /// The polished motion is shown: it is solved, or neither of the two is.
    Polished,
    /// Not tried: accelerations, jerks or rates of torques are limited, energy, jerks or rates of torques
    /// cost something, accelerations are given at an end, there are tools or obstacles, or a limit on
    /// positions, rates or powers is active. An extremal keeps the limits of controls only.
    /// [`PolishReport::cause`] says which.
    Limited,
    /// Not tried: the motion has vias or is periodic. An extremal has one phase between independent ends.
    Phases,
    /// Not tried: the direct method found no motion to polish.
    NoMotion,
    /// The polish found no extremal.
    Failed,
    /// The extremal is not verified: integrated again, with its costates, it leads elsewhere, or its cost is
    /// another one. [`PolishReport::cause`] says which check failed.
    NotVerified,
    /// The polish was stopped, or took its share: ten times the work of the direct method, Newton steps times
    /// nodes.
    OutOfTime,
    /// The extremal has a conjugate time: motions beside it cost less.
    NoMinimum,
    /// The extremal costs more than the motion of the direct method.
    CostsMore,
    /// The extremal exceeds a limit on positions, rates or powers.
    BeyondLimits,
}

impl PolishOutcome {
    /// Whether the polished motion is shown.
    pub fn is_polished(self) -> bool {
        self == Self::Polished
    }

    /// In words, as a reason.
    pub fn reason(self) -> &'static str {
        match self {
            Self::Polished => "polished",
            Self::Limited => "direct: the motion is not one that bounds on torques alone determine",
            Self::Phases => "direct: vias or a periodic motion",
            Self::NoMotion => "direct: there was no motion to polish",
            Self::Failed => "direct: the polish found no extremal",
            Self::NotVerified => "direct: the extremal is not verified",
            Self::OutOfTime => "direct: the polish was stopped or took too long",
            Self::NoMinimum => "direct: the extremal is no minimum",
            Self::CostsMore => "direct: the extremal costs more",
            Self::BeyondLimits => "direct: the extremal exceeds a limit",
        }
    }
}
