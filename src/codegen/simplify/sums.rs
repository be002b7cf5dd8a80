//! Sums rebuilt as chains in which each product is one step together with the sum before it.
//!
//! A sum of p products and t other terms takes `p + max(t - 1, 0)` steps: the first term costs nothing, every
//! other term one addition, every product one step. Without other terms the first product is a step by
//! itself.

use super::graph::Graph;
use crate::codegen::record::{Id, Node};

/// One term of a sum.
#[derive(Clone, Copy, Debug)]
struct Term {
    id: Id,
    negative: bool,
    /// A product that is computed as part of the sum only.
    joins: bool,
}

/// The graph with every sum as a chain.
///
/// Sums and products whose only user is one sum are part of that sum. A product that several sums use is a
/// step of its own unless it can join all of them without making any of them longer.
pub(super) fn joined(graph: &Graph) -> Graph {
    let nodes = &graph.nodes;
    let uses = graph.uses();
    let mut inner = vec![false; nodes.len()];
    for node in nodes {
        if let Node::Add(a, b) | Node::Sub(a, b) = *node {
            for id in [a, b] {
                let ends = matches!(nodes[id.index()], Node::Add(..) | Node::Sub(..) | Node::Mul(..));
                inner[id.index()] = ends && uses[id.index()] == 1;
            }
        }
    }
    let mut sums: Vec<Option<Vec<Term>>> = vec![None; nodes.len()];
    let mut users = vec![Vec::new(); nodes.len()];
    let mut open = Vec::new();
    for k in 0..nodes.len() {
        if matches!(nodes[k], Node::Add(..) | Node::Sub(..)) && !inner[k] {
            let terms = terms(nodes, &inner, k, &mut open);
            let several = terms.iter().filter(|term| !term.joins && is_product(nodes, term.id));
            several.for_each(|term| users[term.id.index()].push(k));
            sums[k] = Some(terms);
        }
    }
    for (k, users) in users.iter().enumerate() {
        let in_sums_alone = !users.is_empty() && users.len() == uses[k] as usize;
        let free = |sum: &usize| sums[*sum].iter().flatten().filter(|term| !term.joins).count() > 1;
        if in_sums_alone && users.windows(2).all(|pair| pair[0] < pair[1]) && users.iter().all(free) {
            for &sum in users {
                let terms = sums[sum].iter_mut().flatten().filter(|term| term.id.index() == k);
                terms.for_each(|term| term.joins = true);
            }
        }
    }
    Chains::new(nodes).graph(&inner, sums, &graph.results).swept()
}

fn is_product(nodes: &[Node], id: Id) -> bool {
    matches!(nodes[id.index()], Node::Mul(..))
}

/// The terms of the sum at k, from left to right; `open` is room for this function.
fn terms(nodes: &[Node], inner: &[bool], k: usize, open: &mut Vec<(Id, bool)>) -> Vec<Term> {
    let mut terms = Vec::new();
    open.push((Id(k as u32), false));
    while let Some((id, negative)) = open.pop() {
        let joins = inner[id.index()];
        match nodes[id.index()] {
            Node::Add(a, b) if joins || id.index() == k => open.extend([(b, negative), (a, negative)]),
            Node::Sub(a, b) if joins || id.index() == k => open.extend([(b, !negative), (a, negative)]),
            _ => terms.push(Term { id, negative, joins }),
        }
    }
    terms
}

/// The new nodes while they are built.
struct Chains<'a> {
    old: &'a [Node],
    /// Positions of the old nodes among the new ones.
    places: Vec<Id>,
    nodes: Vec<Node>,
    /// Steps of the longest chain that ends at each new node.
    depths: Vec<u32>,
}

impl<'a> Chains<'a> {
    fn new(old: &'a [Node]) -> Self {
        let (nodes, depths) = (Vec::with_capacity(old.len()), Vec::with_capacity(old.len()));
        Self { old, places: vec![Id(0); old.len()], nodes, depths }
    }

    fn push(&mut self, node: Node) -> Id {
        let deepest = node.operands().map(|id| self.depths[id.index()] + 1).max().unwrap_or(0);
        self.depths.push(deepest);
        self.nodes.push(node);
        Id(self.nodes.len() as u32 - 1)
    }

    fn graph(mut self, inner: &[bool], mut sums: Vec<Option<Vec<Term>>>, results: &[Id]) -> Graph {
        for k in 0..self.old.len() {
            if inner[k] {
                continue;
            }
            self.places[k] = match sums[k].take() {
                Some(terms) => self.chain(terms),
                None => {
                    let node = self.old[k].map(|id| self.places[id.index()]);
                    self.push(node)
                }
            };
        }
        let results = results.iter().map(|id| self.places[id.index()]).collect();
        Graph { nodes: self.nodes, results }
    }

    /// The factors of a term that joins, among the new nodes.
    fn factors(&self, term: &Term) -> Option<(Id, Id)> {
        match self.old[term.id.index()] {
            Node::Mul(a, b) if term.joins => Some((self.places[a.index()], self.places[b.index()])),
            _ => None,
        }
    }

    /// The depth of a term: steps of the longest chain before it.
    fn depth(&self, term: &Term) -> u32 {
        let depth = |id: Id| self.depths[id.index()];
        match self.factors(term) {
            Some((a, b)) => depth(a).max(depth(b)),
            None => depth(self.places[term.id.index()]),
        }
    }

    /// The terms one after the other, those of least depth first.
    fn chain(&mut self, mut terms: Vec<Term>) -> Id {
        terms.sort_by_key(|term| self.depth(term));
        let start = self.start(&mut terms);
        terms.iter().fold(start, |sum, term| {
            let place = self.places[term.id.index()];
            self.push(match (self.factors(term), term.negative) {
                (Some((a, b)), false) => Node::MulAdd(a, b, sum),
                (Some((a, b)), true) => Node::NegMulAdd(a, b, sum),
                (None, false) => Node::Add(sum, place),
                (None, true) => Node::Sub(sum, place),
            })
        })
    }

    /// The begin of a chain, removed from the terms: a positive term, else a product minus a term, else a
    /// product alone.
    fn start(&mut self, terms: &mut Vec<Term>) -> Id {
        let place = |term: Term| self.places[term.id.index()];
        if let Some(at) = terms.iter().position(|term| !term.joins && !term.negative) {
            return place(terms.remove(at));
        }
        let first = terms.remove(terms.iter().position(|term| !term.negative).unwrap_or(0));
        let Some((a, b)) = self.factors(&first) else {
            return self.push(Node::Neg(place(first)));
        };
        let less = terms.iter().position(|term| !term.joins).map(|at| place(terms.remove(at)));
        self.push(less.map_or(Node::Mul(a, b), |less| Node::MulSub(a, b, less)))
    }
}
