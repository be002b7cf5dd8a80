//! Why a saved trajectory cannot be used.

use costate::robot::printable;

/// Version of the format of saved solutions. It grows when a key changes its meaning; a new key alone does
/// not change it.
pub(crate) const VERSION: u32 = 1;

/// Why a saved trajectory cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TrajectoryError {
    /// The text is not a saved solution.
    #[error("not a saved solution: {0}")]
    NotASolution(#[source] serde_json::Error),
    /// A version that this library does not read.
    #[error(
        "saved with version {found} of the format, and this program reads up to {VERSION}; update costate"
    )]
    Version {
        /// The version of the file.
        found: u32,
    },
    /// The text is too long.
    #[error("has more than {most} bytes, the most that a saved solution may have; save it with fewer nodes")]
    TooLong {
        /// Most bytes.
        most: usize,
    },
    /// A motion of another robot.
    #[error(
        "a motion of robot '{}' with joints {}; this robot has joints {}",
        printable(found),
        list(found_joints),
        list(joints)
    )]
    OtherRobot {
        /// Name of the robot in the file.
        found: String,
        /// Its joints.
        found_joints: Vec<String>,
        /// The joints of the robot that it should be.
        joints: Vec<String>,
    },
    /// A bound of a joint that the solution does not have.
    #[error("`bounds` names joint '{}'; the joints of the solution are {}", printable(joint), list(joints))]
    UnknownJoint {
        /// The joint.
        joint: String,
        /// The joints of the solution.
        joints: Vec<String>,
    },
    /// Fewer than two times, or times that fall.
    #[error("`t` is not a rising list of at least two finite times")]
    BadTimes,
    /// A list with too few or too many rows.
    #[error("`{key}` has {found} rows, and `t` has {expected}")]
    WrongRows {
        /// The list.
        key: &'static str,
        /// Rows it has.
        found: usize,
        /// Rows it needs.
        expected: usize,
    },
    /// A row with too few or too many numbers.
    #[error("row {row} of `{key}` (counted from 0) has {found} numbers; this robot needs {expected}")]
    WrongLength {
        /// The list.
        key: &'static str,
        /// The row, from 0.
        row: usize,
        /// Numbers it has.
        found: usize,
        /// Numbers it needs.
        expected: usize,
    },
    /// A number that is infinite or undefined.
    #[error("row {row} of `{key}` (counted from 0) holds a number that is not finite")]
    NotFinite {
        /// The list.
        key: &'static str,
        /// The row, from 0.
        row: usize,
    },
}

/// Refuses a version that this library does not read.
pub(crate) fn check_version(found: u32) -> Result<(), TrajectoryError> {
    if found > VERSION { Err(TrajectoryError::Version { found }) } else { Ok(()) }
}

fn list(names: &[String]) -> String {
    let shown: Vec<_> = names.iter().take(12).map(|name| format!("'{}'", printable(name))).collect();
    let more = if names.len() > 12 { format!(" and {} more", names.len() - 12) } else { String::new() };
    shown.join(", ") + &more
}
