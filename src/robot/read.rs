//! Robots from files, text and streams.

use super::error::RobotError;
use super::format::RobotFormat;
use super::model::Robot;
use super::options::LoadOptions;
use std::io::{ErrorKind, Read};
use std::path::{Path, PathBuf};

impl Robot {
    /// Reads a `.urdf` or `.toml` file.
    ///
    /// # Errors
    /// As [`from_file_with`](Self::from_file_with).
    pub fn from_file(path: impl AsRef<Path>) -> Result<Self, RobotError> {
        Self::from_file_with(path, LoadOptions::default())
    }

    /// Reads a `.urdf` or `.toml` file, with options.
    ///
    /// # Errors
    /// Those of [`RobotText::from_file`] and [`RobotText::robot`].
    pub fn from_file_with(path: impl AsRef<Path>, options: LoadOptions) -> Result<Self, RobotError> {
        RobotText::from_file(path)?.robot(options)
    }

    /// Reads a robot from a stream, such as standard input.
    ///
    /// # Errors
    /// [`RobotError::Unreadable`], [`RobotError::TooLong`] for more than [`RobotFormat::most_bytes`],
    /// [`RobotError::NotUtf8`] with the line, and the errors of [`from_urdf_str`](Self::from_urdf_str) or
    /// [`from_toml_str`](Self::from_toml_str).
    pub fn read(source: impl Read, format: RobotFormat, options: LoadOptions) -> Result<Self, RobotError> {
        parse(&text_of(source, format)?, format, options)
    }

    /// Reads the text of a URDF, as [`urdf::parse`](super::urdf::parse).
    ///
    /// # Errors
    /// [`RobotError::InFile`] with the line of the culprit and an empty path; the error itself where no line
    /// is known.
    #[cfg(feature = "urdf")]
    pub fn from_urdf_str(text: &str, options: LoadOptions) -> Result<Self, RobotError> {
        super::urdf::parse(text, options)
    }

    /// Reads the text of a robot in TOML, as [`file::parse`](super::file::parse).
    ///
    /// # Errors
    /// [`RobotError::InFile`] with the line of the culprit and an empty path; the error itself where no line
    /// is known.
    #[cfg(feature = "toml")]
    pub fn from_toml_str(text: &str, options: LoadOptions) -> Result<Self, RobotError> {
        super::file::parse(text, options)
    }
}

/// The text of a robot file, read once: to make robots of it, and to keep.
///
/// ```
/// use costate::robot::{LoadOptions, RobotText};
/// # std::env::set_current_dir(env!("CARGO_MANIFEST_DIR"))?;
/// let text = RobotText::from_file("robots/two_link.toml")?;
/// assert!(text.as_str().contains(text.robot(LoadOptions::default())?.name()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct RobotText {
    path: PathBuf,
    text: String,
    format: RobotFormat,
}

impl RobotText {
    /// Reads a `.urdf` or `.toml` file.
    ///
    /// # Errors
    /// [`RobotError::InFile`] with the path and, where it is known, the line. In it:
    /// [`RobotError::Unreadable`], [`RobotError::IsXacro`], [`RobotError::UnknownFormat`] for another
    /// extension, [`RobotError::TooLong`] and [`RobotError::NotUtf8`].
    pub fn from_file(path: impl AsRef<Path>) -> Result<Self, RobotError> {
        let path = path.as_ref();
        let read = || {
            let unreadable = |source| RobotError::Unreadable { source };
            if std::fs::metadata(path).map_err(unreadable)?.is_dir() {
                return Err(unreadable(ErrorKind::IsADirectory.into()));
            }
            let format = RobotFormat::of_path(path)?;
            let text = text_of(std::fs::File::open(path).map_err(unreadable)?, format)?;
            Ok(Self { path: path.into(), text, format })
        };
        read().map_err(|error| in_file(path, error))
    }

    /// The robot that it describes.
    ///
    /// # Errors
    /// [`RobotError::InFile`] with the path and, where it is known, the line; in it the errors of
    /// [`Robot::read`].
    pub fn robot(&self, options: LoadOptions) -> Result<Robot, RobotError> {
        parse(&self.text, self.format, options).map_err(|error| in_file(&self.path, error))
    }

    /// The text.
    pub fn as_str(&self) -> &str {
        &self.text
    }

    /// Its format.
    pub fn format(&self) -> RobotFormat {
        self.format
    }
}

/// The error with the path of the file.
fn in_file(path: &Path, error: RobotError) -> RobotError {
    match error {
        RobotError::InFile { line, error, .. } => RobotError::InFile { path: path.into(), line, error },
        error => RobotError::InFile { path: path.into(), line: None, error: Box::new(error) },
    }
}

/// The text of a stream.
fn text_of(source: impl Read, format: RobotFormat) -> Result<String, RobotError> {
    let mut bytes = Vec::new();
    let most = format.most_bytes();
    source
        .take(most as u64 + 1)
        .read_to_end(&mut bytes)
        .map_err(|source| RobotError::Unreadable { source })?;
    if bytes.len() > most {
        return Err(RobotError::TooLong { most });
    }
    String::from_utf8(bytes).map_err(|error| {
        let valid = error.as_bytes().get(..error.utf8_error().valid_up_to()).unwrap_or_default();
        let line = 1 + valid.iter().filter(|&&byte| byte == b'\n').count();
        RobotError::InFile { path: "".into(), line: Some(line), error: Box::new(RobotError::NotUtf8) }
    })
}

fn parse(text: &str, format: RobotFormat, options: LoadOptions) -> Result<Robot, RobotError> {
    match format {
        RobotFormat::Urdf => from_urdf(text, options),
        RobotFormat::Toml => from_toml(text, options),
    }
}

#[cfg(feature = "urdf")]
fn from_urdf(text: &str, options: LoadOptions) -> Result<Robot, RobotError> {
    super::urdf::parse(text, options)
}

#[cfg(not(feature = "urdf"))]
fn from_urdf(_: &str, _: LoadOptions) -> Result<Robot, RobotError> {
    Err(RobotError::ReaderMissing { feature: "urdf" })
}

#[cfg(feature = "toml")]
fn from_toml(text: &str, options: LoadOptions) -> Result<Robot, RobotError> {
    super::file::parse(text, options)
}

#[cfg(not(feature = "toml"))]
fn from_toml(_: &str, _: LoadOptions) -> Result<Robot, RobotError> {
    Err(RobotError::ReaderMissing { feature: "toml" })
}
