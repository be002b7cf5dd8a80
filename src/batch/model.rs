//! Models dx/dt = f(x, u) at many nodes, for direct collocation.

use super::{Batch, BatchError, Evaluator, Failure, Layout, NodeArray, Packed};
use crate::dynamics::Dynamics;
use crate::matrix::Block;

/// A model as an evaluator of nodes.
#[derive(Clone, Debug)]
pub struct Model<D>(pub D);

/// The quantities of a model at every node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ModelQuantity {
    /// (x, u) to f.
    Value,
    /// (x, u) to f, f_x, f_u.
    Linearisation,
    /// (x, u, y) to y'f_x, y'f_u.
    Adjoint,
    /// (x, u, y) to f, f_x, f_u and the blocks xx, ux, uu of the second derivatives of y'f.
    Contraction,
}

/// Output arrays for f and its Jacobians, node by node; empty ones are skipped.
#[derive(Debug)]
pub struct FirstOrderArrays<'a, L> {
    /// N x states.
    pub f: &'a mut [L],
    /// N x states x states.
    pub f_x: &'a mut [L],
    /// N x states x controls; the same at every node if
    /// [`Structure::constant_f_u`](crate::dynamics::Structure::constant_f_u).
    pub f_u: &'a mut [L],
}

/// Output arrays for the second derivatives of y'f, node by node; empty ones are skipped.
#[derive(Debug)]
pub struct SecondOrderArrays<'a, L> {
    /// N x states x states.
    pub xx: &'a mut [L],
    /// N x controls x states; zero if the model has none.
    pub ux: &'a mut [L],
    /// N x controls x controls; zero if the model has none.
    pub uu: &'a mut [L],
}

impl<L> Default for FirstOrderArrays<'_, L> {
    fn default() -> Self {
        Self { f: &mut [], f_x: &mut [], f_u: &mut [] }
    }
}

impl<L> Default for SecondOrderArrays<'_, L> {
    fn default() -> Self {
        Self { xx: &mut [], ux: &mut [], uu: &mut [] }
    }
}

/// Writes results one after the other.
pub(super) struct Writer<'a, S>(pub &'a mut [S]);

impl<S: Packed> Writer<'_, S> {
    pub fn slice(&mut self, entries: &[S]) {
        let (here, behind) = std::mem::take(&mut self.0).split_at_mut(entries.len());
        here.copy_from_slice(entries);
        self.0 = behind;
    }

    pub fn block(&mut self, block: Block<'_, S>) {
        block.iter_rows().for_each(|row| self.slice(row));
    }

    /// A block padded with zeros to `rows` x `columns`; all zero if `None`.
    pub fn padded(&mut self, block: Option<Block<'_, S>>, rows: usize, columns: usize) {
        let (here, behind) = std::mem::take(&mut self.0).split_at_mut(rows * columns);
        here.fill(S::zero());
        for (target, row) in
            here.chunks_exact_mut(columns.max(1)).zip(block.iter().flat_map(Block::iter_rows))
        {
            target.iter_mut().zip(row).for_each(|(target, &entry)| *target = entry);
        }
        self.0 = behind;
    }
}

impl<S: Packed, D: Dynamics<S, Error: Send> + Send> Evaluator<S> for Model<D> {
    type Quantity = ModelQuantity;
    type Error = D::Error;

    fn layouts(&self) -> Vec<(ModelQuantity, Layout)> {
        let (n, m) = (self.0.states(), self.0.controls());
        let (at, with) = (
            [NodeArray::new("x", n), NodeArray::new("u", m)],
            [NodeArray::new("x", n), NodeArray::new("u", m), NodeArray::new("y", n)],
        );
        let first = [NodeArray::new("f", n), NodeArray::new("f_x", n * n), NodeArray::new("f_u", n * m)];
        let second = [
            first.as_slice(),
            &[NodeArray::new("xx", n * n), NodeArray::new("ux", m * n), NodeArray::new("uu", m * m)],
        ]
        .concat();
        vec![
            (ModelQuantity::Value, Layout::new(&at, &first[..1])),
            (ModelQuantity::Linearisation, Layout::new(&at, &first)),
            (
                ModelQuantity::Adjoint,
                Layout::new(&with, &[NodeArray::new("y_f_x", n), NodeArray::new("y_f_u", m)]),
            ),
            (ModelQuantity::Contraction, Layout::new(&with, &second)),
        ]
    }

