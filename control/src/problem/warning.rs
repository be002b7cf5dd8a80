//! Valid problems that are probably not meant.

use super::gait_symmetry::in_words;
use crate::problem::key::Key;
use crate::problem::{Gait, Problem};
use costate::robot::{JointKind, SymmetryChange, printable, printable_number};
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
    /// The robot of a gait is not its own mirror image, up to what a gait takes.
    Uneven {
        /// The joint whose torque differs most in mirrored motions.
        joint: String,
        /// By how much (N m, N).
        by: f64,
        /// The same relative to the weight times the length of a leg.
        share: f64,
    },
    /// The robot of a gait was replaced by its mean with its mirror image.
    Symmetrised {
        /// What was changed.
        change: SymmetryChange,
    },
    /// A payload without a shape in a problem with obstacles or pairs of bodies.
    PayloadWithoutBody {
        /// The field.
        key: Key,
        /// The frame that carries it.
        frame: String,
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
            Self::LargeAngle { key, .. }
            | Self::NothingToAvoid { key }
            | Self::PayloadWithoutBody { key, .. } => *key,
            Self::Uneven { .. } | Self::Symmetrised { .. } => Key::GAIT_MIRROR,
        }
    }

    /// Whether it says what was done, and nothing is odd.
    pub fn is_note(&self) -> bool {
        matches!(self, Self::Uneven { .. } | Self::Symmetrised { .. } | Self::PayloadWithoutBody { .. })
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
            Self::Uneven { joint, by, share } => write!(
                f,
                "gait.mirror: the robot is not exactly its own mirror image: in mirrored motions the torque at joint \
                 '{}' differs by {} (N m, N), {} % of the weight times the length of a leg, and so it does in \
                 every second step; gait.symmetrise = true takes the mean of the robot and its mirror image",
                printable(joint),
                printable_number(*by),
                printable_number(format!("{:.1e}", 100.0 * share).parse().unwrap_or(100.0 * share))
            ),
            Self::Symmetrised { change } => write!(
                f,
                "gait.symmetrise: the robot was replaced by its mean with its mirror image; this changed {}",
                in_words(change)
            ),
            Self::PayloadWithoutBody { key, frame } => write!(
                f,
                "{}: the payload of '{}' has no body and is not checked for collisions; give it a shape",
                key.part(),
                printable(frame)
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
    /// What is said about the mirror image of the robot of a gait.
    fn unevenness(&self, gait: &Gait) -> Option<ProblemWarning> {
        if let Some(change) = &gait.symmetrised {
            return Some(ProblemWarning::Symmetrised { change: change.clone() });
        }
        let found = self.asymmetry(gait, &self.exchange(gait).ok()?, &self.start.q).ok()?;
        let joint = self.robot.independent_joints().nth(found.joint)?.name.clone();
        let share = found.by / found.scale;
        found.is_real.then_some(ProblemWarning::Uneven { joint, by: found.by, share })
    }

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
        warnings.extend(self.gait.as_ref().and_then(|gait| self.unevenness(gait)));
        if self.task.collision.is_some() && !self.task.has_collisions() {
            warnings.push(ProblemWarning::NothingToAvoid { key: Key::entry("collision", "pairs", 0) });
        }
        if self.task.has_collisions() {
            let own = self.task.payloads.iter().enumerate();
            let own = own.map(|(entry, payload)| (Key::entry("robot.payload", "shape", entry), payload));
            let vias = self.vias.iter().enumerate().flat_map(|(number, via)| {
                via.payload.iter().flatten().map(move |payload| (Key::via("payload", number), payload))
            });
            let mut bare = own.chain(vias).filter(|(_, payload)| payload.shape.is_none());
            // Once for all of them.
            warnings.extend(bare.next().map(|(key, payload)| {
                let frame = payload.frame.clone();
                ProblemWarning::PayloadWithoutBody { key, frame }
            }));
        }
        warnings
    }
}
