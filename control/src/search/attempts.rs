//! Which attempts a search makes, in which order, and when it accepts what they found.
//!
//! [`Strategy::Direct`] makes the second attempt only. [`Strategy::Full`] goes through this list:
//!
//! 1. *From a motion* ([`Search::try_saved_motion`]), saved or found by the direct method: Newton's method
//!    on the arcs that its controls show ([`Search::try_saved`]); if that fails and there are controls
//!    without effort, from smoothed ones. Accepted if it converged, or nearly so
//!    ([`Solved::is_nearly_solved`]).
//! 2. *From cubics* ([`Search::try_guess`]): Newton's method, roughly at first. Left out if there are
//!    controls without effort, whose costates cannot be zero.
//! 3. *From relaxed problems* ([`Search::try_relaxed_problems`]), if the problem can be relaxed and the
//!    direct method found no motion that may be given instead. The result is returned as it is.
//!
//! If the search is stopped, the last result is returned. All numbers are in [`crate::constants`].

use crate::bvp::timed::Clock;
use crate::constants::attempts::FEW_STEPS;
use crate::constants::polish::SMOOTHING;
use crate::extremal::Relaxation;
use crate::options::{SolverOptions, Strategy};
use crate::problem::FinalTime;
use crate::progress::Phase;
use crate::search::Search;
use crate::solve::arcs::{solve_arcs, solve_given_arcs};
use crate::solve::{Attempt, Discretisation, Solved};
use crate::status::Status;

impl Search<'_, '_> {
    /// Makes the attempts that the options ask for.
    pub fn run(mut self, options: &SolverOptions) -> Solved {
        let attempt = Attempt::new(options, Phase::FixedTime);
        match options.strategy {
            Strategy::Direct => self.try_guess(self.time, attempt.max_steps, &attempt),
            Strategy::Full => self.full(&attempt),
        }
    }

    /// From a motion that is nearly optimal, alone: not from anything else if that fails.
    pub fn polish(mut self, options: &SolverOptions) -> Solved {
        self.try_saved_motion(&Attempt::new(options, Phase::Polish))
    }

    /// From a saved motion: Newton's method, on the arcs that its controls show if they jump, and from a
    /// smoothed problem if that fails.
    fn try_saved_motion(&mut self, attempt: &Attempt) -> Solved {
        // A saved motion brings its own duration.
        let time = match (self.time, self.guess.saved_duration()) {
            (FinalTime::Free { .. }, Some(guess)) => FinalTime::Free { guess },
            _ => self.time,
        };
        if let Some(found) = self.try_saved(time, attempt) {
            return found;
        }
        if self.extremal.easiest().effort == 0.0 {
            return self.try_guess(time, attempt.max_steps.min(FEW_STEPS), attempt);
        }
        let ease = Relaxation { effort: SMOOTHING, ..Relaxation::NONE };
        self.extremal.set_relaxation(ease);
        let Some(smoothed) = self.saved_discretisation(time, attempt) else {
            return self.at_fixed_time(time, 1.0, attempt).unsolved(self.extremal);
        };
        let few = Attempt { max_steps: FEW_STEPS, ..attempt.loose() };
        let at = self.solve(smoothed, &few);
        self.without_smoothing(at, ease, attempt)
    }

    /// The saved motion on one arc, with the clock of the problem.
    fn saved_discretisation(&mut self, time: FinalTime, attempt: &Attempt) -> Option<Discretisation> {
        let fixed = self.at_fixed_time(time, 1.0, attempt).evaluated(self.extremal).ok()?;
        match time {
            FinalTime::Fixed(_) => Some(fixed),
            FinalTime::Free { .. } => {
                fixed.with_clock(self.extremal, Clock::Free).evaluated(self.extremal).ok()
            }
        }
    }

    fn full(&mut self, attempt: &Attempt) -> Solved {
        let easiest = self.extremal.easiest();
        let mut last = None;
        if self.guess.saved_duration().is_some() {
            let found = self.try_saved_motion(attempt);
            if found.is_nearly_solved() || found.status.is_interruption() {
                return found;
            }
            self.extremal.set_relaxation(Relaxation::NONE);
            self.guess.forget_saved();
            last = Some(found);
        }
        if easiest.effort == 0.0 || easiest == Relaxation::NONE {
            let steps = if easiest == Relaxation::NONE { usize::MAX } else { FEW_STEPS };
            let found = self.try_guess(self.time, attempt.max_steps.min(steps), attempt);
            if found.is_nearly_solved() || easiest == Relaxation::NONE {
                return found;
            }
            last = Some(found);
        }
        match (last, self.recorder.interruption()) {
            (Some(last), Some(stopped)) => last.with_status(stopped.into()),
            (Some(last), None) if self.guess.is_replaceable() => last,
            _ => self.try_relaxed_problems(attempt),
        }
    }

    /// Newton's method from the simple guess: at first roughly and at a fixed time, with at most `max_steps`
    /// on a mesh.
    fn try_guess(&mut self, time: FinalTime, max_steps: usize, attempt: &Attempt) -> Solved {
        let guess = self.at_fixed_time(time, 1.0, attempt);
        let first = self.solve(guess, &Attempt { max_steps, ..attempt.loose() });
        self.finish(first, time, attempt)
    }

    /// From a saved motion at once to a sharp solution: on the arcs that its controls show, on those that its
    /// costates show if controls jump, or on its mesh if no control is at a bound. `None` where that fails.
    fn try_saved(&mut self, time: FinalTime, attempt: &Attempt) -> Option<Solved> {
        let rough = self.saved_discretisation(time, attempt)?;
        let crossings = self.guess.saved_crossings();
        if !crossings.is_empty() {
            let found = solve_given_arcs(&rough, crossings, self.extremal, attempt, self.recorder);
            if found.is_some() {
                return found;
            }
        }
        let easiest = self.extremal.easiest();
        if easiest.effort > 0.0 {
            return solve_arcs(&rough, self.extremal, attempt, self.recorder);
        }
        let sharp = Attempt { max_steps: attempt.max_steps.min(FEW_STEPS), ..*attempt };
        let bounded = easiest.bounds > 1.0;
        if bounded && !rough.crossings(self.extremal).is_empty() {
            return None;
        }
        let found = self.solve(rough, &sharp);
        let inside = !bounded || found.found.crossings(self.extremal).is_empty();
        (found.is_converged() && inside && found.found.final_time(self.extremal) > 0.0).then_some(found)
    }
}

impl Solved {
    /// Whether this is so near to a solution that no further attempt is made if there is no other.
    pub fn is_nearly_solved(&self) -> bool {
        matches!(self.status, Status::Converged | Status::MeshLimit | Status::SwitchesNotRefined)
    }
}
