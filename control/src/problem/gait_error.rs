//! What is wrong with a gait.

use super::key::Key;
use crate::constants::checks::gait::UNEVEN;
use costate::constraints::ConstraintError;
use costate::robot::{RobotError, printable, printable_number as number};
use std::fmt;
use std::sync::Arc;

/// Why a [`Gait`](crate::Gait) was refused.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum GaitError {
    /// A frame that the robot does not have.
    UnknownFrame {
        /// The name that was given.
        frame: String,
        /// Names of frames that resemble it.
        nearest: Vec<String>,
    },
    /// A frame that cannot stand on the ground.
    NoFoot {
        /// Why.
        cause: Arc<RobotError>,
    },
    /// A foot that is named twice.
    OneFoot {
        /// The frame.
        frame: String,
    },
    /// Feet that stand and feet that swing are not as many.
    Unpaired {
        /// Feet that stand.
        stance: usize,
        /// Feet that swing.
        swing: usize,
    },
    /// Feet of which one follows those before it: their forces are not determined.
    Redundant {
        /// Its frame.
        frame: String,
    },
    /// The same of all feet together, in the phase of double support.
    RedundantTogether {
        /// The frame of the foot that follows the others.
        frame: String,
    },
    /// Soles behind that shall stand flat, but there are none, or no double support.
    NoSolesBehind,
    /// Soles that stand flat, but not with the legs exchanged.
    SolesDiffer {
        /// The frame of the foot that stands.
        frame: String,
    },
    /// A number out of its range.
    OutOfRange {
        /// Its value.
        value: f64,
        /// The valid range.
        remedy: &'static str,
    },
    /// A width of a robot in the plane.
    WidthInPlane {
        /// Its value.
        value: f64,
    },
    /// Gravity that is not along -z of the world, or none.
    NotLevel {
        /// Gravity (m/s^2).
        gravity: [f64; 3],
    },
    /// A joint that does not move the whole robot along x of the world, or has a motor.
    NotAlong {
        /// The joint.
        joint: String,
    },
    /// A foot that leaves the plane of x and z of the world, where no joint is flipped.
    NotPlanar {
        /// The frame.
        frame: String,
    },
    /// A sole whose frame does not lie in the plane of x and z of the world, x ahead and z up.
    Tilted {
        /// The frame.
        frame: String,
    },
    /// The mirror image of the robot is another one.
    NotSymmetric {
        /// The joint whose torque differs most for mirrored motions.
        joint: String,
        /// By how much (N m, N).
        by: f64,
        /// The same relative to the weight times the length of a leg.
        share: f64,
        /// What its mean with the mirror image would change, if the axes show that the pairs are right.
        changes: Option<String>,
    },
    /// Two joints that are no mirror images of each other.
    NotMirrored {
        /// Why.
        cause: Arc<RobotError>,
    },
    /// A joint with another limit, gain or weight than the one whose place it takes in the next step.
    LegsDiffer {
        /// The joint.
        joint: String,
        /// What it has.
        value: f64,
        /// The joint whose place it takes; the same one if it keeps its place.
        other: String,
        /// What that one has in the mirror.
        expected: f64,
    },
    /// The feet are not exchanged by the mirror.
    FeetStay {
        /// The distance of the foot that swings from where the other one is in the mirror (m).
        miss: f64,
        /// Whether this is little beside a leg: the pairs are right, and the file is not exact.
        is_slight: bool,
    },
    /// No position has both feet on the ground at the distance of a step.
    CannotStand {
        /// Why.
        cause: ConstraintError,
    },
    /// Something that gaits do not take.
    NotTaken {
        /// What it is.
        with: Key,
    },
    /// Something that takes no gait at all.
    NotHere,
    /// A robot with constraints of its own.
    Constrained {
        /// The first one.
        constraint: String,
    },
}

/// Errors with one message are one.
impl PartialEq for GaitError {
    fn eq(&self, other: &Self) -> bool {
        std::mem::discriminant(self) == std::mem::discriminant(other) && self.to_string() == other.to_string()
    }
}

