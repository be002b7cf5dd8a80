//! The contracted Hessian of the phase velocities by one dual pass through the analytic Jacobian.

use super::conservative::Conservative;
use super::{Hamiltonian, Linearisation, check};
use crate::error::EvalError;
use crate::kernels::friction;
use crate::matrix::{Block, Matrix};
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
/// one dual number ([`Tangent`]), seeded with x' = w, carried through the analytic Jacobian gives the whole matrix. Friction
/// D(v) shifts the direction, `w = (-y_p, y_q + D_v y_p)`, and adds `V' (y_p . D_vv) V`, `V = [-M^-1 P, M^-1]`; the
/// dual pass goes through the conservative part alone.
#[derive(Clone, Debug)]
pub struct SecondOrder<S> {
    first: Hamiltonian<S>,
    tangent: Conservative<Tangent<S>>,
    q: Vec<Tangent<S>>,
    p: Vec<Tangent<S>>,
    y_f_xx: Matrix<S>,
}

/// F, F_x and y'F_xx at one state; borrowed from the workspace.
#[derive(Clone, Copy, Debug)]
pub struct ContractedHessian<'a, S> {
    linearisation: Linearisation<'a, S>,
    y_f_xx: &'a Matrix<S>,
}

impl<'a, S: Scalar> ContractedHessian<'a, S> {
    /// F and F_x.
    pub fn linearisation(&self) -> Linearisation<'a, S> {
        self.linearisation
    }

    /// `sum_k y_k d2 F_k / dx dx`, 2n x 2n, symmetric, rows and columns in the order (q, p).
    pub fn matrix(&self) -> Block<'a, S> {
        self.y_f_xx.view()
    }

    /// Its block in (q, q), n x n.
    pub fn qq(&self) -> Block<'a, S> {
        let n = self.y_f_xx.rows() / 2;
        self.y_f_xx.block(0, 0, n, n)
    }

    /// Its block in (q, p), n x n; that in (p, q) is the transpose.
    pub fn qp(&self) -> Block<'a, S> {
        let n = self.y_f_xx.rows() / 2;
        self.y_f_xx.block(0, n, n, n)
    }

    /// Its block in (p, p), n x n.
    pub fn pp(&self) -> Block<'a, S> {
        let n = self.y_f_xx.rows() / 2;
        self.y_f_xx.block(n, n, n, n)
    }
}

impl<S: Scalar> SecondOrder<S> {
    /// Builds the workspace: all that is ever allocated.
    pub fn new(robot: &Robot) -> Self {
        Self::from_tree(Tree::from(robot))
    }

    /// As [`new`](Self::new), from a model that was turned already.
    pub fn from_tree(tree: Tree) -> Self {
        let n = tree.len();
        let zero = Tangent::zero();
        Self {
            tangent: Conservative::new(&tree),
            first: Hamiltonian::from_tree(tree),
            q: vec![zero; n],
            p: vec![zero; n],
            y_f_xx: Matrix::zeros(2 * n, 2 * n),
        }
    }

    /// F, F_x and `sum_k y_k d2 F_k / dx dx` for the costate y = (y_q, y_p) of length 2n, from one sweep.
    ///
    /// # Errors
    /// See [`Hamiltonian`].
    pub fn contracted_hessian(
        &mut self,
        q: &[S],
        p: &[S],
        u: &[S],
        y: &[S],
    ) -> Result<ContractedHessian<'_, S>, EvalError> {
        let n = self.first.len();
        self.first.check(&[("q", q), ("p", p), ("u", u)])?;
        check(&self.first.tree, "y", y, 2 * n)?;
        if !self.first.tree.is_conservative() {
            self.first.flow.solve_velocity(&self.first.tree, q, p)?;
        }
        let (y_q, y_p) = y.split_at(n);
        for (i, joint) in self.first.tree.joints().iter().enumerate() {
            let mut direction = y_q[i];
            if !joint.friction.is_none() {
                direction += friction(&joint.friction, self.first.flow.v[i]).first * y_p[i];
            }
            self.q[i] = Tangent::new(q[i], -y_p[i]);
            self.p[i] = Tangent::new(p[i], direction);
        }
        self.tangent.first_order(&self.first.tree, &self.q, &self.p)?;
        self.tangent.second_order(&self.first.tree);
        self.tangent.copy_values(&mut self.first.flow);
        self.first.rate_of_change(u);
        self.first.assemble();
        self.take_derivative();
        self.add_friction(y_p);
        Ok(ContractedHessian { linearisation: self.first.linearisation(), y_f_xx: &self.y_f_xx })
    }

    /// `D_w (Hess H)`, `Hess H = [ -F^p,q , -F^p,p ; F^q,q , F^q,p ]` of the conservative part.
    fn take_derivative(&mut self) {
        let n = self.first.len();
        let (w, inverse, reduced) = (&self.tangent.w, &self.tangent.inverse, &self.tangent.reduced);
        for i in 0..n {
            for j in 0..n {
                self.y_f_xx[(i, j)] = -reduced[(i, j)].eps;
                self.y_f_xx[(n + i, j)] = -w[(i, j)].eps;
                self.y_f_xx[(j, n + i)] = -w[(i, j)].eps;
                self.y_f_xx[(n + i, n + j)] = inverse[(i, j)].eps;
            }
        }
    }

    /// Adds `sum_k y_p,k D''_k V_k' V_k`, V_k the k-th row of `[-M^-1 P, M^-1]`.
    fn add_friction(&mut self, y_p: &[S]) {
        for (k, joint) in self.first.tree.joints().iter().enumerate() {
            if joint.friction.coulomb == 0.0 {
                continue;
            }
            let curvature = y_p[k] * self.first.friction[k].second;
            let row = self.first.f_x.row(k);
            for i in 0..row.len() {
                let scaled = curvature * row[i];
                for (j, &v) in row[..=i].iter().enumerate() {
                    self.y_f_xx[(i, j)] += scaled * v;
                    if i != j {
                        self.y_f_xx[(j, i)] += scaled * v;
                    }
                }
            }
        }
    }
}

impl<S: Scalar> Conservative<Tangent<S>> {
    /// The values without their derivatives.
    fn copy_values(&self, values: &mut Conservative<S>) {
        values.v.iter_mut().zip(&self.v).for_each(|(value, dual)| *value = dual.re);
        for i in 0..self.v.len() {
            let rows = [
                (values.w.row_mut(i), self.w.row(i)),
                (values.inverse.row_mut(i), self.inverse.row(i)),
                (values.reduced.row_mut(i), self.reduced.row(i)),
            ];
            for (value, dual) in rows {
                value.iter_mut().zip(dual).for_each(|(value, dual)| *value = dual.re);
            }
        }
        self.kernel.copy_values(&mut values.kernel);
    }
}
