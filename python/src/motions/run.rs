//! A solve on a thread of its own.

use super::raise;
use super::solution::SolutionCore;
use super::steps::{Step, step};
use costate_control::{Cancel, Problem, Solution, Solver, SolverOptions, Trajectory};
use pyo3::prelude::*;
use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// A solve that goes on while Python does something else. It ends early when it is dropped.
#[pyclass(frozen, name = "_Run", module = "costate._costate")]
pub struct Run {
    problem: Arc<Problem>,
    shared: Arc<Shared>,
}

/// What the threads share.
#[derive(Default)]
struct Shared {
    cancel: Cancel,
    state: Mutex<State>,
    ended: Condvar,
}

#[derive(Default)]
struct State {
    /// Newton steps that were not fetched yet.
    steps: Vec<Step>,
    /// The solution and its time (s), or the message of a panic.
    outcome: Option<Result<(Arc<Solution>, f64), String>>,
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Run {
    /// Begins a solve that was checked.
    ///
    /// # Errors
    /// `OSError` where there is no thread.
    pub fn begin(
        problem: Arc<Problem>,
        options: SolverOptions,
        start: Option<Trajectory>,
        collect: bool,
        times: bool,
    ) -> PyResult<Self> {
        let shared = Arc::new(Shared::default());
        let (there, posed) = (shared.clone(), problem.clone());
        let work = move || {
            let began = Instant::now();
            let solve = || solve(&posed, options, start.as_ref(), &there, collect, times);
            let solution = catch_unwind(AssertUnwindSafe(solve)).unwrap_or_else(|panic| {
                let text = panic.downcast_ref::<String>().map(String::as_str);
                let text = text.or(panic.downcast_ref::<&str>().copied());
                Err(text.unwrap_or("the solver panicked").to_owned())
            });
            let seconds = began.elapsed().as_secs_f64();
            there.lock().outcome = Some(solution.map(|solution| (Arc::new(solution), seconds)));
            there.ended.notify_all();
        };
        std::thread::Builder::new().name("costate".into()).spawn(work)?;
        Ok(Self { problem, shared })
    }
}

fn solve(
    problem: &Problem,
    options: SolverOptions,
    start: Option<&Trajectory>,
    shared: &Shared,
    collect: bool,
    times: bool,
) -> Result<Solution, String> {
    let mut solver = Solver::new(problem, options).map_err(|error| error.to_string())?;
    if let Some(start) = start {
        solver = solver.with_start(start).map_err(|error| error.to_string())?;
    }
    if times {
        solver = solver.with_stage_times();
    }
    if collect {
        solver = solver.on_iteration(|iteration| {
            shared.lock().steps.push(step(iteration));
            ControlFlow::Continue(())
        });
    }
    Ok(solver.with_cancel(shared.cancel.clone()).solve())
}

#[pymethods]
impl Run {
    /// Waits at most so many seconds; whether it has ended.
    fn wait(&self, py: Python<'_>, seconds: f64) -> bool {
        let most = Duration::try_from_secs_f64(seconds).unwrap_or(Duration::MAX);
        py.detach(|| {
            let going = |state: &mut State| state.outcome.is_none();
            let waited = self.shared.ended.wait_timeout_while(self.shared.lock(), most, going);
            waited.unwrap_or_else(PoisonError::into_inner).0.outcome.is_some()
        })
    }

    /// The Newton steps since the last time.
    fn steps(&self) -> Vec<Step> {
        std::mem::take(&mut self.shared.lock().steps)
    }

    /// Asks it to end before its next Newton step.
    fn cancel(&self) {
        self.shared.cancel.cancel();
    }

    /// The solution; None before the end.
    fn solution(&self) -> PyResult<Option<SolutionCore>> {
        match &self.shared.lock().outcome {
            None => Ok(None),
            Some(Ok((solution, seconds))) => {
                Ok(Some(SolutionCore::new(self.problem.clone(), solution.clone(), *seconds)))
            }
            Some(Err(message)) => Err(raise::failure(message)),
        }
    }
}

impl Drop for Run {
    fn drop(&mut self) {
        self.shared.cancel.cancel();
    }
}
