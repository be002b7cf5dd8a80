//! A problem that is solved again and again.

use super::arrays::{matrix, numbers};
use super::feedback::FeedbackCore;
use super::raise;
use crate::errors::{argument, evaluation};
use crate::signals::Signals;
use costate_control::{Budget, Obstacle, Reference, Resolve, ResolveError, ResolveStatus, ToolOrientation};
use pyo3::prelude::*;
use std::cell::Cell;
use std::ops::ControlFlow;
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// A solver whose calls wait for each other, without the interpreter's lock.
#[pyclass(frozen, name = "_Resolve", module = "costate._costate")]
pub struct ResolveCore {
    inner: Mutex<Resolve>,
    n: usize,
}

/// What solving again gave: status, steps, cost, gap, violation at points and of clearances between them,
/// whether limits are kept, seconds; and the exception of a signal that ended it.
type Resolved = (&'static str, usize, f64, f64, f64, f64, bool, f64, Option<Py<PyAny>>);

thread_local! {
    /// The address of the solver that this thread uses.
    static IN_USE: Cell<usize> = const { Cell::new(0) };
}

/// While it lives, this thread uses a solver; with the one that it used before.
struct InUse(usize);

impl Drop for InUse {
    fn drop(&mut self) {
        IN_USE.set(self.0);
    }
}

impl ResolveCore {
    pub fn new(inner: Resolve) -> Self {
        Self { n: inner.dof(), inner: Mutex::new(inner) }
    }

    /// Number of joints.
    pub fn dof(&self) -> usize {
        self.n
    }

    /// Runs `work` once no other call uses the solver.
    ///
    /// # Errors
    /// `RuntimeError` where this thread uses it already: in the handler of a signal that came during a solve.
    pub fn with<R: Send>(&self, py: Python<'_>, work: impl FnOnce(&mut Resolve) -> R + Send) -> PyResult<R> {
        let this = std::ptr::from_ref(self).addr();
        if IN_USE.get() == this {
            let message = "this Resolve is solving; the handler of a signal cannot use it";
            return Err(pyo3::exceptions::PyRuntimeError::new_err(message));
        }
        Ok(py.detach(|| {
            let mut motion = self.inner.lock().unwrap_or_else(PoisonError::into_inner);
            let _in_use = InUse(IN_USE.replace(this));
            work(&mut motion)
        }))
    }

    /// The same for what can be refused.
    pub fn set(
        &self,
        py: Python<'_>,
        work: impl FnOnce(&mut Resolve) -> Result<(), ResolveError> + Send,
    ) -> PyResult<()> {
        self.with(py, work)?.map_err(|error| raise::resolve(py, error))
    }
}

#[pymethods]
impl ResolveCore {
    fn set_start(&self, py: Python<'_>, q: &Bound<'_, PyAny>, v: &Bound<'_, PyAny>) -> PyResult<()> {
        let (q, v) = (numbers(q, "q", Some(self.n))?, numbers(v, "v", Some(self.n))?);
        self.set(py, |motion| motion.set_start(&q, &v))
    }

    fn set_end(&self, py: Python<'_>, q: &Bound<'_, PyAny>, v: &Bound<'_, PyAny>) -> PyResult<()> {
        let (q, v) = (numbers(q, "q", Some(self.n))?, numbers(v, "v", Some(self.n))?);
        self.set(py, |motion| motion.set_end(&q, &v))
    }

    fn set_via(
        &self,
        py: Python<'_>,
        number: usize,
        q: &Bound<'_, PyAny>,
        v: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        let (q, v) = (numbers(q, "q", Some(self.n))?, numbers(v, "v", Some(self.n))?);
        self.set(py, |motion| motion.set_via(number, &q, &v))
    }

    /// Accelerations at the start, or at the end.
    fn set_acceleration(&self, py: Python<'_>, at_end: bool, a: &Bound<'_, PyAny>) -> PyResult<()> {
        let a = numbers(a, "a", Some(self.n))?;
        self.set(py, |motion| match at_end {
            true => motion.set_end_acceleration(&a),
            false => motion.set_start_acceleration(&a),
        })
    }

    /// The position of a tool: at the start, at the end or of a cost.
    fn set_tool(&self, py: Python<'_>, of: &str, number: usize, xyz: &Bound<'_, PyAny>) -> PyResult<()> {
        let xyz = numbers(xyz, "xyz", Some(3))?;
        let xyz = [xyz[0], xyz[1], xyz[2]];
        self.set(py, |motion| match of {
            "start" => motion.set_start_tool(number, xyz),
            "end" => motion.set_end_tool(number, xyz),
            _ => motion.set_tool_cost(number, xyz),
        })
    }

    /// The orientation of a tool, as the text of its keys: at the start, at the end or of a cost.
    fn set_orientation(&self, py: Python<'_>, of: &str, number: usize, text: &str) -> PyResult<()> {
        let to = ToolOrientation::from_text(text).map_err(|error| raise::file(py, &error))?;
        self.set(py, |motion| match of {
            "start" => motion.set_start_orientation(number, &to),
            "end" => motion.set_end_orientation(number, &to),
            _ => motion.set_tool_cost_orientation(number, &to),
        })
    }

    /// The text of a table `[[obstacle]]`.
    fn set_obstacle(&self, py: Python<'_>, number: usize, text: &str) -> PyResult<()> {
        let obstacle = Obstacle::from_text(text).map_err(|error| raise::file(py, &error))?;
        self.set(py, |motion| motion.set_obstacle(number, &obstacle.shape))
    }

    /// The text of a table `[[cost.reference]]`.
    fn set_reference(&self, py: Python<'_>, number: usize, text: &str) -> PyResult<()> {
        let reference = Reference::from_text(text).map_err(|error| raise::file(py, &error))?;
        self.set(py, |motion| motion.set_reference(number, &reference))
    }

    fn set_start_time(&self, py: Python<'_>, time: f64) -> PyResult<()> {
        self.set(py, |motion| motion.set_start_time(time))
    }

    fn advance(&self, py: Python<'_>, dt: f64) -> PyResult<()> {
        let refused = |reason: String| argument(py, "dt", format!("dt is {dt} s; {reason}"));
        if !(dt.is_finite() && dt >= 0.0) {
            return Err(refused(
                "give the time since the last solve, which is finite and not negative".into(),
            ));
        }
        self.with(py, |motion| match motion.final_time() {
            Some(time) if dt > time => Err(time),
            _ => {
                motion.advance(dt);
                Ok(())
            }
        })?
        .map_err(|time| refused(format!("the motion is over after {time} s")))
    }

    /// Begins anew.
    fn reset(&self, py: Python<'_>) -> PyResult<()> {
        self.with(py, Resolve::reset)
    }

    /// With at most so many Newton steps and seconds; with the limits of the options where neither is given.
    fn solve(&self, py: Python<'_>, steps: Option<usize>, seconds: Option<f64>) -> PyResult<Resolved> {
        let time = match seconds {
            Some(seconds) => {
                let time = Duration::try_from_secs_f64(seconds).ok().filter(|time| !time.is_zero());
                let message = "seconds must be a positive number";
                Some(time.ok_or_else(|| argument(py, "seconds", message.into()))?)
            }
            None => None,
        };
        let mut signals = Signals::default();
        let found = self.with(py, |motion| {
            let budget = match (steps, time) {
                (None, None) => motion.budget(),
                (steps, None) => Budget::steps(steps.unwrap_or(usize::MAX)),
                (steps, Some(time)) => Budget::steps(steps.unwrap_or(usize::MAX)).within(time),
            };
            motion.solve_until(budget, || match signals.came() {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            })
        })?;
        let raised = signals.raised().map(|raised| raised.into_value(py).into_any());
        let found = found.map_err(|error| evaluation(py, error))?;
        let status = match found.status {
            ResolveStatus::Solved => "solved",
            ResolveStatus::Iterations => "iterations",
            ResolveStatus::OutOfTime => "out_of_time",
            ResolveStatus::Cancelled => "cancelled",
            _ => "no_progress",
        };
        let (kept, seconds) = (found.keeps_limits(), found.time.as_secs_f64());
        let violations = (found.violation, found.clearance_violation);
        Ok((
            status,
            found.iterations,
            found.cost,
            found.gap,
            violations.0,
            violations.1,
            kept,
            seconds,
            raised,
        ))
    }

    fn final_time(&self, py: Python<'_>) -> PyResult<f64> {
        self.with(py, |motion| motion.final_time().unwrap_or(f64::NAN))
    }

    /// q, v and a at times (s), 3n numbers each.
    fn states<'py>(&self, py: Python<'py>, times: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let times = numbers(times, "times", None)?;
        let rows = self.with(py, |motion| {
            let row = |&t: &f64| {
                let mut z = vec![0.0; 3 * self.n];
                motion.state_at(t, &mut z).map(|()| z)
            };
            times.iter().map(row).collect::<Result<Vec<_>, _>>()
        })?;
        Ok(matrix(py, &rows.map_err(|error| raise::resolve(py, error))?, 3 * self.n)?.into_any())
    }

    /// Torques at times (s), n numbers each.
    fn torques<'py>(&self, py: Python<'py>, times: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let times = numbers(times, "times", None)?;
        let rows = self.with(py, |motion| {
            let row = |&t: &f64| {
                let mut torques = vec![0.0; self.n];
                motion.torques_at(t, &mut torques).map(|()| torques)
            };
            times.iter().map(row).collect::<Result<Vec<_>, _>>()
        })?;
        Ok(matrix(py, &rows.map_err(|error| raise::resolve(py, error))?, self.n)?.into_any())
    }

    fn feedback(&self, py: Python<'_>) -> PyResult<Option<FeedbackCore>> {
        let found = self.with(py, |motion| match motion.final_time() {
            None => Err(ResolveError::NotSolved),
            Some(_) => Ok(motion.feedback()?.cloned()),
        })?;
        Ok(found.map_err(|error| raise::resolve(py, error))?.map(FeedbackCore))
    }
}
