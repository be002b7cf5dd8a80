//! Derivatives of functions of (q, v, a) of a chain of joints by the motion of a floating or spherical joint.

use crate::configuration::{ChartFrame, MOST};
use crate::matrix::{Matrix, add_scaled};
use crate::robot::FreeFrame;
use crate::scalar::Scalar;

pub(crate) type Square<S> = [[S; MOST]; MOST];

/// What is kept of one joint between the steps of an evaluation.
#[derive(Clone, Debug)]
pub(crate) struct Part<S> {
    pub frame: ChartFrame<S>,
    /// nu and nu'.
    velocity: [S; MOST],
    acceleration: [S; MOST],
    /// `dv = dnu + v_q dxi`, `da = dnu' + a_v dnu + a_q dxi`.
    v_q: Square<S>,
    a_v: Square<S>,
    a_q: Square<S>,
}

impl<S: Scalar> Part<S> {
    pub fn new(free: &FreeFrame) -> Self {
        let zero = [S::zero(); MOST];
        Self {
            frame: ChartFrame::new(free),
            velocity: zero,
            acceleration: zero,
            v_q: [zero; MOST],
            a_v: [zero; MOST],
            a_q: [zero; MOST],
        }
    }

    pub fn set_velocity(&mut self, v: &[S]) {
        let nu = self.frame.entries(v);
        let zero = [[S::zero(); MOST]; MOST];
        (self.velocity, self.v_q, self.a_v) = (nu, zero, zero);
        for e in &self.frame.chart.rates.first {
            let [i] = e.by;
            let along = nu[e.column].times(e.value);
            self.v_q[e.row][i] += along;
            self.a_v[e.row][i] += along;
            self.a_v[e.row][e.column] += nu[i].times(e.value);
        }
    }

    /// Adds `B_q[nu] nu` to the acceleration nu'.
    pub fn set_acceleration(&mut self, acceleration: &[S], a: &mut [S]) {
        self.acceleration = self.frame.entries(acceleration);
        let ((at, _), nu) = (self.frame.place(), &self.velocity);
        for e in &self.frame.chart.rates.first {
            a[at + e.row] += (nu[e.by[0]] * nu[e.column]).times(e.value);
        }
        let Self { velocity: nu, acceleration, v_q, a_q, .. } = self;
        *a_q = [[S::zero(); MOST]; MOST];
        for e in &self.frame.chart.rates.first {
            let [i] = e.by;
            a_q[e.row][i] += acceleration[e.column].times(e.value);
            add_scaled(&mut a_q[e.row], nu[e.column].times(e.value), &v_q[i]);
        }
        for e in &self.frame.chart.rates.second {
            let [i, j] = e.by;
            a_q[e.row][j] += (nu[i] * nu[e.column]).times(e.value);
        }
    }

    /// A row of derivatives by (xi, nu, nu') from one by (q, v, a), of n entries each; those by a remain.
    pub fn spread(&self, [in_q, in_v]: [&mut [S]; 2], in_a: &[S]) {
        let (at, m) = self.frame.place();
        for k in 0..m {
            let (by_v, by_a) = (in_v[at + k], in_a[at + k]);
            add_scaled(&mut in_q[at..at + m], by_v, &self.v_q[k]);
            add_scaled(&mut in_q[at..at + m], by_a, &self.a_q[k]);
        }
        for k in 0..m {
            add_scaled(&mut in_v[at..at + m], in_a[at + k], &self.a_v[k]);
        }
    }

    /// Columns and rows of a matrix of 3n.
    pub fn spread_hessian(&self, matrix: &mut Matrix<S>) {
        let ((at, m), n) = (self.frame.place(), matrix.rows() / 3);
        for i in 0..3 * n {
            let (in_q, rest) = matrix.row_mut(i).split_at_mut(n);
            let (in_v, in_a) = rest.split_at_mut(n);
            self.spread([in_q, in_v], in_a);
        }
        let [q, v, a] = [at, n + at, 2 * n + at];
        for (to, from, factors) in [(q, v, &self.v_q), (q, a, &self.a_q), (v, a, &self.a_v)] {
            for (k, factors) in factors[..m].iter().enumerate() {
                for (i, &factor) in factors[..m].iter().enumerate() {
                    let (row, source) = matrix.row_mut_and_below(to + i, from + k);
                    add_scaled(row, factor, source);
                }
            }
        }
    }

    /// `tau = B' tau_c`: what tau_q has besides the derivatives of tau_c.
    pub fn turn_force(&self, tau: &[S], tau_q: &mut Matrix<S>) {
        let (at, _) = self.frame.place();
        for e in &self.frame.chart.rates.first {
            tau_q[(at + e.column, at + e.by[0])] += tau[at + e.row].times(e.value);
        }
    }

