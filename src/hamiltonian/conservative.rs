//! The part without friction and actuation: `x' = J grad H`, and Hess H.

use crate::error::EvalError;
use crate::kernels::{Factor, LagrangianHessian};
use crate::matrix::{Panel, dot, sized, sum_rows};
use crate::robot::Tree;
use crate::scalar::Scalar;

/// `v = M^-1 p`, L_q and the blocks from which F_x and Hess H are put together.
#[derive(Clone, Debug)]
pub(super) struct Conservative<S: Scalar, K> {
    pub kernel: K,
    pub factor: Factor<S>,
    /// `v = M^-1 p`.
    pub v: Vec<S>,
    /// `W = M^-1 P = -F^q,q`.
    pub w: Panel<S>,
    /// `Z = D^-1 L'^-1 P`; W = L^-1 Z.
    pub z: Panel<S>,
    /// `M^-1 = F^q,p`, at and below the diagonal.
    pub inverse: Panel<S>,
    /// `L_qq - P' M^-1 P = F^p,q`, at and below the diagonal.
    pub reduced: Panel<S>,
    half: Panel<S>,
}

impl<S: Scalar, K: LagrangianHessian<S>> Conservative<S, K> {
    pub fn new(tree: &Tree) -> Self {
        let n = tree.len();
        let square = Panel::zeros(n, n);
        Self {
            kernel: K::new(tree),
            factor: Factor::new(tree),
            v: vec![S::zero(); n],
            w: square.clone(),
            z: square.clone(),
            inverse: square.clone(),
            reduced: square.clone(),
            half: square,
        }
    }

    /// M(q) and its factors.
    pub fn factor(&mut self, tree: &Tree, q: &[S]) -> Result<(), EvalError> {
        self.kernel.set_position(tree, q)?;
        let singular = |k: usize| EvalError::SingularMassMatrix { joint: tree.name(k).into() };
        let size_of = |k| self.kernel.size_of_entry(tree, k);
        self.factor.factor(self.kernel.mass_matrix(), size_of).map_err(singular)
    }

    /// `v = M^-1 p` (17).
    pub fn solve_velocity(&mut self, tree: &Tree, q: &[S], p: &[S]) -> Result<(), EvalError> {
        self.factor(tree, q)?;
        self.v.copy_from_slice(p);
        self.factor.solve(&mut self.v);
        Ok(())
    }

    /// v and L_q (17).
    pub fn first_order(&mut self, tree: &Tree, q: &[S], p: &[S]) -> Result<(), EvalError> {
        self.solve_velocity(tree, q, p)?;
        self.kernel.set_velocity(tree, &self.v)
    }

    /// `V d = M^-1 (d_p - P d_q)`: the change of v along d = (d_q, d_p), after the third stage of the kernel.
    pub fn velocity_change(&self, d_q: &[S], d_p: &[S], change: &mut [S]) {
        for ((change, &d_p), i) in change.iter_mut().zip(d_p).zip(0..) {
            *change = d_p - dot(self.kernel.l_vq().row(i), d_q);
        }
        self.factor.solve(change);
    }

    /// W, M^-1 and `L_qq - P' M^-1 P` (21), after [`first_order`](Self::first_order).
    ///
    /// With `Y = L'^-1 P` and `Z = D^-1 Y`: `P' M^-1 P = Y' Z`, `W = L^-1 Z`.
    pub fn second_order(&mut self, tree: &Tree) {
        self.kernel.second_order(tree);
        sized!(S, tree.len(), self.eliminate_velocities());
    }

    fn eliminate_velocities<const N: usize, const W: usize>(&mut self) {
        let n = if N > 0 { N } else { self.z.rows() };
        // First what does not need the entries of P and L_qq, which were stored one by one just before.
        self.factor.form_inverse::<N, W>(&mut self.inverse);
        self.half.read::<N>(self.kernel.l_vq());
        self.factor.first_half::<N, W>(&mut self.half);
        self.factor.divide_by_pivots::<W>(&self.half, &mut self.z);
        for i in 0..n {
            self.reduced.read_row::<N>(i, self.kernel.l_qq().row(i));
            let column = (0..n).map(|k| (k, -self.half.splat::<W>(k, i)));
            // Up to the diagonal, or all where that is free.
            let target = &mut self.reduced.row_mut(i)[..Panel::<S>::width_up_to::<W>(i + 1)];
            sum_rows::<W, S::Pack>(target, self.z.packs(), self.z.width::<W>(), column);
        }
        self.w.copy_from::<N, W>(&self.z);
        self.factor.second_half::<N, W>(&mut self.w);
    }
}
