//! What each error says.

use super::RobotError;
use crate::robot::nearest::offer;
use crate::robot::printable::{list, printable, printable_number, sentence};
use std::fmt;
use std::io::ErrorKind;
use std::path::Path;

impl fmt::Display for RobotError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::InFile { path, line, error } => {
                // Each warning names its own line.
                let line = line.filter(|_| !matches!(**error, Self::Strict { .. }));
                write!(f, "{}{error}", position(path, line))
            }
            Self::Unreadable { source } => match source.kind() {
                ErrorKind::NotFound => f.write_str("does not exist; check the path"),
                ErrorKind::IsADirectory => f.write_str("is a folder; give a robot file, .urdf or .toml"),
                _ => write!(f, "cannot be read ({source}); check the path and the permissions"),
            },
            Self::UnknownFormat => f.write_str(
                "unknown kind of robot file; use a name that ends in .urdf or .toml, or give the format by --format \
                 (Robot::read)",
            ),
            Self::IsXacro => {
                write!(f, "this is xacro, not URDF; expand it first: {EXPAND}")
            }
            Self::Unexpanded { error, element, line } => write!(
                f,
                "the file holds xacro elements (the first is '{}' in line {line}), which are not read; expand it first: \
                 {EXPAND}; as it is: {error}",
                printable(element)
            ),
            Self::ReaderMissing { feature } => write!(
                f,
                "this program was built without the reader of this format; build `costate` with the feature `{feature}`"
            ),
            Self::TooLong { most } => write!(
                f,
                "the text is longer than {} MiB, the limit for a robot; remove what is not a link or joint",
                most >> 20
            ),
            Self::NotUtf8 => f.write_str("the text is not UTF-8; save the file as UTF-8"),
            Self::DocumentType => f.write_str(
                "a document type (<!DOCTYPE ...>) is refused, since its entities can fill the memory; remove it",
            ),
            Self::Malformed { message, .. } => sentence(message).fmt(f),
            Self::NoJoints { robot } => write!(
                f,
                "robot '{}' has no moving joint; describe at least one revolute or prismatic joint \
                 (the base does not move: attach a free body to a link 'world' by a floating joint)",
                printable(robot)
            ),
            Self::AllLocked { joints } => write!(
                f,
                "all independent joints are locked, '{}'; leave at least one of them free",
                list(joints, "', '")
            ),
            Self::DuplicateName { kind, name } => {
                write!(f, "two {kind}s are called '{}'; give each its own name", printable(name))
            }
            Self::BadName { kind, name, rule } => {
                write!(f, "a {kind} is called '{}'; {rule}", printable(name))
            }
            Self::UnknownParent { joint, parent, kind } => write!(
                f,
                "joint '{}' is attached to '{}', which does not exist; correct the name or add the missing {kind}",
                printable(joint),
                printable(parent)
            ),
            Self::UnknownFrame { frame, nearest } => {
                write!(f, "there is no frame '{}'{}", printable(frame), offer(nearest, "; `costate info --frames` lists the names"))
            }
            Self::BadFramePlacement { frame } => write!(
                f,
                "the placement of frame '{}' is not a right-handed rotation and a finite translation of 1e75 m at most; correct it",
                printable(frame)
            ),
            Self::BadWrench { frame } => write!(
                f,
                "the wrench at frame '{}' has a number that is not finite, or larger than 1e75; give finite moments and forces",
                printable(frame)
            ),
            Self::Constrained { constraint, what } => write!(
                f,
                "the robot has the constraint '{}': it cannot {what}; remove its constraints to use the open tree",
                printable(constraint)
            ),
            Self::BadConstraint { constraint, problem } => {
                write!(f, "constraint '{}' cannot be held: {problem}", printable(constraint))
            }
            Self::BadLoop { constraint, problem } => {
                write!(f, "loop '{}' {problem}", printable(constraint))
            }
            Self::UnknownChild { joint, child } => write!(
                f,
                "joint '{}' moves link '{}', which does not exist; correct the name or add the missing link",
                printable(joint),
                printable(child)
            ),
            Self::TwoParents { link, first, second } => write!(
                f,
                "link '{}' is moved by two joints, '{}' and '{}'; a tree gives each link one parent: \
                 open the loop by removing one of them",
                printable(link),
                printable(first),
                printable(second)
            ),
            Self::Cycle { joints } => write!(
                f,
                "the joints form a loop, each attached to the next: {}; attach one of them to the world",
                list(joints, " -> ")
            ),
            Self::SeveralRoots { first, second } => write!(
                f,
                "links '{}' and '{}' both have no parent joint; connect them by a joint (a fixed one merges them)",
                printable(first),
                printable(second)
            ),
            Self::UnknownMimic { joint, master, nearest } => write!(
                f,
                "joint '{}' mimics '{}', which does not exist{}",
                printable(joint),
                printable(master),
                offer(nearest, "; name one of the joints, or remove the mimicry")
            ),
            Self::MimicCycle { joints } => match &joints[..] {
                [joint] => write!(f, "joint '{}' mimics itself; name another joint", printable(joint)),
                joints => write!(
                    f,
                    "the joints mimic each other in a loop: {}; let one of them mimic none",
                    list(&[joints, &joints[..1]].concat(), " -> ")
                ),
            },
            Self::UnsupportedMimic { joint, master, several, kind } => write!(
                f,
                "joint '{}' mimics '{}', but '{}' is {kind}: only joints of one degree of freedom can mimic or \
                 be mimicked; remove <mimic>",
                printable(joint),
                printable(master),
                printable(several)
            ),
            Self::UnknownJoint { joint, nearest } => write!(
                f,
                "there is no joint '{}'{}",
                printable(joint),
                offer(nearest, "; `costate info` lists the names")
            ),
            Self::FreeJoint { joint, kind, what } => write!(
                f,
                "joint '{}' is {kind}, its orientation a quaternion, and cannot {what}; leave this out, or describe it as \
                 a chain of joints of one degree of freedom",
                printable(joint)
            ),
            Self::StillJoint { joint } => write!(
                f,
                "joint '{}' does not move: it is locked, or fixed in the file; leave it out, or do not lock it",
                printable(joint)
            ),
            Self::RepeatedJoint { joint } => {
                write!(f, "joint '{}' is named twice; name it once", printable(joint))
            }
            Self::DependentJoint { joint, master } => write!(
                f,
                "joint '{}' follows joint '{}', which it mimics; name '{}' instead",
                printable(joint),
                printable(master),
                printable(master)
            ),
            Self::NotMirrored { joint, other, why } if joint == other => write!(
                f,
                "joint '{}' is no mirror image of itself: {why}; check its pair, and whether its sign changes in the \
                 mirror",
                printable(joint)
            ),
            Self::NotMirrored { joint, other, why } => write!(
                f,
                "joints '{}' and '{}' are no mirror images of each other: {why}; check the pairs, and which \
                 joints change their signs in the mirror",
                printable(joint),
                printable(other)
            ),
            Self::FixedFrame { frame } => write!(
                f,
                "no joint moves frame '{}', and a payload there has no effect; name a frame beyond a joint",
                printable(frame)
            ),
            Self::WrongPositions { expected, found } => write!(
                f,
                "there are {found} positions for {expected} independent joints; give one for each of them"
            ),
            Self::UnsupportedJoint { joint, kind } => write!(
                f,
                "joint '{}' is of type '{}'; use revolute, continuous, prismatic, fixed, floating or planar",
                printable(joint),
                printable(kind)
            ),
            Self::BadAxis { joint } => write!(
                f,
                "the axis of joint '{}' has length zero or is not finite; give it a direction such as 0 0 1",
                printable(joint)
            ),
            Self::BadPlacement { joint } => write!(
                f,
                "the placement of joint '{}' is not a right-handed rotation and a finite translation of 1e75 m at most; correct it",
                printable(joint)
            ),
            Self::BadValue { joint, what, value, rule } => {
                write!(f, "{what} of joint '{}' is {}; {rule}", printable(joint), printable_number(*value))
            }
            Self::NonFiniteInertia { body, what } => write!(f, "{what} of {body} is not finite; correct it"),
            Self::NegativeMass { body, mass } => {
                let mass = printable_number(*mass);
                write!(f, "the mass of {body} is {mass} kg; a mass is zero or positive")
            }
            Self::OutOfRange { body, what, value } => write!(
                f,
                "{what} of {body} is {}; what is not zero must lie between 1e-75 and 1e75, for products to stay \
                 finite: check the units",
                printable_number(*value)
            ),
            Self::IndefiniteInertia { body, moment } => write!(
                f,
                "the inertia of {body} about its centre of mass has the negative principal moment {} kg m^2; \
                 check signs and reference point of the matrix",
                printable_number(*moment)
            ),
            Self::BadGravity => f.write_str("gravity is not finite, or larger than 1e75; correct it (m/s^2)"),
            Self::BadArmature { problem, n } => write!(
                f,
                "the armature matrix {problem}; it must be {n} x {n}, symmetric and positive semidefinite, \
                 in the order of the joints"
            ),
            Self::Strict { warnings } => {
                let all: Vec<String> = warnings.iter().map(ToString::to_string).collect();
                write!(f, "refused by strict loading: {}", sentence(&all.join("; ")))
            }
        }
    }
}

/// How a URDF is made of xacro.
const EXPAND: &str = "xacro robot.xacro > robot.urdf (the program comes with ROS, or by pip install xacro)";

/// `path:line: `, or what is known of it.
fn position(path: &Path, line: Option<usize>) -> String {
    let name = path.display().to_string();
    match (name.is_empty(), line) {
        (false, Some(line)) => format!("{}:{line}: ", sentence(&name)),
        (false, None) => format!("{}: ", sentence(&name)),
        (true, Some(line)) => format!("line {line}: "),
        (true, None) => String::new(),
    }
}
