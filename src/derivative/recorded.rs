//! Recorded programs as one more method.

// `#[inline]` in this file: compiled where it is used, not by everyone who builds the library.

use super::reference::Reference;
use super::row::{COSTATE, COSTATE_OF_MOTION, COSTATE_OF_Z, OF_TORQUE, OF_VELOCITY, Row, STATE, matrix};
use super::state::State;
use crate::codegen::{CodegenError, Coordinates, Program, ProgramOptions, Quantity, robot_program};
use crate::error::EvalError;
use crate::matrix::{Matrix, filled};
use crate::robot::Robot;
use crate::scalar::{Count, Scalar};
use std::fmt;

/// Evaluates a quantity: all arguments one after the other in, all results likewise out.
pub type Evaluate = Box<dyn FnMut(&[f64], &mut [f64]) -> Result<(), EvalError>>;

/// Derivatives by other means than the pipeline, such as machine code: [`Routes`](super::Routes) compares
/// them, too. The rounding error is that of the recorded program, which they are made from, step by step.
pub struct RecordedRoute {
    quantity: Quantity,
    coordinates: Coordinates,
    name: &'static str,
    program: Program,
    evaluate: Evaluate,
    results: Vec<f64>,
    counted: (Vec<Count>, Vec<Count>),
}

impl fmt::Debug for RecordedRoute {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("RecordedRoute")
            .field("quantity", &self.quantity)
            .field("coordinates", &self.coordinates)
            .field("name", &self.name)
            .finish_non_exhaustive()
    }
}

impl RecordedRoute {
    /// Records the program of the quantity that `evaluate` computes: `f_x` or `y_f_xx` in either coordinates,
    /// `tau_z` or `y_tau_zz`; of others nothing is compared.
    ///
    /// # Errors
    /// As [`robot_program`].
    pub fn new(
        robot: &Robot,
        quantity: Quantity,
        coordinates: Coordinates,
        name: &'static str,
        evaluate: Evaluate,
    ) -> Result<Self, CodegenError> {
        let program = robot_program(robot, quantity, coordinates, &ProgramOptions::default())?;
        let results = vec![0.0; program.outputs()];
        let counted = (Vec::new(), filled(Count::zero(), program.outputs()));
        Ok(Self { quantity, coordinates, name, program, evaluate, results, counted })
    }

    /// The arguments at a state.
    fn arguments<S: Scalar>(&self, state: &State<S>) -> Vec<S> {
        let State { q, p, v, u, y } = state;
        let (moving, y) = match self.coordinates {
            Coordinates::Hamiltonian => (p, &y[..]),
            Coordinates::Lagrangian => (v, &y[v.len()..]),
        };
        let weighted = matches!(self.quantity, Quantity::YFXX | Quantity::YTauZZ);
        [&q[..], moving, u, if weighted { y } else { &[] }].concat()
    }

    /// Its row in `f64`, if there is something to compare.
    #[inline]
    pub(super) fn row(
        &mut self,
        state: &State<f64>,
        to: &Reference<f64>,
    ) -> Result<Option<Row<f64>>, EvalError> {
        let arguments = self.arguments(state);
        (self.evaluate)(&arguments, &mut self.results)?;
        Ok(self.compared(&self.results, to))
    }

    /// The same with rounding errors.
    #[inline]
    pub(super) fn rounded_row(&mut self, state: &State<Count>, to: &Reference<Count>) -> Option<Row<Count>> {
        let arguments = self.arguments(state);
        let (work, results) = &mut self.counted;
        // The lengths are those of the program.
        self.program.evaluate(&arguments, results, work).ok()?;
        self.compared(&self.counted.1, to)
    }

    fn compared<S: Scalar>(&self, results: &[S], to: &Reference<S>) -> Option<Row<S>> {
        use Coordinates::{Hamiltonian, Lagrangian};
        use Quantity::{FX, TauZ, YFXX, YTauZZ};
        let n = to.a_z.rows();
        // The first result is a vector.
        let whole = |rows: usize, columns: usize, from: usize| {
            matrix(rows, columns, |i, j| results[from + i * columns + j])
        };
        let (quantity, found, expected, scales) = match (self.quantity, self.coordinates) {
            (FX, Hamiltonian) => ("F_x", whole(2 * n, 2 * n, 2 * n), &to.f_x, [STATE, COSTATE]),
            (YFXX, Hamiltonian) => {
                let first = 2 * n + 4 * n * n;
                ("y'F_xx", whole(2 * n, 2 * n, first), &to.y_f_xx, [COSTATE, COSTATE])
            }
            (FX, Lagrangian) => {
                ("a_z, z = (q, v, u)", whole(n, 3 * n, n), &to.a_z, [OF_VELOCITY, COSTATE_OF_Z])
            }
            (TauZ, Lagrangian) => {
                ("tau_z, z = (q, v, a)", whole(n, 3 * n, n), &to.tau_z, [OF_TORQUE, COSTATE_OF_MOTION])
            }
            (YFXX, Lagrangian) => ("y'a_zz", second(results, n), &to.y_a_zz, [COSTATE_OF_Z, COSTATE_OF_Z]),
            (YTauZZ, Lagrangian) => {
                ("w'tau_zz", second(results, n), &to.w_tau_zz, [COSTATE_OF_MOTION, COSTATE_OF_MOTION])
            }
            _ => return None,
        };
        Some(Row::new([quantity, self.name], found.view(), expected.view(), scales))
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
