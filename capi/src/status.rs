//! Codes, and the text of the last error.

use costate::EvalError;
use costate::codegen::CodegenError;
use costate::robot::RobotError;
use costate::step::StepError;
use std::cell::RefCell;
use std::ffi::{CString, c_char, c_int};
use std::fmt::Display;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// The results of functions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    Ok = 0,
    /// A pointer that must not be null is.
    Null = 1,
    /// An argument that is not one of its values, or not UTF-8.
    Argument = 2,
    /// A number of entries that is not that of the robot.
    Size = 3,
    /// A file that cannot be read.
    File = 4,
    /// A robot that cannot be built, or a name that it does not have.
    Robot = 5,
    NonFinite = 6,
    Singular = 7,
    /// An implicit step that was not solved.
    Step = 8,
    /// Anything else that an evaluation refuses.
    Evaluation = 9,
    /// A defect of the library.
    Internal = 10,
}

/// Why a function fails.
pub struct Failure {
    pub status: Status,
    text: String,
}

impl Failure {
    pub fn new(status: Status, text: impl Display) -> Self {
        Self { status, text: text.to_string() }
    }

    /// A pointer that is null.
    pub fn null(name: &str) -> Self {
        Self::new(Status::Null, format_args!("{name} is NULL"))
    }
}

impl From<RobotError> for Failure {
    fn from(error: RobotError) -> Self {
        let unreadable = |error: &RobotError| matches!(error, RobotError::Unreadable { .. });
        let file = match &error {
            RobotError::InFile { path, error, .. } => !path.as_os_str().is_empty() && unreadable(error),
            error => unreadable(error),
        };
        Self::new(if file { Status::File } else { Status::Robot }, error)
    }
}

impl From<EvalError> for Failure {
    fn from(error: EvalError) -> Self {
        let status = match &error {
            EvalError::NonFinite { .. } => Status::NonFinite,
            EvalError::SingularMassMatrix { .. } => Status::Singular,
            EvalError::WrongLength(_) => Status::Size,
            _ => Status::Evaluation,
        };
        Self::new(status, error)
    }
}

impl From<StepError<EvalError>> for Failure {
    fn from(error: StepError<EvalError>) -> Self {
        match error {
            StepError::Dynamics(error) => error.into(),
            StepError::WrongLength(error) => Self::new(Status::Size, error),
            StepError::NonFiniteDuration => Self::new(Status::NonFinite, error),
            error => Self::new(Status::Step, error),
        }
    }
}

impl From<CodegenError> for Failure {
    fn from(error: CodegenError) -> Self {
        Self::new(Status::Internal, error)
    }
}

thread_local! {
    static LAST: RefCell<CString> = RefCell::default();
}

fn remember(text: String) {
    let text = CString::new(text.replace('\0', " ")).unwrap_or_default();
    LAST.with_borrow_mut(|last| *last = text);
}

/// The code of what `work` returns; its error is remembered, and no panic leaves it.
pub fn guarded(work: impl FnOnce() -> Result<(), Failure>) -> c_int {
    let status = match catch_unwind(AssertUnwindSafe(work)) {
        Ok(Ok(())) => Status::Ok,
        Ok(Err(failure)) => {
            remember(failure.text);
            failure.status
        }
        Err(panic) => {
            let text = panic.downcast_ref::<String>().map(String::as_str);
            let text = text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("unknown");
            remember(format!("defect of costate, please report it: {text}"));
            Status::Internal
        }
    };
    status as c_int
}

#[unsafe(no_mangle)]
pub extern "C" fn costate_last_error() -> *const c_char {
    LAST.with_borrow(|last| last.as_ptr())
}

#[unsafe(no_mangle)]
pub extern "C" fn costate_version() -> *const c_char {
    const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), "\0");
    VERSION.as_ptr().cast()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::ffi::CStr;

    #[test]
    fn panics_become_errors_and_texts_stay_until_the_next_one() {
        assert_eq!(guarded(|| panic!("entry {} is missing", 3)), Status::Internal as c_int);
        assert_eq!(guarded(|| Ok(())), 0);
        // SAFETY: the text ends with a zero byte.
        let text = unsafe { CStr::from_ptr(costate_last_error()) };
        assert!(text.to_string_lossy().contains("entry 3 is missing"));
        assert_eq!(guarded(|| Err(Failure::null("q"))), Status::Null as c_int);
        // SAFETY: as above.
        assert_eq!(unsafe { CStr::from_ptr(costate_last_error()) }, c"q is NULL");
    }
}
