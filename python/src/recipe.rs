//! How a robot was made: the calls that make it again, for pickling.

use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList, PyTuple, PyType};
use std::cell::Cell;

/// The calls that made an object, one after the other: each with its name and its arguments by name.
///
/// The arguments are those that Rust has read, so later changes of what a caller passed have no effect.
#[derive(Default)]
pub struct Recipe {
    steps: Vec<(&'static str, Py<PyDict>)>,
}

impl Recipe {
    /// The same calls.
    pub fn copy(&self, py: Python<'_>) -> Self {
        Self { steps: self.steps.iter().map(|(name, of)| (*name, of.clone_ref(py))).collect() }
    }

    /// The same calls, then one more.
    pub fn then(&self, py: Python<'_>, name: &'static str, arguments: Bound<'_, PyDict>) -> Self {
        let mut copy = self.copy(py);
        copy.push(name, arguments);
        copy
    }

    /// Whether the calls and their arguments are equal.
    pub fn equals(&self, py: Python<'_>, other: &Self) -> PyResult<bool> {
        let mut equal = self.steps.len() == other.steps.len();
        for ((name, of), (other, theirs)) in self.steps.iter().zip(&other.steps) {
            equal = equal && name == other && of.bind(py).eq(theirs)?;
        }
        Ok(equal)
    }

    /// The argument `name` of each of the calls of these methods, as Python writes it.
    ///
    /// # Errors
    /// What Python raises.
    pub fn names(&self, py: Python<'_>, methods: &[&str]) -> PyResult<Vec<String>> {
        let of = self.steps.iter().filter(|(method, _)| methods.contains(method));
        let names = of.filter_map(|(_, arguments)| arguments.bind(py).get_item("name").transpose());
        names.map(|name| Ok(name?.repr()?.to_string())).collect()
    }

    /// One more call.
    pub fn push(&mut self, name: &'static str, arguments: Bound<'_, PyDict>) {
        self.steps.push((name, arguments.unbind()));
    }

    /// What `__reduce__` returns for an object of this class.
    pub fn reduce<'py>(&self, class: Bound<'py, PyType>) -> PyResult<Bound<'py, PyTuple>> {
        let py = class.py();
        let rebuild = py.import("costate._costate")?.getattr("_rebuild")?;
        let steps = self.steps.iter().map(|(name, of)| (*name, of.clone_ref(py)));
        let steps = PyList::new(py, steps.collect::<Vec<_>>())?;
        (rebuild, (class, steps)).into_pyobject(py)
    }
}

/// Arguments by name.
macro_rules! named {
    ($py:expr, $($name:ident),* $(,)?) => {{
        let arguments = pyo3::types::PyDict::new($py);
        $(arguments.set_item(stringify!($name), &$name)?;)*
        arguments
    }};
}
pub(crate) use named;

thread_local! {
    static REBUILDING: Cell<bool> = const { Cell::new(false) };
}

/// While it lives, robots are made again on this thread: their warnings were shown when they were made first.
struct Quiet(bool);

impl Quiet {
    fn new() -> Self {
        Self(REBUILDING.replace(true))
    }
}

impl Drop for Quiet {
    fn drop(&mut self) {
        REBUILDING.set(self.0);
    }
}

/// Whether an object is made again from a pickle.
pub fn is_rebuilding() -> bool {
    REBUILDING.get()
}

/// Makes an object again by the calls that made it; for pickles.
#[pyfunction]
pub fn _rebuild<'py>(class: Bound<'py, PyType>, steps: Bound<'py, PyList>) -> PyResult<Bound<'py, PyAny>> {
    let _quiet = Quiet::new();
    let mut object = class.into_any();
    for step in steps {
        let step = step.cast_into::<PyTuple>()?;
        let method = object.getattr(step.get_item(0)?.cast::<pyo3::types::PyString>()?)?;
        object = method.call((), Some(step.get_item(1)?.cast::<PyDict>()?))?;
    }
    Ok(object)
}
