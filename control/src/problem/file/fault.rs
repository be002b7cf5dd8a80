//! Errors of the text of a problem file, with their lines and keys.

use crate::problem::file::error::{ProblemFileCause, ProblemFileError};
use std::path::Path;
use std::string::FromUtf8Error;

/// An error of the text, without its file.
#[derive(Debug)]
pub(crate) struct Fault {
    pub line: Option<usize>,
    pub key: Option<String>,
    pub cause: Box<ProblemFileCause>,
}

impl Fault {
    pub fn in_file(self, path: Option<&Path>) -> ProblemFileError {
        let Self { line, key, cause } = self;
        ProblemFileError { path: path.map(Path::to_path_buf), line, key, cause }
    }
}

impl From<ProblemFileCause> for Fault {
    fn from(cause: ProblemFileCause) -> Self {
        Self { line: None, key: None, cause: Box::new(cause) }
    }
}

/// The line at which a file stops being UTF-8.
pub(crate) fn not_utf8(error: &FromUtf8Error) -> Fault {
    let valid = &error.as_bytes()[..error.utf8_error().valid_up_to()];
    Fault { line: Some(line_at(valid, valid.len())), ..ProblemFileCause::NotUtf8.into() }
}

/// Line of a byte, from 1.
pub(super) fn line_at(text: &[u8], offset: usize) -> usize {
    1 + text.iter().take(offset).filter(|&&byte| byte == b'\n').count()
}
