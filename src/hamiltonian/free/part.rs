//! F, F_x and y'F_xx of one floating or spherical joint, from those in its chart.
//!
//! In the chart the state is (q, p_c) with `p_c = A' pi`, and the rate of the momentum pi of the moved frame
//!
//! $$ \dot \pi = A^{-T} (F^p - (A\_q[v])^T \pi), \qquad \nu = A v, \qquad v = F^q $$
//!
//! so that `y'F = alpha . F^q + beta . F^p` with `beta = A^-1 y_pi`, `alpha_k = (A' y_xi)_k - pi . A_k
//! beta`. F, F_x and y'F_xx are derivatives of this at the centre of the chart by (xi, pi): those of F^q and
//! F^p come from the chain of joints, those of alpha, beta and A are products with constants, and touch rows
//! and columns of this joint only.

use crate::configuration::{ChartFrame, MOST};
use crate::matrix::{Entry, Matrix, add_scaled, dot};
use crate::robot::FreeFrame;
use crate::scalar::Scalar;

/// What is kept of one joint between the steps of an evaluation.
#[derive(Clone, Debug)]
pub(crate) struct Part<S> {
    pub frame: ChartFrame<S>,
    /// pi, v and F^p in the chart, and the rate of pi without actuation.
    momentum: [S; MOST],
    velocity: [S; MOST],
    force: [S; MOST],
    rate: [S; MOST],
}

impl<S: Scalar> Part<S> {
    pub fn new(free: &FreeFrame) -> Self {
        let zero = [S::zero(); MOST];
        Self { frame: ChartFrame::new(free), momentum: zero, velocity: zero, force: zero, rate: zero }
    }

    /// Its first coordinate and how many there are.
    pub fn place(&self) -> (usize, usize) {
        self.frame.place()
    }

    pub fn set_momentum(&mut self, p: &[S]) {
        self.momentum = self.frame.entries(p);
    }

    /// F in the tangent space from F in the chart, both without the actuation of this joint.
    pub fn finish_rate(&mut self, f: &mut [S]) {
        let (f_q, f_p) = f.split_at_mut(f.len() / 2);
        self.frame.inward(f_q);
        self.frame.inward(f_p);
        let (at, m) = self.place();
        self.velocity = self.frame.entries(f_q);
        self.force = self.frame.entries(f_p);
        self.rate = self.force;
        for e in &self.frame.chart.twist.first {
            self.rate[e.column] -= (self.velocity[e.by[0]] * self.momentum[e.row]).times(e.value);
        }
        f_p[at..at + m].copy_from_slice(&self.rate[..m]);
    }

    /// Adds K of `dp_c = dpi + K dxi`, in the axes of the chart, to the entries that P loses.
    pub fn add_momentum_slope(&self, less: &mut Vec<Entry<S>>) {
        let (at, m) = self.place();
        let mut slope = [[S::zero(); MOST]; MOST];
        for e in &self.frame.chart.twist.first {
            slope[e.by[0]][e.column] += self.momentum[e.row].times(e.value);
        }
        for (angle, slope) in slope.iter_mut().enumerate().take(m).skip(m - 3) {
            self.frame.outward_own(slope);
            less.extend((0..m).map(|row| Entry { row: at + row, column: at + angle, value: slope[row] }));
        }
    }

    /// The derivative of F in the chart by (xi, pi) from one whose rows of p are those of
    /// `F^p - K'F^q`.
    pub fn part_rows(&self, f_x: &mut Matrix<S>) {
        let (at, n) = (self.place().0, f_x.columns() / 2);
        for e in &self.frame.chart.twist.first {
            let factor = self.momentum[e.row].times(e.value);
            let (row, source) = f_x.row_mut_and_above(n + at + e.by[0], at + e.column);
            add_scaled(row, factor, source);
        }
    }

    /// F_x of the tangent space from the derivative of F in the chart by (xi, pi).
    pub fn finish_jacobian(&self, f_x: &mut Matrix<S>) {
        let (at, n) = (self.place().0, f_x.columns() / 2);
        let Self { frame: ChartFrame { chart, .. }, momentum, velocity, rate, .. } = self;
        for e in &chart.twist.first {
            let [i] = e.by;
            let factor = momentum[e.row].times(-e.value);
            let (row, source) = f_x.row_mut_and_above(n + at + e.column, at + i);
            add_scaled(row, factor, source);
            row[n + at + e.row] -= velocity[i].times(e.value);
            row[at + i] -= rate[e.row].times(e.value);
        }
        for e in &chart.twist.second {
            let [i, j] = e.by;
            f_x[(n + at + e.column, at + j)] -= (velocity[i] * momentum[e.row]).times(e.value);
        }
        for e in &chart.twist.first {
            f_x[(at + e.row, at + e.by[0])] += velocity[e.column].times(e.value);
        }
    }

    /// The costate (alpha, beta) of the chart at its centre, from one of the tangent space.
    pub fn costate(&self, y: &mut [S]) {
        let at = self.place().0;
        let (y_q, y_p) = y.split_at_mut(y.len() / 2);
        for e in &self.frame.chart.twist.first {
            y_q[at + e.by[0]] -= (self.momentum[e.row] * y_p[at + e.column]).times(e.value);
        }
    }

