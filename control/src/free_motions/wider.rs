//! What limits of torques lack where no motion within them was found.

use super::guess::{self, Guess};
use super::solution::solution;
use super::task::FreeTask;
use super::unsolved::Unsolved;
use crate::constants::free_motions as constants;
use crate::direct_states::solution::StateMotion;
use crate::options::{SolverOptions, Verify};
use crate::problem::Problem;
use crate::result::motion::{Certificate, Motion};
use crate::result::solution::Solution;
use crate::result::trajectory::Trajectory;
use crate::solve::Recorder;
use crate::status::Status;

/// In the place of a motion that is not solved: one that keeps the limits, begun at a motion with wider ones;
/// or the motion with the narrowest limits of torques, all wider in proportion, with which one was found. It
/// exceeds its own by what it needs ([`Status::LimitsNotKept`]). The motion itself where there is neither.
pub(super) fn or_wider(
    problem: &Problem,
    options: &SolverOptions,
    saved: Option<&Trajectory>,
    unsolved: Solution,
    recorder: &mut Recorder<'_>,
) -> Solution {
    let status = &unsolved.motion.status;
    if status.is_solved() || status.is_interruption() || matches!(status, Status::EvaluationFailed(_)) {
        return unsolved;
    }
    let found = nearest(problem, options, saved, recorder).ok().flatten();
    let mut steps = std::mem::take(&mut recorder.iterations);
    let mut solution = unsolved;
    solution.newton_iterations += steps.len();
    solution.motion.iterations.append(&mut steps);
    let Some(found) = found else { return solution };
    let iterations = solution.motion.iterations;
    Solution {
        motion: Motion { iterations, ..found.motion },
        end_defect: found.end_defect,
        limits: found.limits,
        trajectory: found.trajectory,
        ..solution
    }
}

fn nearest(
    problem: &Problem,
    options: &SolverOptions,
    saved: Option<&Trajectory>,
    recorder: &mut Recorder<'_>,
) -> Result<Option<Solution>, Unsolved> {
    let mut task = FreeTask::new(problem)?;
    let limited = task.driven.iter().any(|&i| task.limits[i].torque.iter().any(|limit| limit.is_finite()));
    if !limited {
        return Ok(None);
    }
    let guess = match saved {
        Some(saved) => guess::of_motion(&task, saved),
        None => guess::simple(&task, options.seed, 0)?,
    };
    let rough = options.clone().with_tolerance(options.tolerance.max(constants::ROUGH));
    let mut lacking = 1.0;
    task.widened = f64::INFINITY;
    let Some(mut found) = solved(&task, &rough, guess, recorder)? else { return Ok(None) };
    for _ in 0..constants::TRIALS {
        let needed = task.needed(&found);
        if needed <= constants::NEAR * lacking {
            break;
        }
        task.widened = (lacking * needed).sqrt();
        match solved(&task, &rough, of(&found), recorder)? {
            Some(closer) => found = closer,
            None => lacking = task.widened,
        }
    }
    task.widened = 1.0;
    if lacking == 1.0
        && let Some(within) = solved(&task, options, of(&found), recorder)?
    {
        return Ok(Some(solution(&task, options, &within)?));
    }
    if task.needed(&found) <= 1.0 {
        return Ok(None);
    }
    // A motion that cannot be made need not be integrated.
    let unverified = options.clone().with_verify(Verify::None);
    let mut nearest = solution(&task, &unverified, &found)?;
    nearest.motion.status = Status::LimitsNotKept;
    nearest.motion.certificate = Certificate::NotChecked;
    Ok(Some(nearest))
}

/// The motion from a guess, if it is solved.
fn solved(
    task: &FreeTask<'_>,
    options: &SolverOptions,
    guess: Guess,
    recorder: &mut Recorder<'_>,
) -> Result<Option<StateMotion>, Unsolved> {
    let mut direct = task.direct()?.with_guess(&guess.t, &guess.x, &guess.u)?;
    let found = direct.solve_recorded(options, recorder)?;
    Ok(found.status.is_solved().then_some(found))
}

fn of(motion: &StateMotion) -> Guess {
    Guess { t: motion.t.clone(), x: motion.x.clone(), u: motion.u.clone() }
}
