//! What a batch evaluates.

use super::Packed;
use std::fmt::Debug;

/// One array of a quantity: its name and how many entries a node has in it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Argument {
    /// Name, for errors.
    pub name: &'static str,
    /// Entries a node.
    pub length: usize,
}

/// The arrays that a quantity is computed from and those it fills, in order.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Layout {
    /// What is read.
    pub inputs: Vec<Argument>,
    /// What is written.
    pub outputs: Vec<Argument>,
}

impl Layout {
    /// From names and lengths.
    pub fn new(inputs: &[(&'static str, usize)], outputs: &[(&'static str, usize)]) -> Self {
        let arguments = |pairs: &[(&'static str, usize)]| {
            pairs.iter().map(|&(name, length)| Argument { name, length }).collect()
        };
        Self { inputs: arguments(inputs), outputs: arguments(outputs) }
    }

    /// Entries that a node has in all inputs together.
    pub fn input_length(&self) -> usize {
        self.inputs.iter().map(|argument| argument.length).sum()
    }

    /// Entries that a node has in all outputs together.
    pub fn output_length(&self) -> usize {
        self.outputs.iter().map(|argument| argument.length).sum()
    }
}

/// Quantities of one node, or of as many as a number of type `S` holds: a workspace, a generated function, a closure.
///
/// Implemented by [`Model`](super::Model) for every
/// [`Dynamics`](crate::dynamics::Dynamics), by [`StepMap`](super::StepMap) for every [`Step`](crate::step::Step), and by
/// [`NodeFunction`](super::NodeFunction) for straight-line functions and whatever can be called with two slices.
///
/// ```
/// use costate::batch::{Batch, Evaluator, Layout, Packed};
/// use costate::hamiltonian::Hamiltonian;
/// use costate::{EvalError, robot::Robot};
///
/// /// H(q, p) at every node.
/// struct Energy<S: Packed>(Hamiltonian<S>);
///
/// impl<S: Packed> Evaluator<S> for Energy<S> {
///     type Quantity = ();
///     type Error = EvalError;
///     fn layouts(&self) -> Vec<((), Layout)> {
///         let n = self.0.dof();
///         vec![((), Layout::new(&[("q", n), ("p", n)], &[("H", 1)]))]
///     }
///     fn evaluate(&mut self, _: (), input: &[S], output: &mut [S]) -> Result<(), EvalError> {
///         let (q, p) = input.split_at(self.0.dof());
///         output[0] = self.0.hamiltonian(q, p)?;
///         Ok(())
///     }
/// }
/// # std::env::set_current_dir(env!("CARGO_MANIFEST_DIR"))?;
/// let robot = Robot::from_file("robots/two_link.toml")?;
/// let mut batch = Batch::<f64, _>::new(Energy(Hamiltonian::new(&robot)));
/// let (q, p, mut h) = ([0.3, -0.8, 0.1, 0.2], [1.0, 0.5, 0.0, 0.0], [0.0; 2]);
/// assert!(batch.run((), 2, [&q, &p], [&mut h])?.is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Evaluator<S: Packed>: Send {
    /// Names a quantity; `()` where there is one only.
    type Quantity: Copy + PartialEq + Debug + Send + Sync;

    /// Why a node may be refused.
    type Error: std::error::Error + Send;

    /// Every quantity with the arrays that belong to it.
    fn layouts(&self) -> Vec<(Self::Quantity, Layout)>;

    /// Fills `output` from `input`: the entries of one node, all arrays of the layout one behind the other.
    ///
    /// # Errors
    /// Whatever the evaluator has to say of any of the nodes in the lanes: all are then evaluated one by one, the same node
    /// in every lane.
    fn evaluate(
        &mut self,
        quantity: Self::Quantity,
        input: &[S],
        output: &mut [S],
    ) -> Result<(), Self::Error>;
}
