//! From a problem to a motion: starts, meshes, verification.

use super::first::First;
use super::looks::{Found, Looked, Looks};
use super::meshes::refine;
use super::prepare::{Dynamics, interior_of};
use super::refined::Refined;
use super::refinement::Start;
use super::settle::settle;
use super::verified::verify_and_repair;
use super::with_effort::{Smoothing, WithEffort, with_effort};
use crate::constants::direct as constants;
use crate::constants::guesses;
use crate::constants::saddle;
use crate::direct::interior::inertia::Inertia;
use crate::direct::interior::iterate::Interior;
use crate::direct::interior::looseness::Looseness;
use crate::direct::outcome::found::{self, found};
use crate::direct::outcome::independent;
use crate::direct::outcome::report::report;
use crate::direct::outcome::verify::{Again, integrate_again};
use crate::direct::refine::at_ends::AtEnds;
use crate::direct::refine::resolution::Resolution;
use crate::options::{SolverOptions, Verify};
use crate::parallel::best_of_starts;
use crate::problem::check::CheckedProblem;
use crate::result::motion::{Certificate, Motion};
use crate::result::solution::{RobotNames, Solution};
use crate::result::stage_times::{Clock, Stage};
use crate::result::start::StartResult;
use crate::result::trajectory::Trajectory;
use crate::result::verification::Verification;
use crate::solve::Recorder;
use crate::status::Status;
use crate::task::build::TaskRows;
use crate::verdict::rank::compare;
use costate::EvalError;
use std::cmp::Ordering;

/// A problem that the direct method solves from one or several guesses.
pub(crate) struct Direct<'a> {
    pub problem: CheckedProblem<'a>,
    /// The functions of its task.
    pub rows: &'a TaskRows,
    pub options: &'a SolverOptions,
    /// That of the tolerance that was asked for, which may be tighter than that of the options.
    pub looseness: Looseness,
    /// Where the first start begins.
    pub saved: Option<&'a Trajectory>,
}

