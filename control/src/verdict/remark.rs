//! One thing to know about a solution.

use crate::result::limit_use::LimitViolation;
use serde::{Deserialize, Serialize};
use std::fmt;

/// How much a [`Remark`] matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Severity {
    /// The motion is no solution: [`Solution::check`](crate::Solution::check) fails.
    Error,
    /// The motion is a solution; what to know before it is used.
    Warning,
    /// How it was found.
    Note,
}

impl Severity {
    /// "error", "warning" or "note".
    pub fn name(self) -> &'static str {
        match self {
            Self::Error => "error",
            Self::Warning => "warning",
            Self::Note => "note",
        }
    }
}

/// What a [`Remark`] is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum RemarkKey {
    /// The status is no solution.
    NotSolved,
    /// A hard limit is exceeded at the points of the motion.
    LimitExceeded,
    /// A hard limit is exceeded between them.
    LimitExceededBetween,
    /// Torques lead elsewhere from the start, and along each part of the motion.
    Unstable,
    /// A saddle among the motions of its mesh.
    Saddle,
    /// A conjugate time lies before the end.
    NotMinimal,
    /// Torques are cut to their limits between points.
    TorqueCut,
    /// Limits of the robot are exceeded that the problem does not ask for.
    RobotLimit,
    /// An acceleration that no arm with gears reaches.
    SuddenAcceleration,
    /// The motion beats the best converged one.
    DearerConverged,
    /// A polish led to an extremal that is not verified: the motion of the direct method is shown.
    PolishLeft,
    /// The search ended before all starts were tried.
    SkippedStarts,
}

impl RemarkKey {
    /// Its name in JSON: "not_solved" and so on.
    pub fn name(self) -> &'static str {
        match self {
            Self::NotSolved => "not_solved",
            Self::LimitExceeded => "limit_exceeded",
            Self::LimitExceededBetween => "limit_exceeded_between",
            Self::Unstable => "unstable",
            Self::Saddle => "saddle",
            Self::NotMinimal => "not_minimal",
            Self::TorqueCut => "torque_cut",
            Self::RobotLimit => "robot_limit",
            Self::SuddenAcceleration => "sudden_acceleration",
            Self::DearerConverged => "dearer_converged",
            Self::PolishLeft => "polish_left",
            Self::SkippedStarts => "skipped_starts",
        }
    }
}

/// One thing to know about a solution, in words and numbers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Remark {
    /// What it is about.
    pub key: RemarkKey,
    /// How much it matters.
    pub severity: Severity,
    /// A sentence without capital letter and full stop.
    pub text: String,
    /// Name of the joint, tool or body. In JSON its key is `joint`.
    #[serde(rename = "joint", default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// The kind of limit, as in [`LimitReport`](crate::LimitReport); of a motion that is not verified the
    /// [check](crate::Verification::checks) that failed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub kind: Option<String>,
    /// When (s).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time: Option<f64>,
    /// What it is about, as a number: what is limited, an end defect, a cost.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub value: Option<f64>,
    /// What `value` is compared with: a limit, the bound of a verification, a cost.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub limit: Option<f64>,
    /// By how much a limit is exceeded.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub excess: Option<f64>,
    /// The unit of these numbers.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unit: Option<String>,
}

impl Remark {
    pub(super) fn new(key: RemarkKey, severity: Severity, text: String) -> Self {
        let (name, kind, unit) = (None, None, None);
        let (time, value, limit, excess) = (None, None, None, None);
        Self { key, severity, text, name, kind, time, value, limit, excess, unit }
    }

    /// With these two numbers, unless they are not finite.
    pub(super) fn comparing(self, value: f64, limit: f64) -> Self {
        let finite = |x: f64| Some(x).filter(|x| x.is_finite());
        Self { value: finite(value), limit: finite(limit), ..self }
    }

    /// With the numbers of a violation of this kind of limits.
    pub(super) fn of_violation(self, kind: &str, violation: &LimitViolation) -> Self {
        let LimitViolation { name, time, excess, unit, value, limit, .. } = violation;
        Self {
            name: Some(name.clone()),
            kind: Some(kind.into()),
            time: Some(*time),
            excess: Some(*excess),
            unit: Some(unit.clone()),
            ..self.comparing(*value, *limit)
        }
    }

    /// Whether the motion is no solution because of it.
    pub fn is_error(&self) -> bool {
        self.severity == Severity::Error
    }
}

impl fmt::Display for Remark {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

/// Why a motion should not be used: the errors among its remarks.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}", joined(.remarks))]
#[non_exhaustive]
pub struct UnfitMotion {
    /// The errors; at least one.
    pub remarks: Vec<Remark>,
}

/// All texts in one line.
fn joined(remarks: &[Remark]) -> String {
    remarks.iter().map(|remark| &remark.text[..]).collect::<Vec<_>>().join("; ")
}
