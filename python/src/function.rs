//! A function of arrays: its arguments are read, all states are evaluated, its results are new arrays.

use crate::arrays::{Axes, Source, Target, allocate, read_all};
use crate::call::Call;
use crate::cores::Core;
use crate::failures::{Failures, report};
use crate::plan::Plan;
use crate::workspace::Workspace;
use costate::robot::Robot;
use costate_jit::JitLanes;
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use std::num::NonZero;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// Fewer states are evaluated one by one, on the calling thread.
const FEW: usize = 16;
/// States that a thread takes at a time; a multiple of the states in one number.
const CHUNK: usize = 64;
/// Numbers that the arguments and results of a batch have at least to be worth another thread.
const WORTH_A_THREAD: usize = 1 << 16;

/// How states that cannot be evaluated are reported, and how many threads evaluate batches.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Settings {
    /// Their results are not-a-number, with a warning; otherwise the first one is raised.
    pub nan: bool,
    /// At most so many threads; as many as the process may use where it is not given.
    pub threads: Option<NonZero<usize>>,
}

/// What computes a quantity: workspaces for any number of threads, and code for four states at once.
pub struct Engine {
    new_core: Box<dyn Fn() -> Box<dyn Core> + Send + Sync>,
    /// Workspaces that nobody uses.
    free: Mutex<Vec<Workspace>>,
    new_lanes: Box<dyn Fn() -> Option<JitLanes> + Send + Sync>,
    lanes: OnceLock<Option<JitLanes>>,
    /// Whether one state takes so little time that others need not be let in meanwhile.
    short: bool,
}

impl Engine {
    /// An engine whose workspaces `core` makes.
    pub fn new(core: impl Fn() -> Box<dyn Core> + Send + Sync + 'static) -> Self {
        Self {
            new_core: Box::new(core),
            free: Mutex::default(),
            new_lanes: Box::new(|| None),
            lanes: OnceLock::new(),
            short: false,
        }
    }

    /// The same with machine code for four states, which is made for the first batch.
    pub fn with_lanes(self, lanes: impl Fn() -> Option<JitLanes> + Send + Sync + 'static) -> Self {
        Self { new_lanes: Box::new(lanes), ..self }
    }

    /// The same, saying whether one state takes a few microseconds at most.
    pub fn short(self, short: bool) -> Self {
        Self { short, ..self }
    }

    fn lanes(&self) -> Option<&JitLanes> {
        self.lanes.get_or_init(|| (self.new_lanes)()).as_ref()
    }

    /// Runs `work` with a workspace that nobody else uses.
    #[inline]
    pub fn with<R>(&self, plan: &Plan, work: impl FnOnce(&mut Workspace) -> R) -> R {
        let free = self.free.lock().unwrap_or_else(PoisonError::into_inner).pop();
        let mut workspace = free.unwrap_or_else(|| Workspace::new((self.new_core)()));
        workspace.fit(plan);
        let result = work(&mut workspace);
        self.free.lock().unwrap_or_else(PoisonError::into_inner).push(workspace);
        result
    }
}

/// A function of arrays with N arguments.
pub struct Function {
    plan: Plan,
    engine: Arc<Engine>,
    /// The robot whose joints the entries of arguments belong to.
    robot: Arc<Robot>,
}

impl Function {
    pub fn new(plan: Plan, engine: Arc<Engine>, robot: Arc<Robot>) -> Self {
        Self { plan, engine, robot }
    }

    /// Evaluates the function at all states of its arguments: one array, or a tuple of them.
    ///
    /// # Errors
    /// `ArgumentError`, and `StateError` unless the settings ask for not-a-number.
    pub fn call<'py, const N: usize>(
        &self,
        py: Python<'py>,
        given: [&Bound<'py, PyAny>; N],
        settings: Settings,
    ) -> PyResult<Bound<'py, PyAny>> {
        let plan = &self.plan;
        let (_arguments, sources, axes) = read_all(py, given, &plan.arguments)?;
        if let [output] = plan.outputs.as_slice() {
            let (array, target) = allocate(py, &axes, output)?;
            self.evaluate(py, &sources, &[target], axes, settings)?;
            return Ok(array);
        }
        let new: Vec<_> =
            plan.outputs.iter().map(|output| allocate(py, &axes, output)).collect::<PyResult<_>>()?;
        let (arrays, targets): (Vec<_>, Vec<_>) = new.into_iter().unzip();
        self.evaluate(py, &sources, &targets, axes, settings)?;
        Ok(PyTuple::new(py, arrays)?.into_any())
    }

    #[inline]
    fn evaluate(
        &self,
        py: Python<'_>,
        sources: &[Source],
        targets: &[Target],
        axes: Axes,
        settings: Settings,
    ) -> PyResult<()> {
        let failures = if self.engine.short && axes.states() < FEW {
            self.compute(sources, targets, axes, settings)
        } else {
            py.detach(|| self.compute(sources, targets, axes, settings))
        };
        report(py, &axes, failures, settings.nan)
    }

    /// What it reads and writes.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// Evaluates all states, whose numbers are where the sources and targets of each argument and result say.
    #[inline]
    pub fn compute(
        &self,
        sources: &[Source],
        targets: &[Target],
        axes: Axes,
        settings: Settings,
    ) -> Failures {
        let Self { plan, robot, engine } = self;
        let states = axes.states();
        let call = Call { plan, robot, sources, targets, axes };
        if states >= FEW {
            return self.many(&call, states, settings);
        }
        engine.with(plan, |workspace| {
            let mut failures = Failures::default();
            (0..states).for_each(|state| call.one(workspace, state, &mut failures));
            failures
        })
    }

    /// Evaluates many states on lanes and threads. Which states are evaluated together does not depend on
    /// the number of threads.
    fn many(&self, call: &Call<'_>, states: usize, settings: Settings) -> Failures {
        let lanes = self.engine.lanes();
        let next = AtomicUsize::new(0);
        let work = || {
            self.engine.with(call.plan, |workspace| {
                let mut failures = Failures::default();
                loop {
                    let start = next.fetch_add(CHUNK, Ordering::Relaxed);
                    if start >= states {
                        return failures;
                    }
                    let end = states.min(start + CHUNK);
                    match lanes {
                        Some(lanes) => call.by_fours(lanes, workspace, start..end, &mut failures),
                        None => (start..end).for_each(|state| call.one(workspace, state, &mut failures)),
                    }
                }
            })
        };
        let numbers: usize = call.plan.outputs.iter().map(|output| output.length).sum::<usize>()
            + call.plan.arguments.iter().map(|argument| argument.length).sum::<usize>();
        let worth = (numbers.saturating_mul(states) / WORTH_A_THREAD).min(states / CHUNK);
        let most = || std::thread::available_parallelism().map_or(1, NonZero::get);
        let threads = if worth > 1 { settings.threads.map_or_else(most, NonZero::get).min(worth) } else { 1 };
        if threads <= 1 {
            return work();
        }
        // Threads live as long as the call: none is missing in a process that was forked.
        std::thread::scope(|scope| {
            let helpers: Vec<_> = (1..threads)
                .map_while(|_| std::thread::Builder::new().spawn_scoped(scope, work).ok())
                .collect();
            let mut failures = work();
            for helper in helpers {
                match helper.join() {
                    Ok(found) => failures.join(found),
                    Err(panic) => std::panic::resume_unwind(panic),
                }
            }
            failures
        })
    }
}
