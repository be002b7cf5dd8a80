//! Where a step and its derivatives are kept, and how those of the stages are added up.

use super::{StepContraction, StepFirstOrder};
use crate::dynamics::Contraction;
use crate::matrix::{Matrix, add_rows, add_scaled};
use crate::scalar::Scalar;

/// Phi, `Phi_(x,u,h)` and the second derivatives of y'Phi in z = (x, u).
#[derive(Clone, Debug)]
pub(super) struct Outcome<S> {
    pub next: Vec<S>,
    /// Columns x, u and h.
    pub phi_z: Matrix<S>,
    phi_h: Vec<S>,
    /// The lower triangle while it is added up.
    hessian: Matrix<S>,
    product: Matrix<S>,
}

impl<S: Scalar> Outcome<S> {
    pub fn new(states: usize, controls: usize) -> Self {
        let inputs = states + controls;
        Self {
            next: vec![S::zero(); states],
            phi_z: Matrix::zeros(states, inputs + 1),
            phi_h: vec![S::zero(); states],
            hessian: Matrix::zeros(inputs, inputs),
            product: Matrix::zeros(states, inputs),
        }
    }

    fn states(&self) -> usize {
        self.next.len()
    }

    /// Phi and its Jacobians, once `next` and `phi_z` are filled.
    pub fn first(&mut self) -> StepFirstOrder<'_, S> {
        let inputs = self.hessian.rows();
        for (i, phi_h) in self.phi_h.iter_mut().enumerate() {
            *phi_h = self.phi_z[(i, inputs)];
        }
        self.seen()
    }

    fn seen(&self) -> StepFirstOrder<'_, S> {
        let (states, inputs) = (self.states(), self.hessian.rows());
        StepFirstOrder {
            next: &self.next,
            phi_x: self.phi_z.block(0, 0, states, states),
            phi_u: self.phi_z.block(0, states, states, inputs - states),
            phi_h: &self.phi_h,
        }
    }

    /// All of it, once the contractions of all stages are added.
    pub fn contraction(&mut self) -> StepContraction<'_, S> {
        let (states, inputs) = (self.states(), self.hessian.rows());
        for i in 0..inputs {
            for j in 0..i {
                self.hessian[(j, i)] = self.hessian[(i, j)];
            }
        }
        self.first();
        let controls = inputs - states;
        StepContraction {
            first: self.seen(),
            xx: self.hessian.block(0, 0, states, states),
            ux: self.hessian.block(states, 0, controls, states),
            uu: self.hessian.block(states, states, controls, controls),
        }
    }

    pub fn clear_hessian(&mut self) {
        self.hessian.fill_zero();
    }

    /// Adds the second derivatives of `mu'f(X, u)` in (x, u), given those in (X, u):
    ///
    /// ```text
    /// [Z ; 0 1]' (mu'f_zz) [Z ; 0 1] ,   Z = dX/d(x, u) ,  (1 0) where none is given.
    /// ```
    ///
    /// Z may have more columns, which are not looked at.
    pub fn add(&mut self, second: &Contraction<'_, S>, z: Option<&Matrix<S>>) {
        let states = self.states();
        match z {
            None => {
                for (i, row) in second.xx.iter_rows().enumerate() {
                    add_scaled(&mut self.hessian.row_mut(i)[..=i], S::one(), row);
                }
                for (j, row) in second.ux.iter().flat_map(|ux| ux.iter_rows()).enumerate() {
                    add_scaled(self.hessian.row_mut(states + j), S::one(), row);
                }
            }
            Some(z) => self.add_transformed(second, z),
        }
        for (j, row) in second.uu.iter().flat_map(|uu| uu.iter_rows()).enumerate() {
            add_scaled(&mut self.hessian.row_mut(states + j)[states..=states + j], S::one(), row);
        }
    }

    /// The lower triangle of `Z' T + (0 ; ux Z)`, `T = xx Z + (0 ux')`.
    fn add_transformed(&mut self, second: &Contraction<'_, S>, z: &Matrix<S>) {
        let (states, inputs) = (self.states(), self.hessian.rows());
        let (entries, stride) = (z.as_slice(), z.columns());
        self.product.fill_zero();
        for (i, row) in second.xx.iter_rows().enumerate() {
            add_rows(self.product.row_mut(i), entries, stride, row.iter().copied().enumerate());
        }
        for (j, row) in second.ux.iter().flat_map(|ux| ux.iter_rows()).enumerate() {
            let target = &mut self.hessian.row_mut(states + j)[..=states + j];
            add_rows(target, entries, stride, row.iter().copied().enumerate());
            for (c, &entry) in row.iter().enumerate() {
                self.product[(c, states + j)] += entry;
            }
        }
        for i in 0..inputs {
            let column = (0..states).map(|c| (c, z[(c, i)]));
            add_rows(&mut self.hessian.row_mut(i)[..=i], self.product.as_slice(), inputs, column);
        }
    }
}
