//! Errors as Python exceptions, which carry what they are about.

use crate::words::in_python;
use costate::EvalError;
use costate::constraints::ConstraintError;
use costate::robot::RobotError;
use costate::step::StepError;
use pyo3::PyErr;
use pyo3::prelude::*;
use pyo3::types::PyBool;
use std::ops::RangeInclusive;
use std::path::Path;

/// The classes of `costate._errors`.
mod classes {
    pyo3::import_exception!(costate._errors, ArgumentError);
    pyo3::import_exception!(costate._errors, CodegenError);
    pyo3::import_exception!(costate._errors, ConstraintError);
    pyo3::import_exception!(costate._errors, CostateError);
    pyo3::import_exception!(costate._errors, Interrupted);
    pyo3::import_exception!(costate._errors, NonFiniteResult);
    pyo3::import_exception!(costate._errors, NonFiniteState);
    pyo3::import_exception!(costate._errors, NonUnitQuaternion);
    pyo3::import_exception!(costate._errors, RobotError);
    pyo3::import_exception!(costate._errors, RobotWarning);
    pyo3::import_exception!(costate._errors, SingularMassMatrix);
    pyo3::import_exception!(costate._errors, StateError);
    pyo3::import_exception!(costate._errors, StateWarning);
    pyo3::import_exception!(costate._errors, StepNotSolved);
}

pub use classes::{CodegenError, CostateError, Interrupted, RobotWarning, StateWarning};

/// The same error with one more attribute; if that fails, the error of the failure.
pub fn with<'py>(py: Python<'py>, error: PyErr, name: &str, value: impl IntoPyObject<'py>) -> PyErr {
    error.value(py).setattr(name, value).err().unwrap_or(error)
}

/// An argument that does not fit.
#[cold]
pub fn argument(py: Python<'_>, name: &str, message: String) -> PyErr {
    with(py, classes::ArgumentError::new_err(message), "argument", name)
}

/// An argument that is a whole number in a range; a truth value is none.
///
/// # Errors
/// `ArgumentError` for another type, and for a number out of the range.
pub fn whole(name: &str, given: &Bound<'_, PyAny>, range: RangeInclusive<usize>) -> PyResult<usize> {
    match given.extract::<usize>() {
        Ok(number) if range.contains(&number) && !given.is_instance_of::<PyBool>() => Ok(number),
        _ => {
            let shown = given.repr().map_or_else(|_| "?".into(), |text| text.to_string());
            let (least, most) = range.into_inner();
            let message = match most {
                usize::MAX => format!("{name} is {shown}; give a whole number, at least {least}"),
                most => format!("{name} is {shown}; give a whole number from {least} to {most}"),
            };
            Err(argument(given.py(), name, message))
        }
    }
}

/// A file that cannot be read, as Python raises it: with its name.
#[cold]
pub fn unreadable(path: &Path, error: &std::io::Error) -> PyErr {
    let text = error.to_string();
    let text = text.split(" (os error").next().unwrap_or_default().to_owned();
    pyo3::exceptions::PyOSError::new_err((error.raw_os_error(), text, path.display().to_string()))
}

/// A robot that cannot be read, built or changed.
#[cold]
pub fn robot(py: Python<'_>, error: &RobotError) -> PyErr {
    if let RobotError::InFile { path, error: inner, .. } = error
        && let RobotError::Unreadable { source } = &**inner
        && source.raw_os_error().is_some()
    {
        return unreadable(path, source);
    }
    let mut raised = classes::RobotError::new_err(in_python(&error.to_string()));
    if let RobotError::InFile { path, .. } = error
        && !path.as_os_str().is_empty()
    {
        raised = with(py, raised, "path", path.display().to_string());
    }
    raised = with(py, raised, "line", error.line());
    with(py, raised, "culprit", error.culprit())
}

/// A robot that a computation does not take, whatever its state.
#[cold]
pub fn unusable(py: Python<'_>, error: &EvalError) -> PyErr {
    let raised = classes::RobotError::new_err(in_python(&error.to_string()));
    let joint =
        if let EvalError::FreeJointAndWrench { joint, .. } = error { Some(joint.clone()) } else { None };
    with(py, raised, "culprit", joint)
}

/// A state of a motion that could not be evaluated.
#[cold]
pub fn evaluation(py: Python<'_>, error: EvalError) -> PyErr {
    Failure::from(error).raise(py, Vec::new())
}

