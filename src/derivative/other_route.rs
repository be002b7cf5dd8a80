//! Derivatives by other means than the pipeline, as one more method.

// `#[inline]` in this file: compiled where it is used, not by everyone who builds the library.

use super::reference::{ComparedDerivative, Reference};
use super::row::{Row, matrix};
use super::state::State;
use crate::error::EvalError;
use crate::matrix::{Matrix, filled};
use crate::scalar::{Count, Scalar};
use std::fmt;

/// Evaluates a derivative: all arguments one after the other in, all results likewise out, matrices row by
/// row.
pub type Evaluate<S> = Box<dyn FnMut(&[S], &mut [S]) -> Result<(), EvalError> + Send>;

/// Derivatives by other means than the pipeline, such as machine code: [`Routes`](super::Routes) compares
/// them, too.
pub struct OtherRoute {
    derivative: ComparedDerivative,
    name: &'static str,
    evaluate: Evaluate<f64>,
    rounded: Evaluate<Count>,
}

impl fmt::Debug for OtherRoute {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut f = f.debug_struct("OtherRoute");
        f.field("derivative", &self.derivative).field("name", &self.name).finish_non_exhaustive()
    }
}

impl OtherRoute {
    /// A method of this name. `rounded` computes the same with numbers that carry their rounding error: for
    /// machine code the recorded program, step by step.
    pub fn new(
        derivative: ComparedDerivative,
        name: &'static str,
        evaluate: Evaluate<f64>,
        rounded: Evaluate<Count>,
    ) -> Self {
        Self { derivative, name, evaluate, rounded }
    }

    /// The arguments at a state, and room for the results.
    fn arguments<S: Scalar>(&self, state: &State<S>) -> [Vec<S>; 2] {
        use ComparedDerivative::{AZ, FX, TauZ, WTauZZ, YAZZ, YFXX};
        let State { q, p, v, u, y } = state;
        let n = v.len();
        let (moving, weights, outputs) = match self.derivative {
            FX => (p, &y[..0], 2 * n + 4 * n * n),
            YFXX => (p, &y[..], 2 * n + 8 * n * n),
            AZ | TauZ => (v, &y[..0], n + 3 * n * n),
            YAZZ | WTauZZ => (v, &y[n..], n + 8 * n * n),
        };
        [[&q[..], moving, u, weights].concat(), filled(S::zero(), outputs)]
    }

    /// Its row in `f64`.
    #[inline]
    pub(super) fn row(&mut self, state: &State<f64>, to: &Reference<f64>) -> Result<Row<f64>, EvalError> {
        let [arguments, mut results] = self.arguments(state);
        (self.evaluate)(&arguments, &mut results)?;
        Ok(self.compared(&results, to))
    }

    /// The same with rounding errors.
    #[inline]
    pub(super) fn rounded_row(
        &mut self,
        state: &State<Count>,
        to: &Reference<Count>,
    ) -> Result<Row<Count>, EvalError> {
        let [arguments, mut results] = self.arguments(state);
        (self.rounded)(&arguments, &mut results)?;
        Ok(self.compared(&results, to))
    }

    fn compared<S: Scalar>(&self, results: &[S], to: &Reference<S>) -> Row<S> {
        use ComparedDerivative::{AZ, FX, TauZ, WTauZZ, YAZZ, YFXX};
        let n = to.a_z.rows();
        // The first result is a vector.
        let whole = |rows: usize, columns: usize, from: usize| {
            matrix(rows, columns, |i, j| results[from + i * columns + j])
        };
        let found = match self.derivative {
            FX => whole(2 * n, 2 * n, 2 * n),
            YFXX => whole(2 * n, 2 * n, 2 * n + 4 * n * n),
            AZ | TauZ => whole(n, 3 * n, n),
            YAZZ | WTauZZ => second(results, n),
        };
        to.row(self.derivative, self.name, found.view())
    }
}

/// The Hessian in (q, v, u) or (q, v, a) from its blocks in (q, v), 2n x 2n, and in (u, q) or (a, q), n x n,
/// which come after a vector of n entries and a Jacobian of n x 3n.
fn second<S: Scalar>(results: &[S], n: usize) -> Matrix<S> {
    let (in_state, last) = results[n + 3 * n * n..].split_at(4 * n * n);
    matrix(3 * n, 3 * n, |i, j| match (i.max(j) < 2 * n, i.min(j) < n) {
        (true, _) => in_state[2 * n * i + j],
        (false, true) => last[n * (i.max(j) - 2 * n) + i.min(j)],
        (false, false) => S::zero(),
    })
}
