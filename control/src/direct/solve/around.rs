//! Which way around obstacles: a second guess, from the motion without them.
//!
//! A straight way in the joints may pass an obstacle on the dearer side. The optimal motion without obstacles
//! often passes it on the other one, or does not meet it at all. So both are tried, each on one mesh, and the
//! problem begins with the one that leads to the cheaper motion.

use super::meshes::{iteration, refine};
use super::prepare::{Dynamics, interior};
use crate::constants::direct as constants;
use crate::direct::interior::iterate::{End, Interior};
use crate::direct::motion::spline::Spline;
use crate::direct::refine::resolution::Resolution;
use crate::options::{SolverOptions, Verify};
use crate::problem::Problem;
use crate::solve::Recorder;
use crate::status::Status;
use crate::task::build::TaskRows;
use costate::EvalError;

/// The motion without obstacles, if it is a better guess than `straight`, that of the problem itself; and the
/// number of steps that were made.
///
/// # Errors
/// A motion that cannot be evaluated.
pub(super) fn around_obstacles(
    problem: &Problem,
    rows: &TaskRows,
    options: &SolverOptions,
    straight: &Spline,
    recorder: &mut Recorder<'_>,
) -> Result<(Option<Spline>, usize), EvalError> {
    let mut free = problem.clone();
    free.task.obstacles.clear();
    free.task.collision = None;
    // What was checked with obstacles has no fault without them.
    let Ok(free_rows) = TaskRows::new(&free) else { return Ok((None, 0)) };
    let mut found = interior(&free, &free_rows, options, 0, None);
    let roughly = SolverOptions {
        tolerance: options.tolerance.max(constants::FREE_TOLERANCE),
        verify: Verify::None,
        ..options.clone()
    };
    let refined = refine(&free, &roughly, false, &mut found, &mut Resolution::default(), recorder)?;
    let mut steps = found.figures.iterations;
    if refined.status != Status::NotVerified {
        return Ok((None, steps));
    }
    let mut cost_from = |spline: &Spline| {
        let mut trial = interior(problem, rows, options, 0, None);
        trial.spline.copy_from(spline);
        first_motion(&mut trial, options, recorder, &mut steps)
    };
    let (own, other) = (cost_from(straight)?, cost_from(&found.spline)?);
    let is_better = match (own, other) {
        (Some(own), Some(other)) => other < own - constants::FIRST_PRECISION * own.abs(),
        (own, other) => own.is_none() && other.is_some(),
    };
    Ok((is_better.then_some(found.spline), steps))
}

/// The cost of the motion on the mesh of a guess, solved roughly; `None` if that fails or limits are not
/// kept.
fn first_motion(
    interior: &mut Interior<Dynamics>,
    options: &SolverOptions,
    recorder: &mut Recorder<'_>,
    steps: &mut usize,
) -> Result<Option<f64>, EvalError> {
    let most = options.max_iterations;
    let mut watch = |iterate: &mut Interior<Dynamics>, step: f64| {
        recorder.record(iteration(iterate, 0, step));
        recorder.interruption()
    };
    if interior.needs_smoothing() {
        let effort = interior.smooth_effort();
        interior.begin_smoothed(effort, most, &mut watch)?;
    } else {
        interior.start(None)?;
    }
    let end = interior.iterate(constants::FIRST_PRECISION, most, watch)?;
    *steps += interior.figures.iterations;
    Ok((end == End::Solved).then_some(interior.figures.cost))
}
