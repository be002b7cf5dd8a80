//! What a command returns.

use std::error::Error;
use std::process::ExitCode;

/// The exit status of a command, or the error that stopped it.
pub type Outcome = Result<ExitCode, Box<dyn Error>>;
