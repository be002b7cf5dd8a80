//! From the nodes of a recording to those of a program: signs settled, sums joined with their products, dead nodes left out.

use super::arena::Arena;
use super::node::{Id, Node};
use super::sums::joined;
use super::value::{Signed, Value};

/// Nodes, operands first, and where the results are.
#[derive(Clone, Debug, Default)]
pub(super) struct Graph {
    pub nodes: Vec<Node>,
    pub results: Vec<Id>,
}

impl Graph {
    /// How often each node is used, by results too.
    pub fn uses(&self) -> Vec<u32> {
        let mut uses = vec![0; self.nodes.len()];
        let operands = self.nodes.iter().flat_map(Node::operands);
        operands.chain(self.results.iter().copied()).for_each(|id| uses[id.index()] += 1);
        uses
    }

    /// Which nodes the results need.
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

    /// The nodes of this list alone, in this order; it holds every node that one of them or a result needs.
    pub fn arranged(&self, order: &[usize]) -> Self {
        let mut places = vec![Id(0); self.nodes.len()];
        order.iter().zip(0..).for_each(|(&k, place)| places[k] = Id(place));
        let to_place = |id: Id| places[id.index()];
        Self {
            nodes: order.iter().map(|&k| self.nodes[k].map(to_place)).collect(),
            results: self.results.iter().copied().map(to_place).collect(),
        }
    }

    /// Without what no result needs.
    pub fn swept(&self) -> Self {
        let needed = self.needed();
        let order: Vec<usize> = (0..self.nodes.len()).filter(|&k| needed[k]).collect();
        self.arranged(&order)
    }
}

/// The graph of these results of a recording.
pub(super) fn lower(nodes: Vec<Node>, results: &[Signed]) -> Graph {
    let flipped = flips(&nodes, results);
    joined(&signed(&nodes, results, &flipped).swept())
}

/// Which nodes are computed with the other sign.
///
/// A difference has either sign for the same price, and with it every sum and product that uses it alone. Sums and products
/// take any sign of an operand; results and functions want theirs.
fn flips(nodes: &[Node], results: &[Signed]) -> Vec<bool> {
    let all = Graph { nodes: nodes.to_vec(), results: results.iter().map(|signed| signed.id).collect() };
    let (needed, uses) = (all.needed(), all.uses());
    let mut free = vec![false; nodes.len()];
    for (k, node) in nodes.iter().enumerate() {
        free[k] = match *node {
            Node::Sub(..) => true,
            Node::Add(a, b) | Node::Mul(a, b) | Node::Div(a, b) => carrier(&free, &uses, a, b).is_some(),
            _ => false,
        };
    }
    let mut wanted = vec![[0_u32; 2]; nodes.len()];
    results.iter().for_each(|signed| wanted[signed.id.index()][usize::from(signed.negative)] += 1);
    let mut flipped = vec![false; nodes.len()];
    for (k, node) in nodes.iter().enumerate().rev().filter(|(k, _)| needed[*k]) {
        let [plus, minus] = wanted[k];
        let worth = if matches!(node, Node::Sub(..)) { minus > plus } else { plus == 0 && minus > 0 };
        flipped[k] = worth && free[k];
        match *node {
            Node::Add(a, b) | Node::Mul(a, b) | Node::Div(a, b) if flipped[k] => {
                let carrier = carrier(&free, &uses, a, b);
                carrier.into_iter().for_each(|id| wanted[id.index()][1] += 1);
            }
            Node::Add(..) | Node::Sub(..) | Node::Mul(..) | Node::Div(..) => {}
            _ => node.operands().for_each(|id| wanted[id.index()][0] += 1),
        }
    }
    flipped
}

/// Which operand changes its sign for nothing.
fn carrier(free: &[bool], uses: &[u32], a: Id, b: Id) -> Option<Id> {
    [b, a].into_iter().find(|id| free[id.index()] && uses[id.index()] == 1)
}

/// The same results with the signs of these nodes turned, and with nodes that change a sign where one must be changed.
fn signed(nodes: &[Node], results: &[Signed], flipped: &[bool]) -> Graph {
    let mut arena = Arena::default();
    let mut values: Vec<Signed> = Vec::with_capacity(nodes.len());
    for (k, node) in nodes.iter().enumerate() {
        let signed = |id: Id| values[id.index()];
        let value = match *node {
            Node::Add(a, b) => sum(&mut arena, signed(a), signed(b), flipped[k]),
            Node::Sub(a, b) => {
                let b = signed(b);
                sum(&mut arena, signed(a), Signed { negative: !b.negative, ..b }, flipped[k])
            }
            Node::Mul(a, b) | Node::Div(a, b) => {
                let (a, b) = (signed(a), signed(b));
                let node = match node {
                    Node::Mul(..) => Node::Mul(a.id, b.id),
                    _ => Node::Div(a.id, b.id),
                };
                Signed { id: arena.intern(node), negative: a.negative != b.negative }
            }
            _ => {
                let whole: Vec<Id> = node.operands().map(|id| arena.whole(Value::Of(signed(id)))).collect();
                let mut next = whole.into_iter();
                let places: Vec<(Id, Id)> = node.operands().zip(next.by_ref()).collect();
                let place = |id: Id| places.iter().find(|(from, _)| *from == id).map_or(id, |(_, to)| *to);
                Signed { id: arena.intern(node.map(place)), negative: false }
            }
        };
        values.push(value);
    }
    let results = results.iter().map(|&Signed { id, negative }| {
        let value = values[id.index()];
        arena.whole(Value::Of(Signed { id: value.id, negative: value.negative != negative }))
    });
    let results = results.collect();
    Graph { nodes: arena.nodes, results }
}

/// `a + b`, computed with the other sign if `flipped` and otherwise where that needs no change of sign.
fn sum(arena: &mut Arena, a: Signed, b: Signed, flipped: bool) -> Signed {
    let (node, negative) = match (a.negative, b.negative) {
        (false, false) => (Node::Add(a.id, b.id), false),
        (true, true) => (Node::Add(a.id, b.id), true),
        (false, true) if flipped => (Node::Sub(b.id, a.id), true),
        (true, false) if flipped => (Node::Sub(a.id, b.id), true),
        (false, true) => (Node::Sub(a.id, b.id), false),
        (true, false) => (Node::Sub(b.id, a.id), false),
    };
    Signed { id: arena.intern(node), negative }
}
