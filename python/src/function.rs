//! A function of arrays: its arguments are read, all states are evaluated, its results are arrays.

use crate::arrays::{Axes, Source, read_all};
use crate::call::Call;
use crate::engine::Engine;
use crate::errors::{argument, whole};
use crate::failures::{Failures, report};
use crate::plan::Plan;
use crate::results::{Target, allocate, given};
use crate::signals::{Signals, with_reached};
use costate::robot::Robot;
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use std::num::NonZero;
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Fewer states are evaluated one by one, on the calling thread.
const FEW: usize = 16;
/// States between two looks whether to stop, and the fewest that a thread takes at a time; a multiple of the
/// states in one number.
const CHUNK: usize = 64;
/// Bytes of results that a thread takes at a time where there are many: new memory is given by pages of up to
/// 2 MB, and threads that write to the same one for the first time would clear it twice.
const STRETCH: usize = 1 << 23;
/// Such stretches for each thread, at least, and the most chunks of one: no thread waits long for the others.
const STRETCHES: usize = 8;
const MOST_CHUNKS: usize = 32;
/// States that a thread fills at a time after a signal.
const FILLED: usize = 4096;
/// More threads are probably a mistake.
const MOST_THREADS: usize = 4096;
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

impl Settings {
    /// By the words of a caller.
    ///
    /// # Errors
    /// `ArgumentError`.
    pub fn of(py: Python<'_>, on_error: &str, threads: Option<&Bound<'_, PyAny>>) -> PyResult<Self> {
        let nan = match on_error {
            "raise" => false,
            "nan" => true,
            _ => {
                let message = format!("unknown on_error '{on_error}'; give 'raise' or 'nan'");
                return Err(argument(py, "on_error", message));
            }
        };
        let threads = threads.map(|given| whole("threads", given, 1..=MOST_THREADS)).transpose()?;
        Ok(Self { nan, threads: threads.and_then(NonZero::new) })
    }

    /// `"raise"` or `"nan"`.
    pub fn on_error(&self) -> &'static str {
        if self.nan { "nan" } else { "raise" }
    }

    /// Most threads, where they are given.
    pub fn threads(&self) -> Option<usize> {
        self.threads.map(NonZero::get)
    }
}

/// A function of arrays with N arguments.
pub struct Function {
    plan: Plan,
    engine: Arc<Engine>,
    /// The robot whose joints the entries of arguments belong to.
    robot: Arc<Robot>,
    gaps: bool,
}

impl Function {
    pub fn new(plan: Plan, engine: Arc<Engine>, robot: Arc<Robot>) -> Self {
        Self { plan, engine, robot, gaps: false }
    }

    /// The same where some results are no numbers though nothing is wrong.
    pub fn with_gaps(self, gaps: bool) -> Self {
        Self { gaps, ..self }
    }

