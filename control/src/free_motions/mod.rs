//! Motions of robots with floating and spherical joints: the direct method in states
//! ([`crate::direct_states`]) on [`QuaternionDynamics`], x = (q, p) with quaternions as plain numbers.
//!
//! Collocation needs no care for the length of a quaternion: the model keeps it, and is homogeneous in it.
//! What is given at the end are three functions of each quaternion ([`crate::problem::free_end`]). Controls
//! are the torques of the coordinates that something drives; a floating base is not among them unless limits
//! of its forces are given.
//!
//! | file | content |
//! |---|---|
//! | [`task`] | the problem in states |
//! | [`guess`] | where it begins |
//! | [`rows`] | the motion as a trajectory of the robot |
//! | [`verify`] | integrated again |
//! | [`uses`] | how limits are used |

mod guess;
mod rows;
mod task;
mod unsolved;
mod uses;
mod verify;

use crate::direct_states::solution::StateMotion;
use crate::options::{SolverOptions, Verify};
use crate::parallel::best_of_starts;
use crate::problem::Problem;
use crate::result::motion::Motion;
use crate::result::solution::{RobotNames, Solution};
use crate::result::start::{GuessKind, StartResult};
use crate::result::trajectory::Trajectory;
use crate::result::verify::verification_bound;
use crate::solve::Recorder;
use crate::status::Status;
use costate::EvalError;
use task::FreeTask;
use unsolved::Unsolved;

/// Solves a problem that was checked, the first start from a saved motion if there is one.
pub(crate) fn solve(
    problem: &Problem,
    options: &SolverOptions,
    saved: Option<&Trajectory>,
    recorder: &mut Recorder<'_>,
) -> Solution {
    let missing = |status| Solution::without_motion(problem, status);
    let start = |number: usize, recorder: &mut Recorder<'_>| {
        let saved = saved.filter(|_| number == 0);
        from_start(problem, options, (number, saved), recorder)
            .unwrap_or_else(|unsolved| missing(unsolved.into()))
    };
    best_of_starts(options, recorder, start).unwrap_or_else(|| missing(Status::Cancelled))
}

fn from_start(
    problem: &Problem,
    options: &SolverOptions,
    (number, saved): (usize, Option<&Trajectory>),
    recorder: &mut Recorder<'_>,
) -> Result<Solution, Unsolved> {
    let task = FreeTask::new(problem)?;
    let guess = match saved {
        Some(saved) => guess::of_motion(&task, saved),
        None => guess::simple(&task, options.seed, number)?,
    };
    let mut direct = task.direct()?.with_guess(&guess.t, &guess.x, &guess.u)?;
    let found = direct.solve_recorded(options, recorder)?;
    let kind = match (saved, number) {
        (Some(_), _) => GuessKind::Saved,
        (None, 0) => GuessKind::Straight,
        _ => GuessKind::Disturbed,
    };
    let iterations = std::mem::take(&mut recorder.iterations);
    let solution = solution(&task, options, &found)?;
    let motion = Motion { iterations, ..solution.motion };
    let starts = vec![StartResult::of(&motion, kind, 1)];
    Ok(Solution { motion, starts, ..solution })
}

/// The motion of the robot with its figures.
fn solution(
    task: &FreeTask<'_>,
    options: &SolverOptions,
    found: &StateMotion,
) -> Result<Solution, EvalError> {
    let problem = task.problem;
    let trajectory = rows::trajectory(task, found)?;
    let verifies = options.verify == Verify::Full && !found.status.is_interruption();
    let end_state = if verifies { verify::integrated_again(task, found) } else { None };
    let end_defect = end_state.as_ref().map_or(f64::INFINITY, |end| verify::missed(problem, end));
    let bound = verification_bound(options.tolerance).sqrt();
    // The integration of the whole misses the end, that of its parts does not: the motion is unstable.
    let by_parts = end_defect > bound && found.end_error.is_finite();
    let figures = rows::figures(task, found);
    let motion = Motion {
        cost: found.cost,
        hamiltonian: figures.hamiltonian,
        phase_hamiltonians: vec![figures.hamiltonian],
        hamiltonian_drift: figures.drift,
        end_state: end_state.clone(),
        verification: if end_state.is_some() { Verify::Full } else { Verify::None },
        shooting_defect: if by_parts { found.end_error } else { f64::INFINITY },
        stationarity: found.residual,
        certificate: found.certificate,
        // That of the mesh before, whose intervals are twice as wide.
        errors: if found.cost_change.is_finite() { vec![found.cost_change] } else { Vec::new() },
        ..Motion::missing(found.status.clone(), found.final_time)
    };
    Ok(Solution {
        motion,
        end_defect,
        newton_iterations: found.steps.len(),
        limits: uses::limits(task, found),
        constraints: Vec::new(),
        gait: None,
        polish: None,
        stage_times: None,
        trajectory,
        starts: Vec::new(),
        options: options.clone(),
        robot: RobotNames::of(&problem.robot),
    })
}
