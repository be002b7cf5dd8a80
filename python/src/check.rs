//! The comparison of all methods for derivatives, for `costate.check`.

use crate::errors::{Failure, argument};
use crate::robot::Robot;
use crate::signals::{PAUSE, Signals};
use costate::codegen::{Coordinates, Quantity};
use costate::derivative::{DerivativeError, Figure, StateReport, Verdict, worse};
use costate::hamiltonian::Hamiltonian;
use costate::step::StepError;
use costate::{EvalError, robot};
use costate_comparison::{Routes, StepRoutes};
use costate_jit::{Backend, JitQuantity};
use pyo3::prelude::*;
use std::sync::Arc;
use std::sync::mpsc::{self, RecvTimeoutError};

/// Duration of the steps that are compared (s).
const STEP: f64 = 1e-3;

/// What machine code may differ by from the generic code, relative to the largest entry, where the condition
/// number of M is at most `WELL_CONDITIONED`; in proportion above it (`docs/jit.md`).
const MACHINE_CODE: f64 = 1e-12;
const WELL_CONDITIONED: f64 = 1e3;

/// One row: quantity, method, difference, bound, and whether it agrees; None: rounding leaves too few digits.
type Row = (&'static str, &'static str, f64, f64, Option<bool>);

/// The rows, how many states were looked at and how many of these left out, and Ctrl-C.
type Found = (Vec<Row>, usize, usize, Option<Py<PyAny>>);

/// The worst figure of each comparison over all states (q, v, tau, y), how many states were looked at, how
/// many of these were left out because M is singular there, and the exception of a signal that ended it.
#[pyfunction]
pub fn _compare(py: Python<'_>, robot: &Robot, states: Vec<[Vec<f64>; 4]>) -> PyResult<Found> {
    robot.refuse_constraints(py, "be checked")?;
    let (nq, n) = (robot.model().nq(), robot.model().dof());
    for [q, v, tau, y] in &states {
        if [q.len(), v.len(), tau.len(), y.len()] != [nq, n, n, 2 * n] {
            return Err(argument(py, "states", "a state is q (nq), v, tau (n each) and y (2n)".into()));
        }
    }
    let mut signals = Signals::default();
    let compared = py.detach(|| compare(robot.shared(), states, &mut signals))?;
    let (report, seen, left_out) = compared.map_err(|(state, failure)| failure.raise(py, vec![state]))?;
    let raised = signals.raised().map(|raised| raised.into_value(py).into_any());
    let row = |figure: &Figure| {
        let agrees = match figure.verdict(1.0) {
            Verdict::Agrees => Some(true),
            Verdict::Differs => Some(false),
            Verdict::NotComparable => None,
        };
        (figure.quantity, figure.route, figure.difference, figure.bound, agrees)
    };
    let (figures, machine) = report.map_or((Vec::new(), None), |(report, machine)| {
        let row = |[difference, bound]: [f64; 2]| {
            ("F, F_x, y'F_xx", "machine code", difference, bound, Some(difference <= bound))
        };
        (report.figures, machine.map(row))
    });
    Ok((figures.iter().map(row).chain(machine).collect(), seen, left_out, raised))
}

/// The worst report, with the difference of machine code and its bound where they are closest or farthest
/// beyond, if there is machine code; how many states were looked at, and how many left out.
type Compared = (Option<AtState>, usize, usize);

/// What computes the quantities that are compared.
struct Compare {
    routes: Routes,
    steps: StepRoutes,
    hamiltonian: Hamiltonian<f64>,
    /// With machine code, and without.
    codes: [Option<JitQuantity>; 2],
}

