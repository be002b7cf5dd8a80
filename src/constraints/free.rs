//! Rows of constraints of robots with floating and spherical joints, and their derivatives.
//!
//! Rows are functions of the coordinates of the chains of joints. Derivatives by q are those in the
//! left-trivialised tangent space. With the chart of a joint (`configuration/chart.rs`) and `B = A^-1`, twist
//! and wrench are those of the chain of joints by
//!
//! $$ v = B \nu, \qquad a = B \dot \nu + B\_q[v] \nu, \qquad w \cdot \tau = (B w) \cdot \tau\_c,
//! \qquad q = \xi + \tfrac12 \Phi(\xi, \xi) + \dots $$
//!
//! The derivatives of B are constants, and touch rows and columns of the joint only.

use super::free_part::Part;
use crate::matrix::filled;
use crate::robot::Tree;
use crate::scalar::Scalar;

/// The charts of all floating and spherical joints at a state.
#[derive(Clone, Debug)]
pub(crate) struct Free<S: Scalar> {
    pub parts: Vec<Part<S>>,
    /// v and a of the chart in the axes of the chain.
    pub v_chain: Vec<S>,
    pub a_chain: Vec<S>,
}

impl<S: Scalar> Free<S> {
    /// `None` for a robot without such joints.
    pub fn where_any(tree: &Tree) -> Option<Box<Self>> {
        let (n, zero) = (tree.dof(), S::zero());
        let parts: Vec<Part<S>> = tree.free().iter().map(Part::new).collect();
        (!parts.is_empty())
            .then(|| Box::new(Self { parts, v_chain: filled(zero, n), a_chain: filled(zero, n) }))
    }

    pub fn set_configuration(&mut self, q: &[S]) {
        self.parts.iter_mut().for_each(|part| part.frame.set_configuration(q));
    }

    pub fn set_state(&mut self, q: &[S], v: &[S]) {
        self.v_chain.copy_from_slice(v);
        for part in &mut self.parts {
            part.frame.set_configuration(q);
            part.set_velocity(v);
            part.frame.outward(&mut self.v_chain);
        }
    }

    /// a of the chain from the acceleration nu'.
    pub fn set_acceleration(&mut self, acceleration: &[S]) {
        self.a_chain.copy_from_slice(acceleration);
        for part in &mut self.parts {
            part.set_acceleration(acceleration, &mut self.a_chain);
            part.frame.outward(&mut self.a_chain);
        }
    }

    /// From the axes of the frames to those of the chain.
    pub fn outward(&self, vector: &mut [S]) {
        self.parts.iter().for_each(|part| part.frame.outward(vector));
    }

    /// And back.
    pub fn inward(&self, vector: &mut [S]) {
        self.parts.iter().for_each(|part| part.frame.inward(vector));
    }
}
