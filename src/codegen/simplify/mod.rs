//! From the nodes of a recording to the steps of a program.
//!
//! `signs` chooses the sign with which each node is computed, `sums` joins products with sums, `order` sorts
//! the steps so that few values are alive at once; `graph` removes what no result needs.

mod graph;
mod order;
mod signs;
mod sums;

pub(super) use graph::Graph;

use crate::codegen::record::{Node, Signed};

/// The steps that compute these results of a recording, in the order of computation.
pub(super) fn simplify(nodes: &[Node], results: &[Signed]) -> Graph {
    order::few_waiting(&sums::joined(&signs::settled(nodes, results)))
}
