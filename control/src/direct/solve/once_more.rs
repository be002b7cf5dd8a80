//! A solved motion with dry friction, solved once more from itself alone.
//!
//! Where a joint starts, stops or turns a little later, friction bends torques within its narrow transition.
//! So motions with dry friction have many local minima near each other, and multipliers of a solved one hold
//! the iteration where it is. A search that begins at the motion without them, with a wide barrier, on a mesh
//! with nodes where it crosses transitions, goes over what separates neighbouring minima: where it ends at a
//! motion that costs less, that one is taken.

use super::meshes::refine;
use super::prepare::{Dynamics, most_knots};
use super::refined::Refined;
use super::refinement::Start;
use crate::constants::checks::once_more as constants;
use crate::direct::interior::iterate::Interior;
use crate::direct::motion::mesh::Mesh;
use crate::direct::refine::resolution::Resolution;
use crate::options::{SolverOptions, Verify};
use crate::problem::Problem;
use crate::result::stage_times::Stage;
use crate::solve::Recorder;
use costate::EvalError;

/// Solves a motion that is to be verified in full once more, where it crosses a transition; whether the
/// one that is found costs less, and is the iterate. Else that stays.
///
/// # Errors
/// A motion that cannot be evaluated.
pub(super) fn solve_once_more(
    problem: &Problem,
    options: &SolverOptions,
    (interior, resolution, refined): (&mut Interior<Dynamics>, &mut Resolution, &mut Refined),
    recorder: &mut Recorder<'_>,
) -> Result<bool, EvalError> {
    let is_judged = options.verify == Verify::Full && refined.status.is_converged();
    if !is_judged || recorder.interruption().is_some() {
        return Ok(false);
    }
    let mesh = &interior.spline.mesh;
    let crossed = interior.seeded(most_knots(options, mesh.shape));
    if crossed == mesh.nodes {
        return Ok(false);
    }
    let nodes = Mesh::new(crossed, mesh.shape).divided(constants::PARTS, interior.narrowest()[0]);
    if mesh.shape.points_of(nodes.len() - 1) > options.max_nodes {
        return Ok(false);
    }
    let solved = interior.snapshot();
    let clock = std::mem::take(&mut interior.clock);
    interior.move_to(nodes)?;
    let mut finer = Resolution::default();
    let found = refine(problem, options, Start::Saved, interior, &mut finer, recorder);
    interior.clock = clock;
    interior.clock.lap(Stage::Verification);
    let least = resolution.cost - constants::CHEAPER * options.tolerance * interior.figures.size;
    match found {
        Ok(found) if found.status.is_converged() && finer.cost < least => {
            (*resolution, *refined) = (finer, found);
            Ok(true)
        }
        _ => {
            interior.take_again(solved)?;
            Ok(false)
        }
    }
}