    fn evaluate(&mut self, quantity: ModelQuantity, input: &[S], output: &mut [S]) -> Result<(), D::Error> {
        let (n, m) = (self.0.states(), self.0.controls());
        let (x, rest) = input.split_at(n);
        let (u, y) = rest.split_at(m);
        let mut writer = Writer(output);
        match quantity {
            ModelQuantity::Value => writer.slice(self.0.evaluate(x, u)?),
            ModelQuantity::Linearisation => {
                let first = self.0.linearise(x, u)?;
                writer.slice(first.f);
                writer.block(first.f_x);
                writer.block(first.f_u);
            }
            ModelQuantity::Adjoint => {
                let (y_f_x, y_f_u) = writer.0.split_at_mut(n);
                self.0.adjoint(x, u, y, y_f_x, y_f_u)?;
            }
            ModelQuantity::Contraction => {
                let second = self.0.contract(x, u, y)?;
                writer.slice(second.first.f);
                writer.block(second.first.f_x);
                writer.block(second.first.f_u);
                writer.block(second.xx);
                writer.padded(second.ux, m, n);
                writer.padded(second.uu, m, m);
            }
        }
        Ok(())
    }
}

/// The failed nodes, or an error of the whole batch.
type Failures<'a, S, D> = Result<&'a [Failure<<D as Dynamics<S>>::Error>], BatchError>;

/// x, u and y are N x states, N x controls and N x states, node by node; x determines N.
///
/// All methods return the nodes that could not be evaluated, or a [`BatchError`] if an array does not fit.
impl<S: Packed, D: Dynamics<S, Error: Send> + Send> Batch<S, Model<D>> {
    /// f at every node: N x states.
    ///
    /// # Errors
    /// [`BatchError`].
    pub fn evaluate(&mut self, x: &[S::Lane], u: &[S::Lane], f: &mut [S::Lane]) -> Failures<'_, S, D> {
        let nodes = self.nodes(x);
        self.run(ModelQuantity::Value, nodes, [x, u], [f])
    }

    /// f, f_x and f_u at every node.
    ///
    /// # Errors
    /// [`BatchError`].
    pub fn linearise(
        &mut self,
        x: &[S::Lane],
        u: &[S::Lane],
        into: FirstOrderArrays<'_, S::Lane>,
    ) -> Failures<'_, S, D> {
        let nodes = self.nodes(x);
        self.run(ModelQuantity::Linearisation, nodes, [x, u], [into.f, into.f_x, into.f_u])
    }

    /// y'f_x (N x states) and y'f_u (N x controls) at every node.
    ///
    /// # Errors
    /// [`BatchError`].
    pub fn adjoint(
        &mut self,
        [x, u, y]: [&[S::Lane]; 3],
        [y_f_x, y_f_u]: [&mut [S::Lane]; 2],
    ) -> Failures<'_, S, D> {
        let nodes = self.nodes(x);
        self.run(ModelQuantity::Adjoint, nodes, [x, u, y], [y_f_x, y_f_u])
    }

    /// f, its Jacobians and the second derivatives of y'f at every node, y the multipliers of the state
    /// equations.
    ///
    /// # Errors
    /// [`BatchError`].
    pub fn contract(
        &mut self,
        [x, u, y]: [&[S::Lane]; 3],
        first: FirstOrderArrays<'_, S::Lane>,
        second: SecondOrderArrays<'_, S::Lane>,
    ) -> Failures<'_, S, D> {
        let nodes = self.nodes(x);
        let outputs = [first.f, first.f_x, first.f_u, second.xx, second.ux, second.uu];
        self.run(ModelQuantity::Contraction, nodes, [x, u, y], outputs)
    }

    fn nodes(&self, x: &[S::Lane]) -> usize {
        self.first_layout().map_or(0, |layout| x.len() / layout.inputs[0].length.max(1))
    }
}
