//! What computes one state: workspaces that are built once and used by one thread at a time.

use crate::errors::Failure;
use costate_jit::JitQuantity;

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
pub struct Writer<'a>(pub &'a mut [f64]);

impl Writer<'_> {
    /// Appends numbers.
    pub fn put(&mut self, values: &[f64]) -> &mut Self {
        let (here, rest) = std::mem::take(&mut self.0).split_at_mut(values.len());
        here.copy_from_slice(values);
        self.0 = rest;
        self
    }
}
