//! Contracted second derivatives of accelerations and forces in (q, v, u), by one adjoint solution.

use super::blocks::Moving;
use super::lagrangian_rows::RowHessian;
use super::{AccelerationLinearisation, ConstrainedLagrangian};
use crate::error::{EvalError, check_length};
use crate::kernels::check_entries;
use crate::lagrangian::LagrangianSecondOrder;
use crate::matrix::{Block, Matrix, add_scaled, filled};
use crate::robot::Robot;
use crate::scalar::Scalar;

/// Workspace for a, lambda, their Jacobians and contracted second derivatives in z = (q, v, u); no call
/// allocates.
///
/// With r(z, s) = 0 the equations of [`ConstrainedLagrangian`], s = (a, lambda), and weights (e, c),
///
/// $$ (e \cdot a + c \cdot \lambda)\_{zz} = -\begin{pmatrix} 1 \\\\ s\_z \end{pmatrix}^T (m \cdot
/// r)\_{(z s)(z s)} \begin{pmatrix} 1 \\\\ s\_z \end{pmatrix}, \qquad r\_s^T m = \begin{pmatrix} e \\\\ c
/// \end{pmatrix} $$
///
/// no second derivative of s enters (2n+1 rule). With m = (m_1, m_2), `m . r` consists of the power `m_1 .
/// tau` of inverse dynamics, of `lambda . J m_1`, and of `m_2 . (J a + J'v)`, the second derivative of `m_2 .
/// g` along a motion with this velocity and acceleration: both derivatives of rows are tangents of the same
/// code.
#[derive(Clone, Debug)]
pub struct ConstrainedLagrangianSecondOrder<S: Scalar> {
    first: ConstrainedLagrangian<S>,
    open: LagrangianSecondOrder<S>,
    /// The rows with lambda, along m_1.
    held: Moving<S>,
    of_rows: RowHessian<S>,
    /// m_1 and minus m_2.
    adjoint: [Vec<S>; 2],
    /// `(m . r)` by (q, v) twice, and by (a, lambda) and q.
    curvature: Matrix<S>,
    mixed: [Matrix<S>; 2],
    zz: Matrix<S>,
}

impl<S: Scalar> ConstrainedLagrangianSecondOrder<S> {
    /// Builds the workspace. Later calls do not allocate.
    pub fn new(robot: &Robot) -> Self {
        let first = ConstrainedLagrangian::new(robot);
        let (n, k) = (first.dof(), first.lambda.len());
        Self {
            open: LagrangianSecondOrder::new(&robot.without_constraints()),
            held: Moving::new(&first.solver.tree),
            of_rows: RowHessian::new(n, k),
            adjoint: [filled(S::zero(), n), filled(S::zero(), k)],
            curvature: Matrix::zeros(2 * n, 2 * n),
            mixed: [Matrix::zeros(n, n), Matrix::zeros(k, n)],
            zz: Matrix::zeros(3 * n, 3 * n),
            first,
        }
    }

    /// Number of coordinates, n.
    pub fn dof(&self) -> usize {
        self.first.dof()
    }

    /// The first-order workspace: a, lambda and their Jacobians.
    pub fn first(&mut self) -> &mut ConstrainedLagrangian<S> {
        &mut self.first
    }

    /// The same, to read from.
    pub fn constrained(&self) -> &ConstrainedLagrangian<S> {
        &self.first
    }

    /// a, lambda, their Jacobians, and `sum e_i d2 a_i / dz dz + sum c_i d2 lambda_i / dz dz`, z = (q, v, u),
    /// for the weights e (n) of the accelerations and c (k) of the forces. A zero e or c leaves the other.
    ///
    /// # Errors
    /// See [`ConstrainedLagrangian`].
    pub fn contract(
        &mut self,
        [q, v, u]: [&[S]; 3],
        e: &[S],
        c: &[S],
    ) -> Result<AccelerationContraction<'_, S>, EvalError> {
        let Self { first, adjoint: [m_1, m_2], .. } = self;
        check_entries(&first.solver.tree, "e", e, first.dof())?;
        check_length("c", c, first.lambda.len())?;
        first.linearise(q, v, u)?;
        // (M J'; -J 0) (m_1; m_2) = (e; c): the symmetric matrix for (m_1; -m_2).
        m_1.copy_from_slice(e);
        m_2.copy_from_slice(c);
        first.solver.kkt.solve(&first.solver.factor, m_1, m_2);
        self.differentiate(q, v)?;
        self.transform();
        Ok(AccelerationContraction { linearisation: self.first.linearisation(), zz: &self.zz })
    }

    /// The blocks of `(m . r)_(zs)(zs)`.
    #[inline(never)]
    fn differentiate(&mut self, q: &[S], v: &[S]) -> Result<(), EvalError> {
        let Self { first, open, held, of_rows, adjoint: [m_1, m_2], curvature, mixed, .. } = self;
        of_rows.take(first, held, [m_1, m_2], [q, v]);
        let n = v.len();
        let torque = open.contract_inverse_dynamics(q, v, &first.a, m_1)?;
        let ([in_a, in_lambda], zz, rows) = (mixed, torque.zz(), &of_rows.matrix);
        for i in 0..2 * n {
            for j in 0..2 * n {
                curvature[(i, j)] = zz[(i, j)] + rows[(i, j)];
            }
        }
        for i in 0..n {
            for j in 0..n {
                in_a[(i, j)] = zz[(2 * n + i, j)] + rows[(2 * n + i, j)];
            }
        }
        for i in 0..in_lambda.rows() {
            let slope = held.blocks.slope.row(i).iter();
            in_lambda.row_mut(i).iter_mut().zip(slope).for_each(|(to, &slope)| *to = -slope);
        }
        Ok(())
    }

    /// `-(1; s_z)' (m . r)'' (1; s_z)`: besides the block of (q, v) only products with columns of q.
    #[inline(never)]
    fn transform(&mut self) {
        let Self { first, curvature, mixed: [in_a, in_lambda], zz, .. } = self;
        let n = first.a.len();
        zz.fill_zero();
        for i in 0..3 * n {
            let row = &mut zz.row_mut(i)[..n];
            for l in 0..n {
                add_scaled(row, -first.a_z[(l, i)], in_a.row(l));
            }
            for l in 0..in_lambda.rows() {
                add_scaled(row, -first.lambda_z[(l, i)], in_lambda.row(l));
            }
        }
        // The transposed product, and the block of (q, v).
        for i in 0..3 * n {
            for j in 0..=i {
                let mut entry = zz[(i, j)];
                if i < n {
                    entry += zz[(j, i)];
                }
                if i < 2 * n {
                    entry -= curvature[(i, j)];
                }
                zz[(i, j)] = entry;
            }
        }
        for i in 0..3 * n {
            for j in 0..i {
                zz[(j, i)] = zz[(i, j)];
            }
        }
    }
}

/// a, lambda, their Jacobians and one contracted second derivative at one state; borrowed from the workspace.
#[derive(Clone, Copy, Debug)]
pub struct AccelerationContraction<'a, S> {
    linearisation: AccelerationLinearisation<'a, S>,
    zz: &'a Matrix<S>,
}

impl<'a, S: Scalar> AccelerationContraction<'a, S> {
    /// a, lambda and their Jacobians.
    pub fn linearisation(&self) -> AccelerationLinearisation<'a, S> {
        self.linearisation
    }

    /// `(e . a + c . lambda)_zz`, 3n x 3n, symmetric, rows and columns in the order (q, v, u).
    pub fn matrix(&self) -> Block<'a, S> {
        self.zz.view()
    }
}
