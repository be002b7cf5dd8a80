//! Robots with floating and spherical joints.
//!
//! q has [`Tree::nq`] entries, v, p, u and all derivatives have n: p is conjugate to v, so that the momentum
//! of a floating joint is that of all that it moves, about the origin of the moved frame, in its axes. State
//! derivatives are those by xi and p, with q (+) xi the configuration moved by `exp(xi)` on the right
//! ([`ConfigurationSpace`](crate::configuration::ConfigurationSpace)): the left-trivialised tangent. F is
//! the rate (v, p'), and y'F_xx the Hessian of `y . F(q (+) xi, p + dp)` at zero, components of F and y
//! being those in the tangent space at either point. It is symmetric.

mod part;
#[cfg(test)]
mod tests;

use crate::matrix::{Entry, Matrix, add_scaled, filled};
use crate::robot::Tree;
use crate::scalar::Scalar;
use part::Part;

/// What the state equation needs besides that of the chains of joints.
#[derive(Clone, Debug)]
pub(crate) struct Free<S: Scalar> {
    pub(crate) parts: Vec<Part<S>>,
    /// p in the chart, u without that of free joints.
    pub(crate) p: Vec<S>,
    pub(crate) u: Vec<S>,
    /// y of the chart in the axes of the frames, and in those of the parents.
    pub(crate) y: Vec<S>,
    pub(crate) y_chart: Vec<S>,
    pub(crate) mass_matrix: Matrix<S>,
    /// y'F_x of the chart, by (xi, pi) of free joints, and a sum of rows of F_x.
    slope: Vec<S>,
    sum: Vec<S>,
    /// See [`momentum_slope`](Self::momentum_slope).
    less: Vec<Entry<S>>,
}

impl<S: Scalar> Free<S> {
    /// `None` for a robot without such joints.
    pub fn where_any(tree: &Tree) -> Option<Box<Self>> {
        let n = tree.dof();
        let parts: Vec<Part<S>> = tree.free().iter().map(Part::new).collect();
        (!parts.is_empty()).then(|| {
            Box::new(Self {
                parts,
                p: filled(S::zero(), n),
                u: filled(S::zero(), n),
                y: filled(S::zero(), 2 * n),
                y_chart: filled(S::zero(), 2 * n),
                mass_matrix: Matrix::zeros(n, n),
                slope: filled(S::zero(), 2 * n),
                sum: filled(S::zero(), 2 * n),
                less: Vec::with_capacity(3 * n),
            })
        })
    }

    pub(crate) fn set_configuration(&mut self, q: &[S]) {
        self.parts.iter_mut().for_each(|part| part.frame.set_configuration(q));
    }

    /// A momentum, or a velocity, in the axes of the chart.
    pub(crate) fn set_momentum(&mut self, p: &[S]) {
        self.p.copy_from_slice(p);
        for part in &mut self.parts {
            part.set_momentum(p);
            part.frame.outward(&mut self.p);
        }
    }

    /// p and u, of chains that are displaced along the axes of the moved frames
    /// ([`World`](super::World::with_own_axes)).
    pub(crate) fn set_state_in_own_axes(&mut self, [p, u]: [&[S]; 2]) {
        self.parts.iter_mut().for_each(|part| part.frame.set_own_axes());
        self.set_momentum(p);
        self.set_actuation(u);
    }

    /// q, p and u in the axes of the chart.
    pub(crate) fn set_state(&mut self, [q, p, u]: [&[S]; 3]) {
        self.set_configuration(q);
        self.set_momentum(p);
        self.set_actuation(u);
    }

    pub(crate) fn set_actuation(&mut self, u: &[S]) {
        self.u.copy_from_slice(u);
        for (at, m) in self.parts.iter().map(Part::place) {
            self.u[at..at + m].fill(S::zero());
        }
    }

    /// F of the chart becomes that of the tangent space.
    pub(crate) fn finish_rate(&mut self, f: &mut [S], u: &[S]) {
        let n = u.len();
        for part in &mut self.parts {
            part.finish_rate(f);
            let (at, m) = part.place();
            f[n + at..n + at + m].iter_mut().zip(&u[at..at + m]).for_each(|(f, &u)| *f += u);
        }
    }

