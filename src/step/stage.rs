//! One stage of a scheme: the state at which the model is evaluated, and its derivatives.

use super::lu::Lu;
use super::tableau::Pair;
use crate::dynamics::Linearisation;
use crate::matrix::{Matrix, add_rows, add_scaled, filled};
use crate::scalar::Scalar;
use std::ops::Range;

/// One stage X of a scheme, with z = (x, u, h).
#[derive(Clone, Debug)]
pub(super) struct Stage<S> {
    pub x: Vec<S>,
    pub f: Vec<S>,
    f_x: Matrix<S>,
    f_u: Matrix<S>,
    /// dX/dz.
    pub x_z: Matrix<S>,
    /// df(X, u)/dz.
    f_z: Matrix<S>,
    /// Costate of f: mu.
    pub mu: Vec<S>,
    /// Costate of X: `f_x' mu`.
    xi: Vec<S>,
    /// Whether the scheme sets X = x.
    pub is_start: bool,
    pub implicit: Option<Implicit<S>>,
}

/// The implicit part of a stage: `X_k = g_k + h a f_k(X, u)` for k in a range.
#[derive(Clone, Debug)]
pub(super) struct Implicit<S> {
    pub a: f64,
    pub range: Range<usize>,
    /// `1 - h a f_x` in rows and columns of the range.
    pub matrix: Lu<S>,
}

impl<S: Scalar> Implicit<S> {
    /// Fills and factors the matrix, from f_x by rows.
    pub fn factor<'a>(&mut self, h: S, f_x: impl Fn(usize) -> &'a [S]) {
        let factor = -h.times(self.a);
        for (i, k) in self.range.clone().enumerate() {
            let row = self.matrix.row_mut(i);
            for (entry, &f_x) in row.iter_mut().zip(&f_x(k)[self.range.clone()]) {
                *entry = factor * f_x;
            }
            row[i] = row[i].plus(1.0);
        }
        self.matrix.factor();
    }
}

impl<S: Scalar> Stage<S> {
    /// The stage of one row of A.
    pub fn new(states: usize, controls: usize, row: &[Pair]) -> Self {
        let inputs = states + controls + 1;
        let diagonal = row.last().copied().unwrap_or_default();
        let range = match diagonal {
            [0.0, 0.0] => 0..0,
            [0.0, _] => states / 2..states,
            [_, 0.0] => 0..states / 2,
            _ => 0..states,
        };
        Self {
            x: filled(S::zero(), states),
            f: filled(S::zero(), states),
            f_x: Matrix::zeros(states, states),
            f_u: Matrix::zeros(states, controls),
            x_z: Matrix::zeros(states, inputs),
            f_z: Matrix::zeros(states, inputs),
            mu: filled(S::zero(), states),
            xi: filled(S::zero(), states),
            is_start: row.iter().all(|pair| *pair == [0.0; 2]),
            implicit: (!range.is_empty()).then(|| Implicit {
                a: if diagonal[0] == 0.0 { diagonal[1] } else { diagonal[0] },
                matrix: Lu::new(range.len()),
                range,
            }),
        }
    }

    pub fn take(&mut self, first: &Linearisation<'_, S>) {
        self.f.copy_from_slice(first.f);
        for (i, (f_x, f_u)) in first.f_x.iter_rows().zip(first.f_u.iter_rows()).enumerate() {
            self.f_x.row_mut(i).copy_from_slice(f_x);
            self.f_u.row_mut(i).copy_from_slice(f_u);
        }
    }

