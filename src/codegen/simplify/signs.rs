//! The sign with which each node is computed: differences are reversed where that saves a negation.

use super::graph::Graph;
use crate::codegen::record::{Arena, Id, Node, Signed, Value};

/// The graph of these results of a recording, with the sign of every node chosen.
pub(super) fn settled(nodes: &[Node], results: &[Signed]) -> Graph {
    let flipped = flips(nodes, results);
    signed(nodes, results, &flipped).swept()
}

/// Whether each node is computed with the opposite sign.
///
/// A difference costs the same with either sign, and so does every sum, product and quotient whose operand is
/// such a difference without other uses. Sums and products accept any sign of an operand; results and
/// functions need the right one.
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

/// The operand whose sign can change at no cost.
fn carrier(free: &[bool], uses: &[u32], a: Id, b: Id) -> Option<Id> {
    [b, a].into_iter().find(|id| free[id.index()] && uses[id.index()] == 1)
}

/// The same results with the signs of these nodes reversed, and with negations where a sign must change.
fn signed(nodes: &[Node], results: &[Signed], flipped: &[bool]) -> Graph {
    let mut arena = Arena::with_capacity(nodes.len());
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

/// `a + b`, computed with the opposite sign if `flipped`, or if both operands have it.
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