impl fmt::Display for GaitError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::UnknownFrame { frame, nearest } => {
                write!(f, "the robot has no frame '{}'", printable(frame))?;
                if nearest.is_empty() {
                    return f.write_str("; `costate info` lists its frames");
                }
                let names: Vec<String> = nearest.iter().map(|name| format!("'{}'", printable(name))).collect();
                write!(f, "; did you mean {}?", names.join(" or "))
            }
            Self::NoFoot { cause } => write!(f, "{cause}"),
            Self::OneFoot { frame } => write!(
                f,
                "'{}' is named twice; each foot either stands or swings",
                printable(frame)
            ),
            Self::Unpaired { stance, swing } => write!(
                f,
                "{stance} feet stand and {swing} swing; give each foot that stands the one that lands in its place"
            ),
            Self::Redundant { frame } => write!(
                f,
                "'{}' cannot move freely where the feet named before it stand, so that their forces are not \
                 determined; name fewer feet",
                printable(frame)
            ),
            Self::RedundantTogether { frame } => write!(
                f,
                "with all feet on the ground '{}' cannot move freely where the others stand, so that their forces \
                 are not determined; remove double_support, or name fewer feet",
                printable(frame)
            ),
            Self::NoSolesBehind => f.write_str(
                "says how soles behind stand in double support; give sole and double_support, or remove it",
            ),
            Self::SolesDiffer { frame } => write!(
                f,
                "in the mirror the sole of '{}' is turned: give the frames of both feet axes that are mirror \
                 images, x ahead and z up where they stand",
                printable(frame)
            ),
            Self::OutOfRange { value, remedy } => write!(f, "{remedy}, but is {}", number(*value)),
            Self::WidthInPlane { value } => write!(
                f,
                "is {}, but a robot in the plane has no widths; remove it, or name in gait.flipped the joints \
                 that change their signs in the mirror of a robot in space",
                number(*value)
            ),
            Self::NotLevel { gravity: [x, y, z] } => write!(
                f,
                "is [{}, {}, {}] (m/s^2), but the ground of a gait is level and feet stand on it by their weight; \
                 give gravity along -z of the world, as slopes are not taken",
                number(*x),
                number(*y),
                number(*z)
            ),
            Self::NotAlong { joint } => write!(
                f,
                "joint '{}' must be prismatic, move both feet along x of the world, and have no motor: its \
                 entry of limits.torque_max is 0",
                printable(joint)
            ),
            Self::NotPlanar { frame } => write!(
                f,
                "a joint moves the frame '{}' along y of the world: gaits are those of robots in the plane of x \
                 and z, or in space if gait.flipped names the joints that change their signs in the mirror",
                printable(frame)
            ),
            Self::Tilted { frame } => write!(
                f,
                "a foot with a sole stands on x of its frame, with z up, but that of '{}' is tilted sideways or \
                 turned about z; place another frame there",
                printable(frame)
            ),
            Self::NotSymmetric { joint, by, share, changes: Some(changes) } => write!(
                f,
                "the pairs are right, but the robot is not its own mirror image: the torque at joint '{}' differs by \
                 {} (N m, N) in a mirrored motion, {:.1} % of the weight times the length of a leg, where {:.0} % \
                 are taken; gait.symmetrise = true takes the mean of the robot and its mirror image, which \
                 changes {changes}",
                printable(joint),
                number(*by),
                100.0 * share,
                100.0 * UNEVEN
            ),
            Self::NotSymmetric { joint, by, share, changes: None } => write!(
                f,
                "with these pairs exchanged the robot is another one: the torque at joint '{}' differs by {} \
                 (N m, N) in a mirrored motion, {:.0} % of the weight times the length of a leg, and axes do \
                 not agree; pair each joint of one leg with its counterpart, and in space name in gait.flipped \
                 all that move along y or turn about x or z",
                printable(joint),
                number(*by),
                100.0 * share
            ),
            Self::NotMirrored { cause } => write!(f, "{cause} (gait.mirror, gait.flipped)"),
            Self::LegsDiffer { joint, value, other, expected } if joint == other => write!(
                f,
                "joint '{}' has {}, but {} in the mirror, as it has in the next step; give it the same in both \
                 directions, limits of the robot included",
                printable(joint),
                number(*value),
                number(*expected)
            ),
            Self::LegsDiffer { joint, value, other, expected } => write!(
                f,
                "joint '{}' has {}, but '{}' {} in the mirror, and they change places in the next step; give both \
                 legs the same, limits of the robot included, and flipped joints limits of opposite signs",
                printable(joint),
                number(*value),
                printable(other),
                number(*expected)
            ),
            Self::FeetStay { miss, is_slight: true } => write!(
                f,
                "in the mirror a foot is {} m away from the other one, as the links of both legs differ by a \
                 little; gait.symmetrise = true takes the mean of the robot and its mirror image",
                number(*miss)
            ),
            Self::FeetStay { miss, is_slight: false } => write!(
                f,
                "with these pairs exchanged one foot is {} m away from where the other one was; pair each \
                 joint of one leg with its counterpart, and flip in space what moves along y",
                number(*miss)
            ),
            Self::CannotStand { cause } => {
                write!(f, "from here the feet do not come to the ground one step apart: {cause}")
            }
            Self::NotTaken { with } => write!(f, "{with} and a gait do not go together; remove one of the two"),
            Self::NotHere => f.write_str(
                "gaits are motions of the direct method alone, without solving again, feedback, sensitivities or \
                 continuation; remove [gait], or that",
            ),
            Self::Constrained { constraint } => write!(
                f,
                "the robot has the constraint '{}', and gaits are those of open trees; remove it",
                printable(constraint)
            ),
        }
    }
}

impl std::error::Error for GaitError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::CannotStand { cause } => Some(cause),
            Self::NoFoot { cause } | Self::NotMirrored { cause } => Some(&**cause),
            _ => None,
        }
    }
}
