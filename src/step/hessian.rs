//! Second derivatives of a step as the sum over its stages.

use crate::dynamics::Contraction;
use crate::matrix::{Block, Matrix, add_rows, add_scaled};
use crate::scalar::Scalar;

/// The second derivatives of y'Phi in z = (x, u).
#[derive(Clone, Debug)]
pub(super) struct StageHessians<S> {
    /// Only the lower triangle during the summation.
    hessian: Matrix<S>,
    product: Matrix<S>,
}

impl<S: Scalar> StageHessians<S> {
    pub fn new(states: usize, controls: usize) -> Self {
        let inputs = states + controls;
        Self { hessian: Matrix::zeros(inputs, inputs), product: Matrix::zeros(states, inputs) }
    }

    /// The blocks xx, ux and uu, once the contractions of all stages are added.
    pub fn blocks(&mut self) -> [Block<'_, S>; 3] {
        let (states, inputs) = (self.product.rows(), self.hessian.rows());
        for i in 0..inputs {
            for j in 0..i {
                self.hessian[(j, i)] = self.hessian[(i, j)];
            }
        }
        let controls = inputs - states;
        [
            self.hessian.block(0, 0, states, states),
            self.hessian.block(states, 0, controls, states),
            self.hessian.block(states, states, controls, controls),
        ]
    }

    pub fn clear(&mut self) {
        self.hessian.fill_zero();
    }

    /// Adds the second derivatives of `mu'f(X, u)` in (x, u), given those in (X, u):
    ///
    /// ```text
    /// [Z ; 0 1]' (mu'f_zz) [Z ; 0 1] ,   Z = dX/d(x, u) ,  (1 0) if z is `None`.
    /// ```
    ///
    /// Further columns of Z are ignored.
    pub fn add(&mut self, second: &Contraction<'_, S>, z: Option<&Matrix<S>>) {
        let states = self.product.rows();
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
        let (states, inputs) = (self.product.rows(), self.hessian.rows());
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
