//! A function with its derivatives, evaluated at the addresses that CasADi passes.

use super::layout::{PARTS, Part};
use super::models::Spec;
use crate::cores::Order;
use crate::engine::Engine;
use std::ffi::CString;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// A function with its derivatives.
pub struct Family {
    /// What it computes.
    pub spec: Spec,
    /// The same as text, from which another process makes it again.
    pub text: CString,
    /// The four functions.
    pub parts: [Part; PARTS],
    engines: [OnceLock<Option<Engine>>; 3],
    calls: [AtomicU64; PARTS],
}

impl Family {
    pub fn new(spec: Spec, text: CString) -> Self {
        let parts = spec.description().parts();
        Self { spec, text, parts, engines: Default::default(), calls: Default::default() }
    }

    /// How often each of the four functions was evaluated.
    pub fn calls(&self) -> [u64; PARTS] {
        [0, 1, 2, 3].map(|part| self.calls[part].load(Relaxed))
    }

    fn engine(&self, order: Order) -> Option<&Engine> {
        self.engines[order as usize].get_or_init(|| self.spec.engine(order).ok()).as_ref()
    }

    /// Evaluates one of the functions; false where the state is refused. Any number of threads at once.
    ///
    /// # Safety
    /// `arg` points to one pointer for each argument of the function, `res` to one for each result: null, or
    /// to as many numbers as its sparsity has.
    pub unsafe fn evaluate(&self, part: usize, arg: *const *const f64, res: *const *mut f64) -> bool {
        self.calls[part].fetch_add(1, Relaxed);
        let Part { inputs, outputs, plan, order } = &self.parts[part];
        let Some(engine) = self.engine(*order) else { return false };
        engine.with(plan, |workspace| {
            let buffer = workspace.state(plan);
            let used = inputs.iter().enumerate().filter(|(_, port)| port.full);
            // Each argument has one place, in their order.
            for ((input, _), place) in used.zip(&plan.places) {
                let to = &mut buffer[place.at..place.at + place.length];
                // SAFETY: by the contract of this function; null stands for zeros.
                unsafe {
                    let from = *arg.add(input);
                    if from.is_null() {
                        to.fill(0.0);
                    } else {
                        std::ptr::copy_nonoverlapping(from, to.as_mut_ptr(), to.len());
                    }
                }
            }
            if workspace.evaluate(plan).is_err() {
                return false;
            }
            let buffer = workspace.state(plan);
            let used = outputs.iter().enumerate().filter(|(_, port)| port.full);
            for ((output, _), of) in used.zip(&plan.outputs) {
                // SAFETY: by the contract of this function; null stands for a result that nobody reads.
                let to = unsafe { *res.add(output) };
                if !to.is_null() {
                    // SAFETY: it has as many numbers as its sparsity: those of the plan.
                    of.write(buffer, 0, unsafe { std::slice::from_raw_parts_mut(to, of.length) });
                }
            }
            true
        })
    }
}