/// Why a state could not be evaluated.
#[derive(Debug)]
pub enum Failure {
    /// A number of an argument is infinite or not a number.
    NonFinite {
        argument: &'static str,
        index: usize,
        joint: Option<String>,
    },
    /// A quaternion of an argument has another length than 1.
    NotUnit {
        argument: &'static str,
        joint: String,
        length: f64,
    },
    /// Arguments are finite, and a state between the beginning and the end of a step is not.
    Overflow {
        joint: String,
    },
    /// Arguments are finite, and a result is not; with the largest number of all arguments.
    Result {
        argument: &'static str,
        index: usize,
        joint: Option<String>,
        value: f64,
    },
    Evaluation(EvalError),
    Step(StepError<EvalError>),
    Constraint(ConstraintError),
}

impl From<ConstraintError> for Failure {
    fn from(error: ConstraintError) -> Self {
        match error {
            ConstraintError::Evaluation(error) => error.into(),
            error => Self::Constraint(error),
        }
    }
}

impl From<EvalError> for Failure {
    fn from(error: EvalError) -> Self {
        Self::Evaluation(error)
    }
}

impl From<StepError<EvalError>> for Failure {
    fn from(error: StepError<EvalError>) -> Self {
        match error {
            // Arguments have been checked.
            StepError::Dynamics(EvalError::NonFinite { joint, .. }) => Self::Overflow { joint },
            StepError::Dynamics(error) => error.into(),
            error => Self::Step(error),
        }
    }
}

impl std::fmt::Display for Failure {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NonFinite { argument, index, joint } => {
                write!(f, "{argument}[{index}]")?;
                if let Some(joint) = joint {
                    write!(f, " (joint '{}')", costate::robot::printable(joint))?;
                }
                f.write_str(" is not finite; check the computation that produced it")
            }
            Self::NotUnit { argument, joint, length } => {
                let joint = costate::robot::printable(joint);
                let advice = match length.is_normal() {
                    true => "Robot.normalize divides it by its length",
                    false => "it has no direction; give another one",
                };
                write!(
                    f,
                    "the quaternion of joint '{joint}' in {argument} has the length {length}, not 1; {advice}"
                )
            }
            Self::Overflow { joint } => write!(
                f,
                "joint '{}' is beyond all numbers within the step; take a shorter step, or smaller arguments",
                costate::robot::printable(joint)
            ),
            Self::Result { argument, index, joint, value } => {
                write!(
                    f,
                    "a result is not finite, though all arguments are; the largest is {argument}[{index}]"
                )?;
                if let Some(joint) = joint {
                    write!(f, " (joint '{}')", costate::robot::printable(joint))?;
                }
                write!(f, " = {value:e}; give smaller ones")
            }
            Self::Evaluation(error) => error.fmt(f),
            Self::Step(error) => error.fmt(f),
            Self::Constraint(error) => error.fmt(f),
        }
    }
}

impl Failure {
    /// What happened, with the batch index of the state.
    pub fn at(&self, index: &[usize]) -> String {
        let text = if index.is_empty() { self.to_string() } else { format!("state {index:?}: {self}") };
        in_python(&text)
    }

    /// The exception for the state with this batch index.
    #[cold]
    pub fn raise(&self, py: Python<'_>, index: Vec<usize>) -> PyErr {
        let message = self.at(&index);
        let raised = match self {
            Self::Evaluation(EvalError::SingularMassMatrix { joint }) => {
                with(py, classes::SingularMassMatrix::new_err(message), "joint", joint)
            }
            Self::NonFinite { argument, joint, .. } => {
                let raised = with(py, classes::NonFiniteState::new_err(message), "joint", joint);
                with(py, raised, "argument", *argument)
            }
            Self::NotUnit { argument, joint, length } => {
                let raised = with(py, classes::NonUnitQuaternion::new_err(message), "joint", joint);
                with(py, with(py, raised, "argument", *argument), "length", *length)
            }
            Self::Overflow { joint } => with(py, classes::NonFiniteResult::new_err(message), "joint", joint),
            Self::Result { argument, joint, .. } => {
                let raised = with(py, classes::NonFiniteResult::new_err(message), "joint", joint);
                with(py, raised, "argument", *argument)
            }
            Self::Evaluation(_) => classes::StateError::new_err(message),
            Self::Step(_) => classes::StepNotSolved::new_err(message),
            Self::Constraint(error) => {
                let raised = classes::ConstraintError::new_err(message);
                match error {
                    ConstraintError::CannotClose { constraint, miss }
                    | ConstraintError::Contradiction { constraint, miss, .. } => {
                        with(py, with(py, raised, "constraint", constraint), "miss", miss)
                    }
                    _ => raised,
                }
            }
        };
        match pyo3::types::PyTuple::new(py, index) {
            Ok(index) => with(py, raised, "index", index),
            Err(error) => error,
        }
    }
}
