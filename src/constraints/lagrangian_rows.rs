//! What the rows of constraints give to derivatives of accelerations and forces in (q, v, u), with
//!
//! $$ r = \begin{pmatrix} \tau - J^T \lambda - u \\\\ J a + \dot J v \end{pmatrix} $$
//!
//! Derivatives by q are those in the tangent space: see `constraints/blocks.rs`.

use super::blocks::{Moving, take};
use super::{ConstrainedLagrangian, Constraints};
use crate::matrix::{Matrix, add_scaled, filled};
use crate::scalar::{Scalar, Tangent};

/// All entries of a square matrix.
fn pairs(n: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..n).flat_map(move |i| (0..n).map(move |j| (i, j)))
}

/// Adds `J'lambda`, on the joints.
pub(super) fn add_forces<S: Scalar>(rows: &Constraints<S>, lambda: &[S], force: &mut [S]) {
    for (i, &lambda) in lambda.iter().enumerate() {
        add_scaled(force, lambda, rows.jacobian().row(i));
    }
}

impl<S: Scalar> ConstrainedLagrangian<S> {
    /// `(J'lambda)_q`, and the derivatives of `J a + J'v` by q and v, at lambda and a.
    ///
    /// With `s = (J v)_q` and its rate they are `s' + s N(v)'` and `2 s - J N(v)'`.
    pub(super) fn move_rows(&mut self, q: &[S], v: &[S]) {
        let Self { solver, twice, a, lambda, curvature, moving: [by_q, by_v], .. } = self;
        twice.place(q, v, a);
        curvature.copy_from(solver.rows.contract(lambda));
        let slope = &twice.rows.blocks.slope;
        take(slope, by_q, |entry| entry.eps);
        take(slope, by_v, |entry| entry.re.times(2.0));
        for e in solver.brackets.of_velocity(v) {
            for i in 0..by_q.rows() {
                by_q[(i, e.row)] += e.value * slope[(i, e.column)].re;
                by_v[(i, e.row)] -= e.value * solver.rows.jacobian()[(i, e.column)];
            }
        }
    }
}

/// Second derivatives of the rows, contracted with m_1 and m_2.
#[derive(Clone, Debug)]
pub(super) struct RowHessian<S> {
    /// That of `m_2 . (J a + J'v) - m_1 . J'lambda` in (q, v, a).
    pub matrix: Matrix<S>,
    /// m_2, as constants.
    weights: Vec<Tangent<S>>,
}

impl<S: Scalar> RowHessian<S> {
    pub fn new(n: usize, k: usize) -> Self {
        Self { matrix: Matrix::zeros(3 * n, 3 * n), weights: filled(Tangent::zero(), k) }
    }

    /// At the last state of `first`, for m = (m_1, -m_2); `held` gets `(J m_1)_q` as its slope.
    ///
    /// With C and B the blocks `(J'm_2)_q` and `(m_2 . J v)_qq`, and their rates
    ///
    /// ```text
    /// qq = B' + N(v) B + (N(v) B)'     qv = 2 (C'^T + N(v) C^T) + (N(v) C)^T     qa = C^T     vv = C + C^T
    /// ```
    #[inline(never)]
    pub fn take(
        &mut self,
        first: &mut ConstrainedLagrangian<S>,
        held: &mut Moving<S>,
        [m_1, m_2]: [&[S]; 2],
        [q, v]: [&[S]; 2],
    ) {
        let ConstrainedLagrangian { solver, twice, lambda, .. } = first;
        for (to, &m) in self.weights.iter_mut().zip(m_2) {
            *to = Tangent::new(-m, S::zero());
        }
        held.place(q, m_1, lambda);
        twice.rows.contract(&twice.v, &self.weights);
        let (c, b) = (&twice.rows.blocks.curvature, &twice.rows.blocks.bend);
        let (n, matrix) = (v.len(), &mut self.matrix);
        matrix.fill_zero();
        for (i, j) in pairs(n) {
            matrix[(i, j)] = b[(i, j)].eps - held.blocks.bend[(i, j)];
            matrix[(i, n + j)] = c[(j, i)].eps.times(2.0);
            matrix[(n + i, n + j)] = c[(i, j)].re + c[(j, i)].re;
            (matrix[(2 * n + j, i)], matrix[(i, 2 * n + j)]) = (c[(j, i)].re, c[(j, i)].re);
        }
        for e in solver.brackets.of_velocity(v) {
            for j in 0..n {
                let bend = e.value * b[(e.column, j)].re;
                matrix[(e.row, j)] += bend;
                matrix[(j, e.row)] += bend;
                matrix[(e.row, n + j)] += e.value.times(2.0) * c[(j, e.column)].re;
                matrix[(j, n + e.row)] += e.value * c[(e.column, j)].re;
            }
        }
        pairs(n).for_each(|(i, j)| matrix[(n + j, i)] = matrix[(i, n + j)]);
    }
}
