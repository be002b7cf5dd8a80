//! What computes one state: workspaces that are built once and used by one thread at a time.

use crate::errors::Failure;
use costate::scalar::F64x4;
use costate_jit::{JitLanes, JitQuantity, finite_states};
use std::sync::Arc;

/// What a core computes of a function: its value; its Jacobian too; its contracted Hessian too.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    Value,
    First,
    Second,
}

/// Computes the results of one state from its arguments.
pub trait Core: Send {
    /// All arguments one after the other in, all results likewise out.
    ///
    /// # Errors
    /// Why the state is refused.
    fn evaluate(&mut self, inputs: &[f64], outputs: &mut [f64]) -> Result<(), Failure>;
}

impl Core for JitQuantity {
    fn evaluate(&mut self, inputs: &[f64], outputs: &mut [f64]) -> Result<(), Failure> {
        Ok(JitQuantity::evaluate(self, inputs, outputs)?)
    }
}

/// Computes the results of four states at once.
pub trait Lanes: Send {
    /// As [`Core::evaluate`], entry k holding number k of all four; says of which states it is certain. The
    /// others are computed one by one.
    fn evaluate(&mut self, inputs: &[[f64; 4]], outputs: &mut [[f64; 4]]) -> [bool; 4];
}

impl Lanes for Arc<JitLanes> {
    fn evaluate(&mut self, inputs: &[[f64; 4]], outputs: &mut [[f64; 4]]) -> [bool; 4] {
        JitLanes::evaluate(self, inputs, outputs).unwrap_or([false; 4])
    }
}

/// A workspace over lanes, and a function that computes four states with it.
struct Packs<W, F> {
    workspace: W,
    evaluate: F,
    inputs: Vec<F64x4>,
    outputs: Vec<F64x4>,
}

impl<W: Send, F> Lanes for Packs<W, F>
where
    F: FnMut(&mut W, &[F64x4], &mut [F64x4]) -> Result<(), Failure> + Send,
{
    fn evaluate(&mut self, inputs: &[[f64; 4]], outputs: &mut [[f64; 4]]) -> [bool; 4] {
        self.inputs.clear();
        self.inputs.extend(inputs.iter().map(|four| F64x4::from_lanes(four)));
        self.outputs.resize(outputs.len(), F64x4::from_lanes(&[]));
        if (self.evaluate)(&mut self.workspace, &self.inputs, &mut self.outputs).is_err() {
            return [false; 4];
        }
        outputs.iter_mut().zip(&self.outputs).for_each(|(to, from)| to.copy_from_slice(from.as_slice()));
        // The library checks what it needs: a number that is not finite may have no effect.
        let (given, found) = (finite_states(inputs), finite_states(outputs));
        std::array::from_fn(|state| given[state] && found[state])
    }
}

/// A core that computes four states by a function of a workspace over lanes.
pub fn lanes_of<W, F>(workspace: W, evaluate: F) -> Box<dyn Lanes>
where
    W: Send + 'static,
    F: FnMut(&mut W, &[F64x4], &mut [F64x4]) -> Result<(), Failure> + Send + 'static,
{
    Box::new(Packs { workspace, evaluate, inputs: Vec::new(), outputs: Vec::new() })
}

/// A workspace and a function that computes one state with it.
struct Workspace<W, F> {
    workspace: W,
    evaluate: F,
}

impl<W: Send, F> Core for Workspace<W, F>
where
    F: FnMut(&mut W, &[f64], &mut [f64]) -> Result<(), Failure> + Send,
{
    fn evaluate(&mut self, inputs: &[f64], outputs: &mut [f64]) -> Result<(), Failure> {
        (self.evaluate)(&mut self.workspace, inputs, outputs)
    }
}

/// A core that computes one state by a function of a workspace.
pub fn core_of<W, F>(workspace: W, evaluate: F) -> Box<dyn Core>
where
    W: Send + 'static,
    F: FnMut(&mut W, &[f64], &mut [f64]) -> Result<(), Failure> + Send + 'static,
{
    Box::new(Workspace { workspace, evaluate })
}

/// Results, written one after the other.
pub struct Writer<'a, S>(pub &'a mut [S]);

impl Writer<'_, f64> {
    /// Appends zeros.
    pub fn zeros(&mut self, count: usize) {
        let (here, rest) = std::mem::take(&mut self.0).split_at_mut(count);
        here.fill(0.0);
        self.0 = rest;
    }
}

impl<S: Copy> Writer<'_, S> {
    /// Appends numbers.
    pub fn put(&mut self, values: &[S]) -> &mut Self {
        let (here, rest) = std::mem::take(&mut self.0).split_at_mut(values.len());
        here.copy_from_slice(values);
        self.0 = rest;
        self
    }
}
