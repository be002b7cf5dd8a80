//! Errors of problems and motions as Python exceptions.

use crate::errors::{argument, evaluation, unreadable, with};
use crate::words::in_python;
use costate_control::{
    GainError, ProblemError, ProblemFileCause, ProblemFileError, ResolveError, SampleError, SensitivityError,
};
use pyo3::prelude::*;

mod classes {
    pyo3::import_exception!(costate._errors, MotionError);
    pyo3::import_exception!(costate._errors, ProblemError);
    pyo3::import_exception!(costate._errors, ProblemWarning);
}

pub use classes::ProblemWarning;

/// A problem or an option that is refused.
#[cold]
pub fn file(py: Python<'_>, error: &ProblemFileError) -> PyErr {
    if let (ProblemFileCause::Unreadable(source), Some(path)) = (error.cause(), &error.path)
        && source.raw_os_error().is_some()
    {
        return unreadable(path, source);
    }
    // Lines of a text that was not read from a file were not written by the user.
    let message = match (&error.path, &error.key) {
        (Some(_), _) => error.to_string(),
        (None, Some(key)) => format!("{}: {}", costate::robot::printable(key), error.cause()),
        (None, None) => error.cause().to_string(),
    };
    let raised = classes::ProblemError::new_err(in_python(&message));
    let raised = with(py, raised, "path", error.path.as_ref().map(|path| path.display().to_string()));
    let raised = with(py, raised, "line", error.line);
    with(py, raised, "key", error.key.clone())
}

/// A problem that a method does not take.
#[cold]
pub fn problem(py: Python<'_>, error: &ProblemError) -> PyErr {
    let key = error.key().map(|key| key.to_string());
    let message = match &key {
        Some(key) => format!("{key}: {}", error.reason()),
        None => error.reason(),
    };
    with(py, classes::ProblemError::new_err(in_python(&message)), "key", key)
}

/// What cannot be asked of a motion.
#[cold]
pub fn motion(message: impl std::fmt::Display) -> PyErr {
    classes::MotionError::new_err(in_python(&message.to_string()))
}

#[cold]
pub fn sample(py: Python<'_>, error: SampleError) -> PyErr {
    match error {
        SampleError::Rate { .. } => argument(py, "rate", error.to_string()),
        SampleError::Evaluation(error) => evaluation(py, error),
        error => motion(error),
    }
}

#[cold]
pub fn gains(py: Python<'_>, error: GainError) -> PyErr {
    match error {
        GainError::Rate { .. } => argument(py, "rate", error.to_string()),
        GainError::Problem(error) => problem(py, &error),
        GainError::Evaluation(error) => evaluation(py, error),
        GainError::Resolve(error) => resolve(py, error),
        error => motion(error),
    }
}

#[cold]
pub fn sensitivity(py: Python<'_>, error: SensitivityError) -> PyErr {
    match error {
        SensitivityError::Problem(error) => problem(py, &error),
        SensitivityError::Evaluation(error) => evaluation(py, error),
        error => motion(error),
    }
}

#[cold]
pub fn resolve(py: Python<'_>, error: ResolveError) -> PyErr {
    let message = in_python(&error.to_string());
    match error {
        ResolveError::Evaluation(error) => evaluation(py, error),
        ResolveError::WrongLength { what, .. }
        | ResolveError::NotFinite { what, .. }
        | ResolveError::FreeAcceleration { what }
        | ResolveError::Outside { what, .. } => argument(py, what, message),
        ResolveError::NoEntry { table, .. }
        | ResolveError::NoNumber { table, .. }
        | ResolveError::Task { table, .. }
        | ResolveError::NoOrientation { table, .. }
        | ResolveError::NoTool { table, .. } => argument(py, table, message),
        ResolveError::Periodic => argument(py, "end", message),
        ResolveError::NoLimit { kind, .. } | ResolveError::BadLimit { kind, .. } => {
            argument(py, kind, message)
        }
        ResolveError::Payload(_) | ResolveError::NoMass => argument(py, "payload", message),
        _ => motion(message),
    }
}

/// A panic of the solver, which is a mistake in it.
#[cold]
pub fn failure(message: &str) -> PyErr {
    pyo3::exceptions::PyRuntimeError::new_err(format!("the solver failed, please report it: {message}"))
}