    /// Adds what the Hessian of a function of (q, v, a) of the chart has in the variables (xi, nu, nu')
    /// besides products of first derivatives: second derivatives of q, v and a, for its gradients by them.
    /// That by q is the whole one at constant nu and nu', since v and a depend on q.
    pub fn bend_arguments(&self, [by_q, by_v, force]: [[S; MOST]; 3], hessian: &mut Matrix<S>) {
        let ((at, m), n) = (self.frame.place(), hessian.rows() / 3);
        let Self { velocity: nu, acceleration, v_q, .. } = self;
        let (rates, zero) = (&self.frame.chart.rates, [[S::zero(); MOST]; MOST]);
        // Blocks (xi, xi), (xi, nu), (xi, nu') and (nu, nu), and what multiplies v in a.
        let (mut square, mut in_v, mut in_a, mut both, mut slope) = (zero, zero, zero, zero, by_v);
        for e in &rates.first {
            slope[e.by[0]] += (force[e.row] * nu[e.column]).times(e.value);
        }
        for e in &rates.first {
            let [i] = e.by;
            let push = force[e.row].times(e.value);
            in_v[i][e.column] += slope[e.row].times(e.value);
            in_a[i][e.column] += push;
            both[i][e.column] += push;
            both[e.column][i] += push;
            for (in_v, &along) in in_v[..m].iter_mut().zip(&v_q[i]) {
                in_v[e.column] += push * along;
            }
        }
        for e in &rates.second {
            let [i, j] = e.by;
            let weight = slope[e.row] * nu[e.column] + force[e.row] * acceleration[e.column];
            square[i][j] += weight.times(e.value);
            let push = force[e.row].times(e.value);
            in_v[j][i] += push * nu[e.column];
            in_v[j][e.column] += push * nu[i];
            for l in 0..m {
                let term = push * nu[e.column] * v_q[i][l];
                square[j][l] += term;
                square[l][j] += term;
            }
        }
        for e in &rates.third {
            let [i, j, l] = e.by;
            square[j][l] += (force[e.row] * nu[i] * nu[e.column]).times(e.value);
        }
        for e in &self.frame.chart.retraction {
            square[e.column][e.by[0]] += by_q[e.row].times(e.value);
        }
        for i in 0..m {
            for j in 0..m {
                hessian[(at + i, at + j)] += square[i][j];
                hessian[(n + at + i, n + at + j)] += both[i][j];
                for (column, entry) in [(n, in_v[i][j]), (2 * n, in_a[i][j])] {
                    hessian[(at + i, column + at + j)] += entry;
                    hessian[(column + at + j, at + i)] += entry;
                }
            }
        }
    }

    /// Adds what the Hessian of `(B w) . tau_c` has besides that of tau_c, since B depends on xi: tau_c is a
    /// function of some variables, of n each, with these Jacobians; q is the first of them.
    pub fn bend_weights(&self, [tau, w]: [&[S]; 2], jacobian: &[&Matrix<S>], hessian: &mut Matrix<S>) {
        let ((at, m), n) = (self.frame.place(), tau.len());
        let (tau, w_q) = (self.frame.entries(tau), self.weight_slope(w));
        let own = self.frame.entries(w);
        let mut square = [[S::zero(); MOST]; MOST];
        for e in &self.frame.chart.rates.second {
            let [i, j] = e.by;
            square[i][j] += (tau[e.row] * own[e.column]).times(e.value);
        }
        for e in &self.frame.chart.retraction {
            let by_q = (0..m).fold(S::zero(), |sum, row| tau[row].mul_add(w_q[row][e.row], sum));
            square[e.column][e.by[0]] += by_q.times(e.value);
        }
        for (i, square) in square[..m].iter().enumerate() {
            square[..m].iter().enumerate().for_each(|(j, &entry)| hessian[(at + i, at + j)] += entry);
        }
        for (k, w_q) in w_q[..m].iter().enumerate() {
            for (i, &factor) in w_q[..m].iter().enumerate() {
                for (block, matrix) in jacobian.iter().enumerate() {
                    for (j, &entry) in matrix.row(at + k).iter().enumerate() {
                        let term = factor * entry;
                        hessian[(at + i, block * n + j)] += term;
                        hessian[(block * n + j, at + i)] += term;
                    }
                }
            }
        }
    }

    /// The derivative of `B w` by xi: its rows are those of w.
    pub fn weight_slope(&self, w: &[S]) -> Square<S> {
        let (own, mut w_q) = (self.frame.entries(w), [[S::zero(); MOST]; MOST]);
        for e in &self.frame.chart.rates.first {
            w_q[e.row][e.by[0]] += own[e.column].times(e.value);
        }
        w_q
    }
}
