//! Robots with floating and spherical joints.
//!
//! q has [`Tree::nq`](crate::robot::Tree::nq) entries, v, p, u and all derivatives have n: p is conjugate to
//! v, so that the momentum of a floating joint is that of all that it moves, about the origin of the moved
//! frame, in its axes. State derivatives are those by xi and p, with q (+) xi the configuration moved by
//! `exp(xi)` on the right ([`ConfigurationSpace`](crate::configuration::ConfigurationSpace)): the
//! left-trivialised tangent. F is the rate (v, p'), and y'F_xx the Hessian of `y . F(q (+) xi, p + dp)` at
//! zero, components of F and y being those in the tangent space at either point. It is symmetric.
//!
//! The kernel gives L_q and the symmetric part of L_qq. [`Brackets`] add `K(p) v` to p', half of K(L_q) to
//! L_qq, and rows of F_x to y'F_xx. Without such joints they have no entries.

#[cfg(test)]
mod tests;

use crate::configuration::Brackets;
use crate::matrix::{Matrix, add_scaled};
use crate::scalar::Scalar;

impl<S: Scalar> Brackets<S> {
    /// Adds `K(p) v` to F, whose first half is v.
    pub fn add_rate(&mut self, p: &[S], f: &mut [S]) {
        let (v, f_p) = f.split_at_mut(p.len());
        self.of_momentum(p).iter().for_each(|e| f_p[e.row] += e.value * v[e.column]);
    }

    /// Adds its Jacobian, and half of K(L_q), to F_x, at v.
    pub fn add_slopes(&mut self, [p, v, l_q]: [&[S]; 3], f_x: &mut Matrix<S>) {
        let n = v.len();
        for e in self.of_momentum(p) {
            let (row, source) = f_x.row_mut_and_above(n + e.row, e.column);
            add_scaled(row, e.value, source);
        }
        self.of_momentum(l_q).iter().for_each(|e| f_x[(n + e.row, e.column)] += e.value.times(0.5));
        self.of_velocity(v).iter().for_each(|e| f_x[(n + e.row, n + e.column)] -= e.value);
    }

    /// Adds the derivative of `y_p . K(p) v` by v to the weights of v, for `minus_y = -y_p`.
    pub fn add_weights(&mut self, p: &[S], minus_y: &[S], weights: &mut [S]) {
        self.of_momentum(p).iter().for_each(|e| weights[e.row] += e.value * minus_y[e.column]);
    }

    /// Adds `N(y_p) F^p_x` to the rows and columns of xi in y'F_xx, `N(y_p)' F^q_x` to those of p, for F_x
    /// without friction and [brackets](Self::add_slopes).
    pub fn add_curvature(&mut self, y_p: &[S], f_x: &Matrix<S>, y_f_xx: &mut Matrix<S>) {
        let n = y_p.len();
        for e in self.of_velocity(y_p) {
            for (to, from) in [(e.row, n + e.column), (n + e.column, e.row)] {
                for (j, &entry) in f_x.row(from).iter().enumerate() {
                    y_f_xx[(to, j)] += e.value * entry;
                    y_f_xx[(j, to)] += e.value * entry;
                }
            }
        }
    }
}
