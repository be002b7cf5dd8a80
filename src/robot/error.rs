//! What can be wrong with the description of a robot.

use std::path::{Path, PathBuf};

/// Why a robot was refused. Every message names the culprit and says what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RobotError {
    /// Any of the other errors, with the file and, where known, the line.
    #[error("{}{error}", position(path, *line))]
    InFile {
        /// The file.
        path: PathBuf,
        /// Line of the culprit, from 1.
        line: Option<usize>,
        /// What is wrong.
        error: Box<RobotError>,
    },
    /// The file cannot be read.
    #[error("cannot be read ({reason}); check the path and the permissions")]
    Unreadable {
        /// The operating system's reason.
        reason: String,
    },
    /// Neither .urdf nor .toml.
    #[error("unknown kind of robot file; use a name that ends in .urdf or .toml")]
    UnknownFormat,
    /// The text breaks the rules of its format.
    #[error("{message}")]
    Malformed {
        /// What is wrong and what was expected.
        message: String,
    },
    /// Nothing moves.
    #[error(
        "robot '{robot}' has no moving joint; describe at least one revolute or prismatic joint \
             (the base does not move: a free body stands on a link 'world' by a floating joint)"
    )]
    NoJoints {
        /// The robot.
        robot: String,
    },
    /// A name given twice.
    #[error("two {kind}s are called '{name}'; give each its own name")]
    DuplicateName {
        /// `"joint"` or `"link"`.
        kind: &'static str,
        /// The name.
        name: String,
    },
    /// The parent does not exist.
    #[error(
        "joint '{joint}' stands on '{parent}', which does not exist; correct the name or add the missing {kind}"
    )]
    UnknownParent {
        /// The joint.
        joint: String,
        /// What it names as its parent.
        parent: String,
        /// `"joint"` or `"link"`.
        kind: &'static str,
    },
    /// The child link does not exist.
    #[error(
        "joint '{joint}' moves link '{child}', which does not exist; correct the name or add the missing link"
    )]
    UnknownChild {
        /// The joint.
        joint: String,
        /// The link it names.
        child: String,
    },
    /// A link moved by two joints.
    #[error(
        "link '{link}' is moved by two joints, '{first}' and '{second}'; a tree gives each link one parent: \
         open the loop by removing one of them"
    )]
    TwoParents {
        /// The link.
        link: String,
        /// First joint in the file.
        first: String,
        /// Second joint.
        second: String,
    },
    /// Joints that stand on each other in a circle.
    #[error("joints stand on each other in a circle: {}; let one of them stand on the world", joints.join(" -> "))]
    Cycle {
        /// The joints, each standing on the next, the last on the first.
        joints: Vec<String>,
    },
    /// More than one link without a parent.
    #[error(
        "links '{first}' and '{second}' both have no parent joint; join them by a joint (a fixed one merges them)"
    )]
    SeveralRoots {
        /// First root link.
        first: String,
        /// Another one.
        second: String,
    },
    /// A joint that copies another one.
    #[error(
        "joint '{joint}' mimics joint '{master}', a constraint that a tree of independent joints cannot hold; \
         make it independent (remove <mimic>) or fixed"
    )]
    Mimic {
        /// The joint.
        joint: String,
        /// The joint it copies.
        master: String,
    },
    /// A kind of joint that is not offered.
    #[error(
        "joint '{joint}' is of type '{kind}'; use revolute, continuous, prismatic, fixed, floating or planar"
    )]
    UnsupportedJoint {
        /// The joint.
        joint: String,
        /// Its type.
        kind: String,
    },
    /// An axis without direction.
    #[error(
        "the axis of joint '{joint}' has length zero or is not finite; give it a direction such as 0 0 1"
    )]
    BadAxis {
        /// The joint.
        joint: String,
    },
    /// A placement that is not a rigid motion.
    #[error(
        "the placement of joint '{joint}' is not a finite right-handed rotation and translation; correct it"
    )]
    BadPlacement {
        /// The joint.
        joint: String,
    },
    /// A value out of its range.
    #[error("{what} of joint '{joint}' is {value}; {rule}")]
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
    #[error("{what} of link '{link}' is not finite; correct it")]
    NonFiniteInertia {
        /// The link.
        link: String,
        /// Which figure.
        what: &'static str,
    },
    /// A mass below zero.
    #[error("the mass of link '{link}' is {mass} kg; a mass is zero or positive")]
    NegativeMass {
        /// The link.
        link: String,
        /// The mass (kg).
        mass: f64,
    },
    /// An inertia matrix that is not positive semidefinite.
    #[error(
        "the inertia of link '{link}' about its centre of mass has the negative principal moment {moment} kg m^2; \
         check signs and reference point of the matrix"
    )]
    IndefiniteInertia {
        /// The link.
        link: String,
        /// Smallest principal moment (kg m^2).
        moment: f64,
    },
    /// A joint that moves nothing.
    #[error(
        "joint '{joint}' moves no mass at all, so the mass matrix is singular in every pose; \
         give its links a mass, give it armature (rotor inertia), or make it fixed"
    )]
    MovesNothing {
        /// The joint.
        joint: String,
    },
    /// A file without any mass.
    #[error(
        "joint '{joint}' moves no mass, and no link of the file has any: it describes kinematics only; \
         give its links <inertial> with <mass> and <inertia>"
    )]
    KinematicsOnly {
        /// First joint.
        joint: String,
    },
    /// Gravity is infinite or undefined.
    #[error("gravity is not finite; correct it")]
    BadGravity,
    /// An armature matrix that does not fit.
    #[error(
        "the armature matrix {problem}; it must be {n} x {n}, symmetric and positive semidefinite, in joint order"
    )]
    BadArmature {
        /// What is wrong.
        problem: String,
        /// Number of joints.
        n: usize,
    },
    /// Warnings, where strict checking was asked for.
    #[error("refused by strict checking: {}", warnings.join("; "))]
    Strict {
        /// The warnings that became errors.
        warnings: Vec<String>,
    },
}

/// `path:line: `, or what is known of it.
fn position(path: &Path, line: Option<usize>) -> String {
    match (path.as_os_str().is_empty(), line) {
        (false, Some(line)) => format!("{}:{line}: ", path.display()),
        (false, None) => format!("{}: ", path.display()),
        (true, Some(line)) => format!("line {line}: "),
        (true, None) => String::new(),
    }
}

impl RobotError {
    /// The joint or link that is at fault, where one is.
    pub fn culprit(&self) -> Option<&str> {
        match self {
            Self::InFile { error, .. } => error.culprit(),
            Self::UnknownParent { joint, .. }
            | Self::UnknownChild { joint, .. }
            | Self::Mimic { joint, .. }
            | Self::UnsupportedJoint { joint, .. }
            | Self::BadAxis { joint }
            | Self::BadPlacement { joint }
            | Self::BadValue { joint, .. }
            | Self::MovesNothing { joint }
            | Self::KinematicsOnly { joint } => Some(joint),
            Self::TwoParents { second, .. } => Some(second),
            Self::Cycle { joints } => joints.first().map(String::as_str),
            Self::SeveralRoots { second, .. } => Some(second),
            Self::NonFiniteInertia { link, .. }
            | Self::NegativeMass { link, .. }
            | Self::IndefiniteInertia { link, .. } => Some(link),
            Self::DuplicateName { name, .. } => Some(name),
            _ => None,
        }
    }
}
