//! The nonlinear program of a motion on one mesh.

use super::arrays::numbers;
use crate::errors::evaluation;
use crate::signals::Signals;
use costate::EvalError;
use costate_control::MotionProgram;
use costate_nlp::{Certificate, Settings, SolveError, Solver, SparseProgram, StagedProblem, Start, Status};
use numpy::PyArray1;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::ops::ControlFlow;
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// A program whose calls wait for each other, without the interpreter's lock.
#[pyclass(frozen, name = "_Program", module = "costate._costate")]
pub struct ProgramCore {
    inner: Mutex<SparseProgram<MotionProgram>>,
    start: Vec<f64>,
    sizes: [usize; 3],
    bounds: [Vec<f64>; 2],
    rows: Vec<Row>,
    jacobian: [Vec<i64>; 2],
    hessian: [Vec<i64>; 2],
}

type Array<'py> = Bound<'py, PyArray1<f64>>;
type Indices<'py> = Bound<'py, PyArray1<i64>>;

/// Kind, name, unit and place of a constraint.
type Row = (&'static str, String, &'static str, f64);

/// Status, point, cost, multipliers, error of the conditions of optimality, iterations, certificate.
type Solved<'py> = (&'static str, Array<'py>, f64, Array<'py>, f64, usize, &'static str);

impl ProgramCore {
    pub fn new(program: MotionProgram) -> Self {
        let start = program.start().to_vec();
        let equalities = program.equalities().len();
        let rows = program.equalities().iter().chain(program.ranges());
        let rows = rows.map(|row| (row.kind, row.name.clone(), row.unit, row.place)).collect();
        // The unknowns are numbers: with zero as its centre x is the point itself.
        let sparse = SparseProgram::at(program, &vec![0.0; start.len()]);
        let listed =
            |lists: [&[usize]; 2]| lists.map(|list| list.iter().map(|&index| index as i64).collect());
        Self {
            sizes: [sparse.variables(), equalities, sparse.constraints()],
            bounds: sparse.bounds(),
            jacobian: listed(sparse.jacobian_structure()),
            hessian: listed(sparse.hessian_structure()),
            inner: Mutex::new(sparse),
            start,
            rows,
        }
    }

    /// Runs `work` at x, once no other call uses the program.
    fn at<R: Send>(
        &self,
        x: &Bound<'_, PyAny>,
        work: impl FnOnce(&mut SparseProgram<MotionProgram>, &[f64]) -> Result<R, EvalError> + Send,
    ) -> PyResult<R> {
        let (py, x) = (x.py(), numbers(x, "x", Some(self.start.len()))?);
        let found = py.detach(|| work(&mut self.inner.lock().unwrap_or_else(PoisonError::into_inner), &x));
        found.map_err(|error| evaluation(py, error))
    }
}

#[pymethods]
impl ProgramCore {
    /// Numbers of variables, of equations and of all constraints.
    fn sizes(&self) -> [usize; 3] {
        self.sizes
    }

