//! Which way around obstacles: a second guess, from the motion without them.
//!
//! A straight way in the joints may pass an obstacle on the dearer side. The optimal motion without obstacles
//! often passes it on the other one, or does not meet it at all. So both are tried, each on one mesh, and the
//! problem goes on with the cheaper motion.

use super::meshes::{Start, iteration, refine};
use super::prepare::{self, Dynamics};
use crate::constants::direct as constants;
use crate::direct::interior::figures::Figures;
use crate::direct::interior::iterate::{End, Interior};
use crate::direct::refine::resolution::Resolution;
use crate::options::{SolverOptions, Verify};
use crate::problem::Problem;
use crate::solve::Recorder;
use crate::solve::recorder::Interruption;
use crate::status::Status;
use crate::task::build::TaskRows;
use costate::EvalError;

/// Solves the problem on its first mesh from the guess of `interior` and from the motion without obstacles;
/// the cheaper one of both is what `interior` has then. Whether it is solved on that mesh, and the number of
/// steps that were made beside those of `interior`.
///
/// # Errors
/// A motion that cannot be evaluated.
pub(super) fn around_obstacles(
    problem: &Problem,
    rows: &TaskRows,
    options: &SolverOptions,
    interior: &mut Interior<Dynamics>,
    recorder: &mut Recorder<'_>,
) -> Result<(bool, usize), EvalError> {
    let mut free = problem.clone();
    free.task.obstacles.clear();
    free.task.collision = None;
    // What was checked with obstacles has no fault without them.
    let Ok(free_rows) = TaskRows::new(&free) else { return Ok((false, 0)) };
    let mut found = prepare::interior(&free, &free_rows, options, 0, None);
    found.looseness = interior.looseness;
    let roughly = SolverOptions {
        tolerance: options.tolerance.max(constants::FREE_TOLERANCE),
        verify: Verify::None,
        ..options.clone()
    };
    let refined = refine(&free, &roughly, Start::Guess, &mut found, &mut Resolution::default(), recorder)?;
    let mut steps = found.figures.iterations;
    if refined.status != Status::NotVerified {
        return Ok((false, steps));
    }
    let mut other = prepare::interior(problem, rows, options, 0, None);
    other.spline.copy_from(&found.spline);
    other.looseness = interior.looseness;
    let guess = interior.spline.clone();
    let of_other = first_motion(&mut other, options, None, recorder)?;
    let nodes = other.spline.mesh.nodes.clone();
    if interior.spline.mesh.nodes.len() < nodes.len() {
        // Costs on a mesh that was too coarse for the motion without obstacles compare with nothing.
        interior.spline = guess.on_nodes(nodes);
    }
    let of_own = first_motion(interior, options, of_other, recorder)?;
    let is_better = match (of_own, of_other) {
        (Some(own), Some(other)) => other < own - constants::FIRST_PRECISION * own.abs(),
        (own, other) => own.is_none() && other.is_some(),
    };
    if is_better {
        std::mem::swap(interior, &mut other);
        std::mem::swap(&mut interior.clock, &mut other.clock);
    }
    steps += other.figures.iterations;
    let is_solved = is_better || of_own.is_some();
    if !is_solved {
        interior.spline = guess;
    }
    Ok((is_solved, steps))
}

/// The cost of the motion on the mesh of a guess, solved roughly; `None` if that fails or limits are not
/// kept. It need not be solved further than to tell on which side of the cost of a `rival` it ends, by what
/// is still to be gained: the gap, and what the next step promises.
fn first_motion(
    interior: &mut Interior<Dynamics>,
    options: &SolverOptions,
    rival: Option<f64>,
    recorder: &mut Recorder<'_>,
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
    let mut is_decided = false;
    let end = interior.iterate(constants::FIRST_PRECISION, most, |iterate, step| {
        let Figures { cost, gap, decrement, violation, .. } = iterate.figures;
        let open = constants::DECIDED * (gap + decrement.abs());
        is_decided = violation < constants::DECIDED_VIOLATION
            && rival.is_some_and(|rival| (cost - rival).abs() > open);
        watch(iterate, step).or(is_decided.then_some(Interruption::TimeLimit))
    })?;
    Ok((end == End::Solved || is_decided).then_some(interior.figures.cost))
}
