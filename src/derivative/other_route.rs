//! Derivatives by other means than the pipeline, as one more method.

// `#[inline]` in this file: compiled where it is used, not by everyone who builds the library.

use super::reference::Reference;
use super::row::{COSTATE, COSTATE_OF_MOTION, COSTATE_OF_Z, OF_TORQUE, OF_VELOCITY, Row, STATE, matrix};
use super::state::State;
use crate::error::EvalError;
use crate::matrix::{Matrix, filled};
use crate::scalar::{Count, Scalar};
use std::fmt;

/// A derivative that [`Routes`](super::Routes) compares: what a [`Quantity`](crate::codegen::Quantity)
/// computes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ComparedDerivative {
    /// Arguments q, p, u; results F and F_x.
    FX,
    /// q, p, u, y (2n): F, F_x and y'F_xx.
    YFXX,
    /// q, v, u: a and a_z, z = (q, v, u).
    AZ,
    /// q, v, u, y (n): a, a_z, y'a_zz in (q, v), 2n x 2n, and in (u, q).
    YAZZ,
    /// q, v, a: tau and tau_z, z = (q, v, a).
    TauZ,
    /// q, v, a, w: tau, tau_z, w'tau_zz in (q, v), 2n x 2n, and in (a, q).
    WTauZZ,
}

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
        let (quantity, found, expected, scales) = match self.derivative {
            FX => ("F_x", whole(2 * n, 2 * n, 2 * n), &to.f_x, [STATE, COSTATE]),
            YFXX => ("y'F_xx", whole(2 * n, 2 * n, 2 * n + 4 * n * n), &to.y_f_xx, [COSTATE, COSTATE]),
            AZ => ("a_z, z = (q, v, u)", whole(n, 3 * n, n), &to.a_z, [OF_VELOCITY, COSTATE_OF_Z]),
            YAZZ => ("y'a_zz", second(results, n), &to.y_a_zz, [COSTATE_OF_Z, COSTATE_OF_Z]),
            TauZ => ("tau_z, z = (q, v, a)", whole(n, 3 * n, n), &to.tau_z, [OF_TORQUE, COSTATE_OF_MOTION]),
            WTauZZ => ("w'tau_zz", second(results, n), &to.w_tau_zz, [COSTATE_OF_MOTION, COSTATE_OF_MOTION]),
        };
        Row::new([quantity, self.name], found.view(), expected.view(), scales)
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
