//! Storage of a step and its Jacobians.

use super::StepLinearisation;
use crate::matrix::{Matrix, filled};
use crate::scalar::Scalar;

/// Phi and `Phi_(x,u,h)`.
#[derive(Clone, Debug)]
pub(super) struct Outcome<S> {
    pub next: Vec<S>,
    /// Columns x, u and h.
    pub phi_z: Matrix<S>,
    phi_h: Vec<S>,
}

impl<S: Scalar> Outcome<S> {
    pub fn new(states: usize, controls: usize) -> Self {
        Self {
            next: filled(S::zero(), states),
            phi_z: Matrix::zeros(states, states + controls + 1),
            phi_h: filled(S::zero(), states),
        }
    }

    /// Phi and its Jacobians, once `next` and `phi_z` are filled.
    pub fn first(&mut self) -> StepLinearisation<'_, S> {
        let (states, inputs) = (self.next.len(), self.phi_z.columns() - 1);
        for (i, phi_h) in self.phi_h.iter_mut().enumerate() {
            *phi_h = self.phi_z[(i, inputs)];
        }
        StepLinearisation {
            next: &self.next,
            phi_x: self.phi_z.block(0, 0, states, states),
            phi_u: self.phi_z.block(0, states, states, inputs - states),
            phi_h: &self.phi_h,
        }
    }
}
