//! One mesh after the other, until the motion is accurate.

use super::prepare::Dynamics;
use super::refined::Refined;
use super::refinement::{Refinement, Start, iteration};
use super::restore::{Restored, restore};
use crate::constants::direct as constants;
use crate::direct::interior::iterate::Interior;
use crate::direct::outcome::infeasible::with_proof;
use crate::direct::refine::resolution::Resolution;
use crate::options::SolverOptions;
use crate::problem::Problem;
use crate::result::stage_times::Stage;
use crate::solve::Recorder;
use crate::status::Status;
use costate::EvalError;

/// Solves on finer and finer meshes.
///
/// # Errors
/// A motion that cannot be evaluated.
pub(super) fn refine(
    problem: &Problem,
    options: &SolverOptions,
    start: Start,
    interior: &mut Interior<Dynamics>,
    resolution: &mut Resolution,
    recorder: &mut Recorder<'_>,
) -> Result<Refined, EvalError> {
    let too_short = problem.too_short().is_some();
    let goes_on = recorder.interruption().is_none();
    interior.clock.lap(Stage::Preparation);
    let is_begun = start == Start::Solved && goes_on && !too_short;
    if goes_on && !too_short && interior.needs_smoothing() && start == Start::Guess {
        let effort = interior.smooth_effort();
        let mut watch = |iterate: &mut Interior<Dynamics>, step: f64| {
            recorder.record(iteration(iterate, 0, step));
            recorder.interruption()
        };
        interior.begin_smoothed(effort, options.max_iterations, &mut watch)?;
    } else if !is_begun {
        interior.start(None)?;
    }
    if goes_on && too_short {
        return explain(problem, options, interior, resolution, recorder);
    }
    if let Some(interruption) = recorder.interruption() {
        interior.refresh()?;
        resolution.measure(interior)?;
        return Ok(Refined::without(interruption.into()));
    }
    Refinement::new(problem, options, start, interior, resolution, recorder).run()
}

/// What limits would have to give where it is proven that no motion keeps them.
fn explain(
    problem: &Problem,
    options: &SolverOptions,
    interior: &mut Interior<Dynamics>,
    resolution: &mut Resolution,
    recorder: &mut Recorder<'_>,
) -> Result<Refined, EvalError> {
    let guess = interior.spline.clone();
    let gap = constants::FIRST_GAP;
    let restored = restore(problem, interior, &guess, gap, options, recorder)?;
    interior.refresh()?;
    resolution.measure(interior)?;
    let found = match restored {
        Restored::Interrupted(interruption) => return Ok(Refined::without(interruption.into())),
        Restored::Infeasible(infeasible) => Some(infeasible),
        // Between its points the motion that keeps its limits there does not.
        Restored::Kept | Restored::Unknown => None,
    };
    let infeasible = with_proof(problem, found);
    Ok(Refined { infeasible, ..Refined::without(Status::Infeasible) })
}