    /// Adds what y'F_xx has besides `y_c'F_c,xx` in the variables (xi, pi), of y in the axes of the frame;
    /// `f_x` is the derivative of F in the chart by (xi, pi), `slope` that of `y_c . F_c`; `sum` has 2n
    /// entries.
    pub fn curve(&self, [y, slope]: [&[S]; 2], f_x: &Matrix<S>, sum: &mut [S], y_f_xx: &mut Matrix<S>) {
        let (at, m) = self.place();
        let n = f_x.columns() / 2;
        let Self { frame: ChartFrame { chart, .. }, momentum: pi, velocity: v, force, .. } = self;
        let zero = [S::zero(); MOST];
        let (mut lg, mut l) = (zero, zero);
        lg[..m].copy_from_slice(&y[at..at + m]);
        l[..m].copy_from_slice(&y[n + at..n + at + m]);
        // Derivatives of beta and alpha by coordinates i and j, and of alpha by pi.
        let (mut b1, mut b2) = ([zero; MOST], [[zero; MOST]; MOST]);
        for e in &chart.twist.first {
            b1[e.by[0]][e.row] -= l[e.column].times(e.value);
        }
        for e in &chart.twist.second {
            b2[e.by[0]][e.by[1]][e.row] -= l[e.column].times(e.value);
        }
        let angles = m - 3..m;
        for e in &chart.twist.first {
            let [i] = e.by;
            for j in angles.clone() {
                let (along_i, along_j) = (b1[j][e.column].times(e.value), i);
                b2[along_j][j][e.row] -= along_i;
                b2[j][along_j][e.row] -= along_i;
            }
        }
        let (mut a1, mut by_momentum) = ([zero; MOST], [zero; MOST]);
        for e in &chart.twist.first {
            let [k] = e.by;
            a1[k][e.column] += lg[e.row].times(e.value);
            by_momentum[e.row][k] -= l[e.column].times(e.value);
            for i in angles.clone() {
                a1[i][k] -= (pi[e.row] * b1[i][e.column]).times(e.value);
            }
        }
        for e in &chart.twist.second {
            let [k, i] = e.by;
            a1[i][k] -= (pi[e.row] * l[e.column]).times(e.value);
        }
        // Second derivatives, contracted with F, and those of p_c and q with y_c'F_c,x.
        let (mut square, mut mixed) = ([zero; MOST], [zero; MOST]);
        for i in angles.clone() {
            for j in angles.clone() {
                square[i][j] = dot(&b2[i][j], force);
            }
        }
        let mut pull = zero;
        pull[..m].copy_from_slice(&slope[n + at..n + at + m]);
        for e in &chart.twist.first {
            let [k] = e.by;
            mixed[k][e.row] += pull[e.column].times(e.value);
            for i in angles.clone() {
                mixed[i][e.row] -= (v[k] * b1[i][e.column]).times(e.value);
                for j in angles.clone() {
                    square[i][j] -= (pi[e.row] * v[k] * b2[i][j][e.column]).times(e.value);
                }
            }
        }
        for e in &chart.twist.second {
            let [i, j] = e.by;
            let weight = lg[e.row] * v[e.column] + pull[e.column] * pi[e.row];
            square[i][j] += weight.times(e.value);
            // As A_ki: k is the coordinate of v.
            mixed[j][e.row] -= (v[i] * l[e.column]).times(e.value);
            for other in angles.clone() {
                let weight = (pi[e.row] * v[i] * b1[other][e.column]).times(e.value);
                square[j][other] -= weight;
                square[other][j] -= weight;
            }
        }
        for e in &chart.twist.third {
            let [k, i, j] = e.by;
            square[i][j] -= (pi[e.row] * v[k] * l[e.column]).times(e.value);
        }
        for e in &chart.retraction {
            let k = e.row;
            let along = slope[at + k] + dot(&a1[k], v) + dot(&b1[k], force);
            square[e.column][e.by[0]] += along.times(e.value);
        }
        for (i, (square, mixed)) in square[..m].iter().zip(&mixed).enumerate() {
            for (j, (&square, &mixed)) in square[..m].iter().zip(mixed).enumerate() {
                y_f_xx[(at + i, at + j)] += square;
                y_f_xx[(at + i, n + at + j)] += mixed;
                y_f_xx[(n + at + j, at + i)] += mixed;
            }
        }
        // Products of first derivatives: sums of rows, each added to a row and to a column.
        for i in angles {
            sum.fill(S::zero());
            for k in 0..m {
                add_scaled(sum, a1[i][k], f_x.row(at + k));
                add_scaled(sum, b1[i][k], f_x.row(n + at + k));
            }
            add_both(y_f_xx, sum, at + i);
        }
        for (r, factors) in by_momentum[..m].iter().enumerate() {
            sum.fill(S::zero());
            (0..m).for_each(|k| add_scaled(sum, factors[k], f_x.row(at + k)));
            add_both(y_f_xx, sum, n + at + r);
        }
    }
}

/// Adds a row to row i and to column i.
fn add_both<S: Scalar>(matrix: &mut Matrix<S>, row: &[S], i: usize) {
    for (j, &entry) in row.iter().enumerate() {
        matrix[(i, j)] += entry;
        matrix[(j, i)] += entry;
    }
}
