//! What is wrong with a task.

use super::rounded::{rounded, rounded_up};
use costate::robot::{printable, printable_number as number};
use std::fmt;

/// Why a part of a [`Task`](crate::Task) was refused.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum TaskError {
    /// A frame that the robot does not have.
    UnknownFrame {
        /// The name that was given.
        frame: String,
        /// Names of frames that resemble it.
        nearest: Vec<String>,
    },
    /// A frame that no joint moves.
    FixedFrame {
        /// The frame.
        frame: String,
    },
    /// A number that is not finite.
    NotFinite,
    /// A direction of length zero, or one that is not finite.
    NoDirection,
    /// A matrix that is not orthonormal and right-handed to 1e-6.
    NotARotation,
    /// A number out of its range.
    OutOfRange {
        /// The number.
        value: f64,
        /// The range.
        remedy: &'static str,
    },
    /// A pose without position and orientation, or a box without sides.
    NothingAsked {
        /// The frame.
        frame: String,
        /// What would ask for something.
        remedy: &'static str,
    },
    /// Tools at an end that fix more than the joints which are free there.
    TooManyConditions {
        /// Number of conditions.
        asked: usize,
        /// Number of joints whose position is free.
        free: usize,
        /// The key that frees joints.
        remedy: &'static str,
    },
    /// A condition that no free joint changes.
    Immovable {
        /// The condition.
        what: String,
    },
    /// A time of a reference that is not later than the one before.
    NotLater {
        /// The time (s).
        time: f64,
        /// The one before it (s).
        before: f64,
    },
    /// A time of a reference that is so close to the one before that velocities between them are rounding.
    TooClose {
        /// The time (s).
        time: f64,
        /// The one before it (s).
        before: f64,
        /// The least distance of two times (s).
        least: f64,
    },
    /// A list of a reference with another number of entries than it needs.
    WrongCount {
        /// What it needs an entry for.
        what: &'static str,
        /// Number of entries it needs.
        expected: usize,
        /// Number of entries that were given.
        found: usize,
    },
    /// A reference whose orientation turns by half a turn or more from one knot to the next one.
    HalfTurn {
        /// The time of the first of the two knots (s).
        time: f64,
    },
    /// Velocities of a reference without its positions.
    NoPositions,
    /// An obstacle that shall move and has another shape or size.
    OtherShape,
    /// An orientation that shall take the place of another one, and is of the other kind: all axes, or one.
    OtherOrientation,
    /// A reference that shall take the place of another one, and is of something else: joints, another tool,
    /// other coordinates.
    OtherReference,
    /// A half-space as the body of a payload.
    BodyWithoutEnd,
    /// Obstacles or pairs, but no bodies of the robot that could touch them.
    NoBodies,
    /// A name that no body and no obstacle has.
    UnknownBody {
        /// The name that was given.
        name: String,
        /// The names there are.
        known: Vec<String>,
    },
    /// A pair of two bodies that the robot does not move against each other.
    FixedPair {
        /// The bodies.
        names: [String; 2],
    },
    /// Two bodies without radius and margin: their distance has no derivatives where they touch.
    NoRadius {
        /// The bodies.
        names: [String; 2],
    },
    /// More entries, or more pairs of bodies and obstacles, than a task may have.
    TooMany {
        /// Their number.
        found: usize,
        /// The most.
        most: usize,
    },
    /// A name that two of the bodies and obstacles have.
    DuplicateName {
        /// The name.
        name: String,
    },
    /// A start or end that does not keep what must hold along the motion.
    NotKept {
        /// What does not hold.
        what: String,
        /// By how much.
        by: f64,
        /// The unit of this: m, rad or m/s.
        unit: &'static str,
    },
    /// A tool whose position has a body of its link in an obstacle, however the robot holds it.
    InObstacle {
        /// The frame of the tool.
        frame: String,
        /// The clearance that is violated.
        what: String,
        /// By how much at least (m).
        by: f64,
    },
    /// A position that is farther away than links and sliding joints reach, whatever their positions are.
    BeyondReach {
        /// The frame of the tool.
        frame: String,
        /// The first joint that moves it.
        joint: String,
        /// The distance of the position from that joint, in the coordinates that are given (m).
        distance: f64,
        /// The largest one there can be (m).
        reach: f64,
    },
    /// Poses of tools that no position of the free joints within their limits was found for.
    OutOfReach {
        /// What comes least close.
        what: String,
        /// By how much at the nearest position that was found.
        by: f64,
        /// The unit of this: m or rad.
        unit: &'static str,
    },
}

