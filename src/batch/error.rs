//! Errors of a batch, and of one node of it.

use crate::error::LengthError;
use std::fmt;

/// Why a batch was not evaluated: the arrays do not fit the quantity.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum BatchError {
    /// The evaluator has no layout for the quantity.
    #[error("the evaluator does not list the quantity {quantity} among those it computes")]
    UnknownQuantity {
        /// The quantity, as its `Debug` writes it.
        quantity: String,
    },
    /// The number of arrays is not that of the quantity.
    #[error("the quantity has {expected} {role}, not {found}; its layout names them in order")]
    WrongNumber {
        /// Inputs or outputs.
        role: ArrayRole,
        /// Number of arrays that the quantity has.
        expected: usize,
        /// Number of arrays that the caller passed.
        found: usize,
    },
    /// An array has the wrong length.
    #[error("{length}: {nodes} nodes of {} each", length.expected.checked_div(*nodes).unwrap_or(0))]
    WrongLength {
        /// Number of nodes.
        nodes: usize,
        /// The array, with its length in entries of all nodes together.
        #[source]
        length: LengthError,
    },
}

/// Whether an array is read or written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ArrayRole {
    /// The evaluation reads it.
    Input,
    /// The evaluation writes it.
    Output,
}

impl fmt::Display for ArrayRole {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Input => "inputs",
            Self::Output => "outputs",
        })
    }
}

/// One node that could not be evaluated: its outputs are NaN; all other nodes are computed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("node {node}: {error}")]
pub struct Failure<E: std::error::Error> {
    /// Index of the node, from 0.
    pub node: usize,
    /// The error of the node.
    #[source]
    pub error: NodeError<E>,
}

/// Why a node could not be evaluated.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum NodeError<E: std::error::Error> {
    /// The evaluator refused the node.
    #[error(transparent)]
    Evaluation(E),
    /// An input is infinite or not a number, and the evaluator did not refuse it.
    #[error("{what}[{index}] is not finite; check the computation that produced it")]
    Input {
        /// The array.
        what: &'static str,
        /// Index of the entry within the node, from 0.
        index: usize,
    },
    /// A result is infinite or not a number: an overflow, or a singular matrix that went undetected.
    #[error("{what}[{index}] came out infinite or NaN: the state is singular or far too large")]
    Output {
        /// The array.
        what: &'static str,
        /// Index of the entry within the node, from 0.
        index: usize,
    },
}
