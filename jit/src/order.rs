//! The order of computation: list scheduling by the length of dependent chains, within a window.

use crate::step::{Op, Step};

/// Steps that are considered together. Wider windows find more parallel work and need more registers: of 1,
/// 8, 16, 24, 32, 48, 64 and 128, 16 was fastest on UR5 and Panda.
const WINDOW: usize = 16;
/// Steps that start in one cycle: current processors start two products or sums.
const WIDTH: usize = 2;

/// Latency of the slowest step of machine code, in cycles.
const LONGEST: u32 = 20;

/// Approximate latency of a step, in cycles.
fn latency(step: &Step) -> u32 {
    match step.op {
        Op::Constant | Op::Input => 0,
        Op::Neg | Op::Exchange => 1,
        Op::Add | Op::Sub | Op::Mul | Op::Less | Op::Select => 3,
        Op::MulAdd | Op::MulSub | Op::NegMulAdd => 4,
        Op::Div => 13,
        Op::Sqrt => LONGEST,
        Op::Sin | Op::Cos | Op::Exp | Op::ExpM1 => 40,
    }
}

/// Cycles from the start of each step to the end of the longest chain that depends on it.
fn heights(nodes: &[Step]) -> Vec<u32> {
    let mut heights = vec![0; nodes.len()];
    for (k, node) in nodes.iter().enumerate().rev() {
        heights[k] += latency(node);
        for operand in node.operands() {
            heights[operand] = heights[operand].max(heights[k]);
        }
    }
    heights
}

/// Orders the steps of one stage after the other.
pub(crate) struct Scheduler<'a> {
    nodes: &'a [Step],
    heights: Vec<u32>,
    /// The cycle from which the value of each node can be used; never for steps that have not started.
    ready: Vec<u32>,
    cycle: u32,
}

impl<'a> Scheduler<'a> {
    pub fn new(nodes: &'a [Step]) -> Self {
        let ready = nodes.iter().map(|node| if node.is_leaf() { 0 } else { u32::MAX }).collect();
        Self { nodes, heights: heights(nodes), ready, cycle: 0 }
    }

    /// The same steps, reordered: at every point the highest of those that can start, among the next
    /// [`WINDOW`].
    ///
    /// Operands must be earlier steps of this list or steps of earlier calls of this function.
    pub fn stage(&mut self, steps: &[usize]) -> Vec<usize> {
        let mut order = Vec::with_capacity(steps.len());
        let mut waiting: Vec<usize> = steps.iter().rev().copied().collect();
        while !waiting.is_empty() {
            for _ in 0..WIDTH {
                let window = waiting.len().saturating_sub(WINDOW)..waiting.len();
                let startable = window.filter(|&at| self.can_start(waiting[at]));
                let Some(at) = startable.max_by_key(|&at| (self.heights[waiting[at]], at)) else { break };
                let step = waiting.remove(at);
                self.ready[step] = self.cycle + latency(&self.nodes[step]);
                order.push(step);
            }
            self.cycle += 1;
        }
        order
    }

    /// The end of a stage: all values that were started are known.
    pub fn finish(&mut self, functions: impl Iterator<Item = usize>) {
        self.cycle += LONGEST;
        functions.for_each(|node| self.ready[node] = self.cycle);
    }

    fn can_start(&self, step: usize) -> bool {
        self.nodes[step].operands().all(|operand| self.ready[operand] <= self.cycle)
    }
}
