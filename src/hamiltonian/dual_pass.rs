//! The contracted Hessian of the state equation by one dual pass through the analytic Jacobian.

use super::conservative::Conservative;
use super::{Hamiltonian, HamiltonianContraction, check};
use crate::error::EvalError;
use crate::kernels::{Contracted, Route};
use crate::matrix::{Matrix, filled};
use crate::robot::{Robot, Tree};
use crate::scalar::{Scalar, Tangent};

/// Workspace for F, F_x and y'F_xx of one robot; no call allocates.
///
/// F without friction is J grad H, so `y'F = w . grad H` with `w = (-y_p, y_q)` and
///
/// ```text
/// y'F_xx = D_w (Hess H) ,   Hess H = J^-1 F_x :
/// ```
///
/// one dual number ([`Tangent`]), seeded with x' = w, carried through the analytic Jacobian gives the whole
/// matrix. Friction D(v) shifts the direction, `w = (-y_p, y_q + D_v y_p)`, and adds `V' (y_p . D_vv) V`,
/// `V = [-M^-1 P, M^-1]`; the dual pass covers the conservative part only.
///
/// An alternative to [`HamiltonianSecondOrder`](super::HamiltonianSecondOrder), and the method for every
/// other [`Route`].
#[derive(Clone, Debug)]
pub struct DualPass<S: Scalar, R: Route = Contracted> {
    first: Hamiltonian<S, R>,
    tangent: Conservative<Tangent<S>, R::Hessian<Tangent<S>>>,
    l_q: Vec<S>,
    mass_matrix: Matrix<S>,
    q: Vec<Tangent<S>>,
    p: Vec<Tangent<S>>,
    y_f_xx: Matrix<S>,
}

impl<S: Scalar> DualPass<S> {
    /// Builds the workspace. Later calls do not allocate.
    pub fn new(robot: &Robot) -> Self {
        Self::from_tree(Tree::from(robot))
    }

    /// As [`new`](Self::new), from an existing [`Tree`].
    pub fn from_tree(tree: Tree) -> Self {
        Self::with_route(tree, Contracted)
    }
}

impl<S: Scalar, R: Route> DualPass<S, R> {
    /// The workspace of another route, as [`Hamiltonian::with_route`].
    pub fn with_route(tree: Tree, route: R) -> Self {
        let n = tree.dof();
        let zero = Tangent::zero();
        Self {
            tangent: Conservative::new(&tree),
            first: Hamiltonian::with_route(tree, route),
            l_q: filled(S::zero(), n),
            mass_matrix: Matrix::zeros(n, n),
            q: filled(zero, n),
            p: filled(zero, n),
            y_f_xx: Matrix::zeros(2 * n, 2 * n),
        }
    }

    /// Number of coordinates, n.
    pub fn dof(&self) -> usize {
        self.first.dof()
    }

    /// The first-order workspace: F and F_x.
    pub fn first(&mut self) -> &mut Hamiltonian<S, R> {
        &mut self.first
    }

    /// F, F_x and `sum_k y_k d2 F_k / dx dx` for the costate y = (y_q, y_p) of length 2n, from one sweep.
    ///
    /// # Errors
    /// See [`Hamiltonian`].
    #[inline(never)]
    pub fn contract(
        &mut self,
        q: &[S],
        p: &[S],
        u: &[S],
        y: &[S],
    ) -> Result<HamiltonianContraction<'_, S>, EvalError> {
        let n = self.first.dof();
        self.first.tree.refuse_free()?;
        self.first.check(&[("q", q), ("p", p), ("u", u)])?;
        check(&self.first.tree, "y", y, 2 * n)?;
        if !self.first.tree.is_conservative() {
            self.first.flow.solve_velocity(&self.first.tree, q, p)?;
        }
        let Hamiltonian { tree, flow, direction, .. } = &mut self.first;
        direction.set_costate(tree, &flow.v, y);
        for i in 0..n {
            self.q[i] = Tangent::new(q[i], direction.q[i]);
            self.p[i] = Tangent::new(p[i], direction.p[i]);
        }
        self.tangent.first_order(&self.first.tree, &self.q, &self.p)?;
        self.tangent.second_order(&self.first.tree);
        self.take_values();
        let Hamiltonian { tree, flow, state, .. } = &mut self.first;
        state.rate_of_change(tree, &flow.v, &self.l_q, u);
        state.add_wrenches(q);
        state.assemble(tree, flow);
        state.add_slopes(tree);
        state.add_wrench_slopes(q);
        self.take_derivative();
        self.first.state.add_curvature(&self.first.tree, &y[n..], &mut self.y_f_xx);
        self.first.state.add_wrench_curvature(q, &y[n..], &mut self.y_f_xx);
        let linearisation = self.first.state.linearisation(&self.mass_matrix);
        Ok(HamiltonianContraction { linearisation, y_f_xx: &self.y_f_xx })
    }

    /// The values of the dual pass without their derivatives.
    fn take_values(&mut self) {
        fn take<S: Scalar>(values: &mut [S], duals: &[Tangent<S>]) {
            values.iter_mut().zip(duals).for_each(|(value, dual)| *value = dual.re);
        }
        let (flow, tangent) = (&mut self.first.flow, &self.tangent);
        take(&mut flow.v, &tangent.v);
        take(&mut self.l_q, tangent.kernel.l_q());
        for i in 0..self.l_q.len() {
            take(self.mass_matrix.row_mut(i), tangent.kernel.mass_matrix().row(i));
            for j in 0..self.l_q.len() {
                flow.w.set(i, j, tangent.w.get(i, j).re);
                flow.inverse.set(i, j, tangent.inverse.get(i, j).re);
                flow.reduced.set(i, j, tangent.reduced.get(i, j).re);
            }
        }
    }

    /// `D_w (Hess H)`, `Hess H = [ -F^p,q , -F^p,p ; F^q,q , F^q,p ]` of the conservative part.
    fn take_derivative(&mut self) {
        let n = self.first.dof();
        let (w, inverse, reduced) = (&self.tangent.w, &self.tangent.inverse, &self.tangent.reduced);
        for i in 0..n {
            for j in 0..n {
                self.y_f_xx[(i, j)] = -reduced.get(i, j).eps;
                self.y_f_xx[(n + i, j)] = -w.get(i, j).eps;
                self.y_f_xx[(j, n + i)] = -w.get(i, j).eps;
                self.y_f_xx[(n + i, n + j)] = inverse.get(i, j).eps;
            }
        }
    }
}
