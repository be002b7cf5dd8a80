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
//! | [`solution`] | the motion with its figures |
//! | [`verify`] | integrated again |
//! | [`uses`] | how limits are used |
//! | [`wider`] | what limits lack where no motion keeps them |

mod guess;
mod rows;
mod solution;
mod task;
mod unsolved;
mod uses;
mod verify;
mod wider;

use crate::options::SolverOptions;
use crate::parallel::best_of_starts;
use crate::problem::Problem;
use crate::result::motion::Motion;
use crate::result::solution::Solution;
use crate::result::start::{GuessKind, StartResult};
use crate::result::trajectory::Trajectory;
use crate::solve::Recorder;
use crate::status::Status;
use solution::solution;
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
    let best = best_of_starts(options, recorder, start).unwrap_or_else(|| missing(Status::Cancelled));
    wider::or_wider(problem, options, saved, best, recorder)
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
    let starts = vec![StartResult::of(&motion, solution.limits.violation(), kind, 1)];
    Ok(Solution { motion, starts, ..solution })
}