    /// F_x of the chart by (xi, pi), without friction, in the axes of the frames.
    ///
    /// The momentum of the chart is `p_c = A'pi`, `dp_c = dpi + K dxi`. Where P has lost K, its formula gives
    /// the columns by (xi, pi) and a symmetric matrix J F_x, so that its rows are those of `F^p - K'F^q`.
    pub(crate) fn prepare_jacobian(&self, f_x: &mut Matrix<S>) {
        self.parts.iter().for_each(|part| part.frame.turn_symplectic(f_x));
        self.parts.iter().for_each(|part| part.part_rows(f_x));
    }

    /// The same for rows of other functions of (q, p_c) by (xi, pi), k x 2n.
    pub(crate) fn prepare_rows(&self, matrix: &mut Matrix<S>) {
        let n = matrix.columns() / 2;
        for part in &self.parts {
            for i in 0..matrix.rows() {
                let (in_q, in_p) = matrix.row_mut(i).split_at_mut(n);
                part.frame.inward(in_q);
                part.frame.inward(in_p);
            }
        }
    }

    /// K in the axes of the chart, at the momentum set last: the entries that P loses.
    pub(crate) fn momentum_slope(&mut self) -> &[Entry<S>] {
        self.less.clear();
        self.parts.iter().for_each(|part| part.add_momentum_slope(&mut self.less));
        &self.less
    }

    /// Subtracts `K d` from `change`, n each, for K of [`momentum_slope`](Self::momentum_slope), called last.
    pub(crate) fn subtract_momentum_slope(&self, d: &[S], change: &mut [S]) {
        for entry in &self.less {
            change[entry.row] -= entry.value * d[entry.column];
        }
    }

    /// y'F_xx of the chart in the axes of the frames.
    pub(crate) fn turn_hessian(&self, matrix: &mut Matrix<S>) {
        let n = matrix.rows() / 2;
        for part in &self.parts {
            let (at, _) = part.place();
            part.frame.turn_symmetric(matrix, &[at, n + at]);
        }
    }

    /// M, or its inverse, in the axes of the frames.
    pub(crate) fn turn_symmetric(&self, matrix: &mut Matrix<S>) {
        self.parts.iter().for_each(|part| part.frame.turn_symmetric(matrix, &[part.place().0]));
    }

    pub(crate) fn set_mass_matrix(&mut self, mass_matrix: &Matrix<S>) {
        self.mass_matrix.copy_from(mass_matrix);
        self.parts.iter().for_each(|part| {
            part.frame.turn_symmetric(&mut self.mass_matrix, &[part.place().0]);
        });
    }

    /// y'F_xx of the tangent space from that of the chart, both for the costate y, set last; `others` are
    /// further functions of (q, p) with weights, part of the sum, and their Jacobian, by (xi, pi) as F_x.
    pub(crate) fn curve(
        &mut self,
        y: &[S],
        f_x: &Matrix<S>,
        others: Option<(&[S], &Matrix<S>)>,
        y_f_xx: &mut Matrix<S>,
    ) {
        let Self { parts, slope, sum, y: of_chart, .. } = self;
        let n = f_x.columns() / 2;
        slope.fill(S::zero());
        for (weights, rows) in [(&**of_chart, f_x)].into_iter().chain(others) {
            for (i, &weight) in weights.iter().enumerate() {
                let own = parts.iter().map(Part::place).flat_map(|(at, m)| [at..at + m, n + at..n + at + m]);
                for some in own {
                    add_scaled(&mut slope[some.clone()], weight, &rows.row(i)[some]);
                }
            }
        }
        parts.iter().for_each(|part| part.curve([y, slope], f_x, sum, y_f_xx));
    }

    /// The costate of the chart.
    pub(crate) fn set_costate(&mut self, y: &[S]) {
        self.y.copy_from_slice(y);
        for part in &self.parts {
            part.costate(&mut self.y);
        }
        self.y_chart.copy_from_slice(&self.y);
        let (y_q, y_p) = self.y_chart.split_at_mut(y.len() / 2);
        for part in &self.parts {
            part.frame.outward(y_q);
            part.frame.outward(y_p);
        }
    }
}
