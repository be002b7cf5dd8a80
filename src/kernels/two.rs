//! Kernel two: the derivative of kernel one along a direction.

use super::KernelOne;
use crate::error::{EvalError, check_length};
use crate::matrix::Matrix;
use crate::robot::Tree;
use crate::scalar::{Scalar, Tangent};

/// Kernel two: derivatives of M, P and L_qq along a direction (dq, dv).
#[derive(Clone, Debug)]
pub struct KernelTwo<S> {
    along: KernelOne<Tangent<S>>,
    q: Vec<Tangent<S>>,
    v: Vec<Tangent<S>>,
    mass_matrix: Matrix<S>,
    l_vq: Matrix<S>,
    l_qq: Matrix<S>,
}

impl<S: Scalar> KernelTwo<S> {
    /// Buffers for this tree.
    pub fn new(tree: &Tree) -> Self {
        let n = tree.len();
        let square = Matrix::zeros(n, n);
        Self {
            along: KernelOne::new(tree),
            q: vec![Tangent::zero(); n],
            v: vec![Tangent::zero(); n],
            mass_matrix: square.clone(),
            l_vq: square.clone(),
            l_qq: square,
        }
    }

    /// Derivatives at the position q and velocity v that `kernel` was set to (all three stages) along (dq, dv).
    ///
    /// # Errors
    /// [`EvalError::WrongLength`].
    pub fn differentiate(
        &mut self,
        tree: &Tree,
        kernel: &KernelOne<S>,
        dq: &[S],
        dv: &[S],
    ) -> Result<(), EvalError> {
        check_length("dq", dq, tree.len())?;
        check_length("dv", dv, tree.len())?;
        for i in 0..tree.len() {
            self.q[i] = Tangent::new(kernel.q[i], dq[i]);
            self.v[i] = Tangent::new(kernel.v[i], dv[i]);
        }
        self.along.set_position(tree, &self.q)?;
        self.along.set_velocity(tree, &self.v)?;
        self.along.second_order(tree);
        for i in 0..tree.len() {
            for j in 0..tree.len() {
                self.mass_matrix[(i, j)] = self.along.mass_matrix()[(i, j)].eps;
                self.l_vq[(i, j)] = self.along.l_vq()[(i, j)].eps;
                self.l_qq[(i, j)] = self.along.l_qq()[(i, j)].eps;
            }
        }
        Ok(())
    }

    /// `D M`, n x n, symmetric: with dq = v the rate of the mass matrix.
    pub fn mass_matrix(&self) -> &Matrix<S> {
        &self.mass_matrix
    }

    /// `D P = D L_vq`, n x n.
    pub fn l_vq(&self) -> &Matrix<S> {
        &self.l_vq
    }

    /// `D L_qq`, n x n, symmetric.
    pub fn l_qq(&self) -> &Matrix<S> {
        &self.l_qq
    }
}
