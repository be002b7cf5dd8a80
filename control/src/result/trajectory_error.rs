//! Why a saved trajectory cannot be used.

use costate::robot::printable;
use serde_json::error::Category;

/// Version of the format of saved solutions. It grows when a key changes its meaning; a new key alone does
/// not change it.
pub(crate) const VERSION: u32 = 1;

/// Why a saved trajectory cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TrajectoryError {
    /// The text is not a saved solution.
    #[error("not a file that `costate optimize --save` wrote: {problem}")]
    NotASolution {
        /// What is wrong, with the key where it is known, line and column.
        problem: String,
        /// The parser's error; `None` for a missing version.
        source: Option<serde_json::Error>,
    },
    /// The solution has no motion.
    #[error("this file holds no motion (status {}); solve the problem first", printable(status))]
    NoMotion {
        /// The status of the solution.
        status: String,
    },
    /// A version that this library does not read.
    #[error(
        "saved with version {found} of the format, and this program reads up to {VERSION}; update costate"
    )]
    Version {
        /// The version of the file.
        found: u32,
    },
    /// The text is too long.
    #[error(
        "has more than {most} bytes, the most that a saved solution may have; solve with a larger solver.tolerance, which needs fewer nodes"
    )]
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
    /// A motion of another robot, whose joints have the same names and turn in another way.
    #[error(
        "a motion of robot '{}', in which {}; of this robot, {}; give a motion of a robot that was read in the \
         same way",
        printable(found),
        quaternions(found_joints),
        quaternions(joints)
    )]
    OtherFreeJoints {
        /// Name of the robot in the file.
        found: String,
        /// Its floating and spherical joints.
        found_joints: Vec<String>,
        /// Those of the robot that it should be.
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
    /// Floating and spherical joints whose entries are not those of the rows.
    #[error("`free_joints` does not fit the rows of `v`")]
    FreeJoints,
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

impl TrajectoryError {
    /// The parser's error in words of the file.
    pub(crate) fn unreadable(text: &str, error: serde_json::Error) -> Self {
        let (line, column) = (error.line(), error.column());
        let place = if line == 0 { String::new() } else { format!(" (line {line}, column {column})") };
        let whole = error.to_string();
        let reason = whole.split(" at line ").next().unwrap_or_default();
        let key = || key_before(text, line, column).map_or("a value".into(), |key| format!("`{key}`"));
        let problem = match error.classify() {
            Category::Eof => "the text ends too early".into(),
            Category::Data => {
                match (reason.strip_prefix("missing field "), reason.rsplit_once(", expected ")) {
                    (Some(name), _) => format!("the key {name} is missing"),
                    (_, Some((found, expected))) => {
                        let found = found.split_once(": ").map_or(found, |(_, found)| found);
                        let found = match found.strip_prefix("invalid length ") {
                            Some(length) => format!("{length} entries"),
                            None => printable(found).to_string(),
                        };
                        format!("{} holds {found}, not {}", key(), plain(expected))
                    }
                    _ => format!("{}: {}", key(), printable(reason)),
                }
            }
            _ => "not JSON".into(),
        };
        Self::NotASolution { problem: problem + &place, source: Some(error) }
    }
}

/// What the parser expected, without names of types.
fn plain(expected: &str) -> &str {
    match expected {
        "f64" => "a number",
        "u32" | "usize" => "a whole number",
        "a sequence" => "a list",
        expected if expected.starts_with("struct ") => "an object",
        expected => expected,
    }
}

/// The last key before a line and column, from 1.
fn key_before(text: &str, line: usize, column: usize) -> Option<String> {
    let start: usize = text.split_inclusive('\n').take(line.checked_sub(1)?).map(str::len).sum();
    let before = text.as_bytes().get(..(start + column).min(text.len()))?;
    let end = before.windows(2).rposition(|pair| pair == b"\":")?;
    let name = before[..end].iter().rposition(|&byte| byte == b'"')? + 1;
    Some(printable(&String::from_utf8_lossy(&before[name..end])).to_string())
}

/// Refuses a version that this library does not read.
pub(crate) fn check_version(found: u32) -> Result<(), TrajectoryError> {
    if found > VERSION { Err(TrajectoryError::Version { found }) } else { Ok(()) }
}

/// Which joints have quaternions.
fn quaternions(joints: &[String]) -> String {
    match joints {
        [] => "no joint has a quaternion".into(),
        joints => format!("the orientations of {} are quaternions", list(joints)),
    }
}

fn list(names: &[String]) -> String {
    let shown: Vec<_> = names.iter().take(12).map(|name| format!("'{}'", printable(name))).collect();
    let more = if names.len() > 12 { format!(" and {} more", names.len() - 12) } else { String::new() };
    shown.join(", ") + &more
}
