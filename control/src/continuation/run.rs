//! A continuation that runs: the branch point by point.

use super::family::Family;
use super::parameter::Parameter;
use super::points::{BranchEnd, BranchPoint, TurningPoint};
use super::walk::{Aim, Found, Walker};
use crate::constants::branch::{FIRST_STEP, LARGEST_STEP, LEAST_STEP, MOST_BEND, MOST_POINTS, STRAIGHT};
use crate::options::{Method, SolverOptions};
use crate::progress::Phase;
use crate::result::solution::Solution;
use crate::result::trajectory::Trajectory;
use crate::solve::{Attempt, Discretisation, Recorder};
use crate::starts::{Starts, solution};
use crate::status::Status;
use std::ops::ControlFlow;

/// A callback for each point; [`ControlFlow::Break`] cancels.
pub(super) type PointListener<'a> = Box<dyn FnMut(&BranchPoint) -> ControlFlow<()> + Send + 'a>;

/// What is known of a branch while it is followed.
pub(super) struct Walked {
    pub points: Vec<BranchPoint>,
    pub turning_points: Vec<TurningPoint>,
    pub end: BranchEnd,
    /// The solution at the first value, once there is one.
    pub first: Option<Solution>,
}

/// A continuation that runs.
pub(super) struct Run<'a> {
    pub family: Family<'a>,
    pub options: &'a SolverOptions,
    pub start: Option<&'a Trajectory>,
    pub point_listener: Option<PointListener<'a>>,
}

impl Run<'_> {
    /// The solution at the last point, or why there is none.
    pub fn walk(mut self, branch: &mut Walked, recorder: Recorder<'_>) -> Result<Solution, Status> {
        let collocation = SolverOptions { method: Method::Collocation, ..self.options.clone() };
        let attempt = Attempt::new(&collocation, Phase::Continuation);
        let extremal = self.family.extremal(self.family.from)?;
        let mut walker = Walker { family: self.family, extremal, attempt, recorder };
        let start = self.first(&mut walker, branch)?;
        let mut at = walker.begun(start)?;
        branch.end = BranchEnd::Stuck;
        let mut counted = self.report(&mut walker, &at, branch, 0);
        let mut step = FIRST_STEP;
        while branch.points.len() < MOST_POINTS {
            if walker.recorder.interruption().is_some() {
                return self.ended(branch, walker, at, BranchEnd::Interrupted);
            }
            let ahead = at.position + step * at.slope;
            let border = match ahead {
                ahead if ahead >= 1.0 => Some(1.0),
                ahead if ahead <= 0.0 => Some(0.0),
                _ => None,
            };
            let aim = border.map_or(Aim::Along { step, direction: at.slope }, Aim::At);
            let next = walker.go(&at, aim).and_then(|found| walker.on_its_arcs(found));
            let next = match next {
                Ok(found) if found.bend < MOST_BEND && (0.0..=1.0).contains(&found.position) => found,
                _ => {
                    step *= 0.5;
                    if step < LEAST_STEP {
                        return self.ended(branch, walker, at, BranchEnd::Stuck);
                    }
                    continue;
                }
            };
            if border.is_none() && next.slope * at.slope < 0.0 {
                let turn = walker.turn(&at, &next, step);
                branch.turning_points.push(TurningPoint { after: branch.points.len(), ..turn });
            }
            let straight = next.bend < STRAIGHT * MOST_BEND;
            at = next;
            counted = self.report(&mut walker, &at, branch, counted);
            match border {
                Some(1.0) => return self.ended(branch, walker, at, BranchEnd::Reached),
                Some(_) => return self.ended(branch, walker, at, BranchEnd::TurnedBack),
                None => {}
            }
            if straight {
                step = (2.0 * step).min(LARGEST_STEP);
            }
        }
        self.ended(branch, walker, at, BranchEnd::TooManyPoints)
    }

    /// A rough solution at the first value.
    fn first(&self, walker: &mut Walker<'_, '_>, branch: &mut Walked) -> Result<Discretisation, Status> {
        let first = self.family.problem_at(self.family.from)?;
        if self.family.parameter == Parameter::Smoothing {
            return walker.smoothed(&first);
        }
        if let Some(start) = self.start {
            return Ok(walker.rough(start, first.time));
        }
        let starts = Starts {
            problem: first.check().map_err(crate::bvp::Failure::from)?,
            options: self.options,
            saved: None,
            alone: false,
        };
        let solution = branch.first.insert(starts.solve(&mut walker.recorder));
        if solution.motion.status.is_solved() {
            Ok(walker.rough(&solution.trajectory, first.time))
        } else {
            Err(solution.motion.status.clone())
        }
    }

    /// Adds a point to the branch; `counted` iterations belong to the points before.
    fn report(
        &mut self,
        walker: &mut Walker<'_, '_>,
        found: &Found,
        branch: &mut Walked,
        counted: usize,
    ) -> usize {
        let point = walker.point(found, counted);
        if let Some(listener) = &mut self.point_listener
            && let ControlFlow::Break(()) = listener(&point)
        {
            walker.recorder.cancel();
        }
        branch.points.push(point);
        walker.recorder.iterations.len()
    }

    /// The solution at the last point.
    fn ended(
        &self,
        branch: &mut Walked,
        mut walker: Walker<'_, '_>,
        at: Found,
        end: BranchEnd,
    ) -> Result<Solution, Status> {
        let value = self.family.value(at.position);
        let last = self.family.problem_at(value)?;
        let mut extremal = self.family.extremal(value)?;
        let mut found = at.solved.into_solution(&mut extremal, &mut walker.recorder, self.options);
        let status = &mut found.motion.status;
        match end {
            BranchEnd::Stuck | BranchEnd::TooManyPoints => *status = Status::ContinuationFailed,
            BranchEnd::Interrupted => {
                let stopped = walker.recorder.interruption();
                *status = stopped.map_or(Status::ContinuationFailed, Status::from);
            }
            _ => {}
        }
        branch.end = end;
        Ok(solution(&last, self.options, found, &mut extremal))
    }
}