impl Direct<'_> {
    /// The best solution of all starts, as [`compare`] says.
    pub fn solve(&self, recorder: &mut Recorder<'_>) -> Solution {
        let missing = |status| Solution::without_motion(&self.problem, status);
        let solve = |number, recorder: &mut Recorder<'_>| {
            let failed = |error: EvalError| missing(Status::EvaluationFailed(error.into()));
            self.start(number, recorder).unwrap_or_else(failed)
        };
        best_of_starts(self.options, recorder, solve).unwrap_or_else(|| missing(Status::Cancelled))
    }

    /// One start: from the best guess that it looks at, or from the second best one where that fails. A
    /// motion that fails beside obstacles is then begun at disturbed guesses, which pass them elsewhere.
    pub fn start(&self, number: usize, recorder: &mut Recorder<'_>) -> Result<Solution, EvalError> {
        let problem = self.problem.problem();
        let saved = self.saved.filter(|_| number == 0);
        let clock = Clock::new(recorder.takes_times);
        let first = First::new(problem, self.rows, self.options, number, saved);
        let Self { rows, options, looseness, .. } = *self;
        let Found { best, next, looks, steps } = match saved {
            None if number == 0 => {
                Looks { problem, rows, options, looseness }.best(&first, clock, recorder)?
            }
            _ => {
                let mut interior = interior_of(problem, rows, options, &first);
                (interior.clock, interior.looseness) = (clock, looseness);
                let is_own = |saved: &Trajectory| {
                    saved.mesh_nodes().is_some_and(|nodes| nodes == interior.spline.mesh.nodes)
                };
                let start = match saved {
                    Some(saved) if is_own(saved) => Start::Resolved,
                    _ if self.saved.is_some() => Start::Saved,
                    _ => Start::Guess,
                };
                Found::alone(first.kind, interior, start)
            }
        };
        let mut guess = best.kind;
        let mut looks = looks;
        let mut solution = self.carry_on(best, recorder)?;
        let mut try_next = |looked: Looked, solution: &mut Solution, recorder: &mut Recorder<'_>| {
            let kind = looked.kind;
            let other = self.carry_on(looked, recorder)?;
            if better_of(solution, other) {
                guess = kind;
            }
            Ok::<_, EvalError>(())
        };
        if let Some(next) = next.filter(|_| fails(&solution)) {
            try_next(next, &mut solution, recorder)?;
        }
        let has_obstacles = problem.task.collision.is_some();
        if number == 0 && saved.is_none() && options.starts.is_none() && has_obstacles {
            for other in 1..=guesses::DETOURS {
                if !solution.motion.status.exceeds_limits()
                    || !fails(&solution)
                    || recorder.interruption().is_some()
                {
                    break;
                }
                let first = First::new(problem, rows, options, other, None);
                let mut interior = interior_of(problem, rows, options, &first);
                interior.looseness = looseness;
                try_next(Looked::new(first.kind, interior, Start::Guess), &mut solution, recorder)?;
                looks += 1;
            }
        }
        solution.newton_iterations += steps;
        let violation = solution.limits.violation();
        solution.starts = vec![StartResult::of(&solution.motion, violation, guess, looks)];
        Ok(solution)
    }

    /// From a guess, or from what a look has made of it, to a solution.
    fn carry_on(&self, looked: Looked, recorder: &mut Recorder<'_>) -> Result<Solution, EvalError> {
        let problem = self.problem.problem();
        let Looked { mut interior, start, .. } = looked;
        let mut resolution = Resolution::default();
        let guess = interior.spline.clone();
        let eases = interior.needs_smoothing() && self.options.verify != Verify::None;
        let most = if eases { constants::NODES_OF_LEAST_TIME } else { usize::MAX };
        let few = self.options.clone().with_max_nodes(self.options.max_nodes.min(most));
        let mut refined = refine(problem, &few, start, &mut interior, &mut resolution, recorder)?;
        let mut last_solved = refined.last_solved.take();
        for _ in 0..constants::SEARCHES_FROM_UNRESOLVED {
            let gave_up = refined.gave_up && refined.status == Status::MeshLimit;
            if !gave_up || eases || recorder.interruption().is_some() {
                break;
            }
            refined = refine(problem, &few, Start::Saved, &mut interior, &mut resolution, recorder)?;
            let found = refined.last_solved.take();
            let better =
                found.filter(|found| last_solved.as_ref().is_none_or(|last| found.rank() > last.rank()));
            last_solved = better.or(last_solved);
        }
        let is_hard = !(refined.status.is_converged() || refined.status.is_interruption())
            && refined.infeasible.is_none();
        if is_hard && eases {
            let steps = interior.figures.iterations;
            let found = with_effort((problem, self.rows), (&few, self.looseness), &guess, recorder)?;
            let is_solved = |found: &WithEffort| found.refined.status.is_solved();
            let goes_on = refined.status == Status::MeshLimit && few.max_nodes < self.options.max_nodes;
            if goes_on && !found.as_ref().is_some_and(is_solved) {
                // What few nodes do not solve either way, more may.
                let (own, resolution) = (&mut interior, &mut resolution);
                refined = refine(problem, self.options, Start::Resolved, own, resolution, recorder)?;
            } else if let Some(WithEffort { interior: mut eased, resolution, refined, smoothing }) = found {
                eased.figures.iterations += steps;
                eased.clock = std::mem::take(&mut interior.clock);
                return self.finish(&mut eased, &resolution, refined, smoothing, recorder);
            }
        }
        if let Some(last) = last_solved.filter(|last| last.error < refined.error) {
            refined.fall_back_to(last, (&mut interior, &mut resolution), self.options)?;
        }
        let model = (problem, self.rows);
        settle(model, self.options, (&mut interior, &mut resolution, &mut refined), recorder)?;
        verify_and_repair(model, self.options, (&mut interior, &mut resolution, &mut refined), recorder)?;
        self.finish(&mut interior, &resolution, refined, Smoothing::default(), recorder)
    }

    /// The solution, verified by integration where it converged.
    fn finish(
        &self,
        interior: &mut Interior<Dynamics>,
        resolution: &Resolution,
        Refined { mut status, error, finer_mesh, beside, again, verified, infeasible, .. }: Refined,
        smoothing: Smoothing,
        recorder: &mut Recorder<'_>,
    ) -> Result<Solution, EvalError> {
        let problem = self.problem.problem();
        interior.clock.lap(Stage::Meshes);
        let ends = AtEnds::of(interior)?;
        let found::Found { trajectory, hamiltonians, stationarity } = found(problem, interior, &ends)?;
        // What exceeds its limits leads nowhere.
        let exceeds = status.exceeds_limits() || interior.figures.violation > constants::VIOLATION_ACCEPTED;
        let is_checked = !(status.is_interruption() || exceeds);
        let again = again.unwrap_or_else(|| match is_checked {
            false => Again::unknown(false),
            true => {
                let mut stops = || recorder.interruption().is_some();
                integrate_again(problem, self.options, interior, resolution, &mut stops)
            }
        });
        let is_verified = self.options.verify == Verify::Full && is_checked && again.is_complete;
        let model = (problem, self.rows);
        let mut is_complete = again.is_complete;
        // Motions with a cost of torques are solved to this tolerance at best.
        let eased = self.options.tolerance.max(constants::EFFORT_TOLERANCE);
        let eased = self.options.clone().with_tolerance(eased);
        let options = if smoothing.weight > 0.0 { &eased } else { self.options };
        let mut verified = match verified {
            None if is_verified => {
                let is_compared = finer_mesh.is_some();
                let mut stops = || recorder.interruption().is_some();
                let again = (Some(&again), is_compared);
                let costs = &resolution.costs;
                let found = independent::verify(model, options, interior, costs, again, &mut stops);
                is_complete = found.is_complete;
                Some(found.verification)
            }
            verified => verified,
        };
        if status.is_solved() && !is_complete {
            status = recorder.interruption().map_or(Status::NotVerified, Status::from);
        }
        let below = match status.is_converged().then(|| interior.inertia()).transpose()? {
            Some(Inertia::Positive) => Err(Certificate::LocalMinimumOnMesh),
            Some(Inertia::Negative) => {
                interior.below_saddle(saddle::LEAST_OFF).ok_or(Certificate::NotChecked)
            }
            Some(Inertia::Unknown) | None => Err(Certificate::NotChecked),
        };
        // What costs less along that direction is known.
        if let (Ok((_, gain)), Some(verified)) = (&below, &mut verified) {
            let part = (gain / interior.figures.size).max(beside);
            verified.take_saddle(part, saddle::FLAT * options.tolerance);
        }
        let is_doubted = verified.as_ref().is_some_and(|verified| verified.failure().is_some());
        if status.is_solved() && is_doubted {
            status = Status::NotVerified;
        }
        let certificate = match below {
            Ok(_) => Certificate::SaddleOnMesh,
            Err(_) if is_doubted => Certificate::NotChecked,
            Err(certificate) => certificate,
        };
        // The bound is loose there, and the change on a finer mesh is not.
        let is_loose = interior.spline.mesh.shape.is_smooth() && finer_mesh.is_some();
        let error = verified.as_ref().map_or(error, |verified| error.max(verified.cost_error(!is_loose)));
        let iterations = std::mem::take(&mut recorder.iterations);
        let penalty_cost = interior.running.penalty_cost(&interior.spline, &interior.points);
        let motion = Motion {
            cost: resolution.cost - penalty_cost,
            penalty_cost,
            smoothing: smoothing.weight,
            smoothing_bound: smoothing.bound,
            hamiltonian: hamiltonians.by_duration(problem),
            phase_hamiltonians: hamiltonians.phases,
            hamiltonian_drift: hamiltonians.drift,
            end_state: again.state,
            shooting_defect: again.parts,
            finer_mesh: finer_mesh.unwrap_or(f64::NAN),
            duality_gap: interior.figures.gap / interior.figures.size,
            stationarity,
            newton_decrement: interior.figures.decrement.abs() / interior.figures.size,
            verification: if is_checked && is_complete { self.options.verify } else { Verify::None },
            certificate,
            errors: vec![error],
            iterations,
            ..Motion::missing(status, interior.spline.duration())
        };
        let limits = report(problem, interior, resolution, &ends, infeasible);
        interior.clock.lap(Stage::Verification);
        Ok(Solution {
            newton_iterations: interior.figures.iterations,
            end_defect: again.defect,
            limits,
            constraints: Vec::new(),
            gait: None,
            polish: None,
            verified,
            stage_times: interior.clock.times(),
            trajectory,
            starts: Vec::new(),
            options: self.options.clone(),
            robot: RobotNames::of(&problem.robot),
            motion,
        })
    }
}

