//! Calls from XLA, the compiler of JAX, by its foreign function interface (`xla/ffi/api/c_api.h`, major
//! version 0).
//!
//! XLA calls `handler` with a frame: arguments and results in its own memory, and the number of a function,
//! which `registered` gave to it. No lock of the interpreter is held.

mod frame;

use crate::arrays::{Axes, Source};
use crate::dynamics::Dynamics;
use crate::function::{Function, Settings};
use crate::quantities::Verb;
use crate::results::Target;
use frame::{ApiError, CallFrame, Code};
use pyo3::prelude::*;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::sync::{Arc, PoisonError, RwLock};

/// All functions that XLA may call. Compiled programs keep the numbers, so that none is ever removed.
static FUNCTIONS: RwLock<Vec<Registered>> = RwLock::new(Vec::new());

/// A function that XLA may call, and at how many states it was evaluated.
#[derive(Clone)]
struct Registered {
    function: Arc<Function>,
    settings: Settings,
    states: Arc<AtomicU64>,
}

/// The number of a function in calls from XLA.
pub fn registered(function: &Arc<Function>, settings: Settings) -> i64 {
    let mut all = FUNCTIONS.write().unwrap_or_else(PoisonError::into_inner);
    let known =
        all.iter().position(|known| Arc::ptr_eq(&known.function, function) && known.settings == settings);
    let index = known.unwrap_or(all.len());
    if known.is_none() {
        all.push(Registered { function: function.clone(), settings, states: Arc::default() });
    }
    index as i64
}

/// At how many states XLA has evaluated a function, by its number.
#[pyfunction]
pub fn _xla_calls(number: usize) -> u64 {
    let all = FUNCTIONS.read().unwrap_or_else(PoisonError::into_inner);
    all.get(number).map_or(0, |found| found.states.load(Relaxed))
}

/// The address of the function that XLA calls.
#[pyfunction]
pub fn _xla_handler() -> usize {
    handler as *const () as usize
}

/// A call from XLA; null, or an error that XLA destroys.
///
/// # Safety
/// The frame is one of XLA's interface of major version 0.
unsafe extern "C" fn handler(frame: *mut CallFrame) -> *mut ApiError {
    // SAFETY: the promise of the caller.
    let frame = unsafe { &*frame };
    if frame.answered() {
        return std::ptr::null_mut();
    }
    match std::panic::catch_unwind(|| call(frame)) {
        Ok(Ok(())) => std::ptr::null_mut(),
        Ok(Err(message)) => frame.error(&message, Code::InvalidArgument),
        Err(_) => frame.error("costate failed; please report it", Code::Internal),
    }
}

fn call(frame: &CallFrame) -> Result<(), String> {
    let number = frame.number("function").ok_or("costate: the attribute `function` is missing")?;
    let Registered { function, settings, states } = {
        let all = FUNCTIONS.read().unwrap_or_else(PoisonError::into_inner);
        let found = usize::try_from(number).ok().and_then(|index| all.get(index).cloned());
        found.ok_or("costate: this program was compiled in another process; compile it again")?
    };
    let plan = function.plan();
    let (arguments, results) = (frame.arguments()?, frame.results()?);
    if [arguments.len(), results.len()] != [plan.arguments.len(), plan.outputs.len()] {
        return Err("costate: another number of arguments or results".into());
    }
    let leading = arguments.first().and_then(|argument| argument.shape.split_last());
    let leading = leading.map_or(&[][..], |(_, leading)| leading);
    let axes = Axes::new(leading);
    states.fetch_add(leading.iter().product::<usize>() as u64, Relaxed);
    let mut sources = Vec::with_capacity(arguments.len());
    for (buffer, expected) in arguments.iter().zip(&plan.arguments) {
        if buffer.shape.split_last() != Some((&expected.length, leading)) {
            let (name, found) = (expected.name, &buffer.shape);
            return Err(format!("costate: {name} has the shape {found:?}, which does not fit"));
        }
        // SAFETY: XLA's arrays lie in C order, and live as long as the call.
        sources.push(unsafe { Source::dense(buffer.data, &axes, expected.length) });
    }
    let mut targets = Vec::with_capacity(results.len());
    for (buffer, expected) in results.iter().zip(&plan.outputs) {
        if buffer.shape != [leading, &expected.shape].concat() {
            return Err(format!("costate: a result has the shape {:?}, which does not fit", buffer.shape));
        }
        // SAFETY: as above; nobody else uses the memory of a result.
        targets.push(unsafe { Target::dense(buffer.data.cast(), expected.length) });
    }
    function.compute(&sources, &targets, axes, settings).message(&axes, settings.nan)
}

#[pymethods]
impl Dynamics {
    /// The number by which XLA calls a method; for `costate.jax`.
    fn _xla(&self, py: Python<'_>, verb: &str) -> PyResult<i64> {
        let function = self.function(py, Verb::of_name(py, verb)?)?;
        Ok(registered(function, self.settings()))
    }
}
