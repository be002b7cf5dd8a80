//! Where in a file an error is, and what caused it.

use super::RobotError;
use std::error::Error;

impl RobotError {
    /// A text that breaks the rules of its format.
    #[cfg(any(feature = "urdf", feature = "toml"))]
    pub(in crate::robot) fn malformed(message: impl Into<String>) -> Self {
        Self::Malformed { message: message.into(), source: None }
    }

    /// This error at a line of a file whose path the caller knows.
    #[cfg(any(feature = "urdf", feature = "toml"))]
    pub(in crate::robot) fn at(self, line: impl Into<Option<usize>>) -> Self {
        Self::InFile { path: std::path::PathBuf::new(), line: line.into(), error: Box::new(self) }
    }

    /// This error of a file whose first xacro element has this name and line, if it has one.
    #[cfg(feature = "urdf")]
    pub(in crate::robot) fn unexpanded(self, first: Option<(String, usize)>) -> Self {
        match (self, first) {
            (Self::InFile { path, line, error }, first) => {
                Self::InFile { path, line, error: Box::new(error.unexpanded(first)) }
            }
            // What names xacro already.
            (error @ Self::Strict { .. }, _) => error,
            (Self::Malformed { message, source }, _) if message.contains("xacro") => {
                Self::Malformed { message, source }
            }
            (error, Some((element, line))) => Self::Unexpanded { error: Box::new(error), element, line },
            (error, None) => error,
        }
    }

    /// The line of the file, from 1, where it is known.
    pub fn line(&self) -> Option<usize> {
        match self {
            Self::InFile { line, .. } => *line,
            _ => None,
        }
    }
}

impl Error for RobotError {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        match self {
            // Its message contains that of `error`.
            Self::InFile { error, .. } | Self::Unexpanded { error, .. } => error.source(),
            Self::Unreadable { source } => Some(source),
            Self::Malformed { source, .. } => source.as_deref().map(|source| source as _),
            _ => None,
        }
    }
}
