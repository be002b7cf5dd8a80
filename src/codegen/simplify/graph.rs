//! Nodes and results, and what no result needs removed.

use crate::codegen::record::{Id, Node};

/// Nodes, each after its operands, and the nodes that hold the results.
#[derive(Clone, Debug, Default)]
pub(in crate::codegen) struct Graph {
    pub nodes: Vec<Node>,
    pub results: Vec<Id>,
}

impl Graph {
    /// Number of uses of each node, by other nodes and by results.
    pub fn uses(&self) -> Vec<u32> {
        let mut uses = vec![0; self.nodes.len()];
        let operands = self.nodes.iter().flat_map(Node::operands);
        operands.chain(self.results.iter().copied()).for_each(|id| uses[id.index()] += 1);
        uses
    }

    /// Whether a result depends on each node.
    pub fn needed(&self) -> Vec<bool> {
        let mut needed = vec![false; self.nodes.len()];
        self.results.iter().for_each(|id| needed[id.index()] = true);
        for (k, node) in self.nodes.iter().enumerate().rev() {
            if needed[k] {
                node.operands().for_each(|id| needed[id.index()] = true);
            }
        }
        needed
    }

    /// The nodes of this list, in this order. The list must hold all operands of its nodes and all results.
    pub fn arranged(&self, order: &[usize]) -> Self {
        let mut places = vec![Id(0); self.nodes.len()];
        order.iter().zip(0..).for_each(|(&k, place)| places[k] = Id(place));
        let to_place = |id: Id| places[id.index()];
        Self {
            nodes: order.iter().map(|&k| self.nodes[k].map(to_place)).collect(),
            results: self.results.iter().copied().map(to_place).collect(),
        }
    }

    /// The graph without nodes that no result depends on.
    pub fn swept(&self) -> Self {
        let needed = self.needed();
        let order: Vec<usize> = (0..self.nodes.len()).filter(|&k| needed[k]).collect();
        self.arranged(&order)
    }
}
