//! What a mesh leaves: a status, verified where the motion is accurate.

use super::last_solved::LastSolved;
use super::refined::Refined;
use super::refinement::{Judged, Next, Refinement, Solved};
use crate::constants::direct as constants;
use crate::direct::interior::iterate::End;
use crate::direct::outcome::verify::{Again, integrate_again};
use crate::options::Verify;
use crate::result::stage_times::Stage;
use crate::status::Status;
use costate::EvalError;

impl Refinement<'_, '_> {
    /// The outcome if the loop ended here, and whether it does. `solves` tells whether the motion, if its
    /// equations are solved, is as accurate as it was asked for.
    pub(super) fn conclude(
        &mut self,
        solved: &Solved,
        judged: &Judged,
        solves: bool,
    ) -> Result<Option<Next>, EvalError> {
        let (mut again, error) = (None, judged.error);
        let status = match solved.end {
            End::Interrupted(interruption) => {
                // Estimates assume that the equations on the mesh are solved.
                let error = if judged.is_solved { error } else { f64::INFINITY };
                self.refined = Refined { error, ..Refined::without(interruption.into()) };
                let interior = &self.interior;
                let far_off = self.resolution.error() > constants::UNRESOLVED * interior.figures.size;
                if far_off && interior.running.costs_torques() {
                    self.takes_resolved(&solved.resolved)?;
                }
                return Ok(Some(Next::Done));
            }
            _ if solved.unresolved && !judged.violated => Status::MeshLimit,
            End::NoProgress | End::IterationLimit if judged.violated => Status::LimitsNotKept,
            End::NoProgress => Status::NewtonFailed,
            End::IterationLimit => Status::IterationLimit,
            End::Solved if solves => self.verified(&mut again),
            End::Solved => Status::MeshLimit,
        };
        let is_interrupted = status.is_interruption();
        let is_cut = status == Status::NotVerified && self.mended.wants_torques(&judged.beyond);
        self.refined = Refined { error, again, ..Refined::without(status) };
        if is_interrupted {
            return Ok(Some(Next::Done));
        }
        if is_cut && self.resolution.take_hulls(self.interior, true) {
            self.keeps();
            self.interior.begin_inside();
            return Ok(Some(Next::Iterate));
        }
        let unverified = solves && self.options.verify == Verify::None;
        let hopeless = judged.violated && !solved.unresolved && self.mesh >= constants::MESHES_WITHOUT_MOTION;
        Ok((self.refined.status.is_converged() || unverified || hopeless).then_some(Next::Done))
    }

    /// Whether the torques lead along the motion, to the tolerance of the options; or what stopped the
    /// search.
    fn verified(&mut self, again: &mut Option<Again>) -> Status {
        let Self { problem, options, interior, resolution, recorder, .. } = self;
        let mut stops = || recorder.interruption().is_some();
        let found = again.insert(integrate_again(problem, options, interior, resolution, &mut stops));
        interior.clock.lap(Stage::Verification);
        if !found.is_complete {
            return recorder.interruption().map_or(Status::NotVerified, Status::from);
        }
        if found.leads { Status::Converged } else { Status::NotVerified }
    }

    /// Keeps this motion if it is solved and the most accurate one so far.
    pub(super) fn keep_solved(&mut self, judged: &Judged) {
        if !judged.is_solved || judged.violated {
            return;
        }
        let keeps_limits = judged.beyond.violation <= constants::VIOLATION_BETWEEN;
        let Judged { error, accurate, .. } = *judged;
        if self.last_solved.as_ref().is_none_or(|last| (keeps_limits, -error) >= last.rank()) {
            let snapshot = self.interior.snapshot();
            self.last_solved = Some(LastSolved { snapshot, error, keeps_limits, accurate });
            self.stands_at_last = true;
        }
    }

    /// Where the loop did not end with a solution: back to the most accurate motion that was solved, with its
    /// accuracy. Where it gave up, another search may lead on first.
    ///
    /// # Errors
    /// A motion that cannot be evaluated, which one that was evaluated before is not.
    pub(super) fn fall_back(&mut self) -> Result<(), EvalError> {
        let Some(last) = self.last_solved.take().filter(|_| !self.stands_at_last) else { return Ok(()) };
        if self.refined.gave_up {
            self.refined.last_solved = Some(last);
            return Ok(());
        }
        let Self { interior, resolution, refined, options, .. } = self;
        refined.fall_back_to(last, (interior, resolution), options)
    }
}
