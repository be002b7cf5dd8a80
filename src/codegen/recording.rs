//! The recording that runs on a thread.

use super::arena::Arena;
use super::error::CodegenError;
use super::expr::{Content, Expr, ExprMask};
use super::node::Node;
use super::value::{Signed, Truth, Value};
use std::cell::RefCell;
use std::collections::{HashMap, HashSet};
use std::sync::atomic::{AtomicU32, Ordering};

/// Which recording runs, 0 for none, what it has recorded, and what its constants stand for.
#[derive(Default)]
pub(super) struct Recording {
    pub number: u32,
    pub arena: Arena,
    pub labels: Option<Labels>,
    /// Most nodes, where there is a limit.
    pub most: Option<usize>,
}

/// Constants that stand for something else, and those that stand for themselves, by their bits without sign.
pub(super) struct Labels {
    table: HashMap<u64, Expr>,
    numbers: HashSet<u64>,
}

impl Labels {
    /// What a constant stands for; `None` if that is not known.
    pub fn expr(&self, constant: f64) -> Option<Expr> {
        let magnitude = constant.abs();
        let itself = || {
            matches!(magnitude, 0.0 | 0.5 | 1.0 | 2.0 | 4.0) || self.numbers.contains(&magnitude.to_bits())
        };
        match self.table.get(&magnitude.to_bits()) {
            Some(&expr) => Some(if constant < 0.0 { -expr } else { expr }),
            None => itself().then_some(Expr::fixed(constant)),
        }
    }
}

/// From now on, while this recording runs, constants in the table are the expressions beside them. Others must be among
/// the numbers, or small literals.
pub(super) fn replace_labels(table: Vec<(f64, Expr)>, numbers: Vec<f64>) -> Result<(), CodegenError> {
    let count = table.len();
    let table: HashMap<u64, Expr> = table.into_iter().map(|(label, expr)| (label.to_bits(), expr)).collect();
    let numbers = numbers.into_iter().map(|number| number.abs().to_bits()).collect();
    let labels = Labels { table, numbers };
    let doubled =
        labels.table.len() < count || labels.table.keys().any(|label| labels.numbers.contains(label));
    RECORDING.with_borrow_mut(|recording| recording.labels = Some(labels));
    if doubled { Err(CodegenError::Constant) } else { Ok(()) }
}

/// The recording that runs fails with [`CodegenError::LongRecording`] once it has more nodes than this.
pub(super) fn limit_recording(most: usize) {
    RECORDING.with_borrow_mut(|recording| recording.most = Some(most));
}

static RECORDINGS: AtomicU32 = AtomicU32::new(0);

thread_local! {
    pub(super) static RECORDING: RefCell<Recording> = RefCell::default();
}

/// Puts the recording of the surroundings back, however this one ends.
struct Surroundings(Recording);

impl Drop for Surroundings {
    fn drop(&mut self) {
        RECORDING.replace(std::mem::take(&mut self.0));
    }
}

/// Nodes of a recording and its results.
pub(super) type Recorded = (Vec<Node>, Vec<Signed>);

/// Records what `work` does with inputs 0, 1, 2, ...; what it returns is split into what is kept and the results.
pub(super) fn record<R>(
    inputs: usize,
    work: impl FnOnce(&[Expr]) -> (R, Vec<Expr>),
) -> Result<(R, Recorded), CodegenError> {
    let number = 1 + RECORDINGS.fetch_add(1, Ordering::Relaxed) % (u32::MAX - 1);
    let surroundings = Surroundings(RECORDING.replace(Recording { number, ..Recording::default() }));
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

/// An expression of the recording that runs.
fn recorded(make: impl FnOnce(&mut Arena) -> Value) -> Expr {
    RECORDING.with_borrow_mut(|Recording { number, arena, .. }| Expr::from_value(make(arena), *number))
}

/// The node that holds a result.
fn recorded_node(result: Expr) -> Signed {
    RECORDING.with_borrow_mut(|recording| match recording.value(result) {
        Some(value) => recording.arena.signed(value),
        None => recording.arena.signed(Value::Constant(f64::NAN)),
    })
}

impl Recording {
    /// The value of an expression; `None`, and an error, where it does not belong here or the recording has grown too long.
    pub fn value(&mut self, expr: Expr) -> Option<Value> {
        if let Some(limit) = self.most.filter(|&most| self.arena.nodes.len() > most) {
            self.arena.fail(CodegenError::LongRecording { limit });
            return None;
        }
        match expr.0 {
            Content::Constant(value) => Some(Value::Constant(value)),
            Content::Node { node, recording } if recording == self.number => Some(Value::Of(node)),
            _ => {
                self.arena.fail(CodegenError::Foreign);
                None
            }
        }
    }

    pub fn truth(&mut self, mask: ExprMask) -> Option<Truth> {
        match mask.0 {
            Content::Constant(value) => Some(Truth::Constant(value)),
            Content::Node { node, recording } if recording == self.number => Some(Truth::Of(node)),
            _ => {
                self.arena.fail(CodegenError::Foreign);
                None
            }
        }
    }
}
