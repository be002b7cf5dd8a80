//! The formats of robot files.

use super::error::RobotError;
use std::path::Path;

/// The formats of robot files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum RobotFormat {
    /// URDF; needs the feature `urdf`.
    Urdf,
    /// TOML as described in `robot::file`; needs the feature `toml`.
    Toml,
}

impl RobotFormat {
    /// Longest text that is read (bytes): 16 MiB of URDF, 4 MiB of TOML. Reading either takes less than 256
    /// MB.
    pub const fn most_bytes(self) -> usize {
        match self {
            Self::Urdf => 16 << 20,
            Self::Toml => 4 << 20,
        }
    }

    /// `urdf` or `toml`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Urdf => "urdf",
            Self::Toml => "toml",
        }
    }

    /// The format that the extension of a path names, in capital or small letters.
    ///
    /// # Errors
    /// [`RobotError::IsXacro`] for `.xacro`, [`RobotError::UnknownFormat`] for anything else but `.urdf` and
    /// `.toml`.
    pub fn of_path(path: impl AsRef<Path>) -> Result<Self, RobotError> {
        match path.as_ref().extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase).as_deref() {
            Some("urdf") => Ok(Self::Urdf),
            Some("toml") => Ok(Self::Toml),
            Some("xacro") => Err(RobotError::IsXacro),
            _ => Err(RobotError::UnknownFormat),
        }
    }

    /// Refuses a text without content and one that is of the other format.
    #[cfg(any(feature = "urdf", feature = "toml"))]
    pub(super) fn check_text(self, text: &str) -> Result<(), RobotError> {
        let is_blank = |c: char| c == '\u{feff}' || c.is_whitespace();
        let refuse = |message: &str| Err(RobotError::malformed(message).at(1));
        match (self, Self::of_text(text)) {
            _ if text.chars().all(is_blank) => refuse("the file is empty; describe a robot in it"),
            (Self::Toml, Self::Urdf) => {
                refuse("this looks like URDF, not TOML; name the file .urdf, or give --format urdf")
            }
            (Self::Urdf, Self::Toml) if text.contains("[[joint]]") => {
                refuse("this looks like TOML, not URDF; name the file .toml, or give --format toml")
            }
            _ => Ok(()),
        }
    }

    /// The format of a text, by its first character that is not blank: `<` begins a URDF.
    pub fn of_text(text: &str) -> Self {
        let text = text.trim_start_matches(|c: char| c == '\u{feff}' || c.is_whitespace());
        if text.starts_with('<') { Self::Urdf } else { Self::Toml }
    }
}
