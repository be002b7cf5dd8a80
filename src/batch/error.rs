//! What can be wrong with a batch, and with one node of it.

/// Why nothing was evaluated: the arrays do not fit the quantity.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum BatchError {
    /// The evaluator has no layout for the quantity.
    #[error("the evaluator does not list the quantity {quantity} among those it computes")]
    UnknownQuantity {
        /// The quantity.
        quantity: String,
    },
    /// Not as many arrays as the quantity has.
    #[error(
        "{found} arrays were given as {what}, not {expected}; the layout of the quantity names them in order"
    )]
    WrongNumber {
        /// "inputs" or "outputs".
        what: &'static str,
        /// Arrays that the quantity has.
        expected: usize,
        /// Arrays given.
        found: usize,
    },
    /// An array of the wrong length.
    #[error("{what} has {found} entries; {nodes} nodes of {length} each take {}", nodes.saturating_mul(*length))]
    WrongLength {
        /// The array.
        what: &'static str,
        /// Number of nodes.
        nodes: usize,
        /// Entries a node.
        length: usize,
        /// Entries the array has.
        found: usize,
    },
}

/// One node that could not be evaluated; its outputs are not-a-number, those of all others are computed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("node {node}: {error}")]
pub struct Failure<E: std::error::Error> {
    /// Position of the node, from 0.
    pub node: usize,
    /// What was wrong.
    pub error: NodeError<E>,
}

/// What was wrong with a node.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum NodeError<E: std::error::Error> {
    /// The evaluator refused it.
    #[error(transparent)]
    Evaluation(E),
    /// An input is infinite or undefined, and the evaluator had nothing against it.
    #[error("{what}[{index}] is not finite; check what produced it")]
    Input {
        /// The array.
        what: &'static str,
        /// Position of the entry within the node, from 0.
        index: usize,
    },
    /// A result is infinite or undefined: an overflow, or a singular matrix that was not looked for.
    #[error("{what}[{index}] came out infinite or undefined: the state is singular or far too large")]
    Output {
        /// The array.
        what: &'static str,
        /// Position of the entry within the node, from 0.
        index: usize,
    },
}
