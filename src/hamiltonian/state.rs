//! F and F_x put together from the conservative part, friction and actuation.

use super::Linearisation;
use super::conservative::Conservative;
use crate::kernels::{FrictionDerivatives, friction};
use crate::matrix::Matrix;
use crate::robot::Tree;
use crate::scalar::Scalar;

/// `F = (v, L_q + D + u)` and its Jacobian.
#[derive(Clone, Debug)]
pub(super) struct StateEquation<S> {
    pub friction: Vec<FrictionDerivatives<S>>,
    pub f: Vec<S>,
    pub f_x: Matrix<S>,
    /// `(0; 1)`.
    f_u: Matrix<S>,
}

impl<S: Scalar> StateEquation<S> {
    pub fn new(tree: &Tree) -> Self {
        let n = tree.len();
        let none = FrictionDerivatives { value: S::zero(), first: S::zero(), second: S::zero() };
        let mut f_u = Matrix::zeros(2 * n, n);
        (0..n).for_each(|i| f_u[(n + i, i)] = S::one());
        Self { friction: vec![none; n], f: vec![S::zero(); 2 * n], f_x: Matrix::zeros(2 * n, 2 * n), f_u }
    }

    /// Fills f: `(v, L_q + D + u)`.
    pub fn rate_of_change(&mut self, tree: &Tree, v: &[S], l_q: &[S], u: &[S]) {
        let (f_q, f_p) = self.f.split_at_mut(tree.len());
        f_q.copy_from_slice(v);
        for (i, joint) in tree.joints().iter().enumerate() {
            f_p[i] = l_q[i] + u[i];
            if !joint.friction.is_none() {
                self.friction[i] = friction(&joint.friction, v[i]);
                f_p[i] += self.friction[i].value;
            }
        }
    }

    /// Puts F_x together from the blocks of the conservative part and the slopes of friction.
    pub fn assemble<K>(&mut self, tree: &Tree, flow: &Conservative<S, K>) {
        let n = tree.len();
        let (w, inverse, reduced) = (&flow.w, &flow.inverse, &flow.reduced);
        for (i, joint) in tree.joints().iter().enumerate() {
            let (left, right) = self.f_x.row_mut(i).split_at_mut(n);
            left.iter_mut().zip(w.row(i)).for_each(|(entry, &w)| *entry = -w);
            right.copy_from_slice(inverse.row(i));
            let (left, right) = self.f_x.row_mut(n + i).split_at_mut(n);
            left.copy_from_slice(reduced.row(i));
            for (j, entry) in right.iter_mut().enumerate() {
                *entry = w[(j, i)];
            }
            if !joint.friction.is_none() {
                let slope = self.friction[i].first;
                left.iter_mut().zip(w.row(i)).for_each(|(entry, &w)| *entry -= slope * w);
                right.iter_mut().zip(inverse.row(i)).for_each(|(entry, &inverse)| *entry += slope * inverse);
            }
        }
    }

    /// Adds `sum_k y_p,k D''_k V_k' V_k`, V_k the k-th row of `V = [-M^-1 P, M^-1]`, to both triangles.
    pub fn add_curvature(&self, tree: &Tree, y_p: &[S], y_f_xx: &mut Matrix<S>) {
        for (k, joint) in tree.joints().iter().enumerate() {
            if joint.friction.coulomb == 0.0 {
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

    pub fn linearisation<'a>(&'a self, mass_matrix: &'a Matrix<S>) -> Linearisation<'a, S> {
        Linearisation { f: &self.f, f_x: &self.f_x, f_u: &self.f_u, mass_matrix }
    }
}
