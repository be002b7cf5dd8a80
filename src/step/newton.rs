//! Newton's method for the implicit part of a stage.

use super::StepError;
use super::stage::{Implicit, Stage};
use crate::dynamics::Dynamics;
use crate::matrix::filled;
use crate::scalar::Scalar;
use std::ops::{Range, RangeInclusive};

/// Maximum number of iterations for the value.
const MOST: usize = 20;

/// Number of iterations for scalars that are not checked: what short steps of robots need.
const UNCHECKED: usize = 3;

/// Most further iterations for entries that are small beside the largest: convergence is quadratic, and two
/// reach entries twelve decades smaller.
const SMALL_ENTRIES: usize = 2;

/// Most further iterations where all entries are below `512 eps`.
const SMALL_UNITS: usize = 3;

/// Powers of ten that bound the last correction in the error message.
const DECADES: RangeInclusive<i32> = -16..=300;

/// Workspace for the solution of `X_k = g_k + h a f_k(X, u)`, k in a range, all other X_k known.
#[derive(Clone, Debug)]
pub(super) struct Newton<S> {
    /// A nearby value of f, for the initial guess.
    pub slope: Vec<S>,
    known: Vec<S>,
    change: Vec<S>,
    /// Number of iterations of all stages since the last reset.
    pub iterations: usize,
}

impl<S: Scalar> Newton<S> {
    pub fn new(states: usize) -> Self {
        let zero = filled(S::zero(), states);
        Self { slope: zero.clone(), known: zero.clone(), change: zero, iterations: 0 }
    }

    /// Solves for `stage.x`, which holds g, from the guess `g + h a slope`.
    ///
    /// Convergence is quadratic: once a correction is as small as [`Self::left`] requires, the next one would
    /// be rounding error. Scalars with derivatives of order d need more iterations: from a converged value,
    /// one iteration with the Jacobian in the same scalar makes first derivatives exact, the next those up to
    /// third order, then up to seventh: `ceil(log2(d + 1))` more iterations.
    pub fn solve<D: Dynamics<S>>(
        &mut self,
        model: &mut D,
        stage: &mut Stage<S>,
        u: &[S],
        h: S,
    ) -> Result<(), StepError<D::Error>> {
        let Some(implicit) = &mut stage.implicit else { return Ok(()) };
        let (x, range) = (&mut stage.x, implicit.range.clone());
        let factor = h.times(implicit.a);
        self.known.copy_from_slice(x);
        for k in range {
            x[k] += factor * self.slope[k];
        }
        let mut iterations = 0;
        let mut left = if S::CHECKED { None } else { Some(UNCHECKED + more_for_derivatives::<S>()) };
        while left != Some(0) {
            if S::CHECKED && !x.iter().all(|x| x.is_finite()) {
                return Err(StepError::NotConverged { iterations, change: f64::INFINITY });
            }
            if S::CHECKED && iterations == MOST {
                return Err(StepError::NotConverged { iterations, change: self.decade(implicit, x) });
            }
            self.iterate(model, implicit, x, u, h)?;
            iterations += 1;
            let found = if S::CHECKED { self.left(implicit, x) } else { None };
            left = match (left, found) {
                (Some(left), Some(found)) => Some(found.min(left - 1)),
                (Some(left), None) => Some(left - 1),
                (None, found) => found,
            };
        }
        self.iterations += iterations;
        Ok(())
    }

    /// `X <- X + (1 - h a f_x)^-1 (g + h a f - X)`.
    fn iterate<D: Dynamics<S>>(
        &mut self,
        model: &mut D,
        implicit: &mut Implicit<S>,
        x: &mut [S],
        u: &[S],
        h: S,
    ) -> Result<(), D::Error> {
        let range = implicit.range.clone();
        let factor = h.times(implicit.a);
        let first = model.linearise(x, u)?;
        for k in range.clone() {
            self.change[k] = self.known[k] - x[k] + factor * first.f[k];
        }
        implicit.factor(h, |k| first.f_x.row(k));
        implicit.matrix.solve(&mut self.change[range.clone()]);
        range.for_each(|k| x[k] += self.change[k]);
        Ok(())
    }

    /// The number of remaining iterations, or `None` if the last correction is still large.
    ///
    /// Only those for derivatives if every correction is below `sqrt(eps)/64` of its own entry. Up to
    /// [`SMALL_ENTRIES`] more where it is that small only relative to the largest entry of its half, as for
    /// the momenta of light joints beside heavy ones. Up to [`SMALL_UNITS`] more where all are below `512
    /// eps`: a state at rest, whose corrections are rounding errors of balanced forces, or one that is small
    /// in its units.
    fn left(&self, implicit: &Implicit<S>, x: &[S]) -> Option<usize> {
        let for_derivatives = more_for_derivatives::<S>();
        let small = |size: S| size.times(S::EPSILON.sqrt() / 64.0).plus(f64::MIN_POSITIVE);
        let mut entries = implicit.range.clone();
        if entries.all(|k| S::all(self.change[k].abs().less(small(x[k].abs())))) {
            return Some(for_derivatives);
        }
        if self.is_below(implicit, x, small) {
            return Some(for_derivatives + SMALL_ENTRIES);
        }
        let is_tiny = self.is_below(implicit, x, |_| S::from_f64(512.0 * S::EPSILON));
        is_tiny.then_some(for_derivatives + SMALL_UNITS)
    }

    /// The smallest power of ten above the last correction, relative to the largest of its half and 1.
    fn decade(&self, implicit: &Implicit<S>, x: &[S]) -> f64 {
        let below = |power: &f64| self.is_below(implicit, x, |size| size.plus(1.0).times(*power));
        DECADES.map(|exponent| 10_f64.powi(exponent)).find(below).unwrap_or(f64::INFINITY)
    }

    /// Whether every correction is below a bound that depends on the largest entry of its half.
    fn is_below(&self, implicit: &Implicit<S>, x: &[S], bound: impl Fn(S) -> S) -> bool {
        let (half, Range { start, end }) = (x.len() / 2, implicit.range.clone());
        [start..end.min(half), start.max(half)..end].into_iter().all(|range| {
            let bound = bound(largest(&x[range.clone()]));
            self.change[range].iter().all(|change| S::all(change.abs().less(bound)))
        })
    }
}

/// The largest magnitude.
fn largest<S: Scalar>(values: &[S]) -> S {
    values.iter().fold(S::zero(), |largest, value| {
        let size = value.abs();
        S::select(largest.less(size), size, largest)
    })
}

/// `ceil(log2(d + 1))` for derivatives up to order d.
fn more_for_derivatives<S: Scalar>() -> usize {
    (S::ORDER + 1).next_power_of_two().trailing_zeros() as usize
}
