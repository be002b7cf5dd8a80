//! A solved motion, verified independently of its points, and solved again where that fails.

use super::meshes::refine;
use super::prepare::Dynamics;
use super::refined::Refined;
use super::refinement::Start;
use super::settle::settle;
use crate::direct::interior::iterate::Interior;
use crate::direct::outcome::independent::{Independent, verify};
use crate::direct::refine::resolution::Resolution;
use crate::options::{SolverOptions, Verify};
use crate::problem::Problem;
use crate::result::stage_times::Stage;
use crate::solve::Recorder;
use crate::status::Status;
use crate::task::build::TaskRows;
use costate::EvalError;

/// How often a motion that fails is solved again on a finer mesh.
const ROUNDS: usize = 3;
/// The intervals that together make this part of what fails are divided.
const BLAMED: f64 = 0.9;

/// Verifies a converged motion. Where a check fails, the intervals that make it fail are divided, and the
/// search goes on from this motion, a few times, each new one [settled](settle) as the first one was; where
/// that leads to no verified motion, the last one that converged is not verified.
///
/// # Errors
/// A motion that cannot be evaluated.
pub(super) fn verify_and_repair(
    (problem, rows): (&Problem, &TaskRows),
    options: &SolverOptions,
    (interior, resolution, refined): (&mut Interior<Dynamics>, &mut Resolution, &mut Refined),
    recorder: &mut Recorder<'_>,
) -> Result<(), EvalError> {
    if options.verify != Verify::Full || !refined.status.is_converged() {
        return Ok(());
    }
    interior.clock.lap(Stage::Meshes);
    let judge = |interior: &mut Interior<Dynamics>, cost: f64, refined: &Refined| {
        interior.refresh()?;
        let is_compared = refined.finer_mesh.is_some();
        let found = verify((problem, rows), options, interior, cost, refined.again.as_ref(), is_compared);
        interior.clock.lap(Stage::Verification);
        Ok::<_, EvalError>(found)
    };
    let mut found = judge(interior, resolution.cost, refined)?;
    let mut status = Status::NotVerified;
    for _ in 0..ROUNDS {
        if found.verification.failure().is_none() || recorder.interruption().is_some() {
            break;
        }
        let Some(nodes) = divided(interior, &found, options) else { break };
        let solved = interior.snapshot();
        let mut finer = Resolution::default();
        match solve_on(nodes, (problem, rows), options, (interior, &mut finer), recorder) {
            Ok(next) if next.status.is_converged() => {
                found = judge(interior, finer.cost, &next)?;
                (*resolution, *refined) = (finer, next);
            }
            next => {
                // The last motion that converged, with what is known about it.
                if let Ok(Refined { status: interruption, .. }) = next
                    && interruption.is_interruption()
                {
                    status = interruption;
                }
                interior.take_again(solved)?;
                break;
            }
        }
    }
    if found.verification.failure().is_some() {
        refined.status = status;
    }
    refined.verified = Some(found.verification);
    Ok(())
}

/// Goes on from this motion on these nodes, to one that is settled as the first one was.
fn solve_on(
    nodes: Vec<f64>,
    (problem, rows): (&Problem, &TaskRows),
    options: &SolverOptions,
    (interior, resolution): (&mut Interior<Dynamics>, &mut Resolution),
    recorder: &mut Recorder<'_>,
) -> Result<Refined, EvalError> {
    interior.move_to(nodes)?;
    let mut refined = refine(problem, options, Start::Solved, interior, resolution, recorder)?;
    settle((problem, rows), options, (interior, resolution, &mut refined), recorder)?;
    Ok(refined)
}

/// Nodes with the intervals divided that make most of what fails, each halved and at the places where
/// something narrow happens; `None` where that takes too many, or none
/// can be divided.
fn divided(interior: &Interior<Dynamics>, found: &Independent, options: &SolverOptions) -> Option<Vec<f64>> {
    let (mesh, narrowest) = (&interior.spline.mesh, interior.narrowest()[0]);
    let all: f64 = found.blame.iter().sum();
    let mut order: Vec<usize> = (0..mesh.intervals()).collect();
    order.sort_by(|a, b| found.blame[*b].total_cmp(&found.blame[*a]));
    let (mut marked, mut sum) = (vec![false; mesh.intervals()], 0.0);
    for k in order {
        if sum >= BLAMED * all && all > 0.0 {
            break;
        }
        (marked[k], sum) = (true, sum + found.blame[k]);
    }
    let mut nodes = vec![mesh.nodes[0]];
    for (k, &is_marked) in marked.iter().enumerate() {
        let (left, right) = (mesh.nodes[k], mesh.nodes[k + 1]);
        if is_marked && right - left > narrowest {
            let middle = left + 0.5 * (right - left);
            let inside = found.narrow.iter().copied().filter(|s| *s > left && *s < right);
            let mut new: Vec<f64> = inside.chain([middle]).collect();
            new.sort_by(f64::total_cmp);
            let least = 0.5 * narrowest;
            for s in new {
                if nodes.last().is_some_and(|last| s - last > least) && right - s > least {
                    nodes.push(s);
                }
            }
        }
        nodes.push(right);
    }
    let count = mesh.shape.stride() * (nodes.len() - 1) + 1;
    (nodes.len() > mesh.nodes.len() && count <= options.max_nodes).then_some(nodes)
}
