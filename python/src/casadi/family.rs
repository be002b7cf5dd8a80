//! A function with its derivatives, evaluated at the addresses that CasADi passes.

use super::layout::{PARTS, Part, Rows};
use super::models::Spec;
use crate::cores::Order;
use crate::engine::Engine;
use crate::errors::Failure;
use crate::workspace::Workspace;
use std::ffi::CString;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::sync::{Mutex, OnceLock, PoisonError};

/// A function with its derivatives.
pub struct Family {
    /// What it computes.
    pub spec: Spec,
    /// The same as text, from which another process makes it again.
    pub text: CString,
    /// The five functions.
    pub parts: [Part; PARTS],
    engines: [OnceLock<Option<Engine>>; 3],
    /// Why the last state that was refused was.
    refusal: Mutex<Option<String>>,
    calls: [AtomicU64; PARTS],
}

impl Family {
    pub fn new(spec: Spec, text: CString) -> Self {
        let parts = spec.description().parts();
        Self {
            spec,
            text,
            parts,
            engines: Default::default(),
            refusal: Mutex::default(),
            calls: Default::default(),
        }
    }

    /// How often each of the five functions was evaluated.
    pub fn calls(&self) -> [u64; PARTS] {
        std::array::from_fn(|part| self.calls[part].load(Relaxed))
    }

    /// Why the last state that was refused was.
    pub fn refusal(&self) -> Option<String> {
        self.refusal.lock().unwrap_or_else(PoisonError::into_inner).clone()
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
        let Part { inputs, plan, order, rows, .. } = &self.parts[part];
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
            let done = match rows {
                // SAFETY: by the contract of this function.
                None => unsafe { whole(workspace, &self.parts[part], res) },
                // SAFETY: by the contract of this function.
                Some(rows) => unsafe { row_by_row(workspace, &self.parts[part], rows, res) },
            };
            if let Err(failure) = &done {
                let mut refusal = self.refusal.lock().unwrap_or_else(PoisonError::into_inner);
                *refusal = Some(failure.to_string());
            }
            done.is_ok()
        })
    }
}

/// The results of f that are not null, from one evaluation of the core.
///
/// # Safety
/// As [`Family::evaluate`].
unsafe fn whole(workspace: &mut Workspace, part: &Part, res: *const *mut f64) -> Result<(), Failure> {
    let Part { outputs, plan, .. } = part;
    workspace.evaluate(plan)?;
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
    Ok(())
}

/// All second derivatives, from an evaluation of the core for each entry of a result that is read.
///
/// # Safety
/// As [`Family::evaluate`].
unsafe fn row_by_row(
    workspace: &mut Workspace,
    part: &Part,
    rows: &Rows,
    res: *const *mut f64,
) -> Result<(), Failure> {
    let Part { outputs, plan, .. } = part;
    let width = outputs.len() / rows.entries.len();
    let mut weight = rows.y.start;
    for (result, &entries) in rows.entries.iter().enumerate() {
        let read = || {
            let used = outputs.iter().enumerate().filter(|(_, port)| port.full);
            let ours = used.zip(&plan.outputs).filter(move |((k, _), _)| k / width == result);
            // SAFETY: by the contract of this function; null stands for a result that nobody reads.
            ours.map(move |((k, _), of)| (of, unsafe { *res.add(k) })).filter(|(_, to)| !to.is_null())
        };
        let rows_read = if read().next().is_some() { entries } else { 0 };
        for row in 0..rows_read {
            let buffer = workspace.state(plan);
            buffer[rows.y.clone()].fill(0.0);
            buffer[weight + row] = 1.0;
            workspace.evaluate(plan)?;
            let buffer = workspace.state(plan);
            for (of, to) in read() {
                // SAFETY: it has as many numbers as its sparsity: those of the plan for each entry.
                let to = unsafe { std::slice::from_raw_parts_mut(to, of.length * entries) };
                of.write(buffer, 0, &mut to[row..]);
            }
        }
        weight += entries;
    }
    Ok(())
}
