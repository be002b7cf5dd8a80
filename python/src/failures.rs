//! The states of a call that could not be evaluated.

use crate::arrays::Axes;
use crate::errors::{Failure, StateWarning};
use pyo3::prelude::*;
use std::ffi::CString;

/// The first state that failed, and how many did.
#[derive(Default)]
pub struct Failures {
    first: Option<(usize, Failure)>,
    count: usize,
}

impl Failures {
    /// One more state.
    pub fn add(&mut self, state: usize, failure: Failure) {
        self.join(Self { first: Some((state, failure)), count: 1 });
    }

    /// Those of other states too.
    pub fn join(&mut self, other: Self) {
        self.count += other.count;
        let earlier = match (&self.first, &other.first) {
            (Some((ours, _)), Some((theirs, _))) => theirs < ours,
            (ours, _) => ours.is_none(),
        };
        if earlier {
            self.first = other.first;
        }
    }
}

impl Failures {
    /// The first failure and where it is, unless results are not-a-number.
    ///
    /// # Errors
    /// What is to be said.
    pub fn message(&self, axes: &Axes, nan: bool) -> Result<(), String> {
        match &self.first {
            Some((state, failure)) if !nan => Err(failure.at(&axes.index(*state))),
            _ => Ok(()),
        }
    }
}

/// Raises the first failure, or warns of all of them where their results are not-a-number.
#[inline]
pub fn report(py: Python<'_>, axes: &Axes, failures: Failures, nan: bool) -> PyResult<()> {
    match failures.first {
        None => Ok(()),
        Some((state, failure)) if !nan => Err(failure.raise(py, axes.index(state))),
        Some((state, failure)) => warn(py, axes, state, &failure, failures.count),
    }
}

#[cold]
fn warn(py: Python<'_>, axes: &Axes, state: usize, failure: &Failure, count: usize) -> PyResult<()> {
    let text = if axes.shape().is_empty() {
        format!("the state could not be evaluated, and its results are not-a-number: {failure}")
    } else {
        format!(
            "{count} of {} states could not be evaluated, and their results are not-a-number; the first is \
             {:?}: {failure}",
            axes.states(),
            axes.index(state)
        )
    };
    let text = CString::new(text.replace('\0', " "))?;
    PyErr::warn(py, &py.get_type::<StateWarning>(), &text, 1)
}
