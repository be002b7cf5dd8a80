//! Valid problems that are probably not meant.

use crate::problem::Problem;
use crate::problem::key::Key;
use costate::robot::{JointKind, printable};
use std::fmt;

/// Angles beyond this size (rad) are probably degrees: two turns.
const SUSPICIOUS_ANGLE: f64 = 4.0 * std::f64::consts::PI;

/// What is odd about a valid problem.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum ProblemWarning {
    /// An angle of more than two turns.
    LargeAngle {
        /// The field.
        key: Key,
        /// The joint.
        joint: String,
        /// The angle (rad).
        value: f64,
    },
}

impl ProblemWarning {
    /// The field.
    pub fn key(&self) -> Key {
        match self {
            Self::LargeAngle { key, .. } => *key,
        }
    }
}

impl fmt::Display for ProblemWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::LargeAngle { key, joint, value } => write!(
                f,
                "{}: the angle {value} of joint '{}' is more than two turns; angles are in rad, and {value} \
                 degrees are {:.4} rad",
                key.field(),
                printable(joint),
                value.to_radians()
            ),
        }
    }
}

impl Problem {
    /// Suspicious values of a valid problem.
    pub fn warnings(&self) -> Vec<ProblemWarning> {
        let mut warnings = Vec::new();
        for (key, q) in [(Key::START_Q, &self.start.q), (Key::END_Q, &self.end.q)] {
            for (joint, &value) in self.robot.joints().iter().zip(q) {
                if joint.kind == JointKind::Revolute && value.abs() > SUSPICIOUS_ANGLE {
                    warnings.push(ProblemWarning::LargeAngle { key, joint: joint.name.clone(), value });
                }
            }
        }
        warnings
    }
}
