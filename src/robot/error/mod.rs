//! What can be wrong with the description of a robot.

mod culprit;
mod loop_problem;
mod message;
mod place;

pub use self::loop_problem::LoopProblem;

use super::body::Body;
use super::warning::Warning;
use std::error::Error;
use std::path::PathBuf;

/// Why a robot was refused. Every message names the culprit and says what to do.
///
/// Names and values from the file are shown as [`printable`](super::printable) shows them. `source()` is the
/// cause where there is one: the operating system's error, or that of the XML or TOML parser.
#[derive(Debug)]
#[non_exhaustive]
pub enum RobotError {
    /// Any of the other errors, with the file and, where known, the line.
    InFile {
        /// The file.
        path: PathBuf,
        /// Line of the culprit, from 1.
        line: Option<usize>,
        /// What is wrong.
        error: Box<RobotError>,
    },
    /// The file cannot be read.
    Unreadable {
        /// The operating system's error.
        source: std::io::Error,
    },
    /// Neither .urdf nor .toml.
    UnknownFormat,
    /// A file whose name says that it is xacro, from which a URDF is made first.
    IsXacro,
    /// Refused, maybe since the file holds xacro elements, which nobody has expanded.
    Unexpanded {
        /// What is wrong with the text as it is.
        error: Box<RobotError>,
        /// The name of the first xacro element.
        element: String,
        /// Its line, from 1.
        line: usize,
    },
    /// The library was built without the reader of this format.
    ReaderMissing {
        /// The cargo feature that contains it: `"urdf"` or `"toml"`.
        feature: &'static str,
    },
    /// The text is longer than [`RobotFormat::most_bytes`](super::RobotFormat::most_bytes).
    TooLong {
        /// The limit (bytes).
        most: usize,
    },
    /// The text is not UTF-8.
    NotUtf8,
    /// A URDF with a document type, `<!DOCTYPE ...>`.
    DocumentType,
    /// The text breaks the rules of its format.
    Malformed {
        /// What is wrong and what was expected.
        message: String,
        /// The parser's error, if it found the mistake.
        source: Option<Box<dyn Error + Send + Sync>>,
    },
    /// No joint moves.
    NoJoints {
        /// The robot.
        robot: String,
    },
    /// A name given twice.
    DuplicateName {
        /// `"joint"`, `"link"`, `"frame"` or `"constraint"`.
        kind: &'static str,
        /// The name.
        name: String,
    },
    /// A name that cannot be used.
    BadName {
        /// `"joint"`, `"link"`, `"frame"` or `"constraint"`.
        kind: &'static str,
        /// The name.
        name: String,
        /// What is wrong, and what to do.
        rule: &'static str,
    },
    /// The parent does not exist.
    UnknownParent {
        /// The joint.
        joint: String,
        /// What it names as its parent.
        parent: String,
        /// `"joint"` or `"link"`.
        kind: &'static str,
    },
    /// There is no such frame.
    UnknownFrame {
        /// Its name.
        frame: String,
        /// Names of frames that resemble it, the most similar first.
        nearest: Vec<String>,
    },
    /// The placement of a frame is not a rigid motion.
    BadFramePlacement {
        /// The frame.
        frame: String,
    },
    /// A wrench has a number that is not finite, or larger than 1e75.
    BadWrench {
        /// The frame that it acts on.
        frame: String,
    },
    /// A constraint that cannot be held.
    BadConstraint {
        /// The constraint.
        constraint: String,
        /// What is wrong, and what to do.
        problem: &'static str,
    },
    /// A loop or a coupling of a URDF that cannot be read.
    BadLoop {
        /// The loop.
        constraint: String,
        /// What is wrong, and what to do.
        problem: LoopProblem,
    },
    /// The child link does not exist.
    UnknownChild {
        /// The joint.
        joint: String,
        /// The link it names.
        child: String,
    },
    /// A link moved by two joints.
    TwoParents {
        /// The link.
        link: String,
        /// First joint in the file.
        first: String,
        /// Second joint.
        second: String,
    },
    /// Joints attached to each other in a loop.
    Cycle {
        /// The joints, each attached to the link of the next, the last to that of the first.
        joints: Vec<String>,
    },
    /// More than one link without a parent.
    SeveralRoots {
        /// First root link.
        first: String,
        /// Another one.
        second: String,
    },
    /// A joint mimics one that does not exist.
    UnknownMimic {
        /// The joint.
        joint: String,
        /// The joint it mimics.
        master: String,
        /// Names of joints that resemble it, the most similar first.
        nearest: Vec<String>,
    },
    /// Joints that mimic each other in a loop.
    MimicCycle {
        /// The joints, each a mimic of the next, the last of the first.
        joints: Vec<String>,
    },
    /// A joint of several degrees of freedom that mimics another one, or is mimicked.
    UnsupportedMimic {
        /// The joint with the mimicry.
        joint: String,
        /// The joint it mimics.
        master: String,
        /// Which of the two has several degrees of freedom.
        several: String,
        /// Its type.
        kind: &'static str,
    },
    /// A joint that does not exist.
    UnknownJoint {
        /// The joint.
        joint: String,
        /// Names that resemble it, the most similar first.
        nearest: Vec<String>,
    },
    /// A joint that does not move: it is locked, or fixed in the file.
    StillJoint {
        /// The joint.
        joint: String,
    },
    /// A joint that is named twice in a list.
    RepeatedJoint {
        /// The joint.
        joint: String,
    },
    /// A joint that mimics another one, where an independent one is needed.
    DependentJoint {
        /// The joint.
        joint: String,
        /// The independent joint that it follows.
        master: String,
    },
    /// Two joints that are not mirror images of each other.
    NotMirrored {
        /// The joint.
        joint: String,
        /// The joint in whose place it comes; the same one if it keeps its place.
        other: String,
        /// What is different.
        why: &'static str,
    },
    /// A frame that no joint moves, where a body would have no effect.
    FixedFrame {
        /// The frame.
        frame: String,
    },
    /// Every independent joint is locked.
    AllLocked {
        /// The joints.
        joints: Vec<String>,
    },
    /// A list of positions whose length is not that of q.
    WrongPositions {
        /// Number of independent joints.
        expected: usize,
        /// Number of positions.
        found: usize,
    },
    /// Something that a floating or spherical joint cannot have, or that cannot be done with one.
    FreeJoint {
        /// The joint.
        joint: String,
        /// `"floating"` or `"spherical"`.
        kind: &'static str,
        /// What it cannot do, such as `"have limits"`.
        what: &'static str,
    },
    /// Something that cannot be done with a robot that has constraints.
    Constrained {
        /// The first constraint.
        constraint: String,
        /// What cannot be done, such as `"be used from Python"`.
        what: &'static str,
    },
    /// An unsupported type of joint.
    UnsupportedJoint {
        /// The joint.
        joint: String,
        /// Its type.
        kind: String,
    },
    /// An axis without direction.
    BadAxis {
        /// The joint.
        joint: String,
    },
    /// A placement that is not a rigid motion.
    BadPlacement {
        /// The joint.
        joint: String,
    },
    /// A value out of its range.
    BadValue {
        /// The joint.
        joint: String,
        /// Which value.
        what: &'static str,
        /// The value.
        value: f64,
        /// What is allowed.
        rule: &'static str,
    },
    /// Mass, centre of mass or inertia not finite.
    NonFiniteInertia {
        /// The link or payload.
        body: Body,
        /// Which figure.
        what: &'static str,
    },
    /// A mass below zero.
    NegativeMass {
        /// The link or payload.
        body: Body,
        /// The mass (kg).
        mass: f64,
    },
    /// A mass or inertia so small or large that products of it are zero or infinite: neither zero nor between
    /// 1e-75 and 1e75.
    OutOfRange {
        /// The link or payload.
        body: Body,
        /// Which figure.
        what: &'static str,
        /// Its value (kg, kg m^2).
        value: f64,
    },
    /// An inertia matrix that is not positive semidefinite, by more than a mistake in the figures of a real
    /// link explains.
    IndefiniteInertia {
        /// The link or payload.
        body: Body,
        /// Smallest principal moment (kg m^2).
        moment: f64,
    },
    /// Gravity is infinite, undefined or larger than 1e75.
    BadGravity,
    /// An armature matrix that does not fit.
    BadArmature {
        /// What is wrong.
        problem: String,
        /// Number of joints.
        n: usize,
    },
    /// Warnings that strict loading refuses.
    Strict {
        /// The warnings that became errors.
        warnings: Vec<Warning>,
    },
}
