//! The adjoint product y'F_x: the costate equation without F_x.

use super::Hamiltonian;
use crate::error::EvalError;
use crate::kernels::{LagrangianHessian, Route, check_entries};
use crate::matrix::{add_scaled, dot};
use crate::scalar::Scalar;

/// F and y'F_x at one state; borrowed from the workspace.
#[derive(Clone, Copy, Debug)]
pub struct AdjointProduct<'a, S> {
    /// `dx/dt`, 2n.
    pub f: &'a [S],
    /// `F_x' y`, 2n: minus the rate of a costate y with dy/dt = -F_x' y.
    pub y_f_x: &'a [S],
}

impl<S: Scalar, R: Route> Hamiltonian<S, R> {
    /// F and y'F_x for the costate y = (y_q, y_p) of length 2n, at 1.5 to 2 times the cost of F.
    ///
    /// With `w = (-y_p, y_q + D_v y_p)` and the change of velocity `V w = M^-1 (w_p - P w_q)` along it,
    /// `y'F_x = Hess H w = ( -L_qq w_q - P' V w , V w )`: three matrix-vector products with matrices of the
    /// third stage of kernel one, and one more solve with the factors of M. No matrix is inverted, no two
    /// matrices are multiplied. With floating and spherical joints it is the product with F_x.
    ///
    /// # Errors
    /// See [`Hamiltonian`].
    pub fn adjoint(
        &mut self,
        q: &[S],
        p: &[S],
        u: &[S],
        y: &[S],
    ) -> Result<AdjointProduct<'_, S>, EvalError> {
        let n = self.tree.dof();
        self.check(&[("q", q), ("p", p), ("u", u)])?;
        check_entries(&self.tree, "y", y, 2 * n)?;
        if !self.tree.free().is_empty() {
            self.linearise(q, p, u)?;
            self.product.fill(S::zero());
            let rows = y.iter().zip(0..);
            rows.for_each(|(&y, i)| add_scaled(&mut self.product, y, self.state.f_x.row(i)));
            return Ok(AdjointProduct { f: &self.state.f, y_f_x: &self.product });
        }
        let Self { tree, flow, state, direction, product, .. } = self;
        flow.first_order(tree, q, p)?;
        flow.kernel.second_order(tree);
        state.rate_of_change(tree, &flow.v, flow.kernel.l_q(), u);
        state.add_wrenches(q);
        direction.set_costate(tree, &flow.v, y);
        flow.velocity_change(&direction.q, &direction.p, &mut direction.v);
        let (product_q, product_p) = product.split_at_mut(n);
        product_p.copy_from_slice(&direction.v);
        for (i, entry) in product_q.iter_mut().enumerate() {
            *entry = -dot(flow.kernel.body.l_qq().row(i), &direction.q);
        }
        for (k, &v) in direction.v.iter().enumerate() {
            add_scaled(product_q, -v, flow.kernel.body.l_vq().row(k));
        }
        state.add_wrench_adjoint(q, &y[n..], product);
        Ok(AdjointProduct { f: &self.state.f, y_f_x: &self.product })
    }
}
