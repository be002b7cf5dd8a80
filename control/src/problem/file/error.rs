//! Errors of problem files.

use crate::problem::error::ProblemError;
use costate::robot::{RobotError, printable};
use std::fmt;
use std::path::{Path, PathBuf};

/// Why a problem file was refused. Prints as `file:line: key: cause`.
#[derive(Debug)]
#[non_exhaustive]
pub struct ProblemFileError {
    /// The file; `None` for a text.
    pub path: Option<PathBuf>,
    /// Line, from 1.
    pub line: Option<usize>,
    /// The key with its table, as `bounds.u_min`.
    pub key: Option<String>,
    pub(crate) cause: Box<ProblemFileCause>,
}

impl ProblemFileError {
    /// A field of a problem, or an option, that is out of range.
    pub(crate) fn of_problem(path: Option<&Path>, error: ProblemError) -> Self {
        let key = error.key().map(|key| key.to_string());
        let cause = Box::new(ProblemFileCause::Problem(error));
        Self { path: path.map(Path::to_path_buf), line: None, key, cause }
    }

    /// The cause.
    pub fn cause(&self) -> &ProblemFileCause {
        &self.cause
    }
}

/// What is wrong in a problem file.
#[derive(Debug)]
#[non_exhaustive]
pub enum ProblemFileCause {
    /// The file cannot be read.
    Unreadable(std::io::Error),
    /// The file is not UTF-8.
    NotUtf8,
    /// The text is too long.
    TooLong {
        /// Most bytes.
        most: usize,
    },
    /// The text is not TOML.
    Syntax(String),
    /// A key that stands twice in its table.
    DuplicateKey,
    /// A key that the table does not have.
    UnknownKey {
        /// The keys of the table.
        known: &'static [&'static str],
    },
    /// A key that must be given.
    MissingKey,
    /// A value of another type.
    WrongType {
        /// What must be given.
        expected: &'static str,
        /// What was given.
        found: String,
    },
    /// A name that is not one of the values of the key.
    UnknownValue {
        /// The value.
        found: String,
        /// The values of the key.
        known: Vec<&'static str>,
    },
    /// Keys that contradict each other.
    Conflict(&'static str),
    /// The robot cannot be loaded.
    Robot(RobotError),
    /// The problem or an option is not valid.
    Problem(ProblemError),
    /// Any other error of a value.
    Other(Box<dyn std::error::Error + Send + Sync>),
}

impl fmt::Display for ProblemFileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let path = self.path.as_deref().unwrap_or(Path::new("problem"));
        write!(f, "{}", path.display())?;
        if let Some(line) = self.line {
            write!(f, ":{line}")?;
        }
        if let Some(key) = &self.key {
            write!(f, ": {}", printable(key))?;
        }
        write!(f, ": {}", self.cause)
    }
}

impl fmt::Display for ProblemFileCause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unreadable(error) => write!(f, "cannot be read ({error}); check the path"),
            Self::NotUtf8 => f.write_str("the text is not UTF-8; save the file as UTF-8"),
            Self::TooLong { most } => {
                write!(f, "has more than {most} bytes, the most that a problem file may have; shorten it")
            }
            Self::Syntax(message) => write!(f, "not TOML: {message}"),
            Self::DuplicateKey => f.write_str("duplicate key; remove one of the two"),
            Self::UnknownKey { known } => write!(f, "unknown key; the keys here are {}", list(known)),
            Self::MissingKey => f.write_str("missing; add it"),
            Self::WrongType { expected, found } => write!(f, "give {expected}, not {found}"),
            Self::UnknownValue { found, known } => {
                write!(f, "`{}` is unknown; give {}", printable(found), list(known))
            }
            Self::Conflict(message) => f.write_str(message),
            Self::Robot(error) => write!(f, "{error}"),
            Self::Problem(error) => f.write_str(&error.reason()),
            Self::Other(error) => write!(f, "{error}"),
        }
    }
}

impl std::error::Error for ProblemFileError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self.cause() {
            ProblemFileCause::Unreadable(error) => Some(error),
            ProblemFileCause::Robot(error) => Some(error),
            ProblemFileCause::Problem(error) => Some(error),
            ProblemFileCause::Other(error) => Some(error.as_ref()),
            _ => None,
        }
    }
}

fn list(names: &[&str]) -> String {
    names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ")
}
