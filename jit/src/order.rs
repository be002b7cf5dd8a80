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

/// No cycle: what has not started.
const NEVER: u32 = u32::MAX;

/// A step of the window, and the cycle from which it can start, once that is known.
struct Waiting {
    step: usize,
    start: u32,
}

impl Waiting {
    fn new(step: usize) -> Self {
        Self { step, start: NEVER }
    }
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
        let ready = nodes.iter().map(|node| if node.is_leaf() { 0 } else { NEVER }).collect();
        Self { nodes, heights: heights(nodes), ready, cycle: 0 }
    }

    /// The same steps, reordered: at every point the highest of those that can start, among the next
    /// [`WINDOW`].
    ///
    /// Operands must be earlier steps of this list or steps of earlier calls of this function.
    pub fn stage(&mut self, steps: &[usize]) -> Vec<usize> {
        let mut order = Vec::with_capacity(steps.len());
        let (first, mut later) = (steps.len().min(WINDOW), steps.iter().skip(WINDOW));
        let mut window: Vec<Waiting> = steps[..first].iter().map(|&step| Waiting::new(step)).collect();
        while !window.is_empty() {
            let mut next = self.cycle + 1;
            for _ in 0..WIDTH {
                match self.highest(&mut window) {
                    Ok(at) => {
                        let step = window.remove(at).step;
                        window.extend(later.next().map(|&step| Waiting::new(step)));
                        self.ready[step] = self.cycle + latency(&self.nodes[step]);
                        order.push(step);
                    }
                    Err(soonest) => {
                        next = soonest;
                        break;
                    }
                }
            }
            self.cycle = if window.is_empty() { self.cycle + 1 } else { next };
        }
        order
    }

    /// The highest step that can start, of equals the first one; else the cycle in which the first can.
    fn highest(&self, window: &mut [Waiting]) -> Result<usize, u32> {
        let mut best: Option<(u32, usize)> = None;
        let mut soonest = NEVER;
        for (at, waiting) in window.iter_mut().enumerate() {
            if waiting.start == NEVER {
                // Never if one of its operands has not started.
                let ready = self.nodes[waiting.step].operands().map(|operand| self.ready[operand]);
                waiting.start = ready.max().unwrap_or(0);
            }
            soonest = soonest.min(waiting.start);
            let height = self.heights[waiting.step];
            if waiting.start <= self.cycle && best.is_none_or(|(most, _)| height > most) {
                best = Some((height, at));
            }
        }
        best.map(|(_, at)| at).ok_or(soonest)
    }

    /// The end of a stage: all values that were started are known.
    pub fn finish(&mut self, functions: impl Iterator<Item = usize>) {
        self.cycle += LONGEST;
        functions.for_each(|node| self.ready[node] = self.cycle);
    }
}
