//! Codes, and the text of the last error.

use self::costate_status::*;
use costate::EvalError;
use costate::codegen::CodegenError;
use costate::robot::RobotError;
use costate::step::StepError;
use std::cell::RefCell;
use std::ffi::{CString, c_char, c_int};
use std::fmt::Display;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// What functions return.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum costate_status {
    /// Results are written.
    COSTATE_OK = 0,
    /// A pointer that must not be NULL is.
    COSTATE_NULL = 1,
    /// No value of its enum, no such index, or text that is not UTF-8.
    COSTATE_ARGUMENT = 2,
    /// n is not that of the robot.
    COSTATE_SIZE = 3,
    /// A file that cannot be read.
    COSTATE_FILE = 4,
    /// A robot that cannot be built, or a name that it does not have.
    COSTATE_ROBOT = 5,
    /// An argument is infinite or not a number.
    COSTATE_NON_FINITE = 6,
    /// The mass matrix has no inverse.
    COSTATE_SINGULAR = 7,
    /// An implicit step was not solved: take a shorter one.
    COSTATE_STEP = 8,
    /// Anything else that an evaluation refuses.
    COSTATE_EVALUATION = 9,
    /// A defect of costate.
    COSTATE_INTERNAL = 10,
}

/// Why a function fails.
pub struct Failure {
    /// What the function returns.
    pub status: costate_status,
    text: String,
}

impl Failure {
    /// A code with what was wrong.
    pub fn new(status: costate_status, text: impl Display) -> Self {
        Self { status, text: text.to_string() }
    }

    /// A pointer that is null.
    pub fn null(name: &str) -> Self {
        Self::new(COSTATE_NULL, format_args!("{name} is NULL"))
    }
}

impl From<RobotError> for Failure {
    fn from(error: RobotError) -> Self {
        let unreadable = |error: &RobotError| matches!(error, RobotError::Unreadable { .. });
        let file = match &error {
            RobotError::InFile { path, error, .. } => !path.as_os_str().is_empty() && unreadable(error),
            error => unreadable(error),
        };
        Self::new(if file { COSTATE_FILE } else { COSTATE_ROBOT }, error)
    }
}

impl From<EvalError> for Failure {
    fn from(error: EvalError) -> Self {
        let status = match &error {
            EvalError::NonFinite { .. } => COSTATE_NON_FINITE,
            EvalError::SingularMassMatrix { .. } => COSTATE_SINGULAR,
            EvalError::WrongLength(_) => COSTATE_SIZE,
            _ => COSTATE_EVALUATION,
        };
        Self::new(status, error)
    }
}

impl From<StepError<EvalError>> for Failure {
    fn from(error: StepError<EvalError>) -> Self {
        match error {
            StepError::Dynamics(error) => error.into(),
            StepError::WrongLength(error) => Self::new(COSTATE_SIZE, error),
            StepError::NonFiniteDuration => Self::new(COSTATE_NON_FINITE, error),
            error => Self::new(COSTATE_STEP, error),
        }
    }
}

impl From<CodegenError> for Failure {
    fn from(error: CodegenError) -> Self {
        Self::new(COSTATE_INTERNAL, error)
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
        Ok(Ok(())) => COSTATE_OK,
        Ok(Err(failure)) => {
            remember(failure.text);
            failure.status
        }
        Err(panic) => {
            let text = panic.downcast_ref::<String>().map(String::as_str);
            let text = text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("unknown");
            remember(format!("defect of costate, please report it: {text}"));
            COSTATE_INTERNAL
        }
    };
    status as c_int
}

/// What was wrong with the last call of this thread that failed, in UTF-8; valid until the next one that
/// fails.
#[unsafe(no_mangle)]
pub extern "C" fn costate_last_error() -> *const c_char {
    LAST.with_borrow(|last| last.as_ptr())
}

/// The version of the library, such as "0.1.0".
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
        assert_eq!(guarded(|| panic!("entry {} is missing", 3)), COSTATE_INTERNAL as c_int);
        assert_eq!(guarded(|| Ok(())), 0);
        // SAFETY: the text ends with a zero byte.
        let text = unsafe { CStr::from_ptr(costate_last_error()) };
        assert!(text.to_string_lossy().contains("entry 3 is missing"));
        assert_eq!(guarded(|| Err(Failure::null("q"))), COSTATE_NULL as c_int);
        // SAFETY: as above.
        assert_eq!(unsafe { CStr::from_ptr(costate_last_error()) }, c"q is NULL");
    }
}