    /// Evaluates the function at all states of its arguments: one array, or a tuple of them; new ones, or
    /// those of the caller.
    ///
    /// # Errors
    /// `ArgumentError`, `StateError` unless the settings ask for not-a-number, `Interrupted`.
    pub fn call<'py, const N: usize>(
        &self,
        py: Python<'py>,
        arguments: [&Bound<'py, PyAny>; N],
        out: Option<&Bound<'py, PyAny>>,
        settings: Settings,
    ) -> PyResult<Bound<'py, PyAny>> {
        let plan = &self.plan;
        let (held, sources, axes) = read_all(py, arguments, &plan.arguments)?;
        if let ([output], None) = (plan.outputs.as_slice(), out) {
            let (array, target) = allocate(py, &axes, output)?;
            self.evaluate(py, &sources, &[target], axes, settings, || Ok(array.clone()))?;
            return Ok(array);
        }
        let results = match out {
            Some(out) => given(out, &axes, &plan.outputs, (&plan.arguments, &held))?,
            None => plan.outputs.iter().map(|output| allocate(py, &axes, output)).collect::<PyResult<_>>()?,
        };
        let (arrays, targets): (Vec<_>, Vec<_>) = results.into_iter().unzip();
        let all = || match arrays.as_slice() {
            [array] => Ok(array.clone()),
            _ => Ok(PyTuple::new(py, &arrays)?.into_any()),
        };
        self.evaluate(py, &sources, &targets, axes, settings, all)?;
        all()
    }

    #[inline]
    fn evaluate<'py>(
        &self,
        py: Python<'py>,
        sources: &[Source],
        targets: &[Target],
        axes: Axes,
        settings: Settings,
        results: impl Fn() -> PyResult<Bound<'py, PyAny>>,
    ) -> PyResult<()> {
        let states = axes.states();
        if states < FEW {
            let failures = if self.engine.short {
                self.compute(sources, targets, axes, settings)
            } else {
                py.detach(|| self.compute(sources, targets, axes, settings))
            };
            return report(py, &axes, failures, settings.nan);
        }
        let mut signals = Signals::default();
        let (failures, done) =
            py.detach(|| self.many(&self.all(sources, targets, axes), settings, Some(&mut signals)));
        match signals.raised() {
            None => report(py, &axes, failures, settings.nan),
            Some(raised) => {
                let words =
                    format!("interrupted after {done} of {states} states; .reached has their results");
                Err(with_reached(py, raised, results()?, words))
            }
        }
    }

    /// What it reads and writes.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    fn all<'a>(&'a self, sources: &'a [Source], targets: &'a [Target], axes: Axes) -> Call<'a> {
        Call { plan: &self.plan, robot: &self.robot, sources, targets, axes, gaps: self.gaps }
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
        let states = axes.states();
        let call = self.all(sources, targets, axes);
        if states >= FEW {
            return self.many(&call, settings, None).0;
        }
        self.engine.with(&self.plan, |workspace| {
            let mut failures = Failures::default();
            (0..states).for_each(|state| call.one(workspace, state, &mut failures));
            failures
        })
    }

    /// Evaluates many states on lanes and threads, until a signal comes. Which states are evaluated together
    /// does not depend on the number of threads. With the number of states before which all were reached; the
    /// results of all others are not-a-number.
    fn many(&self, call: &Call<'_>, settings: Settings, signals: Option<&mut Signals>) -> (Failures, usize) {
        let states = call.axes.states();
        let threads = self.threads(states, settings);
        let stretch = self.stretch(states, threads);
        let (next, reached, stopped) =
            (AtomicUsize::new(0), AtomicUsize::new(states), AtomicBool::new(false));
        let work = |mut signals: Option<&mut Signals>| {
            self.engine.with(call.plan, |workspace| {
                let has_lanes = self.engine.lanes(workspace);
                let mut failures = Failures::default();
                loop {
                    let start = next.fetch_add(stretch, Ordering::Relaxed);
                    if start >= states {
                        return failures;
                    }
                    let end = states.min(start + stretch);
                    for start in (start..end).step_by(CHUNK) {
                        // Only the thread that called from Python looks.
                        if signals.as_mut().is_some_and(|signals| signals.came()) {
                            stopped.store(true, Ordering::Relaxed);
                        }
                        if stopped.load(Ordering::Relaxed) {
                            reached.fetch_min(start, Ordering::Relaxed);
                            return failures;
                        }
                        let chunk = start..end.min(start + CHUNK);
                        match has_lanes {
                            true => call.by_fours(workspace, chunk, &mut failures),
                            false => chunk.for_each(|state| call.one(workspace, state, &mut failures)),
                        }
                    }
                }
            })
        };
        let mut failures = Failures::default();
        on_threads(threads, || work(None), || work(signals), |found| failures.join(found));
        let done = reached.into_inner();
        if done < states {
            fill(call.targets, done..states, threads);
        }
        (failures, done)
    }

    /// How many states a thread takes at a time.
    fn stretch(&self, states: usize, threads: usize) -> usize {
        let numbers: usize = self.plan.outputs.iter().map(|output| output.length).sum();
        let most = STRETCH / (numbers * size_of::<f64>()).max(1);
        (most.min(states / (STRETCHES * threads)) / CHUNK).clamp(1, MOST_CHUNKS) * CHUNK
    }

    /// How many threads so many states are worth.
    fn threads(&self, states: usize, settings: Settings) -> usize {
        let Plan { outputs, arguments, .. } = &self.plan;
        let numbers: usize = outputs.iter().map(|output| output.length).sum::<usize>()
            + arguments.iter().map(|argument| argument.length).sum::<usize>();
        let worth = (numbers.saturating_mul(states) / WORTH_A_THREAD).min(states / CHUNK);
        let most = || std::thread::available_parallelism().map_or(1, NonZero::get);
        if worth > 1 { settings.threads.map_or_else(most, NonZero::get).min(worth) } else { 1 }
    }
}

/// Runs `first` on this thread and `other` on all others at the same time, and takes what each returns.
/// Threads live as long as the call: none is missing in a process that was forked.
fn on_threads<R: Send>(
    threads: usize,
    other: impl Fn() -> R + Sync,
    first: impl FnOnce() -> R,
    mut take: impl FnMut(R),
) {
    if threads == 1 {
        return take(first());
    }
    std::thread::scope(|scope| {
        let helper = || std::thread::Builder::new().spawn_scoped(scope, &other).ok();
        let helpers: Vec<_> = (1..threads).map_while(|_| helper()).collect();
        take(first());
        for helper in helpers {
            match helper.join() {
                Ok(found) => take(found),
                Err(panic) => std::panic::resume_unwind(panic),
            }
        }
    });
}

/// Makes the results of states that were not reached not-a-number. Memory that nobody has written to yet is
/// given by the system page by page, which takes longer than the writing: all threads ask for it.
fn fill(targets: &[Target], states: Range<usize>, threads: usize) {
    let next = AtomicUsize::new(states.start);
    let work = || {
        loop {
            let start = next.fetch_add(FILLED, Ordering::Relaxed);
            if start >= states.end {
                return;
            }
            let part = start..states.end.min(start + FILLED);
            // SAFETY: no thread computes any more, and no other one fills these states.
            targets.iter().for_each(|target| unsafe { target.of_all(part.clone()) }.fill(f64::NAN));
        }
    };
    on_threads(threads, work, work, |()| ());
}
