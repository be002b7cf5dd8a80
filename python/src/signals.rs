//! Ctrl-C during long work without the interpreter's lock.

use crate::errors::Interrupted;
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use std::time::{Duration, Instant};

/// Time between two looks: one takes the interpreter's lock.
pub const PAUSE: Duration = Duration::from_millis(50);

/// Looks now and then whether a signal came whose handler raised an exception. Handlers run on the main
/// thread of Python alone: on others no signal is ever seen.
#[derive(Debug, Default)]
pub struct Signals {
    last: Option<Instant>,
    raised: Option<PyErr>,
}

impl Signals {
    /// Whether the work is to end.
    pub fn came(&mut self) -> bool {
        if self.raised.is_none() {
            let now = Instant::now();
            let last = *self.last.get_or_insert(now);
            if now - last >= PAUSE {
                // An interpreter that ends has no signals.
                self.raised = Python::try_attach(|py| py.check_signals().err()).flatten();
                self.last = Some(Instant::now());
            }
        }
        self.raised.is_some()
    }

    /// The exception of the handler, where there is one.
    pub fn raised(self) -> Option<PyErr> {
        self.raised
    }
}

/// The exception of a handler, with what was reached where it is that of Ctrl-C.
pub fn with_reached(py: Python<'_>, raised: PyErr, reached: Bound<'_, PyAny>, words: String) -> PyErr {
    if raised.is_instance_of::<PyKeyboardInterrupt>(py) {
        Interrupted::new_err((reached.unbind(), words))
    } else {
        raised
    }
}
