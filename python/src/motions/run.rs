//! A solve on a thread of its own.

use super::raise;
use super::solution::SolutionCore;
use super::steps::{Step, step};
use costate_control::{
    Branch, Cancel, Continuation, Iteration, Parameter, Problem, ProblemError, Solution, Solver,
    SolverOptions, Trajectory,
};
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

/// What a run does.
#[derive(Clone, Copy)]
pub enum Work {
    /// Solves the problem, with the times of stages.
    Solve { times: bool },
    /// Follows its solutions while a parameter changes.
    Follow(Range),
}

/// A parameter with its first and its last value.
#[derive(Clone, Copy)]
pub struct Range {
    pub parameter: Parameter,
    pub first: f64,
    pub last: f64,
}

impl Range {
    /// What follows the solutions.
    ///
    /// # Errors
    /// A problem without this parameter, or an option out of range.
    pub fn continuation(
        self,
        problem: &Problem,
        options: SolverOptions,
    ) -> Result<Continuation<'_>, ProblemError> {
        Continuation::new(problem, self.parameter, self.first, self.last, options)
    }
}

/// What a run found.
#[derive(Clone)]
struct Found {
    solution: Arc<Solution>,
    /// How following a branch ended, its points and its turning points, as JSON.
    branch: Option<[String; 3]>,
    /// How long it took (s).
    seconds: f64,
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
    /// What was found, or the message of a panic.
    outcome: Option<Result<Found, String>>,
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Run {
    /// Begins what was checked.
    ///
    /// # Errors
    /// `OSError` where there is no thread.
    pub fn begin(
        problem: Arc<Problem>,
        options: SolverOptions,
        start: Option<Trajectory>,
        work: Work,
        collect: bool,
    ) -> PyResult<Self> {
        let shared = Arc::new(Shared::default());
        let (there, posed) = (shared.clone(), problem.clone());
        let run = move || {
            let listener = |iteration: &Iteration| {
                if collect {
                    there.lock().steps.push(step(iteration));
                }
                ControlFlow::Continue(())
            };
            let began = Instant::now();
            let find = || match work {
                Work::Solve { times } => solve(&posed, options, start.as_ref(), &there, times, listener),
                Work::Follow(range) => follow(&posed, options, start.as_ref(), &there, range, listener),
            };
            let found = catch_unwind(AssertUnwindSafe(find)).unwrap_or_else(|panic| {
                let text = panic.downcast_ref::<String>().map(String::as_str);
                let text = text.or(panic.downcast_ref::<&str>().copied());
                Err(text.unwrap_or("the solver panicked").to_owned())
            });
            let seconds = began.elapsed().as_secs_f64();
            there.lock().outcome = Some(found.map(|found| Found { seconds, ..found }));
            there.ended.notify_all();
        };
        std::thread::Builder::new().name("costate".into()).spawn(run)?;
        Ok(Self { problem, shared })
    }
}

fn solve(
    problem: &Problem,
    options: SolverOptions,
    start: Option<&Trajectory>,
    shared: &Shared,
    times: bool,
    listener: impl FnMut(&Iteration) -> ControlFlow<()> + Send,
) -> Result<Found, String> {
    let mut solver = Solver::new(problem, options).map_err(|error| error.to_string())?;
    if let Some(start) = start {
        solver = solver.with_start(start).map_err(|error| error.to_string())?;
    }
    if times {
        solver = solver.with_stage_times();
    }
    let solution = solver.on_iteration(listener).with_cancel(shared.cancel.clone()).solve();
    Ok(Found { solution: Arc::new(solution), branch: None, seconds: 0.0 })
}

fn follow(
    problem: &Problem,
    options: SolverOptions,
    start: Option<&Trajectory>,
    shared: &Shared,
    range: Range,
    listener: impl FnMut(&Iteration) -> ControlFlow<()> + Send,
) -> Result<Found, String> {
    let mut follower = range.continuation(problem, options).map_err(|error| error.to_string())?;
    if let Some(start) = start {
        follower = follower.with_start(start).map_err(|error| error.to_string())?;
    }
    let branch = follower.on_iteration(listener).with_cancel(shared.cancel.clone()).follow();
    let json = || -> serde_json::Result<[String; 3]> {
        let Branch { end, points, turning_points, .. } = &branch;
        Ok([
            serde_json::to_string(end)?,
            serde_json::to_string(points)?,
            serde_json::to_string(turning_points)?,
        ])
    };
    let found = json().map_err(|error| error.to_string())?;
    Ok(Found { solution: Arc::new(branch.solution), branch: Some(found), seconds: 0.0 })
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
        let found = self.found()?;
        Ok(found.map(|Found { solution, seconds, .. }| {
            SolutionCore::new(self.problem.clone(), solution, seconds)
        }))
    }

    /// Of a branch: how it ended, its points, its turning points, as JSON.
    fn branch(&self) -> PyResult<Option<[String; 3]>> {
        Ok(self.found()?.and_then(|found| found.branch))
    }
}

impl Run {
    fn found(&self) -> PyResult<Option<Found>> {
        match self.shared.lock().outcome.clone() {
            None => Ok(None),
            Some(Ok(found)) => Ok(Some(found)),
            Some(Err(message)) => Err(raise::failure(&message)),
        }
    }
}

impl Drop for Run {
    fn drop(&mut self) {
        self.shared.cancel.cancel();
    }
}