/// Whether another guess may lead to a better motion: nothing was found, or a motion whose cost is in doubt,
/// and it is not proven that there is nothing.
fn fails(solution: &Solution) -> bool {
    let status = &solution.motion.status;
    let is_proven = solution.limits.infeasible.as_ref().is_some_and(|found| found.is_global);
    let is_in_doubt = solution.verified.as_ref().is_some_and(Verification::doubts_cost);
    let is_found = status.is_solved() || (*status == Status::NotVerified && !is_in_doubt);
    !is_found && !status.is_interruption() && !is_proven
}

/// Keeps the better one of two solutions, with the steps of both. Whether it is the other one.
fn better_of(solution: &mut Solution, mut other: Solution) -> bool {
    let is_better = compare(&other, solution) == Ordering::Less;
    if is_better {
        std::mem::swap(solution, &mut other);
    }
    solution.newton_iterations += other.newton_iterations;
    let times = other.stage_times;
    solution.stage_times = solution.stage_times.map(|own| own.and(&times.unwrap_or_default()));
    let [own, others] = [&mut solution.motion.iterations, &mut other.motion.iterations];
    let [first, second] = if is_better { [others, own] } else { [own, others] };
    let all = first.drain(..).chain(second.drain(..)).collect();
    solution.motion.iterations = all;
    is_better
}
