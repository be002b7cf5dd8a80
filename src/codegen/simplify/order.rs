//! The order of computation.

use super::graph::Graph;
use crate::codegen::record::Node;
use std::collections::BinaryHeap;

/// Leaves first, then the steps in an order that keeps few values alive at any time.
///
/// List scheduling, backwards from the results: of the steps whose users are all placed, the next is the one
/// that ends the life of a value and begins that of the fewest operands; of equals, the one whose user was
/// placed last.
pub(super) fn few_waiting(graph: &Graph) -> Graph {
    let needed = graph.needed();
    let leaves = (0..graph.nodes.len()).filter(|&k| needed[k] && graph.nodes[k].is_leaf());
    let mut order: Vec<usize> = leaves.collect();
    let mut steps = Steps::new(graph, &needed).placed();
    steps.reverse();
    order.append(&mut steps);
    graph.arranged(&order)
}

/// The priority of placing a step now, and the step.
type Offer = (i32, u32, usize);

/// The state of the scheduling, from the last step to the first.
struct Steps<'a> {
    nodes: &'a [Node],
    /// The users of value k are in `users[starts[k]..starts[k + 1]]`.
    users: Vec<u32>,
    starts: Vec<u32>,
    /// Users that are not placed yet.
    missing: Vec<usize>,
    /// Whether a user is placed: the value is alive.
    waiting: Vec<bool>,
    /// When its latest user was placed.
    asked: Vec<u32>,
    placed: Vec<bool>,
    offers: BinaryHeap<Offer>,
}

impl<'a> Steps<'a> {
    fn new(graph: &'a Graph, needed: &[bool]) -> Self {
        let count = graph.nodes.len();
        let mut missing = vec![0_usize; count];
        let steps = (0..count).filter(|&k| needed[k] && !graph.nodes[k].is_leaf());
        for k in steps.clone() {
            distinct_steps(&graph.nodes, k).for_each(|operand| missing[operand] += 1);
        }
        let mut starts = vec![0; count + 1];
        for (k, &users) in missing.iter().enumerate() {
            starts[k + 1] = starts[k] + users as u32;
        }
        let (mut users, mut next) = (vec![0; starts[count] as usize], starts.clone());
        for k in steps.clone() {
            for operand in distinct_steps(&graph.nodes, k) {
                users[next[operand] as usize] = k as u32;
                next[operand] += 1;
            }
        }
        let mut new = Self {
            nodes: &graph.nodes,
            missing,
            users,
            starts,
            waiting: vec![false; count],
            asked: vec![0; count],
            placed: vec![false; count],
            offers: BinaryHeap::new(),
        };
        steps.for_each(|k| new.offer(k));
        new
    }

    /// Offers a step if all of its users are placed.
    fn offer(&mut self, k: usize) {
        if self.missing[k] == 0 && !self.placed[k] {
            let new = distinct_steps(self.nodes, k).filter(|&operand| !self.waiting[operand]).count();
            self.offers.push((i32::from(self.waiting[k]) - new as i32, self.asked[k], k));
        }
    }

    /// All steps, the last one first.
    fn placed(mut self) -> Vec<usize> {
        let mut order = Vec::new();
        while let Some((.., k)) = self.offers.pop() {
            if self.placed[k] {
                continue;
            }
            self.placed[k] = true;
            order.push(k);
            let time = order.len() as u32;
            for operand in distinct_steps(self.nodes, k) {
                self.asked[operand] = time;
                self.missing[operand] -= 1;
                if !std::mem::replace(&mut self.waiting[operand], true) {
                    // The priority of its other users rises; no priority ever falls.
                    for at in self.starts[operand]..self.starts[operand + 1] {
                        self.offer(self.users[at as usize] as usize);
                    }
                }
                self.offer(operand);
            }
        }
        order
    }
}

/// The operands of a step that are steps themselves, each once.
fn distinct_steps(nodes: &[Node], k: usize) -> impl Iterator<Item = usize> {
    let operands = nodes[k].operands().map(|id| id.index());
    let earlier = operands.clone();
    operands
        .enumerate()
        .filter(move |(place, k)| !earlier.clone().take(*place).any(|other| other == *k))
        .map(|(_, k)| k)
        .filter(|&k| !nodes[k].is_leaf())
}
