//! What is done where a motion turns out to be a saddle: the search goes on below it.

use super::first::First;
use super::meshes::refine;
use super::prepare::{Dynamics, interior_on};
use super::refined::Refined;
use super::refinement::Start;
use crate::constants::{direct as constants, saddle};
use crate::direct::interior::inertia::Inertia;
use crate::direct::interior::iterate::Interior;
use crate::direct::refine::resolution::Resolution;
use crate::options::SolverOptions;
use crate::problem::Problem;
use crate::solve::Recorder;
use crate::task::build::TaskRows;
use costate::EvalError;

/// Goes on from a solved motion that is a saddle, along a direction of negative curvature, at most
/// [`MOST`](saddle::MOST) times and while that lowers the cost by more than a [part](saddle::FLAT) of the
/// tolerance. The motion is replaced by what is solved there if that costs less. Where what costs less there
/// is not solved, or is a saddle after all these times, [`Refined::beside`] says by how much. Whether the
/// motion was replaced.
///
/// # Errors
/// A motion that cannot be evaluated.
pub(super) fn leave_saddles(
    (problem, rows): (&Problem, &TaskRows),
    options: &SolverOptions,
    interior: &mut Interior<Dynamics>,
    resolution: &mut Resolution,
    refined: &mut Refined,
    recorder: &mut Recorder<'_>,
) -> Result<bool, EvalError> {
    let (mut was_left, mut last) = (false, 0.0);
    for times in 0..=saddle::MOST {
        let goes_on = refined.status.is_converged() && recorder.interruption().is_none();
        if !goes_on || interior.inertia()? != Inertia::Negative {
            break;
        }
        let Some((spline, _)) = interior.below_saddle(saddle::OFF) else { break };
        if times == saddle::MOST {
            // The way down does not end here.
            refined.beside = last;
            break;
        }
        let mut other = interior_on(
            problem,
            rows,
            options,
            &First::new(problem, rows, options, 0, None),
            &spline.mesh.nodes,
        );
        other.spline.copy_from(&spline);
        other.looseness = interior.looseness;
        other.figures.iterations = interior.figures.iterations;
        other.clock = std::mem::take(&mut interior.clock);
        // The barrier of a cold start would hide the way down.
        other.start(None)?;
        other.start(Some(constants::WARM * other.mu))?;
        let mut of_other = Resolution::default();
        let found = refine(problem, options, Start::Solved, &mut other, &mut of_other, recorder)?;
        interior.clock = std::mem::take(&mut other.clock);
        interior.figures.iterations = other.figures.iterations;
        let gain = (resolution.cost - of_other.cost) / other.figures.size;
        if !(found.status.is_converged() && gain > constants::ROUNDING) {
            let keeps_limits = other.figures.violation <= constants::VIOLATION_ACCEPTED;
            if keeps_limits && gain > found.error && !found.status.is_interruption() {
                refined.beside = gain;
            }
            break;
        }
        std::mem::swap(&mut interior.clock, &mut other.clock);
        (*interior, *resolution, *refined) = (other, of_other, found);
        (was_left, last) = (true, gain);
        if gain < saddle::FLAT * options.tolerance {
            break;
        }
    }
    Ok(was_left)
}
