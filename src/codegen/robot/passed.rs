//! The arguments and results of a quantity, one after the other.

use super::quantity::Variable;
use super::shape::Shape;
use crate::lagrangian::InverseDynamicsLinearisation;
use crate::matrix::Block;
use crate::scalar::Scalar;

/// The arguments of a quantity; those that it does not have are empty.
#[derive(Clone, Copy)]
pub(super) struct Arguments<'a, S> {
    pub q: &'a [S],
    /// p or v.
    pub rate: &'a [S],
    pub u: &'a [S],
    pub a: &'a [S],
    pub y: &'a [S],
    pub d: &'a [S],
}

impl<'a, S> Arguments<'a, S> {
    pub fn split(variables: &[Variable], shapes: &[Shape], inputs: &'a [S]) -> Self {
        let mut all = Self { q: &[], rate: &[], u: &[], a: &[], y: &[], d: &[] };
        let mut rest = inputs;
        for (variable, shape) in variables.iter().zip(shapes) {
            let (part, more) = rest.split_at(shape.entries());
            rest = more;
            match variable {
                Variable::Q => all.q = part,
                Variable::P | Variable::V => all.rate = part,
                Variable::U => all.u = part,
                Variable::A => all.a = part,
                Variable::Y => all.y = part,
                Variable::D => all.d = part,
            }
        }
        all
    }
}

/// Results, written one after the other.
pub(super) struct Results<'a, S> {
    pub rest: &'a mut [S],
}

impl<S: Scalar> Results<'_, S> {
    /// Appends numbers.
    pub fn push(&mut self, values: &[S]) -> &mut Self {
        let (here, rest) = std::mem::take(&mut self.rest).split_at_mut(values.len());
        here.copy_from_slice(values);
        self.rest = rest;
        self
    }

    /// Appends tau and the rows of `[tau_q, tau_v, tau_a]`.
    pub fn push_torques(&mut self, linear: InverseDynamicsLinearisation<'_, S>) -> &mut Self {
        self.push(linear.tau);
        for i in 0..linear.tau.len() {
            self.push(linear.tau_q.row(i)).push(linear.tau_v.row(i)).push(linear.tau_a.row(i));
        }
        self
    }

    pub fn push_rows(&mut self, block: Block<'_, S>) -> &mut Self {
        block.iter_rows().for_each(|row| {
            self.push(row);
        });
        self
    }
}
