//! How a solution enters and leaves restoration: where no acceptable step is found, the elastic program is
//! solved from there until the filter accepts a point with less violation.

use crate::filter::Measure;
use crate::iterate::central;
use crate::outcome::{SolveError, Status};
use crate::problem::StagedProblem;
use crate::restoration::Elastic;
use crate::scaled::Scaled;
use crate::solve::{LARGEST_ESTIMATE, Restoration, Solver, Start};

/// Relative decrease of the violation from one centre of restoration to the next below which it has a
/// minimum.
const LEAST_DECREASE: f64 = 1e-3;

/// Part of the violation that restoration may leave: kappa_resto of IPOPT.
const RESTORED: f64 = 0.9;

impl Solver {
    /// Enters restoration at the iterate.
    pub(crate) fn begin_restoration<P: StagedProblem>(
        &mut self,
        problem: &mut Scaled<'_, P>,
    ) -> Result<Option<Status>, SolveError<P::Error>> {
        let current = Measure::of(&self.iterate);
        self.filter.add(current);
        let Self { iterate, trial, .. } = self;
        trial.point.copy_from_slice(&iterate.point);
        trial.slacks.copy_from_slice(&iterate.slacks);
        trial.gaps.clone_from(&iterate.gaps);
        problem.evaluate(&trial.point, &mut trial.values)?;
        self.centre_restoration(problem, current.violation)
    }

    /// Begins about the trial point, which has this violation.
    fn centre_restoration<P: StagedProblem>(
        &mut self,
        problem: &mut Scaled<'_, P>,
        violation: f64,
    ) -> Result<Option<Status>, SolveError<P::Error>> {
        let mut restoration = self.restoration.take().unwrap_or_else(|| Box::new(Restoration::new(self)));
        let Restoration { is_on, solver, places, room, centre, start, before, most, slacks, gaps } =
            &mut *restoration;
        solver.settings = Restoration::settings(self.settings);
        slacks.copy_from_slice(&self.trial.slacks);
        gaps.clone_from(&self.trial.gaps);
        (*is_on, *before, *most) = (true, violation, RESTORED * violation);
        centre.copy_from_slice(&self.trial.point);
        let mu = self.progress.mu.max(violation.min(1.0));
        room.take(&self.layout, places, problem.problem.bounds(), problem.scales());
        let from = (&self.trial.values, &self.trial.slacks[..], mu);
        room.start((&self.layout, places), centre, from, start);
        let mut elastic = Elastic::new(&mut *problem.problem, (places, room), centre);
        let begun = solver.begin_unchecked(&mut elastic, Start { mu: Some(mu), ..Start::at(start) });
        self.restoration = Some(restoration);
        begun.map(|_| None)
    }

    /// One iteration of restoration.
    pub(crate) fn go_on_restoring<P: StagedProblem>(
        &mut self,
        problem: &mut Scaled<'_, P>,
    ) -> Result<Option<Status>, SolveError<P::Error>> {
        let Some(restoration) = &mut self.restoration else { return Ok(Some(Status::Stalled)) };
        let Restoration { solver, places, room, centre, before, most, slacks, gaps, .. } = &mut **restoration;
        let status = solver.advance(&mut Elastic::new(&mut *problem.problem, (places, room), centre))?;
        let violation = places.violation(&self.layout, room.step_scales(), &solver.iterate, (slacks, gaps));
        let (before, most) = (*before, *most);
        if status.is_none() && violation > most {
            return Ok(None);
        }
        self.take_restored(problem)?;
        if violation > most {
            let is_minimum = matches!(status, Some(Status::Solved | Status::SolvedToRounding));
            // The minimum about one centre lowers the violation a little: go on from there.
            if is_minimum && violation < (1.0 - LEAST_DECREASE) * before {
                return self.centre_restoration(problem, violation);
            }
            self.leave_at_trial(problem)?;
            return Ok(Some(if is_minimum { Status::LocallyInfeasible } else { Status::Stalled }));
        }
        if !self.filter.accepts(Measure::of(&self.trial), self.progress.mu) {
            if RESTORED * violation <= f64::MIN_POSITIVE {
                self.leave_at_trial(problem)?;
                return Ok(Some(Status::Stalled));
            }
            return self.centre_restoration(problem, violation);
        }
        let (mu, Self { trial, .. }) = (self.progress.mu, &mut *self);
        for i in 0..trial.slacks.len() {
            let gaps = [trial.gaps[0][i], trial.gaps[1][i]];
            let central = central(gaps, mu).map(|z| z.min(LARGEST_ESTIMATE));
            [trial.z[0][i], trial.z[1][i]] = central;
            trial.v[i] = central[1] - central[0];
        }
        self.stop_restoring();
        std::mem::swap(&mut self.iterate, &mut self.trial);
        let found = self.estimate_multipliers(problem);
        self.measure_without_step();
        match found {
            Err(SolveError::NotFinite { .. }) => Ok(Some(Status::Stalled)),
            other => other.map(|()| None),
        }
    }

    /// Takes the point of restoration, if it is under way, as the iterate: without multipliers.
    pub(crate) fn leave_restoration<P: StagedProblem>(
        &mut self,
        problem: &mut P,
    ) -> Result<(), SolveError<P::Error>> {
        if !self.is_in_restoration() {
            return Ok(());
        }
        self.with_scaled(problem, |solver, scaled| {
            solver.take_restored(scaled)?;
            solver.leave_at_trial(scaled)
        })
    }

    /// The point of restoration as the trial point.
    fn take_restored<P: StagedProblem>(
        &mut self,
        problem: &mut Scaled<'_, P>,
    ) -> Result<(), SolveError<P::Error>> {
        let Self { trial, restoration, .. } = self;
        let Some(restoration) = restoration else { return Ok(()) };
        let Restoration { solver, places, slacks, gaps, .. } = &**restoration;
        trial.point.copy_from_slice(places.original_point(&solver.iterate.point));
        problem.evaluate(&trial.point, &mut trial.values)?;
        trial.slacks.copy_from_slice(slacks);
        trial.gaps.clone_from(gaps);
        Ok(())
    }

    /// Ends at the trial point, without multipliers.
    fn leave_at_trial<P: StagedProblem>(
        &mut self,
        problem: &mut Scaled<'_, P>,
    ) -> Result<(), SolveError<P::Error>> {
        self.stop_restoring();
        let trial = &mut self.trial;
        if trial.values.are_finite() {
            trial.y.fill(0.0);
            trial.v.fill(0.0);
            trial.z.iter_mut().for_each(|z| z.fill(0.0));
            std::mem::swap(&mut self.iterate, &mut self.trial);
        }
        self.stay(problem)
    }

    /// Whether the solution is in restoration.
    pub(crate) fn is_in_restoration(&self) -> bool {
        self.restoration.as_ref().is_some_and(|restoration| restoration.is_on)
    }

    pub(crate) fn stop_restoring(&mut self) {
        if let Some(restoration) = &mut self.restoration {
            restoration.is_on = false;
        }
    }
}
