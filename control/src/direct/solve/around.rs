//! Which way around obstacles: a second guess, from the motion without them.
//!
//! A straight way in the joints may pass an obstacle on the dearer side. The optimal motion without obstacles
//! often passes it on the other one, or does not meet it at all.

use super::first::First;
use super::meshes::refine;
use super::prepare::interior_of;
use super::refinement::Start;
use crate::constants::direct as constants;
use crate::direct::interior::looseness::Looseness;
use crate::direct::motion::spline::Spline;
use crate::direct::refine::resolution::Resolution;
use crate::options::{SolverOptions, Verify};
use crate::problem::Problem;
use crate::solve::Recorder;
use crate::status::Status;
use crate::task::build::TaskRows;
use costate::EvalError;

/// The motion without obstacles, solved roughly, and the number of steps that were made; `None` where it is
/// not found.
///
/// # Errors
/// A motion that cannot be evaluated.
pub(super) fn without_obstacles(
    problem: &Problem,
    options: &SolverOptions,
    looseness: Looseness,
    recorder: &mut Recorder<'_>,
) -> Result<(Option<Spline>, usize), EvalError> {
    let mut free = problem.clone();
    free.task.obstacles.clear();
    free.task.collision = None;
    // What was checked with obstacles has no fault without them.
    let Ok(free_rows) = TaskRows::new(&free) else { return Ok((None, 0)) };
    let first = First::new(&free, &free_rows, options, 0, None);
    let mut found = interior_of(&free, &free_rows, options, &first);
    found.looseness = looseness;
    let roughly = SolverOptions {
        tolerance: options.tolerance.max(constants::FREE_TOLERANCE),
        verify: Verify::None,
        ..options.clone()
    };
    let refined = refine(&free, &roughly, Start::Guess, &mut found, &mut Resolution::default(), recorder)?;
    let steps = found.figures.iterations;
    Ok(((refined.status == Status::NotVerified).then_some(found.spline), steps))
}
