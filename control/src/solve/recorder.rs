//! The log of a search, who listens to it, and what may stop it.

use crate::bvp::Solvable;
use crate::bvp::newton::{Observer, Outcome, Step, newton};
use crate::bvp::timed::Timed;
use crate::extremal::Extremal;
use crate::progress::{Cancel, Iteration, Listener, Phase};
use crate::solve::attempt::Attempt;
use crate::status::Status;
use std::ops::ControlFlow;
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

/// Why a search stopped early.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Interruption {
    Cancelled,
    TimeLimit,
}

impl From<Interruption> for Status {
    fn from(interruption: Interruption) -> Self {
        match interruption {
            Interruption::Cancelled => Self::Cancelled,
            Interruption::TimeLimit => Self::TimeLimit,
        }
    }
}

/// What all attempts of a search share.
#[derive(Default)]
pub(crate) struct Recorder<'a> {
    pub iterations: Vec<Iteration>,
    /// Whether the direct method measures the times of its stages.
    pub takes_times: bool,
    listener: Option<Listener<'a>>,
    stop: Stop,
}

/// What may stop a search.
#[derive(Clone, Debug, Default)]
pub(crate) struct Stop {
    cancel: Option<Cancel>,
    /// Stops all threads of a search, once a listener asks for it.
    all: Cancel,
    deadline: Option<Instant>,
    /// Nodes of Newton steps that are left.
    work: Option<usize>,
    interruption: Option<Interruption>,
}

impl Stop {
    /// With the clock running from now.
    pub fn new(cancel: Option<Cancel>, time_limit: Option<Duration>) -> Self {
        // A limit beyond the range of the clock is none.
        let deadline = time_limit.and_then(|limit| Instant::now().checked_add(limit));
        Self { cancel, deadline, ..Self::default() }
    }

    /// Whether to stop, and why.
    pub fn check(&mut self) -> Option<Interruption> {
        if self.ended().is_none() && self.work == Some(0) {
            self.interruption = Some(Interruption::TimeLimit);
        }
        self.interruption
    }

    /// Whether the caller or the time stops the search, and which.
    pub fn ended(&mut self) -> Option<Interruption> {
        if self.interruption.is_none() {
            if self.all.is_cancelled() || self.cancel.as_ref().is_some_and(Cancel::is_cancelled) {
                self.interruption = Some(Interruption::Cancelled);
            } else if self.deadline.is_some_and(|deadline| Instant::now() >= deadline) {
                self.interruption = Some(Interruption::TimeLimit);
            }
        }
        self.interruption
    }

    /// Stops at the request of a listener.
    pub fn cancel(&mut self) {
        self.all.cancel();
        self.interruption.get_or_insert(Interruption::Cancelled);
    }
}

impl<'a> Recorder<'a> {
    pub fn new(listener: Option<Listener<'a>>, stop: Stop) -> Self {
        Self { listener, stop, ..Self::default() }
    }

    /// Whether to stop, and why.
    pub fn interruption(&mut self) -> Option<Interruption> {
        self.stop.check()
    }

    /// The same for what is not counted as work: the verification of what was solved.
    pub fn ended(&mut self) -> Option<Interruption> {
        self.stop.ended()
    }

    /// Stops the search.
    pub fn cancel(&mut self) {
        self.stop.cancel();
    }

