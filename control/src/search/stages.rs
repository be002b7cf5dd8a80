//! From relaxed problems to the problem itself.

use crate::constants::attempts::{
    FEW_STEPS, NEGLIGIBLE_CHANGE, SMOOTHED_NODES, SMOOTHED_TOLERANCE, SMOOTHINGS, WEAK_PENALTY,
};
use crate::extremal::{Extremal, Relaxation};
use crate::problem::FinalTime;
use crate::progress::Phase;
use crate::search::Search;
use crate::solve::arcs::solve_arcs;
use crate::solve::free_time::free_time;
use crate::solve::homotopy::{follow, follow_from};
use crate::solve::{Attempt, Solved};
use crate::status::Status;

impl Search<'_, '_> {
    /// Without limits, and to a nearer end if that fails; then by continuation to the end, the final time,
    /// the penalties, the bounds and the smoothing of the problem itself.
    pub fn try_relaxed_problems(&mut self, attempt: &Attempt) -> Solved {
        let easiest = self.extremal.easiest();
        let mut ease = Relaxation { goal: 1.0, ..easiest };
        let mut phase = Phase::WithoutLimits;
        let few = Attempt { max_steps: attempt.max_steps.min(FEW_STEPS), ..attempt.loose() };
        self.extremal.set_relaxation(ease);
        // Without limits this is where a search from cubics began, and that failed.
        let unlimited = Relaxation { goal: 1.0, ..easiest } == Relaxation::NONE;
        let mut at = if unlimited && self.guess.saved_mesh().is_none() {
            let guess = self.at_fixed_time(self.time, ease.goal, attempt);
            guess.unsolved(self.extremal)
        } else {
            let guess = self.at_fixed_time(self.time, 1.0, attempt);
            self.solve(guess, &few.in_phase(phase))
        };
        if !at.is_converged() && easiest.goal < 1.0 {
            phase = Phase::NearerEnd;
            ease.goal = easiest.goal;
            self.extremal.set_relaxation(ease);
            let guess = self.at_fixed_time(self.time, ease.goal, attempt);
            at = self.solve(guess, &few.in_phase(phase));
            at = self.follow(at, &attempt.in_phase(phase), |extremal, s| {
                extremal.set_relaxation(Relaxation { goal: easiest.goal + s * (1.0 - easiest.goal), ..ease });
            });
            ease.goal = 1.0;
        }
        if let (FinalTime::Free { .. }, true) = (self.time, at.is_converged()) {
            at = free_time(at, self.extremal, &attempt.in_phase(phase).loose(), self.recorder);
        }
        if easiest.penalty < 1.0 {
            at = self.follow(at, &attempt.in_phase(Phase::Penalties), |extremal, s| {
                extremal.set_relaxation(Relaxation { penalty: WEAK_PENALTY.powf(1.0 - s), ..ease });
            });
            ease.penalty = 1.0;
        }
        let mut violation = None;
        if easiest.bounds > 1.0 {
            self.extremal.set_relaxation(Relaxation { bounds: 1.0, ..ease });
            let excess = at.found.excess(self.extremal).max(1.0);
            at = self.follow(at, &attempt.in_phase(Phase::Bounds), |extremal, s| {
                extremal.set_relaxation(Relaxation { bounds: excess.powf(1.0 - s), ..ease });
            });
            ease.bounds = 1.0;
            if at.status == Status::ContinuationFailed {
                violation = at.bound_violation(self.extremal);
            }
        }
        let found = self.without_smoothing(at, ease, attempt);
        match violation {
            Some(violation) if !(found.is_nearly_solved() || found.status.is_interruption()) => {
                found.beyond_bounds(violation)
            }
            _ => found,
        }
    }

    fn follow(&mut self, at: Solved, attempt: &Attempt, set: impl FnMut(&mut dyn Extremal, f64)) -> Solved {
        follow(at, self.extremal, attempt, self.recorder, set)
    }

    /// From a solution of a problem with the relaxation `ease`, the smoothing at most, to one of the problem
    /// itself.
    pub fn without_smoothing(&mut self, at: Solved, ease: Relaxation, attempt: &Attempt) -> Solved {
        if ease.effort > 0.0 {
            return self.reduce_smoothing(at, ease, attempt);
        }
        self.extremal.set_relaxation(Relaxation::NONE);
        let phase = if let FinalTime::Fixed(_) = self.time { Phase::FixedTime } else { Phase::FreeTime };
        self.sharpen(at, &attempt.in_phase(phase))
    }

    /// The smoothing of controls without effort is reduced step by step; after each step the arcs of its
    /// solution are tried. The steps end when the cost has settled twice and the same controls change sides
    /// in the same order: the arcs that failed would be tried again.
    fn reduce_smoothing(&mut self, mut at: Solved, mut ease: Relaxation, attempt: &Attempt) -> Solved {
        let attempt = &attempt.in_phase(Phase::Smoothing);
        let (mut change, mut settled, mut switches) = (f64::INFINITY, false, Vec::new());
        let from = ease.effort;
        for next in SMOOTHINGS.into_iter().filter(|&next| next <= from) {
            let effort = ease.effort;
            let before = at.found.total(self.extremal);
            at = follow_from(1.0, at, self.extremal, attempt, self.recorder, |extremal, s| {
                ease.effort = effort * (next / effort).powf(s);
                extremal.set_relaxation(ease);
            });
            self.extremal.set_relaxation(Relaxation::NONE);
            let few = Attempt { max_steps: FEW_STEPS, ..*attempt };
            if let Some(found) = solve_arcs(&at.found, self.extremal, &few, self.recorder) {
                return found;
            }
            let changed = (at.found.total(self.extremal) - before).abs() / before.abs();
            if !at.is_converged() {
                // A step that got stuck halfway: the change of the whole step by extrapolation.
                if ease.effort < effort {
                    change = changed * (effort / next).ln() / (effort / ease.effort).ln();
                }
                break;
            }
            change = changed;
            let before = std::mem::take(&mut switches);
            switches.extend(at.found.crossings(self.extremal).iter().map(|crossing| crossing.switch));
            let small = change < NEGLIGIBLE_CHANGE;
            let no_news = small && settled && switches == before;
            if no_news || (small && at.found.equations.mesh.nodes() > SMOOTHED_NODES) {
                break;
            }
            settled = small;
        }
        // The motion of the smoothed problem; it respects the bounds and meets the end.
        self.extremal.set_relaxation(ease);
        let smoothed = self.solve(at.found, &attempt.no_sharper_than(SMOOTHED_TOLERANCE));
        match smoothed.status {
            Status::Converged if change.is_nan() || change > NEGLIGIBLE_CHANGE => {
                smoothed.with_status(Status::SwitchesNotRefined)
            }
            _ => smoothed,
        }
    }
}
