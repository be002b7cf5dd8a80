//! Valid problems that are probably not meant.

use crate::problem::key::Key;
use crate::problem::{BodyPairs, Problem};
use costate::robot::{JointKind, printable, printable_number};
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
    /// Bodies of the robot with nothing that they keep away from.
    NothingToAvoid {
        /// The field.
        key: Key,
    },
}

impl ProblemWarning {
    /// The field.
    pub fn key(&self) -> Key {
        match self {
            Self::LargeAngle { key, .. } | Self::NothingToAvoid { key } => *key,
        }
    }
}

impl fmt::Display for ProblemWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::LargeAngle { key, joint, value } => write!(
                f,
                "{key}: the angle {} of joint '{}' is more than two turns; angles are in rad, and {} \
                 degrees are {} rad",
                printable_number(*value),
                printable(joint),
                printable_number(*value),
                shown(value.to_radians())
            ),
            Self::NothingToAvoid { key } => write!(
                f,
                "{key}: the bodies of [collision] keep away from nothing, as there is neither an obstacle nor a pair of \
                 them; give [[obstacle]] or this"
            ),
        }
    }
}

/// Four decimals, or an exponent.
fn shown(angle: f64) -> String {
    if angle.abs() < 1e6 { format!("{angle:.4}") } else { format!("{angle:.4e}") }
}

impl Problem {
    /// Suspicious values of a valid problem.
    pub fn warnings(&self) -> Vec<ProblemWarning> {
        let mut warnings = Vec::new();
        let mut given = vec![(Key::START_Q, &self.start.q)];
        // The end of a periodic motion follows its start.
        if self.periodic.is_none() {
            given.push((Key::END_Q, &self.end.q));
        }
        let vias = self.vias.iter().enumerate();
        given.extend(vias.filter_map(|(number, via)| Some((Key::via("q", number), via.q.as_ref()?))));
        for (key, q) in given {
            for (entry, i) in self.robot.plain_entries() {
                let joint = &self.robot.joints()[self.robot.independent_indices()[i]];
                let Some(&value) = q.get(entry) else { continue };
                if joint.kind == JointKind::Revolute && value.abs() > SUSPICIOUS_ANGLE {
                    warnings.push(ProblemWarning::LargeAngle { key, joint: joint.name.clone(), value });
                }
            }
        }
        if let Some(collision) = &self.task.collision {
            let has_pairs = match &collision.pairs {
                BodyPairs::None => false,
                BodyPairs::These(pairs) => !pairs.is_empty(),
                BodyPairs::All => true,
            };
            if !has_pairs && self.task.obstacles.is_empty() {
                warnings.push(ProblemWarning::NothingToAvoid { key: Key::entry("collision", "pairs", 0) });
            }
        }
        warnings
    }
}
