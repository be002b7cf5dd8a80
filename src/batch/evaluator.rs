//! The interface of what a batch evaluates.

use super::Packed;
use std::fmt::Debug;

/// One array of a quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NodeArray {
    /// Name, for errors.
    pub name: &'static str,
    /// Number of entries per node.
    pub length: usize,
}

impl NodeArray {
    /// An array with so many entries per node.
    pub const fn new(name: &'static str, length: usize) -> Self {
        Self { name, length }
    }
}

/// The arrays that a quantity reads and those it writes, in order.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Layout {
    /// The arrays that are read.
    pub inputs: Vec<NodeArray>,
    /// The arrays that are written.
    pub outputs: Vec<NodeArray>,
}

impl Layout {
    /// A layout with these inputs and outputs.
    pub fn new(inputs: &[NodeArray], outputs: &[NodeArray]) -> Self {
        Self { inputs: inputs.to_vec(), outputs: outputs.to_vec() }
    }

    /// Number of entries of one node in all inputs together.
    pub fn input_length(&self) -> usize {
        self.inputs.iter().map(|argument| argument.length).sum()
    }

    /// Number of entries of one node in all outputs together.
    pub fn output_length(&self) -> usize {
        self.outputs.iter().map(|argument| argument.length).sum()
    }
}

/// Computes quantities at one node, or at as many nodes as a number of type `S` has lanes.
///
/// Implemented by [`Model`](super::Model) for every [`Dynamics`](crate::dynamics::Dynamics), by
/// [`StepMap`](super::StepMap) for every [`Step`](crate::step::Step), and by
/// [`NodeFunction`](super::NodeFunction) for generated functions and closures of two slices.
///
/// ```
/// use costate::batch::{Batch, Evaluator, Layout, NodeArray, Packed};
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
///         let inputs = [NodeArray::new("q", n), NodeArray::new("p", n)];
///         vec![((), Layout::new(&inputs, &[NodeArray::new("H", 1)]))]
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
    /// Names a quantity; `()` if there is only one.
    type Quantity: Copy + PartialEq + Debug + Send + Sync;

    /// Why a node is refused.
    type Error: std::error::Error + Send;

    /// All quantities, each with its arrays.
    fn layouts(&self) -> Vec<(Self::Quantity, Layout)>;

    /// Computes `output` from `input`: the entries of one node, all arrays of the layout one after the other.
    ///
    /// # Errors
    /// An error of any of the nodes in the lanes. The batch then evaluates these nodes one by one, with the
    /// same node in every lane.
    fn evaluate(
        &mut self,
        quantity: Self::Quantity,
        input: &[S],
        output: &mut [S],
    ) -> Result<(), Self::Error>;
}
