//! Solving: with a budget, until a callback says stop.

use super::resolve::Resolve;
use super::resolved::{Budget, ResolveStatus, Resolved};
use crate::constants::direct as constants;
use crate::direct::interior::iterate::{End, Interior};
use crate::direct::solve::prepare::Dynamics;
use crate::solve::recorder::Interruption;
use costate::EvalError;
use std::ops::ControlFlow;
use std::time::Instant;

impl Resolve {
    /// Solves with the limits on steps and time of the options: the first solve.
    ///
    /// # Errors
    /// [`EvalError`] where the motion cannot be evaluated.
    pub fn solve(&mut self) -> Result<Resolved, EvalError> {
        self.solve_again(self.budget())
    }

    /// The limits on steps and time of the options.
    pub fn budget(&self) -> Budget {
        Budget { iterations: self.options.max_iterations, time: self.options.time_limit }
    }

    /// Solves the problem with what was set since the last time.
    ///
    /// # Errors
    /// [`EvalError`] where the motion cannot be evaluated; the next solve begins anew then, at the motion
    /// that was shown last.
    pub fn solve_again(&mut self, budget: Budget) -> Result<Resolved, EvalError> {
        self.solve_until(budget, || ControlFlow::Continue(()))
    }

    /// The same with a callback after each Newton step; [`ControlFlow::Break`] ends the solve with the
    /// status [`Cancelled`](ResolveStatus::Cancelled) and the best motion so far. Another thread stops it by
    /// a [`Cancel`](crate::Cancel) that the callback looks at.
    ///
    /// ```
    /// # use costate::robot::Robot;
    /// # use costate_control::{Cancel, Problem, Resolve, ResolveStatus, SolverOptions};
    /// # use std::ops::ControlFlow;
    /// # std::env::set_current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))?;
    /// # let robot = Robot::from_file("robots/two_link.toml")?;
    /// let problem = Problem::rest_to_rest(robot, &[0.0, 0.0], &[1.0, 0.5], 1.0);
    /// let mut motion = Resolve::new(&problem, SolverOptions::default())?;
    /// let cancel = Cancel::new(); // another thread has a clone
    /// cancel.cancel();
    /// let stop = || if cancel.is_cancelled() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) };
    /// let found = motion.solve_until(motion.budget(), stop)?;
    /// assert_eq!((found.status, found.iterations), (ResolveStatus::Cancelled, 1));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// As [`solve_again`](Self::solve_again).
    pub fn solve_until(
        &mut self,
        budget: Budget,
        mut listener: impl FnMut() -> ControlFlow<()>,
    ) -> Result<Resolved, EvalError> {
        let began = Instant::now();
        let found = self.try_again(budget, began, &mut listener);
        self.recovery.note(found.as_ref().ok().map(|found| found.status), &self.interior);
        if found.is_err() {
            (self.started, self.factorised) = (false, false);
            // What cannot be evaluated is no guess.
            if self.shown.spline.dof > 0 {
                self.interior.spline.copy_from(&self.shown.spline);
            }
        }
        found
    }

    fn try_again(
        &mut self,
        budget: Budget,
        began: Instant,
        listener: &mut dyn FnMut() -> ControlFlow<()>,
    ) -> Result<Resolved, EvalError> {
        self.begin_solve()?;
        self.shown.take(&self.interior);
        let first = self.interior.figures.iterations;
        let deadline = budget.time.and_then(|time| began.checked_add(time));
        self.interior.damping = self.damping;
        self.damping *= constants::DAMPING_DOWN;
        let (shown, longest, damping) = (&mut self.shown, &mut self.longest, &mut self.damping);
        let mut last = Instant::now();
        let watch = |iterate: &mut Interior<Dynamics>, _: f64| {
            shown.offer(iterate);
            *damping = iterate.damping;
            let now = Instant::now();
            // One step that the system held up does not count for ever.
            *longest = longest.mul_f64(constants::FADES).max(now - last);
            last = now;
            if listener().is_break() {
                return Some(Interruption::Cancelled);
            }
            deadline.filter(|&deadline| now + *longest > deadline).map(|_| Interruption::TimeLimit)
        };
        let end = self.interior.iterate(self.options.tolerance, budget.iterations.max(1), watch)?;
        self.started = true;
        self.factorised = end != End::NoProgress;
        let status = match end {
            End::Solved => ResolveStatus::Solved,
            End::IterationLimit => ResolveStatus::Iterations,
            End::NoProgress => ResolveStatus::NoProgress,
            End::Interrupted(Interruption::TimeLimit) => ResolveStatus::OutOfTime,
            End::Interrupted(Interruption::Cancelled) => ResolveStatus::Cancelled,
        };
        if status == ResolveStatus::Solved {
            // The last step is known, and the next solve begins after it. It is shown if limits are kept
            // there.
            let longest = self.interior.steps_of(self.interior.mu);
            let _ = self.interior.search(longest);
            if self.interior.figures.violation <= constants::VIOLATION_ACCEPTED {
                self.shown.take(&self.interior);
            } else {
                self.shown.offer(&self.interior);
            }
        }
        Ok(Resolved {
            status,
            iterations: self.interior.figures.iterations - first,
            cost: self.shown.cost,
            gap: self.shown.gap,
            violation: self.shown.violation,
            clearance_violation: self.shown.sweep(&mut self.interior.model.tasks)?,
            time: began.elapsed(),
        })
    }
}
