//! Robots with floating and spherical joints.
//!
//! q has [`Tree::nq`] entries, v, p, u and all derivatives have n: p is conjugate to v, so that the momentum
//! of a floating joint is that of all that it moves, about the origin of the moved frame, in its axes. State
//! derivatives are those by xi and p, with q (+) xi the configuration moved by `exp(xi)` on the right
//! ([`ConfigurationSpace`](crate::configuration::ConfigurationSpace)): the left-trivialised tangent. F is
//! the rate (v, p'), and y'F_xx the Hessian of `y . F(q (+) xi, p + dp)` at zero, components of F and y
//! being those in the tangent space at either point. It is symmetric.
//!
//! L_q and the blocks of its symmetric second derivative are those of the kernel. Displacements do not commute,
//! which adds to the rows of one joint, with linear and angular parts v = (v, w) and p = (f, m),
//!
//! $$ \dot p = L\_q + K(p)\, v + u, \qquad K(p) = \begin{pmatrix} 0 & \hat f \\\\ \hat f & \hat m \end{pmatrix},
//! \qquad N(v) = \begin{pmatrix} \hat w & 0 \\\\ \hat v & \hat w \end{pmatrix}, \qquad K(p)\, v = -N(v)\, p $$
//!
//! the coadjoint action (J. E. Marsden, T. S. Ratiu, Introduction to Mechanics and Symmetry (1999), section
//! 13.5: the Lie-Poisson bracket), to L_qq half of K(L_q), and N(y_p) times rows of F to y'F_xx.

#[cfg(test)]
mod tests;

use crate::matrix::{Entry, Matrix, add_scaled};
use crate::robot::{FreeKind, Tree};
use crate::scalar::Scalar;

/// The brackets of all floating and spherical joints.
#[derive(Clone, Debug)]
pub(crate) struct Free<S> {
    /// First linear coordinate, if there is one, and first angular one.
    places: Vec<(Option<usize>, usize)>,
    /// Those of K or N computed last.
    entries: Vec<Entry<S>>,
}

impl<S: Scalar> Free<S> {
    /// Without such joints all methods do nothing.
    pub fn new(tree: &Tree) -> Self {
        let place = |at: usize, kind: FreeKind| ((kind.slides() > 0).then_some(at), at + kind.slides());
        let places: Vec<_> =
            tree.free().iter().map(|free| place(free.joint.coordinate, free.joint.kind)).collect();
        Self { entries: Vec::with_capacity(18 * places.len()), places }
    }

    /// K(p) of a momentum, n.
    pub fn of_momentum(&mut self, p: &[S]) -> &[Entry<S>] {
        self.entries.clear();
        for &(linear, angular) in &self.places {
            cross(&mut self.entries, [angular, angular], &p[angular..]);
            if let Some(linear) = linear {
                cross(&mut self.entries, [linear, angular], &p[linear..]);
                cross(&mut self.entries, [angular, linear], &p[linear..]);
            }
        }
        &self.entries
    }

    /// N(v) of a velocity, n.
    pub fn of_velocity(&mut self, v: &[S]) -> &[Entry<S>] {
        self.entries.clear();
        for &(linear, angular) in &self.places {
            cross(&mut self.entries, [angular, angular], &v[angular..]);
            if let Some(linear) = linear {
                cross(&mut self.entries, [linear, linear], &v[angular..]);
                cross(&mut self.entries, [angular, linear], &v[linear..]);
            }
        }
        &self.entries
    }

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

    /// Adds `N(y_p) F^p_x` to the rows and columns of xi in y'F_xx, `N(y_p)' F^q_x` to those of p, for F_x without
    /// friction and [brackets](Self::add_slopes).
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

/// The matrix of `a x` in rows and columns from these on.
fn cross<S: Scalar>(entries: &mut Vec<Entry<S>>, [row, column]: [usize; 2], a: &[S]) {
    for (i, j, value) in [(0, 1, -a[2]), (0, 2, a[1]), (1, 0, a[2]), (1, 2, -a[0]), (2, 0, -a[1]), (2, 1, a[0])] {
        entries.push(Entry { row: row + i, column: column + j, value });
    }
}