    /// dX/dz and df/dz from those of the stages before it, once f and its Jacobians are stored.
    ///
    /// From `dX = dg + a (f dh + h (f_x dX + f_u du))` by the implicit function theorem: no iteration is
    /// differentiated.
    pub fn differentiate<'a>(&mut self, h: S, before: impl Iterator<Item = (Pair, &'a Self)> + Clone) {
        differentiate_sum(&mut self.x_z, h, before);
        if let Some(implicit) = &mut self.implicit {
            implicit.factor(h, |k| self.f_x.row(k));
            let Implicit { a, range, matrix } = implicit;
            let factor = h.times(*a);
            let states = self.f.len();
            for k in range.clone() {
                for c in (0..states).filter(|c| !range.contains(c)) {
                    let (row, known) = if c < k {
                        self.x_z.row_mut_and_above(k, c)
                    } else {
                        self.x_z.row_mut_and_below(k, c)
                    };
                    add_scaled(row, factor * self.f_x[(k, c)], known);
                }
                let row = self.x_z.row_mut(k);
                add_scaled(&mut row[states..], factor, self.f_u.row(k));
                if let Some(in_h) = row.last_mut() {
                    *in_h += self.f[k].times(*a);
                }
            }
            matrix.solve_rows(&mut self.x_z, range.start);
        }
        self.differentiate_slope();
    }

    /// `df/dz = f_x dX/dz + (0 f_u 0)`.
    fn differentiate_slope(&mut self) {
        let states = self.f.len();
        for i in 0..states {
            let row = self.f_z.row_mut(i);
            row.fill(S::zero());
            if self.is_start {
                row[..states].copy_from_slice(self.f_x.row(i));
            } else {
                let terms = self.f_x.row(i).iter().copied().enumerate();
                add_rows(row, self.x_z.as_slice(), self.x_z.columns(), terms);
            }
            add_scaled(&mut row[states..], S::one(), self.f_u.row(i));
        }
    }

    /// The costate of f, from those of the stages after it: `mu = h (B y + sum_j A_j xi_j) + h a f_x' mu`.
    ///
    /// Only an implicit stage needs f_x here.
    pub fn set_costate<'a>(
        &mut self,
        h: S,
        (b, y): (Pair, &[S]),
        after: impl Iterator<Item = (Pair, &'a Self)>,
    ) {
        self.mu.fill(S::zero());
        add_halves(&mut self.mu, b, y);
        after.for_each(|(a, stage)| add_halves(&mut self.mu, a, &stage.xi));
        self.mu.iter_mut().for_each(|mu| *mu *= h);
        let Some(Implicit { a, range, matrix }) = &self.implicit else { return };
        let factor = h.times(*a);
        for c in (0..self.f.len()).filter(|c| !range.contains(c)) {
            let scaled = factor * self.mu[c];
            add_scaled(&mut self.mu[range.clone()], scaled, &self.f_x.row(c)[range.clone()]);
        }
        matrix.solve_transposed(&mut self.mu[range.clone()]);
    }

    /// The costate of X, from that of f: `xi = f_x' mu`.
    pub fn turn_back(&mut self) {
        self.xi.fill(S::zero());
        for (i, &mu) in self.mu.iter().enumerate() {
            add_scaled(&mut self.xi, mu, self.f_x.row(i));
        }
    }
}

/// `target += a source`, each half with its coefficient; zero coefficients are skipped.
pub(super) fn add_halves<S: Scalar>(target: &mut [S], pair: Pair, source: &[S]) {
    let half = target.len() / 2;
    let (upper, lower) = target.split_at_mut(half);
    for ((a, target), source) in pair.into_iter().zip([upper, lower]).zip([&source[..half], &source[half..]])
    {
        if a != 0.0 {
            target.iter_mut().zip(source).for_each(|(target, &source)| *target += source.times(a));
        }
    }
}

/// `target = x + h sum a f` over stages.
pub(super) fn sum<'a, S: Scalar>(
    target: &mut [S],
    x: &[S],
    h: S,
    terms: impl Iterator<Item = (Pair, &'a Stage<S>)>,
) {
    target.fill(S::zero());
    terms.for_each(|(a, stage)| add_halves(target, a, &stage.f));
    target.iter_mut().zip(x).for_each(|(target, &x)| *target = x + h * *target);
}

/// The derivative of [`sum`] in z = (x, u, h): `target = (1 0 0) + sum a (h f_z + (0 0 f))`.
pub(super) fn differentiate_sum<'a, S: Scalar>(
    target: &mut Matrix<S>,
    h: S,
    terms: impl Iterator<Item = (Pair, &'a Stage<S>)> + Clone,
) {
    target.fill_zero();
    for i in 0..target.rows() {
        let row = target.row_mut(i);
        for (pair, stage) in terms.clone() {
            let a = pair[usize::from(i >= stage.f.len() / 2)];
            if a == 0.0 {
                continue;
            }
            add_scaled(row, h.times(a), stage.f_z.row(i));
            if let Some(in_h) = row.last_mut() {
                *in_h += stage.f[i].times(a);
            }
        }
        row[i] = row[i].plus(1.0);
    }
}
