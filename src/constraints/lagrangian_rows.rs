//! What the rows of constraints give to derivatives of accelerations and forces in (q, v, u).
//!
//! Rows are functions of the coordinates of the chains of joints. With floating and spherical joints, q, v
//! and a of these are functions of the displacement xi, of the twist nu and its rate, and `B = A^-1`
//! (`constraints/free.rs`):
//!
//! $$ r = \begin{pmatrix} B^T (\tau\_c - J\_c^T \lambda) - u \\\\ J\_c a + \dot J\_c v \end{pmatrix} $$
//!
//! Inverse dynamics has the derivatives of `B'tau_c`.

use super::blocks::{Blocks, Moving};
use super::free::Free;
use super::{ConstrainedLagrangian, Constraints};
use crate::configuration::MOST;
use crate::matrix::{Matrix, add_scaled, filled};
use crate::scalar::{Scalar, Tangent};

type Twice<S> = Tangent<Tangent<S>>;

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
    pub(super) fn move_rows(&mut self, q: &[S], v: &[S]) {
        let Self { solver, twice, free, a, lambda, curvature, moving: [by_q, by_v], column, .. } = self;
        match free {
            Some(free) => {
                free.set_acceleration(a);
                twice.place(q, &free.v_chain, &free.a_chain);
            }
            None => twice.place(q, v, a),
        }
        curvature.copy_from(solver.rows.contract(lambda));
        let along = twice.rows.chart_jacobian();
        for i in 0..along.rows() {
            for (j, entry) in along.row(i).iter().enumerate() {
                (by_q[(i, j)], by_v[(i, j)]) = (entry.eps.eps, entry.eps.re.times(2.0));
            }
        }
        let Some(free) = free else { return };
        let (force, jacobian) = (&mut column[0], solver.rows.jacobian());
        force.fill(S::zero());
        add_forces(&solver.rows, lambda, force);
        for part in &free.parts {
            part.frame.turn_block(curvature, [0, 0], force.len());
            part.turn_force(force, curvature);
            for i in 0..jacobian.rows() {
                let (in_q, in_v) = (by_q.row_mut(i), by_v.row_mut(i));
                part.frame.inward(in_q);
                part.frame.inward(in_v);
                part.spread([in_q, in_v], jacobian.row(i));
            }
        }
    }
}

/// Second derivatives of the rows, contracted with m_1 and m_2.
#[derive(Clone, Debug)]
pub(super) struct RowHessian<S> {
    /// That of `m_2 . (J a + J'v) - m_1 . J'lambda` in (q, v, a).
    pub matrix: Matrix<S>,
    /// m_1 in the axes of the chains, and `J'lambda` in those of the frames.
    along: Vec<S>,
    force: Vec<S>,
    /// m_2, as constants.
    weights: Vec<Twice<S>>,
    /// The gradient of `m_2 . (J a + J'v)` by q, v and a of the chains.
    slopes: [Vec<S>; 3],
}

impl<S: Scalar> RowHessian<S> {
    pub fn new(n: usize, k: usize) -> Self {
        let zeros = filled(S::zero(), n);
        Self {
            matrix: Matrix::zeros(3 * n, 3 * n),
            along: zeros.clone(),
            force: zeros.clone(),
            weights: filled(Scalar::zero(), k),
            slopes: [zeros.clone(), zeros.clone(), zeros],
        }
    }

    /// At the last state of `first`, for m = (m_1, -m_2); `held` gets `(J m_1)_q` as its slope.
    #[inline(never)]
    pub fn take(
        &mut self,
        first: &mut ConstrainedLagrangian<S>,
        held: &mut Moving<S>,
        [m_1, m_2]: [&[S]; 2],
        q: &[S],
    ) {
        let ConstrainedLagrangian { solver, twice, free, lambda, .. } = first;
        for (to, &m) in self.weights.iter_mut().zip(m_2) {
            *to = Tangent::new(Tangent::new(-m, S::zero()), Scalar::zero());
        }
        self.along.copy_from_slice(m_1);
        if let Some(free) = free {
            free.outward(&mut self.along);
        }
        held.place(q, &self.along, lambda);
        twice.rows.contract(&self.weights);
        self.take_moments(twice.rows.contracted());
        if let Some(free) = free {
            self.turn_moments(free, twice.rows.chart_jacobian());
            self.force.fill(S::zero());
            add_forces(&solver.rows, lambda, &mut self.force);
            turn_blocks(free, [&self.force, m_1], solver.rows.jacobian(), &mut held.blocks);
        }
        let n = m_1.len();
        for i in 0..n {
            add_scaled(&mut self.matrix.row_mut(i)[..n], -S::one(), held.blocks.bend.row(i));
        }
    }

