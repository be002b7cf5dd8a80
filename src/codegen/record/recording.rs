//! The recording that runs on a thread.

use super::arena::Arena;
use super::expr::{Content, Expr, ExprMask};
use super::labels::Labels;
use super::node::Node;
use super::value::{Signed, Truth, Value};
use crate::codegen::error::CodegenError;
use std::cell::RefCell;
use std::sync::atomic::{AtomicU32, Ordering};

/// Most operations that are recorded for each step that a program may have.
///
/// A recording holds operations that the program does not need: up to about twice as many as its steps, more
/// only for energies.
pub const OPERATIONS_PER_STEP: usize = 4;

/// Most nodes of any recording; they are counted in 32 bits.
const MOST_NODES: usize = 1 << 31;

/// Most nodes for which there is room from the start.
const MOST_RESERVED: usize = 1 << 14;

/// The limit of a recording: [`OPERATIONS_PER_STEP`] operations for each step.
#[derive(Clone, Copy, Debug)]
pub(in crate::codegen) struct RecordingLimit<'a> {
    /// Name of the program, for the error.
    pub name: &'a str,
    /// Most steps of the program.
    pub steps: usize,
}

/// The recording that runs: its number (0 for none), its nodes, its labels.
#[derive(Default)]
pub(super) struct Recording {
    number: u32,
    arena: Arena,
    labels: Option<Labels>,
    /// Most nodes, and the error beyond.
    limit: Option<(usize, CodegenError)>,
}

static RECORDINGS: AtomicU32 = AtomicU32::new(0);

thread_local! {
    static RECORDING: RefCell<Recording> = RefCell::default();
}

/// Puts the recording of the surroundings back, however this one ends.
struct Surroundings(Recording);

impl Drop for Surroundings {
    fn drop(&mut self) {
        RECORDING.replace(std::mem::take(&mut self.0));
    }
}

/// Nodes of a recording and its results.
type Recorded = (Vec<Node>, Vec<Signed>);

/// Records what `work` does with inputs 0, 1, 2, ...; it returns what is kept and the results.
///
/// # Errors
/// The first error of the recording: [`CodegenError::Foreign`], [`CodegenError::Branch`],
/// [`CodegenError::Constant`],
/// [`CodegenError::LongRecording`].
pub(in crate::codegen) fn record<R>(
    inputs: usize,
    limit: RecordingLimit<'_>,
    work: impl FnOnce(&[Expr]) -> (R, Vec<Expr>),
) -> Result<(R, Recorded), CodegenError> {
    let number = 1 + RECORDINGS.fetch_add(1, Ordering::Relaxed) % (u32::MAX - 1);
    let RecordingLimit { name, steps } = limit;
    let operations = steps.saturating_mul(OPERATIONS_PER_STEP).min(MOST_NODES);
    let error = CodegenError::LongRecording { name: name.into(), operations, limit: steps };
    // Contracted second derivatives of a chain have about 14 nodes for each pair of their inputs.
    let arena = Arena::with_capacity((8 * inputs * inputs).min(operations).min(MOST_RESERVED));
    let recording = Recording { number, arena, limit: Some((operations, error)), ..Recording::default() };
    let surroundings = Surroundings(RECORDING.replace(recording));
    let arguments: Vec<Expr> = (0..inputs as u32).map(|k| recorded(|arena| arena.input(k))).collect();
    let (kept, results) = work(&arguments);
    let results = results.iter().map(|result| recorded_node(*result)).collect();
    let Recording { arena, .. } = RECORDING.take();
    drop(surroundings);
    match arena.error {
        Some(error) => Err(error),
        None => Ok((kept, (arena.nodes, results))),
    }
}

/// From now on, while this recording runs, constants in the table are replaced by the expressions beside
/// them. All other constants must be among the numbers, or small literals.
///
/// # Errors
/// [`CodegenError::Constant`] where two labels or numbers are equal.
pub(in crate::codegen) fn replace_labels(
    table: Vec<(f64, Expr)>,
    numbers: Vec<f64>,
) -> Result<(), CodegenError> {
    let labels = Labels::new(table, numbers).ok_or(CodegenError::Constant)?;
    with(|recording| recording.labels = Some(labels));
    Ok(())
}

/// Works on the recording that runs on this thread.
pub(super) fn with<R>(work: impl FnOnce(&mut Recording) -> R) -> R {
    RECORDING.with_borrow_mut(work)
}

/// An expression of the recording that runs.
fn recorded(make: impl FnOnce(&mut Arena) -> Value) -> Expr {
    with(|recording| recording.expr(make))
}

/// The node that holds a result.
fn recorded_node(result: Expr) -> Signed {
    with(|recording| match recording.value(result) {
        Some(value) => recording.arena.signed(value),
        None => recording.arena.signed(Value::Constant(f64::NAN)),
    })
}

impl Recording {
    /// A new expression of this recording.
    pub fn expr(&mut self, make: impl FnOnce(&mut Arena) -> Value) -> Expr {
        Expr::from_value(make(&mut self.arena), self.number)
    }

    /// A comparison of two expressions.
    pub fn less(&mut self, a: Expr, b: Expr) -> ExprMask {
        let (Some(a), Some(b)) = (self.value(a), self.value(b)) else {
            return ExprMask(Content::Foreign);
        };
        ExprMask(match self.arena.less(a, b) {
            Truth::Constant(value) => Content::Constant(value),
            Truth::Of(node) => Content::Node { node, recording: self.number },
        })
    }

    /// A constant of the recorded function, or what it is a label of.
    pub fn constant(&mut self, value: f64) -> Expr {
        match self.labels.as_ref().map(|labels| labels.expr(value)) {
            None => Expr::fixed(value),
            Some(Some(expr)) => expr,
            Some(None) => {
                self.fail(CodegenError::Constant);
                Expr::fixed(value)
            }
        }
    }

    /// Keeps the first error.
    pub fn fail(&mut self, error: CodegenError) {
        self.arena.fail(error);
    }

    /// The value of an expression; `None`, and an error, if it belongs to another recording or this one is
    /// too long.
    pub fn value(&mut self, expr: Expr) -> Option<Value> {
        if let Some((most, error)) = &self.limit
            && self.arena.nodes.len() > *most
        {
            let error = error.clone();
            self.fail(error);
            return None;
        }
        match expr.0 {
            Content::Constant(value) => Some(Value::Constant(value)),
            Content::Node { node, recording } if recording == self.number => Some(Value::Of(node)),
            _ => {
                self.fail(CodegenError::Foreign);
                None
            }
        }
    }

    /// The value of a comparison; `None`, and an error, if it belongs to another recording.
    pub fn truth(&mut self, mask: ExprMask) -> Option<Truth> {
        match mask.0 {
            Content::Constant(value) => Some(Truth::Constant(value)),
            Content::Node { node, recording } if recording == self.number => Some(Truth::Of(node)),
            _ => {
                self.fail(CodegenError::Foreign);
                None
            }
        }
    }
}