    /// Runs `work` on so many threads, this one among them, each with a recorder of its own. All of them
    /// report to the listener of this one, and what stops one stops all.
    pub fn split(&mut self, threads: usize, work: impl Fn(&mut Recorder<'_>) + Sync) {
        let listener = Mutex::new(self.listener.take());
        let (stop, takes_times) = (self.stop.clone(), self.takes_times);
        let on_thread = || {
            let report = |iteration: &Iteration| {
                let mut listener = listener.lock().unwrap_or_else(PoisonError::into_inner);
                listener.as_mut().map_or(ControlFlow::Continue(()), |listener| listener(iteration))
            };
            let recorder = Recorder::new(Some(Box::new(report)), stop.clone());
            work(&mut Recorder { takes_times, ..recorder });
        };
        thread::scope(|scope| {
            // A thread that cannot be started leaves its part to the others.
            let start = |_| thread::Builder::new().spawn_scoped(scope, on_thread).ok();
            let others: Vec<_> = (1..threads).map_while(start).collect();
            on_thread();
            drop(others);
        });
        self.listener = listener.into_inner().unwrap_or_else(PoisonError::into_inner);
    }

    /// Runs with a limit on the nodes of all Newton steps together, beside the limits of the search. Unlike a
    /// time it is the same on all machines. Reaching it does not stop the search.
    pub fn within<T>(&mut self, nodes: usize, run: impl FnOnce(&mut Self) -> T) -> T {
        let own = self.stop.work.replace(nodes);
        let found = run(self);
        self.stop.work = own;
        let over = self.stop.deadline.is_some_and(|deadline| Instant::now() >= deadline);
        if self.stop.interruption == Some(Interruption::TimeLimit) && !over {
            self.stop.interruption = None;
        }
        found
    }

    /// Adds a step to the log and reports it.
    pub fn record(&mut self, iteration: Iteration) {
        if let Some(listener) = &mut self.listener
            && let ControlFlow::Break(()) = listener(&iteration)
        {
            self.stop.cancel();
        }
        if let Some(left) = &mut self.stop.work {
            *left = left.saturating_sub(iteration.nodes);
        }
        self.iterations.push(iteration);
    }

    /// Newton's method on one mesh, its steps in the log.
    pub fn newton<Q: Solvable<E>, E: Extremal + ?Sized>(
        &mut self,
        equations: &mut Q,
        timed: &mut Timed<'_, E>,
        attempt: &Attempt,
    ) -> Status {
        let mut log = Log { recorder: self, phase: attempt.phase };
        match newton(equations, timed, attempt.limits(), &mut log) {
            Outcome::Converged => Status::Converged,
            Outcome::Stalled => Status::NewtonFailed,
            Outcome::Limit => Status::IterationLimit,
            Outcome::Interrupted => self.interruption().unwrap_or(Interruption::Cancelled).into(),
            Outcome::Failed(failure) => failure.into(),
        }
    }
}

/// Newton steps of one phase.
struct Log<'r, 'a> {
    recorder: &'r mut Recorder<'a>,
    phase: Phase,
}

impl<Q: Solvable<E>, E: Extremal + ?Sized> Observer<Q, E> for Log<'_, '_> {
    fn interrupts(&mut self) -> bool {
        self.recorder.interruption().is_some()
    }

    fn step(&mut self, equations: &Q, timed: &Timed<'_, E>, step: Step) {
        let (cost, penalty) = equations.costs(timed);
        self.recorder.record(Iteration {
            phase: self.phase,
            nodes: equations.mesh().nodes(),
            number: step.number,
            residual: step.correction,
            step: step.damping,
            final_time: equations.final_time(timed),
            cost: cost + penalty,
        });
    }
}

#[cfg(test)]
mod tests {
    use super::{Interruption, Iteration, Phase, Recorder, Stop};
    use std::time::Duration;

    #[test]
    fn a_limit_of_a_part_does_not_stop_the_whole() {
        let mut recorder = Recorder::default();
        let step = |nodes: usize| Iteration {
            phase: Phase::FixedTime,
            nodes,
            number: 1,
            residual: 0.0,
            step: 1.0,
            final_time: 1.0,
            cost: 0.0,
        };
        let inside = recorder.within(20, |recorder| {
            [10, 9, 8].map(|nodes| {
                recorder.record(step(nodes));
                recorder.interruption()
            })
        });
        assert_eq!(inside, [None, None, Some(Interruption::TimeLimit)]);
        assert_eq!(recorder.interruption(), None);
        // The limit of the whole holds inside of a part, and after it.
        let mut recorder = Recorder::new(None, Stop::new(None, Some(Duration::ZERO)));
        let inside = recorder.within(60, Recorder::interruption);
        let limit = Some(Interruption::TimeLimit);
        assert_eq!((inside, recorder.interruption()), (limit, limit));
        let mut recorder = Recorder::default();
        recorder.within(60, Recorder::cancel);
        assert_eq!(recorder.interruption(), Some(Interruption::Cancelled));
    }
}