/// Compares all states, or those before a signal; the number of a state that cannot be evaluated comes with
/// its error. One state of a large robot takes seconds. So a thread of its own compares, and after a signal
/// it is left to finish the state that it is at, of which nobody hears any more.
///
/// # Errors
/// Where there is no thread.
fn compare(
    robot: Arc<robot::Robot>,
    states: Vec<[Vec<f64>; 4]>,
    signals: &mut Signals,
) -> std::io::Result<Result<Compared, (usize, Failure)>> {
    let (send, found) = mpsc::channel();
    let work = move || {
        let mut all = Compare::new(&robot);
        for state in &states {
            let at = all.at(state);
            let failed = at.is_err();
            if send.send(at).is_err() || failed {
                return;
            }
        }
    };
    let thread = std::thread::Builder::new().spawn(work)?;
    let (mut worst, mut seen, mut left_out) = (None::<AtState>, 0, 0);
    while !signals.came() {
        match found.recv_timeout(PAUSE) {
            Ok(Ok(Some((report, machine)))) => {
                worst = Some(match worst.take() {
                    None => (report, machine),
                    Some((before, of)) => (before.with_worse_of(&report), nearer(of, machine)),
                });
                seen += 1;
            }
            Ok(Ok(None)) => (seen, left_out) = (seen + 1, left_out + 1),
            Ok(Err(failure)) => return Ok(Err((seen, failure))),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => {
                thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
                break;
            }
        }
    }
    Ok(Ok((worst, seen, left_out)))
}

/// The figures of a state, and those of machine code, if there is any.
type AtState = (StateReport, Option<[f64; 2]>);

impl Compare {
    fn new(robot: &robot::Robot) -> Self {
        let codes = [None, Some(0)].map(|limit| {
            let of = (Quantity::YFXX, Coordinates::Hamiltonian);
            match limit {
                None => JitQuantity::new(robot, of.0, of.1),
                Some(limit) => JitQuantity::with_limit(robot, of.0, of.1, limit),
            }
            .ok()
        });
        let hamiltonian = Hamiltonian::new(robot);
        Self { routes: Routes::new(robot), steps: StepRoutes::new(robot), hamiltonian, codes }
    }

    /// All figures at a state; none where the mass matrix is singular.
    fn at(&mut self, [q, v, tau, y]: &[Vec<f64>; 4]) -> Result<Option<AtState>, Failure> {
        let x = [q.as_slice(), self.hamiltonian.momentum(q, v)?].concat();
        let mut report = match self.routes.compare(&x, tau, y) {
            Ok(report) => report,
            Err(DerivativeError::Function(EvalError::SingularMassMatrix { .. })) => return Ok(None),
            Err(DerivativeError::Function(error)) => return Err(error.into()),
            Err(error) => return Err(EvalError::Model { reason: error.to_string() }.into()),
        };
        match self.steps.compare(&x, tau, STEP, y, &mut report.figures) {
            Ok(()) | Err(StepError::NotConverged { .. } | StepError::Inaccurate { .. }) => {}
            Err(StepError::Dynamics(EvalError::SingularMassMatrix { .. })) => {}
            Err(error) => return Err(error.into()),
        }
        let bound = MACHINE_CODE * (report.condition / WELL_CONDITIONED).max(1.0);
        let machine = difference(&mut self.codes, &[x.as_slice(), tau, y].concat())?;
        Ok(Some((report, machine.map(|difference| [difference, bound]))))
    }
}

/// The one of two differences that is nearer to its bound, or farther beyond.
fn nearer(a: Option<[f64; 2]>, b: Option<[f64; 2]>) -> Option<[f64; 2]> {
    let part = |[difference, bound]: [f64; 2]| difference / bound;
    match (a, b) {
        (Some(a), Some(b)) => Some(if part(a) >= part(b) || part(a).is_nan() { a } else { b }),
        (a, b) => a.or(b),
    }
}

/// The largest difference of machine code from the generic code, relative to the largest entry; `None` where
/// there is no machine code.
fn difference(codes: &mut [Option<JitQuantity>; 2], inputs: &[f64]) -> Result<Option<f64>, EvalError> {
    let [Some(machine), Some(generic)] = codes else { return Ok(None) };
    if !matches!(machine.backend(), Backend::Compiled { .. }) {
        return Ok(None);
    }
    let (mut ours, mut expected) = (vec![0.0; machine.outputs()], vec![0.0; generic.outputs()]);
    machine.evaluate(inputs, &mut ours)?;
    generic.evaluate(inputs, &mut expected)?;
    let size = expected.iter().fold(0.0, |size, entry| worse(size, entry.abs()));
    let largest = ours.iter().zip(&expected).fold(0.0, |largest, (a, b)| worse(largest, (a - b).abs()));
    Ok(Some(if largest == 0.0 { 0.0 } else { largest / size }))
}
