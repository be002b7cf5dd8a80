//! What can be wrong with a loop of a URDF.

use crate::robot::nearest::offer;
use crate::robot::printable::printable;
use std::fmt;

/// Why a loop or a coupling of a URDF was refused: [`RobotError::BadLoop`](super::RobotError::BadLoop).
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum LoopProblem {
    /// It names a link that does not exist.
    UnknownLink {
        /// The link.
        link: String,
        /// Names of links that resemble it, the most similar first.
        nearest: Vec<String>,
    },
    /// A type that no constraint between two frames expresses.
    UnsupportedType {
        /// The type.
        kind: String,
    },
    /// An axis without direction.
    BadAxis,
    /// A coupling with the ratio 0, which the first of its links does not enter.
    NoRatio,
    /// A coupling of links that no joint moves against each other.
    Still,
    /// A coupling along a joint of several degrees of freedom.
    SeveralFreedoms {
        /// The joint.
        joint: String,
        /// `"floating"` or `"planar"`.
        kind: &'static str,
    },
}

impl fmt::Display for LoopProblem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::UnknownLink { link, nearest } => write!(
                f,
                "names the link '{}', which does not exist{}",
                printable(link),
                offer(nearest, "; name one of the links")
            ),
            Self::UnsupportedType { kind } => write!(
                f,
                "is of type '{}'; use fixed, revolute, continuous, prismatic, planar or spherical",
                printable(kind)
            ),
            Self::BadAxis => f.write_str(
                "has an axis of length zero, or one that is not finite; give it a direction such as 0 0 1",
            ),
            Self::NoRatio => f.write_str(
                "has the ratio zero: it would hold its second link still, whatever the first one does; give another \
                 ratio",
            ),
            Self::Still => f.write_str(
                "couples two links that do not move against each other; name links with a joint between them",
            ),
            Self::SeveralFreedoms { joint, kind } => write!(
                f,
                "couples links along joint '{}', which is {kind}: only joints of one degree of freedom have a \
                 ratio; name links with no such joint between them",
                printable(joint)
            ),
        }
    }
}
