//! A solved motion beside the one on a finer mesh.
//!
//! Estimates of errors assume that torques are smooth inside of the intervals. So a motion that is verified
//! in full is solved once more with all intervals halved, from its own multipliers, which takes a few steps:
//! what the cost changes by is the error that the mesh had, less that of the finer one.

use super::meshes::refine;
use super::prepare::Dynamics;
use super::refined::Refined;
use super::refinement::{Start, iteration};
use crate::constants::checks::finer_mesh;
use crate::constants::direct as constants;
use crate::direct::interior::iterate::{End, Interior};
use crate::direct::refine::resolution::Resolution;
use crate::options::{SolverOptions, Verify};
use crate::problem::Problem;
use crate::result::stage_times::Stage;
use crate::solve::Recorder;
use crate::status::Status;
use costate::EvalError;

/// Compares a motion that is to be verified in full with that on the mesh with halved intervals. Where their
/// costs differ by more than the tolerance the search goes on from the finer one, a few times.
///
/// # Errors
/// A motion that cannot be evaluated.
pub(super) fn compare_with_finer_mesh(
    problem: &Problem,
    options: &SolverOptions,
    (interior, resolution, refined): (&mut Interior<Dynamics>, &mut Resolution, &mut Refined),
    recorder: &mut Recorder<'_>,
) -> Result<(), EvalError> {
    for _ in 0..finer_mesh::MESHES {
        if options.verify != Verify::Full || !refined.status.is_converged() {
            return Ok(());
        }
        let solved = interior.snapshot();
        let finer = change_on_finer_mesh(options, interior, resolution.cost, recorder)?;
        refined.finer_mesh = finer;
        if finer.is_none_or(|change| change <= options.tolerance) {
            interior.take_again(solved)?;
            interior.clock.lap(Stage::Verification);
            return Ok(());
        }
        *refined = refine(problem, options, Start::Solved, interior, resolution, recorder)?;
    }
    if refined.status.is_converged() {
        refined.status = Status::MeshLimit;
    }
    Ok(())
}

/// Solves on halved intervals: by how much the cost differs from `cost`, relative to it. `None` where that
/// is not known: too many nodes, nothing to halve, or not solved in a few steps. The iterate is on the finer
/// mesh then or on its own one.
fn change_on_finer_mesh(
    options: &SolverOptions,
    interior: &mut Interior<Dynamics>,
    cost: f64,
    recorder: &mut Recorder<'_>,
) -> Result<Option<f64>, EvalError> {
    let mesh = &interior.spline.mesh;
    let nodes = mesh.halved(interior.narrowest()[0]);
    let count = mesh.shape.stride() * (nodes.len() - 1) + 1;
    if nodes == mesh.nodes || count > options.max_nodes || recorder.interruption().is_some() {
        return Ok(None);
    }
    interior.move_to(nodes)?;
    let first = interior.figures.iterations;
    let watch = |iterate: &mut Interior<Dynamics>, step: f64| {
        recorder.record(iteration(iterate, first, step));
        recorder.interruption()
    };
    let precision = interior.looseness.between(constants::PART_OF_TOLERANCE) * options.tolerance;
    let end = interior.iterate(precision, finer_mesh::STEPS.min(options.max_iterations), watch)?;
    if end != End::Solved {
        return Ok(None);
    }
    interior.take_last_step();
    let mut finer = Resolution::default();
    finer.measure(interior)?;
    Ok(Some((finer.cost - cost).abs() / interior.figures.size))
}
