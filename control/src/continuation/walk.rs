//! Points of a branch on meshes and arcs.

use super::bordered::Bordered;
use super::family::Family;
use super::{BranchPoint, Parameter, TurningPoint};
use crate::bvp::collocation::error::{Estimate, MeshLimits, estimate, next_mesh};
use crate::bvp::newton::set_scales;
use crate::bvp::timed::{Clock, Timed};
use crate::bvp::{Failure, Solvable};
use crate::constants::branch::{LEAST_DAMPING, MOST_MESHES, MOST_STEPS};
use crate::extremal::hamiltonian::RobotExtremal;
use crate::extremal::{Extremal, Homotopy};
use crate::solve::{Attempt, Discretisation, Recorder, Solved};
use crate::status::Status;

/// Where to look for the next point.
#[derive(Clone, Copy)]
pub(crate) enum Aim {
    /// This far along the branch; its direction has this sign in s.
    Along { step: f64, direction: f64 },
    /// At this s.
    At(f64),
}

/// A point of a branch.
pub(crate) struct Found {
    pub solved: Solved,
    /// s, from 0 to 1.
    pub position: f64,
    /// ds/d(length of the branch); lengths are measured in s and in the root mean square of the scaled change
    /// of z.
    pub slope: f64,
    /// Distance from the prediction, relative to the step.
    pub bend: f64,
}

/// A problem whose parameter changes.
pub(crate) struct Walker<'a, 'r> {
    pub family: Family<'a>,
    pub extremal: RobotExtremal,
    pub attempt: Attempt,
    pub recorder: Recorder<'r>,
}

impl Walker<'_, '_> {
    /// What an attempt at such a point may do: on one arc, where a control may be clipped to its bounds, a
    /// rough solution is enough to find its arcs.
    pub fn attempt_for(&self, at: &Discretisation) -> Attempt {
        let problem = self.family.problem;
        let clipped = problem.bounds.is_some() && !problem.cost.effort.contains(&0.0);
        if clipped && at.arcs.switches.is_empty() { self.attempt.loose() } else { self.attempt }
    }

    /// A point in the direction of `aim`, with as many nodes as the tolerance takes.
    pub fn go(&mut self, from: &Found, mut aim: Aim) -> Result<Found, Status> {
        let mut at = from.solved.found.predicted(&mut self.extremal, None);
        let mut position = from.position;
        let (family, attempt) = (self.family, self.attempt_for(&from.solved.found));
        let attempt = Attempt { max_steps: MOST_STEPS, least_damping: LEAST_DAMPING, ..attempt };
        let limits = MeshLimits { tolerance: attempt.tolerance, max_intervals: attempt.max_intervals() };
        let (mut bend, mut before) = (None, None);
        for _ in 0..MOST_MESHES {
            let mut timed = Timed::new(&mut self.extremal, at.clock, at.arcs);
            let set = |timed: &mut Timed<'_, RobotExtremal>, s: f64| -> Result<(), Failure> {
                let value = family.value(s);
                *timed.extremal = family.extremal(value)?;
                if family.parameter == Parameter::FinalTime {
                    timed.clock = match timed.clock {
                        Clock::Split(_) => Clock::Split(value),
                        _ => Clock::Fixed(value),
                    };
                }
                Ok(())
            };
            let mut bordered = Bordered::new(at.equations, position, set);
            set_scales(&mut bordered, &mut timed, None);
            bordered.linearise(&mut timed)?;
            let length = match aim {
                Aim::At(s) => bordered.aim_at(s),
                Aim::Along { step, direction } => {
                    bordered.step(step, direction);
                    step.abs()
                }
            };
            let status = self.recorder.newton(&mut bordered, &mut timed, &attempt);
            if !status.is_converged() {
                return Err(status);
            }
            if bend.is_none() {
                bend = Some(if length > 0.0 { bordered.deviation() / length } else { 0.0 });
            }
            position = match aim {
                Aim::At(s) => s,
                Aim::Along { .. } => bordered.inner.current.position,
            };
            let slope = bordered.slope();
            let estimated = bordered.estimate(&mut timed)?;
            let (clock, arcs) = (timed.clock, timed.arcs.clone());
            let mut found = Discretisation { equations: bordered.inner, clock, arcs };
            if estimated.largest() <= attempt.tolerance {
                let (relaxation, estimate) = (timed.extremal.relaxation(), Some(estimated));
                let solved =
                    Solved { found, status: Status::Converged, relaxation, estimate, violation: None };
                return Ok(Found { solved, position, slope, bend: bend.unwrap_or(0.0) });
            }
            if limits.full(found.equations.mesh.intervals()) {
                return Err(Status::MeshLimit);
            }
            let mesh = next_mesh(&found.equations, &estimated, before, limits);
            before = Some(estimated.largest());
            found.refine(&timed, mesh);
            at = found;
            if let Aim::Along { .. } = aim {
                aim = Aim::Along { step: 0.0, direction: slope };
            }
        }
        Err(Status::MeshLimit)
    }

    /// A point for the branch; `counted` iterations belong to the points before.
    pub fn point(&mut self, found: &Found, counted: usize) -> BranchPoint {
        let at = &found.solved.found;
        let (cost, penalty_cost) = at.costs(&mut self.extremal);
        BranchPoint {
            parameter: self.family.value(found.position),
            cost,
            penalty_cost,
            final_time: at.final_time(&mut self.extremal),
            hamiltonian: at.mean_hamiltonian(),
            status: found.solved.status.clone(),
            newton_steps: self.recorder.iterations.len() - counted,
        }
    }

    pub fn turning_point(&mut self, found: &Found) -> TurningPoint {
        let at = &found.solved.found;
        let (cost, _) = at.costs(&mut self.extremal);
        let final_time = at.final_time(&mut self.extremal);
        TurningPoint { parameter: self.family.value(found.position), cost, final_time, after: 0 }
    }
}

impl<F> Bordered<F> {
    /// The estimated error across the branch: at fixed s it would have no bound near a turning point.
    fn estimate<E: Extremal + ?Sized>(&mut self, timed: &mut Timed<'_, E>) -> Result<Estimate, Failure> {
        let Self { inner, border, .. } = self;
        Ok(estimate(inner, timed, |equations, defects, target| {
            equations.response(defects, target);
            border.bend(&equations.scale, target, 0.0);
        })?)
    }
}