    /// Of `m_2 . (J a + J'v)`, in the variables of the chains.
    fn take_moments(&mut self, rows: &Matrix<Twice<S>>) {
        let (n, matrix) = (self.along.len(), &mut self.matrix);
        matrix.fill_zero();
        for (i, j) in pairs(n) {
            let row = rows[(i, j)];
            matrix[(i, j)] = row.eps.eps;
            let mixed = row.eps.re.times(2.0);
            (matrix[(n + i, j)], matrix[(i, n + j)]) = (mixed, mixed);
            matrix[(n + i, n + j)] = row.re.re.times(2.0);
            (matrix[(2 * n + i, j)], matrix[(i, 2 * n + j)]) = (row.re.re, row.re.re);
        }
    }

    /// The same in the tangent space.
    fn turn_moments(&mut self, free: &Free<S>, jacobian: &Matrix<Twice<S>>) {
        let Self { matrix, slopes, along, weights, .. } = self;
        let n = along.len();
        slopes.iter_mut().for_each(|slopes| slopes.fill(S::zero()));
        let [by_q, by_v, by_a] = slopes;
        for (i, weight) in weights.iter().enumerate() {
            let weight = weight.re.re;
            for (j, entry) in jacobian.row(i).iter().enumerate() {
                by_q[j] += weight * entry.eps.eps;
                by_v[j] += weight * entry.eps.re.times(2.0);
                by_a[j] += weight * entry.re.re;
            }
        }
        for part in &free.parts {
            for (top, left) in pairs(3) {
                part.frame.turn_block(matrix, [n * top, n * left], n);
            }
            slopes.iter_mut().for_each(|slopes| part.frame.inward(slopes));
        }
        free.parts.iter().for_each(|part| part.spread_hessian(matrix));
        let [by_q, by_v, by_a] = slopes;
        for part in &free.parts {
            // The map from nu to v, and so v and a, depend on q.
            let [of_v, of_a] = [&*by_v, &*by_a].map(|slopes| part.frame.entries(slopes));
            part.spread([&mut *by_q, &mut *by_v], by_a);
            part.bend_arguments([part.frame.entries(by_q), of_v, of_a], matrix);
        }
    }
}

/// `(w . B'J_c'lambda)_qq` of the tangent space in the place of the bend of blocks placed along w, and
/// `(J_c B w)_q` in that of their slope; J'lambda, w and J are in the axes of the frames.
pub(super) fn turn_blocks<S: Scalar>(
    free: &Free<S>,
    [force, w]: [&[S]; 2],
    jacobian: &Matrix<S>,
    Blocks { slope, curvature, bend, .. }: &mut Blocks<S>,
) {
    let n = w.len();
    for part in &free.parts {
        part.frame.turn_block(bend, [0, 0], n);
        part.frame.turn_block(curvature, [0, 0], n);
        (0..slope.rows()).for_each(|i| part.frame.inward(slope.row_mut(i)));
    }
    for part in &free.parts {
        let ((at, m), w_q) = (part.frame.place(), part.weight_slope(w));
        let mut by_q = [S::zero(); MOST];
        for (k, by_q) in by_q[..m].iter_mut().enumerate() {
            *by_q = (0..n).fold(S::zero(), |sum, i| w[i].mul_add(curvature[(i, at + k)], sum));
        }
        for e in &part.frame.chart.retraction {
            bend[(at + e.column, at + e.by[0])] += by_q[e.row].times(e.value);
        }
        part.bend_weights([force, w], &[&*curvature], bend);
        for i in 0..slope.rows() {
            let (own, to) = (part.frame.entries(jacobian.row(i)), slope.row_mut(i));
            for (&along, w_q) in own[..m].iter().zip(&w_q) {
                add_scaled(&mut to[at..at + m], along, &w_q[..m]);
            }
        }
    }
}