impl fmt::Display for TaskError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::UnknownFrame { frame, nearest } => {
                write!(f, "there is no frame '{}'", printable(frame))?;
                match &nearest[..] {
                    [] => write!(f, "; `costate info ROBOT --frames` lists them"),
                    nearest => write!(f, "; did you mean {}?", quoted(nearest, " or ")),
                }
            }
            Self::FixedFrame { frame } => {
                write!(f, "no joint moves the frame '{}'; name one on a link that moves", printable(frame))
            }
            Self::NotFinite => f.write_str("must be finite"),
            Self::NoDirection => f.write_str("gives no direction: it must be finite and not zero"),
            Self::NotARotation => f.write_str("is no rotation: its rows must be orthonormal and right-handed to 1e-6"),
            Self::OutOfRange { value, remedy } => write!(f, "{remedy}, but is {}", number(*value)),
            Self::NothingAsked { frame, remedy } => {
                write!(f, "nothing is asked of the tool '{}': give {remedy}", printable(frame))
            }
            Self::TooManyConditions { asked, free, remedy } => write!(
                f,
                "the tools here fix {asked} quantities, but the number of joints with free positions is {free}; free more in \
                 {remedy} or ask for less; what the arm always keeps, such as the axis of an arm that only moves \
                 upright, is no quantity to ask for, [[keep]] can hold it"
            ),
            Self::Immovable { what } => write!(
                f,
                "no free joint changes the {}; leave it out (a coordinate that is inf is free), or free other joints",
                printable(what)
            ),
            Self::NotLater { time, before } => {
                write!(f, "the time {} s is not later than {} s, the one before", number(*time), number(*before))
            }
            Self::TooClose { time, before, least } => write!(
                f,
                "the time {} s is too close to the one before, {} s: velocities between them would be rounding; leave \
                 {} s at least, or one of the two out",
                number(*time),
                number(*before),
                number(rounded_up(*least, 4))
            ),
            Self::WrongCount { what, expected, found } => {
                write!(f, "needs {expected} entries, one for each {what}, but has {found}")
            }
            Self::HalfTurn { time } => write!(
                f,
                "the orientation turns by half a turn or more from the knot at {} s to the next one; give one between them",
                number(*time)
            ),
            Self::NoPositions => f.write_str("there are no positions that could have these velocities; give positions"),
            Self::OtherShape => {
                f.write_str("has another shape or size than the obstacle that shall move; only places change")
            }
            Self::OtherOrientation => f.write_str(
                "is an orientation of the other kind; all axes stay all axes, one axis stays one axis",
            ),
            Self::OtherReference => f.write_str(
                "is a reference of something else than the one whose place it takes: joints, the tool and the coordinates that \
                 are given stay",
            ),
            Self::BodyWithoutEnd => {
                f.write_str("a payload is a sphere, a capsule or a box, and no half-space; give another shape")
            }
            Self::NoBodies => f.write_str(
                "the robot has no bodies that could touch anything; give [collision] with capsules = \"auto\" and a radius, \
                 or [[collision.capsule]]",
            ),
            Self::UnknownBody { name, known } => write!(
                f,
                "nothing is called '{}'; the bodies and obstacles are {}",
                printable(name),
                quoted(known, ", ")
            ),
            Self::FixedPair { names: [a, b] } => write!(
                f,
                "the robot does not move '{}' and '{}' against each other; remove the pair",
                printable(a),
                printable(b)
            ),
            Self::NoRadius { names: [a, b] } => write!(
                f,
                "'{}' and '{}' have neither a radius nor a margin between them; give one of the three",
                printable(a),
                printable(b)
            ),
            Self::TooMany { found, most } => {
                write!(f, "the task has {found} of these or of their pairs, the most is {most}; leave some out")
            }
            Self::DuplicateName { name } => {
                write!(f, "two bodies or obstacles are called '{}'; rename one", printable(name))
            }
            Self::NotKept { what, by, unit } => write!(
                f,
                "the {} is off by {} {unit}; move it, or ask for less",
                printable(what),
                rounded(*by)
            ),
            Self::InObstacle { frame, what, by } => write!(
                f,
                "with the tool '{}' here the {} is violated by {} m or more, whatever the joints do; move the tool or the \
                 obstacle, or let the two touch (collision.except)",
                printable(frame),
                printable(what),
                rounded(*by)
            ),
            Self::BeyondReach { frame, joint, distance, reach } => write!(
                f,
                "lies {distance:.4} m from joint '{}', but the links to the tool '{}' reach no farther than {reach:.4} m: \
                 that is {:.4} m too far",
                printable(joint),
                printable(frame),
                distance - reach
            ),
            Self::OutOfReach { what, by, unit } => write!(
                f,
                "no position of the free joints within their limits was found: at best the {} is off by {} {unit}; move \
                 the tool, free more joints, or give a better first guess of q",
                printable(what),
                rounded(*by)
            ),
        }
    }
}

impl std::error::Error for TaskError {}

/// The first names, each in quotes.
fn quoted(names: &[String], between: &str) -> String {
    const MOST: usize = 12;
    let shown: Vec<String> = names.iter().take(MOST).map(|name| format!("'{}'", printable(name))).collect();
    let more = names.len().saturating_sub(MOST);
    shown.join(between) + &if more > 0 { format!(" and {more} more") } else { String::new() }
}
