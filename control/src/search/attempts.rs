//! Which attempts a search makes, in which order, and when it accepts what they found.
//!
//! [`Strategy::Direct`] makes the first attempt only. [`Strategy::Full`] goes through this list:
//!
//! 1. *From the guess*: Newton's method from the saved motion, on the arcs that it shows
//!    ([`Search::try_saved`]); otherwise, or if that fails, roughly at first from the saved motion or the
//!    cubics ([`Search::try_guess`]), unless there are controls without effort. Accepted at once if it
//!    converged from a saved motion. Otherwise a converged result is kept, and its cost must be undercut from
//!    here on.
//! 2. *From paths of low cost* ([`Search::try_path`]), one for each entry of [`PATHS`] that differs from
//!    those before in what this problem has: penalties, controls without effort. The loop ends when no path
//!    is found, or when the path is not noticeably cheaper than the solution that is kept. A result is
//!    accepted if it converged and costs less than what is kept; if nothing is kept, an almost converged one
//!    will do ([`Solved::is_nearly_solved`]).
//! 3. *From relaxed problems* ([`Search::try_relaxed_problems`]), if nothing converged so far and the
//!    problem can be relaxed. The result is returned as it is.
//!
//! If the search is stopped, the best result so far is returned. All numbers are in [`crate::constants`].

use crate::bvp::mesh::Mesh;
use crate::bvp::timed::{Arcs, Clock};
use crate::constants::attempts::{FEW_STEPS, NOTICEABLE, PATHS, PathAttempt};
use crate::constants::path::INTERVALS;
use crate::constants::polish::SMOOTHING;
use crate::extremal::Relaxation;
use crate::options::{SolverOptions, Strategy};
use crate::problem::FinalTime;
use crate::progress::Phase;
use crate::search::Search;
use crate::search::guess::FoundPath;
use crate::solve::arcs::{solve_arcs, solve_given_arcs};
use crate::solve::free_time::free_time;
use crate::solve::homotopy::follow;
use crate::solve::{Attempt, Discretisation, Layout, Solved};
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

    /// From a saved motion that is nearly optimal: Newton's method, on the arcs that its controls show if
    /// they jump, and from a smoothed problem if that fails.
    pub fn polish(mut self, options: &SolverOptions) -> Solved {
        let attempt = &Attempt::new(options, Phase::Polish);
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
        let saved = self.guess.saved_duration();
        // A saved motion brings its own duration.
        let begin = match (self.time, saved) {
            (FinalTime::Free { .. }, Some(guess)) => FinalTime::Free { guess },
            _ => self.time,
        };

        // 1. From the guess.
        let from_saved = saved.and_then(|_| self.try_saved(begin, attempt));
        let first = match from_saved {
            None if easiest.effort == 0.0 => {
                Some(self.try_guess(begin, attempt.max_steps.min(FEW_STEPS), attempt))
            }
            found => found,
        };
        let mut best = match first {
            Some(found) if saved.is_some() && found.is_converged() => return found,
            first => first,
        };

        // 2. From paths of low cost.
        let kept = best.as_ref().filter(|best| best.is_converged());
        let cost = kept.map(|kept| kept.found.total(self.extremal));
        let mut tried = Vec::new();
        for path in PATHS {
            let path = path.for_problem(easiest);
            if tried.contains(&path) {
                continue;
            }
            tried.push(path);
            if self.recorder.interruption().is_some() {
                break;
            }
            let Some(lower) = self.guess.find_path(path, self.recorder) else { break };
            if cost.is_some_and(|cost| lower.cost >= cost - NOTICEABLE * cost.abs()) {
                break;
            }
            let found = self.try_path(path, lower, attempt);
            let accepted = match cost {
                Some(cost) => found.is_converged() && found.found.total(self.extremal) < cost,
                None => found.is_nearly_solved(),
            };
            if accepted {
                return found;
            }
            best = best.filter(Solved::is_converged).or(Some(found));
        }

        // 3. From relaxed problems.
        match (best, self.recorder.interruption()) {
            (Some(best), _) if best.is_converged() || easiest == Relaxation::NONE => best,
            (Some(best), Some(stopped)) => best.with_status(stopped.into()),
            _ => {
                self.extremal.set_relaxation(Relaxation::NONE);
                self.try_relaxed_problems(attempt)
            }
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

    /// From a path of low cost to a solution: with the smoothing and the penalties of the path first.
    fn try_path(&mut self, path: PathAttempt, found: FoundPath, attempt: &Attempt) -> Solved {
        let mut ease = Relaxation { effort: path.smoothing, penalty: path.penalty, ..Relaxation::NONE };
        self.extremal.set_relaxation(ease);
        let rough = attempt.in_phase(Phase::FromPath).loose();
        let intervals = (2 * (attempt.nodes - 1)).max(INTERVALS << path.halvings);
        let layout = Layout {
            clock: Clock::Fixed(found.duration),
            arcs: Arcs::one(),
            mesh: Mesh::uniform(&[intervals]),
            points: attempt.points,
        };
        let guess = &mut *self.guess;
        let first = Discretisation::new(self.extremal, layout, |_, s, z| guess.path(s, z));
        let mut at = self.solve(first, &rough);
        if let (FinalTime::Free { .. }, true) = (self.time, at.is_converged()) {
            // The duration of the path is nearly optimal already.
            let free = at.found.with_clock(self.extremal, Clock::Free);
            let free = self.solve(free, &rough);
            let found = free.is_converged() && free.found.final_time(self.extremal) > 0.0;
            at = if found { free } else { free_time(at, self.extremal, &rough, self.recorder) };
        }
        if ease.penalty < 1.0 {
            let rising = attempt.in_phase(Phase::Penalties);
            at = follow(at, self.extremal, &rising, self.recorder, |extremal, s| {
                extremal.set_relaxation(Relaxation { penalty: path.penalty.powf(1.0 - s), ..ease });
            });
            ease.penalty = 1.0;
        }
        self.without_smoothing(at, ease, attempt)
    }
}

impl PathAttempt {
    /// Without what makes no difference to a problem with this easiest relaxation.
    fn for_problem(self, easiest: Relaxation) -> Self {
        Self {
            smoothing: if easiest.effort > 0.0 { self.smoothing } else { 0.0 },
            penalty: if easiest.penalty < 1.0 { self.penalty } else { 1.0 },
            ..self
        }
    }
}

impl Solved {
    /// Whether this is so near to a solution that no further attempt is made if there is no other.
    pub fn is_nearly_solved(&self) -> bool {
        matches!(self.status, Status::Converged | Status::MeshLimit | Status::SwitchesNotRefined)
    }
}
