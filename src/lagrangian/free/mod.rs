//! Inverse and forward dynamics of robots with floating and spherical joints, and their derivatives.
//!
//! q has [`Tree::nq`] entries, all others n; derivatives by q are those in the left-trivialised tangent
//! space, as Pinocchio's. With the chart of a joint (`configuration/chart.rs`) and `B = A^-1`, twist and
//! wrench are those of the chain of joints by
//!
//! $$ v = B \nu, \qquad a = B \dot \nu + B\_q[v] \nu, \qquad w \cdot \tau = (B w) \cdot \tau\_c(q, v, a),
//! \qquad q = \xi + \tfrac12 \Phi(\xi, \xi) + \dots $$
//!
//! The derivatives of tau_c come from kernels one and two of the chain of joints; those of B are constants,
//! and touch rows and columns of the joint only.

mod part;
#[cfg(test)]
mod tests;

use crate::matrix::{Entry, Matrix, filled};
use crate::robot::Tree;
use crate::scalar::Scalar;
use part::Part;

/// What the dynamics need besides that of the chains of joints.
#[derive(Clone, Debug)]
pub(crate) struct Free<S: Scalar> {
    pub parts: Vec<Part<S>>,
    /// v and a of the chart in the axes of the chain.
    pub v_chain: Vec<S>,
    pub a_chain: Vec<S>,
    /// Weights of tau in the axes of the frames.
    pub w: Vec<S>,
    pub mass_matrix: Matrix<S>,
    pub inverse: Matrix<S>,
    /// Coordinates of the chains of joints.
    pub chart: Vec<S>,
    less: Vec<Entry<S>>,
}

impl<S: Scalar> Free<S> {
    /// `None` for a robot without such joints.
    pub fn where_any(tree: &Tree) -> Option<Box<Self>> {
        let (n, zero) = (tree.dof(), S::zero());
        let parts: Vec<Part<S>> = tree.free().iter().map(Part::new).collect();
        (!parts.is_empty()).then(|| {
            Box::new(Self {
                parts,
                v_chain: filled(zero, n),
                a_chain: filled(zero, n),
                w: filled(zero, n),
                mass_matrix: Matrix::zeros(n, n),
                inverse: Matrix::zeros(n, n),
                chart: filled(zero, n),
                less: Vec::with_capacity(3 * n),
            })
        })
    }

    pub fn set_configuration(&mut self, q: &[S]) {
        self.parts.iter_mut().for_each(|part| part.frame.set_configuration(q));
    }

    pub fn set_state(&mut self, tree: &Tree, q: &[S], v: &[S]) {
        tree.chart_coordinates(q, &mut self.chart);
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

    /// nu' in place, from the acceleration of the chain.
    pub fn finish_acceleration(&self, a: &mut [S]) {
        for part in &self.parts {
            part.frame.inward(a);
            part.finish_acceleration(a);
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

    /// M in the axes of the frames, from one of numbers with this value.
    pub fn set_mass_matrix<T: Scalar>(&mut self, from: &Matrix<T>, value: impl Fn(T) -> S) {
        for i in 0..from.rows() {
            let entries = self.mass_matrix.row_mut(i).iter_mut().zip(from.row(i));
            entries.for_each(|(to, &entry)| *to = value(entry));
        }
        for part in &self.parts {
            part.frame.turn_symmetric(&mut self.mass_matrix, &[part.frame.place().0]);
        }
    }

    /// What tau_q loses, in the axes of the chain, so that it is that of `B'tau_c`, at this torque.
    pub fn force_slope(&mut self, tau: &[S]) -> &[Entry<S>] {
        self.less.clear();
        self.parts.iter().for_each(|part| part.add_force_slope(tau, &mut self.less));
        &self.less
    }

    /// a_z in the tangent space from that of the chain, with tau_q as above.
    pub fn finish_responses(&self, a_z: &mut Matrix<S>) {
        self.parts.iter().for_each(|part| part.finish_responses(a_z));
    }

    /// Derivatives of tau in the tangent space from those in the chain; tau is in the axes of the frames.
    pub fn finish_jacobian(&self, tau: &[S], [tau_q, tau_v]: [&mut Matrix<S>; 2]) {
        let n = tau.len();
        for part in &self.parts {
            part.frame.turn_block(tau_q, [0, 0], n);
            part.frame.turn_block(tau_v, [0, 0], n);
        }
        self.spread_jacobian([tau_q, tau_v]);
        self.parts.iter().for_each(|part| part.turn_force(tau, tau_q));
    }

    fn spread_jacobian(&self, [tau_q, tau_v]: [&mut Matrix<S>; 2]) {
        for part in &self.parts {
            for i in 0..tau_q.rows() {
                part.spread([tau_q.row_mut(i), tau_v.row_mut(i)], self.mass_matrix.row(i));
            }
        }
    }

    /// The same with the Hessian of `w.tau` in (q, v, a).
    pub fn finish_hessian(
        &mut self,
        tau: &[S],
        [tau_q, tau_v]: [&mut Matrix<S>; 2],
        w_tau_zz: &mut Matrix<S>,
    ) {
        let n = tau.len();
        for part in &self.parts {
            part.frame.turn_block(tau_q, [0, 0], n);
            part.frame.turn_block(tau_v, [0, 0], n);
            for top in [0, n, 2 * n] {
                [0, n, 2 * n].iter().for_each(|&left| part.frame.turn_block(w_tau_zz, [top, left], n));
            }
        }
        self.parts.iter_mut().for_each(|part| part.set_slopes(&self.w, tau_v, &self.mass_matrix));
        self.spread_jacobian([tau_q, tau_v]);
        for part in &self.parts {
            part.spread_hessian(w_tau_zz);
        }
        let jacobian = [&*tau_q, &*tau_v, &self.mass_matrix];
        self.parts.iter().for_each(|part| part.curve([tau, &self.w], jacobian, w_tau_zz));
        self.parts.iter().for_each(|part| part.turn_force(tau, tau_q));
    }
}
