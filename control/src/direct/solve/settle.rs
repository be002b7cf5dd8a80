//! A solved motion is made a minimum, compared with that on a finer mesh, and solved once more.

use super::finer_mesh::compare_with_finer_mesh;
use super::once_more::solve_once_more;
use super::prepare::Dynamics;
use super::refined::Refined;
use super::saddle::leave_saddles;
use crate::constants::checks::once_more;
use crate::constants::saddle;
use crate::direct::interior::iterate::Interior;
use crate::direct::refine::resolution::Resolution;
use crate::options::SolverOptions;
use crate::problem::Problem;
use crate::solve::Recorder;
use crate::task::build::TaskRows;
use costate::EvalError;

/// Leaves saddles, and compares with a finer mesh, where the search may go on; a few times, as what is a
/// minimum on a mesh may be a saddle on a finer one. Then a motion that crosses the transition of dry
/// friction is [solved once more](super::once_more). A motion that is not converged stays.
///
/// # Errors
/// A motion that cannot be evaluated.
pub(super) fn settle(
    (problem, rows): (&Problem, &TaskRows),
    options: &SolverOptions,
    (interior, resolution, refined): (&mut Interior<Dynamics>, &mut Resolution, &mut Refined),
    recorder: &mut Recorder<'_>,
) -> Result<(), EvalError> {
    for times in 0..=once_more::TIMES {
        settle_nearby((problem, rows), options, (interior, resolution, refined), recorder)?;
        if times == once_more::TIMES
            || !solve_once_more(problem, options, (interior, resolution, refined), recorder)?
        {
            break;
        }
    }
    Ok(())
}

/// Leaves saddles and compares with finer meshes, in turn.
fn settle_nearby(
    (problem, rows): (&Problem, &TaskRows),
    options: &SolverOptions,
    (interior, resolution, refined): (&mut Interior<Dynamics>, &mut Resolution, &mut Refined),
    recorder: &mut Recorder<'_>,
) -> Result<(), EvalError> {
    for round in 0..=saddle::FROM_FINER_MESHES {
        let was_left = leave_saddles((problem, rows), options, interior, resolution, refined, recorder)?;
        if round > 0 && !was_left {
            break;
        }
        let intervals = interior.spline.mesh.intervals();
        compare_with_finer_mesh(problem, options, (interior, resolution, refined), recorder)?;
        if interior.spline.mesh.intervals() == intervals {
            break;
        }
    }
    Ok(())
}