    fn start<'py>(&self, py: Python<'py>) -> Array<'py> {
        PyArray1::from_slice(py, &self.start)
    }

    fn bounds<'py>(&self, py: Python<'py>) -> [Array<'py>; 2] {
        self.bounds.each_ref().map(|bounds| PyArray1::from_slice(py, bounds))
    }

    fn rows(&self) -> Vec<Row> {
        self.rows.clone()
    }

    fn jacobian_structure<'py>(&self, py: Python<'py>) -> [Indices<'py>; 2] {
        self.jacobian.each_ref().map(|list| PyArray1::from_slice(py, list))
    }

    fn hessian_structure<'py>(&self, py: Python<'py>) -> [Indices<'py>; 2] {
        self.hessian.each_ref().map(|list| PyArray1::from_slice(py, list))
    }

    fn cost(&self, x: &Bound<'_, PyAny>) -> PyResult<f64> {
        self.at(x, SparseProgram::cost)
    }

    fn gradient<'py>(&self, x: &Bound<'py, PyAny>) -> PyResult<Array<'py>> {
        let mut values = vec![0.0; self.sizes[0]];
        self.at(x, |program, x| program.gradient(x, &mut values))?;
        Ok(PyArray1::from_vec(x.py(), values))
    }

    fn constraints<'py>(&self, x: &Bound<'py, PyAny>) -> PyResult<Array<'py>> {
        let mut values = vec![0.0; self.sizes[2]];
        self.at(x, |program, x| program.constraints_at(x, &mut values))?;
        Ok(PyArray1::from_vec(x.py(), values))
    }

    fn jacobian<'py>(&self, x: &Bound<'py, PyAny>) -> PyResult<Array<'py>> {
        let values = self.at(x, |program, x| {
            let mut values = vec![0.0; program.jacobian_structure()[0].len()];
            program.jacobian(x, &mut values).map(|()| values)
        })?;
        Ok(PyArray1::from_vec(x.py(), values))
    }

    fn hessian<'py>(
        &self,
        x: &Bound<'py, PyAny>,
        multipliers: &Bound<'py, PyAny>,
        factor: f64,
    ) -> PyResult<Array<'py>> {
        let multipliers = numbers(multipliers, "lagrange", Some(self.sizes[2]))?;
        let values = self.at(x, |program, x| {
            let mut values = vec![0.0; program.hessian_structure()[0].len()];
            program.hessian(x, factor, &multipliers, &mut values).map(|()| values)
        })?;
        Ok(PyArray1::from_vec(x.py(), values))
    }

    /// For each point of the mesh t, then q, v, a and tau.
    fn sample<'py>(&self, x: &Bound<'py, PyAny>) -> PyResult<(Array<'py>, [Array<'py>; 4])> {
        let samples = self.at(x, |program, x| program.problem_mut().sample(x))?;
        let py = x.py();
        let mut lists = [Vec::new(), Vec::new(), Vec::new(), Vec::new()];
        for sample in &samples {
            let parts = [&sample.q, &sample.v, &sample.a, &sample.tau];
            lists.iter_mut().zip(parts).for_each(|(list, part)| list.extend_from_slice(part));
        }
        let times = PyArray1::from_iter(py, samples.iter().map(|sample| sample.t));
        Ok((times, lists.map(|list| PyArray1::from_vec(py, list))))
    }

    /// Solves by the solver of the library.
    fn solve<'py>(
        &self,
        x: &Bound<'py, PyAny>,
        tolerance: f64,
        iterations: usize,
        time_limit: f64,
    ) -> PyResult<Solved<'py>> {
        let (py, mut signals) = (x.py(), Signals::default());
        // What no clock counts to is no limit.
        let time_limit = match time_limit >= 0.0 {
            true => Duration::try_from_secs_f64(time_limit).ok(),
            false => {
                return Err(PyValueError::new_err(format!(
                    "time_limit is {time_limit}: give seconds, 0 or more"
                )));
            }
        };
        let found = self.at(x, |program, x| {
            let problem = program.problem_mut();
            let settings = Settings { tolerance, iterations, time_limit, ..Settings::default() };
            let mut solver = Solver::new(problem.layout(), settings);
            let observer = |_| match signals.came() {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            };
            let found = match solver.solve_observed(problem, Start::at(x), observer) {
                Ok(found) => found,
                Err(SolveError::Problem(error)) => return Err(error),
                Err(error) => return Ok(Err(error.to_string())),
            };
            let (status, cost, iterations) = (found.status, found.cost, found.iterations);
            let (point, error) = (found.point.to_vec(), found.error.largest());
            let multipliers = [found.equalities, found.ranges].concat();
            let is_solved = matches!(status, Status::Solved | Status::SolvedToRounding);
            let certificate = match is_solved {
                true => solver.certify(problem).ok(),
                false => None,
            };
            Ok(Ok((status, point, cost, multipliers, error, iterations, certificate)))
        })?;
        if let Some(raised) = signals.raised() {
            return Err(raised);
        }
        let found = found.map_err(PyValueError::new_err)?;
        let (status, point, cost, multipliers, error, iterations, certificate) = found;
        let [point, multipliers] = [point, multipliers].map(|list| PyArray1::from_vec(py, list));
        Ok((name(status), point, cost, multipliers, error, iterations, certificate_name(certificate)))
    }
}

fn name(status: Status) -> &'static str {
    match status {
        Status::Solved => "solved",
        Status::SolvedToRounding => "solved_to_rounding",
        Status::LocallyInfeasible => "locally_infeasible",
        Status::IterationLimit => "iteration_limit",
        Status::TimeLimit => "time_limit",
        _ => "stalled",
    }
}

fn certificate_name(certificate: Option<Certificate>) -> &'static str {
    match certificate {
        Some(Certificate::LocalMinimum) => "local_minimum",
        Some(Certificate::NotMinimum) => "not_minimum",
        Some(Certificate::NotStationary) => "not_stationary",
        Some(Certificate::Undecided) => "undecided",
        None => "not_checked",
    }
}
