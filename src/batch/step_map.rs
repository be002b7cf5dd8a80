//! Time steps from many states, for multiple shooting.

use super::model::Writer;
use super::{Batch, BatchError, Evaluator, Failure, Layout, NodeArray, Packed, SecondOrderArrays};
use crate::step::{Step, StepLinearisation};

/// A step as an evaluator of nodes, each with its own x, u and h.
#[derive(Clone, Debug)]
pub struct StepMap<P>(pub P);

/// The quantities of a step at every node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StepQuantity {
    /// (x, u, h) to Phi.
    Next,
    /// (x, u, h) to Phi, Phi_x, Phi_u, Phi_h.
    Linearisation,
    /// (x, u, h, y) to Phi, Phi_x, Phi_u, Phi_h and the blocks xx, ux, uu of the second derivatives of y'Phi.
    Contraction,
}

/// Output arrays for Phi and its Jacobians, node by node; empty ones are skipped.
#[derive(Debug)]
pub struct StepArrays<'a, L> {
    /// N x states.
    pub next: &'a mut [L],
    /// N x states x states.
    pub phi_x: &'a mut [L],
    /// N x states x controls.
    pub phi_u: &'a mut [L],
    /// N x states.
    pub phi_h: &'a mut [L],
}

impl<L> Default for StepArrays<'_, L> {
    fn default() -> Self {
        Self { next: &mut [], phi_x: &mut [], phi_u: &mut [], phi_h: &mut [] }
    }
}

impl<S: Packed> Writer<'_, S> {
    fn step(&mut self, first: StepLinearisation<'_, S>) {
        self.slice(first.next);
        self.block(first.phi_x);
        self.block(first.phi_u);
        self.slice(first.phi_h);
    }
}

impl<S: Packed, P: Step<S, Error: Send> + Send> Evaluator<S> for StepMap<P> {
    type Quantity = StepQuantity;
    type Error = P::Error;

    fn layouts(&self) -> Vec<(StepQuantity, Layout)> {
        let (n, m) = (self.0.states(), self.0.controls());
        let (at, with) = (
            [NodeArray::new("x", n), NodeArray::new("u", m), NodeArray::new("h", 1)],
            [NodeArray::new("x", n), NodeArray::new("u", m), NodeArray::new("h", 1), NodeArray::new("y", n)],
        );
        let first = [
            NodeArray::new("next", n),
            NodeArray::new("phi_x", n * n),
            NodeArray::new("phi_u", n * m),
            NodeArray::new("phi_h", n),
        ];
        let second = [
            first.as_slice(),
            &[NodeArray::new("xx", n * n), NodeArray::new("ux", m * n), NodeArray::new("uu", m * m)],
        ]
        .concat();
        vec![
            (StepQuantity::Next, Layout::new(&at, &first[..1])),
            (StepQuantity::Linearisation, Layout::new(&at, &first)),
            (StepQuantity::Contraction, Layout::new(&with, &second)),
        ]
    }

    fn evaluate(&mut self, quantity: StepQuantity, input: &[S], output: &mut [S]) -> Result<(), P::Error> {
        let (n, m) = (self.0.states(), self.0.controls());
        let (x, rest) = input.split_at(n);
        let (u, rest) = rest.split_at(m);
        let (h, y) = (rest[0], &rest[1..]);
        let mut writer = Writer(output);
        match quantity {
            StepQuantity::Next => writer.slice(self.0.evaluate(x, u, h)?),
            StepQuantity::Linearisation => writer.step(self.0.linearise(x, u, h)?),
            StepQuantity::Contraction => {
                let second = self.0.contract(x, u, h, y)?;
                writer.step(second.first);
                writer.block(second.xx);
                writer.padded(second.ux, m, n);
                writer.padded(second.uu, m, m);
            }
        }
        Ok(())
    }
}

/// The failed nodes, or an error of the whole batch.
type Failures<'a, S, P> = Result<&'a [Failure<<P as Step<S>>::Error>], BatchError>;

/// x, u, h and y are N x states, N x controls, N and N x states, node by node; N is the length of h.
///
/// All methods return the nodes whose step failed, or a [`BatchError`] if an array does not fit.
impl<S: Packed, P: Step<S, Error: Send> + Send> Batch<S, StepMap<P>> {
    /// Phi(x, u, h) at every node: N x states.
    ///
    /// # Errors
    /// [`BatchError`].
    pub fn evaluate(&mut self, [x, u, h]: [&[S::Lane]; 3], next: &mut [S::Lane]) -> Failures<'_, S, P> {
        self.run(StepQuantity::Next, h.len(), [x, u, h], [next])
    }

    /// Phi and its Jacobians at every node.
    ///
    /// # Errors
    /// [`BatchError`].
    pub fn linearise(
        &mut self,
        [x, u, h]: [&[S::Lane]; 3],
        into: StepArrays<'_, S::Lane>,
    ) -> Failures<'_, S, P> {
        let outputs = [into.next, into.phi_x, into.phi_u, into.phi_h];
        self.run(StepQuantity::Linearisation, h.len(), [x, u, h], outputs)
    }

    /// Phi, its Jacobians and the second derivatives of y'Phi at every node, y the multipliers of the next
    /// states.
    ///
    /// # Errors
    /// [`BatchError`].
    pub fn contract(
        &mut self,
        [x, u, h, y]: [&[S::Lane]; 4],
        first: StepArrays<'_, S::Lane>,
        second: SecondOrderArrays<'_, S::Lane>,
    ) -> Failures<'_, S, P> {
        let StepArrays { next, phi_x, phi_u, phi_h } = first;
        let SecondOrderArrays { xx, ux, uu } = second;
        let outputs = [next, phi_x, phi_u, phi_h, xx, ux, uu];
        self.run(StepQuantity::Contraction, h.len(), [x, u, h, y], outputs)
    }
}
