//! One workspace and the chunks of nodes it evaluates.

use super::{Evaluator, Failure, Layout, NodeArray, NodeError, Packed};
use crate::scalar::Scalar;
use std::ops::Range;

/// An evaluator with the packed numbers of one chunk.
pub(super) struct Worker<S: Packed, E: Evaluator<S>> {
    evaluator: E,
    input: Vec<S>,
    output: Vec<S>,
    /// Failures since they were last collected.
    pub failures: Vec<Failure<E::Error>>,
}

/// Consecutive nodes, with their position in the batch.
pub(super) struct Nodes<'a, L, const I: usize, const O: usize> {
    pub first: usize,
    pub count: usize,
    pub inputs: [&'a [L]; I],
    pub outputs: [&'a mut [L]; O],
}

#[cfg(feature = "rayon")]
impl<L, const I: usize, const O: usize> Nodes<'_, L, I, O> {
    /// The first `count` nodes and the others.
    pub fn split_at(self, layout: &Layout, count: usize) -> (Self, Self) {
        let mut lengths = layout.inputs.iter().map(|argument| argument.length * count);
        let inputs = self.inputs.map(|input| input.split_at(lengths.next().unwrap_or(0)));
        let mut lengths = layout.outputs.iter().map(|argument| argument.length * count);
        // An output that is skipped has no entries.
        let mut outputs = self.outputs.map(|output| {
            let at = lengths.next().unwrap_or(0).min(output.len());
            output.split_at_mut(at)
        });
        let left = outputs.each_mut().map(|halves| std::mem::take(&mut halves.0));
        let right = outputs.map(|halves| halves.1);
        let (first, rest) = (self.first, self.count - count);
        (
            Self { first, count, inputs: inputs.map(|halves| halves.0), outputs: left },
            Self { first: first + count, count: rest, inputs: inputs.map(|halves| halves.1), outputs: right },
        )
    }
}

impl<S: Packed, E: Evaluator<S>> Worker<S, E> {
    pub fn new(evaluator: E, layouts: &[(E::Quantity, Layout)]) -> Self {
        let longest = |length: fn(&Layout) -> usize| layouts.iter().map(|(_, layout)| length(layout)).max();
        Self {
            evaluator,
            input: vec![S::zero(); longest(Layout::input_length).unwrap_or(0)],
            output: vec![S::zero(); longest(Layout::output_length).unwrap_or(0)],
            failures: Vec::new(),
        }
    }

    /// Evaluates all nodes, as many at once as a scalar has lanes; if one of these fails, each separately.
    pub fn evaluate<const I: usize, const O: usize>(
        &mut self,
        of: (E::Quantity, &Layout),
        mut nodes: Nodes<'_, S::Lane, I, O>,
    ) {
        let mut start = 0;
        while start < nodes.count {
            let end = nodes.count.min(start + S::LANES);
            if self.together(of, &mut nodes, start..end).is_err() {
                (start..end).for_each(|node| self.alone(of, &mut nodes, node));
            }
            start = end;
        }
    }

    /// Evaluates one node, in every lane.
    #[cold]
    fn alone<const I: usize, const O: usize>(
        &mut self,
        of: (E::Quantity, &Layout),
        nodes: &mut Nodes<'_, S::Lane, I, O>,
        node: usize,
    ) {
        let Err(error) = self.together(of, nodes, node..node + 1) else { return };
        self.failures.push(Failure { node: nodes.first + node, error });
        for (argument, entries) in of.1.outputs.iter().zip(&mut nodes.outputs) {
            if !entries.is_empty() {
                entries[node * argument.length..(node + 1) * argument.length]
                    .fill(S::Lane::from_f64(f64::NAN));
            }
        }
    }

    /// Evaluates these nodes at once.
    fn together<const I: usize, const O: usize>(
        &mut self,
        (quantity, layout): (E::Quantity, &Layout),
        nodes: &mut Nodes<'_, S::Lane, I, O>,
        range: Range<usize>,
    ) -> Result<(), NodeError<E::Error>> {
        let input = &mut self.input[..layout.input_length()];
        let output = &mut self.output[..layout.output_length()];
        let mut place = 0;
        for (k, &NodeArray { length, .. }) in layout.inputs.iter().enumerate() {
            let entries = &nodes.inputs[k][range.start * length..range.end * length];
            S::gather(entries, length, &mut input[place..place + length]);
            place += length;
        }
        self.evaluator.evaluate(quantity, input, output).map_err(NodeError::Evaluation)?;
        if S::CHECKED && !all_finite(input) {
            let (what, index) = first_that_is_not_finite(&layout.inputs, input);
            return Err(NodeError::Input { what, index });
        }
        if S::CHECKED && !all_finite(output) {
            let (what, index) = first_that_is_not_finite(&layout.outputs, output);
            return Err(NodeError::Output { what, index });
        }
        let mut place = 0;
        for (k, &NodeArray { length, .. }) in layout.outputs.iter().enumerate() {
            if !nodes.outputs[k].is_empty() {
                let entries = &mut nodes.outputs[k][range.start * length..range.end * length];
                S::scatter(&output[place..place + length], length, entries);
            }
            place += length;
        }
        Ok(())
    }
}

/// 0 x is 0 for finite x and NaN otherwise. The products are summed eight at a time to shorten the chain of
/// dependent additions.
#[inline]
fn all_finite<S: Scalar>(entries: &[S]) -> bool {
    let nothing = |entry: S| entry.times(0.0);
    let (mut left, mut right) = (S::zero(), S::zero());
    let (blocks, rest) = entries.as_chunks::<8>();
    for &[a, b, c, d, e, f, g, h] in blocks {
        left += (nothing(a) + nothing(b)) + (nothing(c) + nothing(d));
        right += (nothing(e) + nothing(f)) + (nothing(g) + nothing(h));
    }
    for &entry in rest {
        left += nothing(entry);
    }
    (left + right).is_finite()
}

fn first_that_is_not_finite<S: Scalar>(arguments: &[NodeArray], mut entries: &[S]) -> (&'static str, usize) {
    for argument in arguments {
        let (here, behind) = entries.split_at(argument.length);
        if let Some(index) = here.iter().position(|entry| !entry.is_finite()) {
            return (argument.name, index);
        }
        entries = behind;
    }
    ("", 0)
}
