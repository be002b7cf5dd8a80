//! Assembles F and F_x from the conservative part, friction and actuation.

use super::HamiltonianLinearisation;
use super::conservative::Conservative;
use crate::kernels::{FrictionDerivatives, LagrangianHessian, friction_of};
use crate::kinematics::ExternalForces;
use crate::matrix::{Matrix, Panel, add_scaled, filled, sized};
use crate::robot::Tree;
use crate::scalar::Scalar;

/// `F = (v, L_q + D + u)` and its Jacobian.
#[derive(Clone, Debug)]
pub(super) struct StateEquation<S: Scalar> {
    pub friction: Vec<FrictionDerivatives<S>>,
    pub f: Vec<S>,
    pub f_x: Matrix<S>,
    /// `(0; 1)`.
    f_u: Matrix<S>,
    /// `W'`.
    across: Panel<S>,
    /// Wrenches from outside, if the robot has any.
    pub external: Option<Box<ExternalForces<S>>>,
}

impl<S: Scalar> StateEquation<S> {
    #[inline(never)]
    pub fn new(tree: &Tree) -> Self {
        let n = tree.dof();
        let none = FrictionDerivatives { value: S::zero(), first: S::zero(), second: S::zero() };
        let mut f_u = Matrix::zeros(2 * n, n);
        (0..n).for_each(|i| f_u[(n + i, i)] = S::one());
        Self {
            friction: filled(none, n),
            f: filled(S::zero(), 2 * n),
            f_x: Matrix::zeros(2 * n, 2 * n),
            f_u,
            across: Panel::zeros(n, n),
            external: ExternalForces::where_any(tree),
        }
    }

    /// Fills f: `(v, L_q + D + u)`.
    #[inline(never)]
    pub fn rate_of_change(&mut self, tree: &Tree, v: &[S], l_q: &[S], u: &[S]) {
        let (f_q, f_p) = self.f.split_at_mut(tree.dof());
        f_q.copy_from_slice(v);
        for (f_p, (&l_q, &u)) in f_p.iter_mut().zip(l_q.iter().zip(u)) {
            *f_p = l_q + u;
        }
        for &i in tree.with_friction() {
            self.friction[i] = friction_of(tree, i, v[i]);
            f_p[i] += self.friction[i].value;
        }
    }

    /// Assembles F_x without friction from the blocks of the conservative part.
    #[inline(never)]
    pub fn assemble<K>(&mut self, tree: &Tree, flow: &Conservative<S, K>) {
        let blocks = [&flow.w, &flow.inverse, &flow.reduced];
        sized!(S, tree.dof(), self.place(blocks));
    }

    /// The same, where the conservative part computes the blocks in place.
    #[inline(never)]
    pub fn assemble_by_blocks<K: LagrangianHessian<S>>(&mut self, flow: &mut Conservative<S, K>) {
        flow.place_blocks(&mut self.f_x);
    }

    /// Adds `D_v V`, `V = [-W, M^-1]` the upper half of F_x, to the lower half.
    pub fn add_slopes(&mut self, tree: &Tree) {
        for &i in tree.with_friction() {
            let slope = self.friction[i].first;
            let (row, v) = self.f_x.row_mut_and_above(tree.dof() + i, i);
            add_scaled(row, slope, v);
        }
    }

    /// Copies the blocks into the matrix.
    fn place<const N: usize, const W: usize>(&mut self, [w, inverse, reduced]: [&Panel<S>; 3]) {
        let n = if N > 0 { N } else { w.rows() };
        [&self.across, w, inverse, reduced].into_iter().for_each(Panel::has_size::<N, W>);
        self.across.take_transpose::<W>(w);
        for i in 0..n {
            let (left, right) = self.f_x.row_mut(i)[..2 * n].split_at_mut(n);
            w.write_row::<W>(i, left, |w| -w);
            inverse.write_row::<W>(i, right, |entry| entry);
            let (left, right) = self.f_x.row_mut(n + i)[..2 * n].split_at_mut(n);
            reduced.write_row::<W>(i, left, |entry| entry);
            self.across.write_row::<W>(i, right, |entry| entry);
        }
    }

    /// Adds `sum_k y_p,k D''_k V_k' V_k`, V_k the k-th row of `V = [-M^-1 P, M^-1]`, to both triangles.
    pub fn add_curvature(&self, tree: &Tree, y_p: &[S], y_f_xx: &mut Matrix<S>) {
        for &k in tree.with_friction() {
            if !tree.has_coulomb_friction(k) {
                continue;
            }
            let (curvature, row) = (y_p[k] * self.friction[k].second, self.f_x.row(k));
            for i in 0..row.len() {
                let scaled = curvature * row[i];
                for (j, &v) in row[..=i].iter().enumerate() {
                    y_f_xx[(i, j)] += scaled * v;
                    y_f_xx[(j, i)] = y_f_xx[(i, j)];
                }
            }
        }
    }

    pub fn linearisation<'a>(&'a self, mass_matrix: &'a Matrix<S>) -> HamiltonianLinearisation<'a, S> {
        HamiltonianLinearisation { f: &self.f, f_x: &self.f_x, f_u: &self.f_u, mass_matrix }
    }
}
