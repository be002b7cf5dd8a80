//! A solved motion beside the one on a finer mesh.
//!
//! Estimates of errors assume that torques are smooth inside of the intervals. So a motion that is verified
//! in full is solved once more with nodes where it crosses the transition of dry friction or a speed of a
//! motor, and with all intervals halved, from its own multipliers, which takes a few steps: what the cost
//! changes by is the error that the mesh had, less that of the finer one. Limits that were
//! moved inside stand at their own places there, so what it costs to move them is in the change.

use super::meshes::refine;
use super::prepare::{Dynamics, most_knots};
use super::refined::Refined;
use super::refinement::{Start, iteration};
use crate::constants::checks::finer_mesh;
use crate::constants::direct as constants;
use crate::direct::interior::iterate::{End, Interior};
use crate::direct::motion::mesh::Mesh;
use crate::direct::refine::resolution::Resolution;
use crate::options::{SolverOptions, Verify};
use crate::problem::Problem;
use crate::result::stage_times::Stage;
use crate::solve::Recorder;
use crate::status::Status;
use costate::EvalError;

/// Compares a motion that is to be verified in full with that on the mesh with halved intervals. Where their
/// costs differ by more than the tolerance the search goes on from the finer one, a few times; where that
/// leads to no solution the motion stays, with the difference as its error.
///
/// # Errors
/// A motion that cannot be evaluated.
pub(super) fn compare_with_finer_mesh(
    problem: &Problem,
    options: &SolverOptions,
    (interior, resolution, refined): (&mut Interior<Dynamics>, &mut Resolution, &mut Refined),
    recorder: &mut Recorder<'_>,
) -> Result<(), EvalError> {
    if options.verify != Verify::Full {
        return Ok(());
    }
    for left in (0..=finer_mesh::MESHES).rev() {
        if !refined.status.is_converged() {
            return Ok(());
        }
        let solved = interior.snapshot();
        // All steps of the comparison are verification.
        let clock = std::mem::take(&mut interior.clock);
        // What cannot be evaluated there says nothing about this motion.
        let change = change_on_finer_mesh(options, interior, resolution.cost, recorder).ok().flatten();
        interior.clock = clock;
        interior.clock.lap(Stage::Verification);
        refined.finer_mesh = change;
        // What halving the intervals changes is an error of this mesh that was seen, whatever was estimated.
        refined.error = refined.error.max(change.unwrap_or(0.0));
        let Some(change) = change.filter(|change| *change > options.tolerance) else {
            return interior.take_again(solved);
        };
        let mut status = Status::MeshLimit;
        if left > 0 {
            let mut finer = Resolution::default();
            let found = refine(problem, options, Start::Solved, interior, &mut finer, recorder);
            match found.unwrap_or_else(|error| Refined::without(Status::EvaluationFailed(error.into()))) {
                found if found.status.is_converged() => {
                    (*resolution, *refined) = (finer, found);
                    continue;
                }
                found if found.status.is_interruption() => status = found.status,
                _ => {}
            }
        }
        (refined.status, refined.error) = (status, change);
        return interior.take_again(solved);
    }
    Ok(())
}

/// Solves on halved intervals: by how much the cost differs from `cost`, relative to it, or at least does if
/// it is not solved in a few steps. `None` where that is not known: too many nodes, nothing to halve, or no
/// motion that costs less. The iterate is on the finer mesh then or on its own one.
fn change_on_finer_mesh(
    options: &SolverOptions,
    interior: &mut Interior<Dynamics>,
    cost: f64,
    recorder: &mut Recorder<'_>,
) -> Result<Option<f64>, EvalError> {
    let mesh = &interior.spline.mesh;
    let crossed = interior.crossed(most_knots(options, mesh.shape));
    let nodes = Mesh::new(crossed, mesh.shape).halved(interior.narrowest()[0]);
    let count = mesh.shape.points_of(nodes.len() - 1);
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
    let is_solved = end == End::Solved;
    if is_solved {
        interior.take_last_step();
    }
    let mut finer = Resolution::default();
    finer.measure(interior)?;
    let change = (finer.cost - cost) / interior.figures.size;
    // A motion that is not solved and costs less says by how much at least.
    let is_less = change < -options.tolerance && interior.figures.violation <= constants::VIOLATION_ACCEPTED;
    Ok((change.is_finite() && (is_solved || is_less)).then_some(change.abs()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::direct::solve::prepare::interior;
    use crate::options::Polish;
    use crate::problem::MotionLimits;
    use crate::task::build::TaskRows;
    use costate::robot::Robot;

    const TOLERANCE: f64 = 1e-4;

    fn problem() -> Problem {
        let robot = Robot::from_file("../robots/two_link.toml").unwrap();
        Problem::rest_to_rest(robot, &[0.0, 0.0], &[1.5, 1.5], 1.0).with_limits(MotionLimits::none())
    }

    fn options() -> SolverOptions {
        SolverOptions::default().with_tolerance(TOLERANCE).with_polish(Polish::Never)
    }

    fn solved(problem: &Problem) -> (Interior<Dynamics>, Resolution, Refined) {
        let rows = TaskRows::new(problem).unwrap();
        let mut interior = interior(problem, &rows, &options(), 0, None);
        let mut resolution = Resolution::default();
        let mut recorder = Recorder::default();
        let (own, of_own) = (&mut interior, &mut resolution);
        let refined = refine(problem, &options(), Start::Guess, own, of_own, &mut recorder).unwrap();
        assert!(refined.status.is_converged());
        (interior, resolution, refined)
    }

    /// As if the mesh had missed a tenth of a per cent of the cost.
    #[test]
    fn the_search_goes_on_where_the_cost_changes_by_more() {
        let problem = problem();
        let (mut interior, mut resolution, mut refined) = solved(&problem);
        let (intervals, cost) = (interior.spline.mesh.intervals(), resolution.cost);
        resolution.cost *= 1.001;
        let of = (&mut interior, &mut resolution, &mut refined);
        compare_with_finer_mesh(&problem, &options(), of, &mut Recorder::default()).unwrap();
        assert!(refined.status.is_converged());
        assert_eq!(interior.spline.mesh.intervals(), 2 * intervals, "on the finer mesh");
        assert!(refined.finer_mesh.is_some_and(|change| change < TOLERANCE), "{:?}", refined.finer_mesh);
        assert!((resolution.cost / cost - 1.0).abs() < TOLERANCE, "{} {cost}", resolution.cost);
    }

    /// Without steps for the finer mesh nothing is known of a motion that costs less than there, and it stays
    /// what it was. Where the search may not go on from it either, the change is the error.
    #[test]
    fn the_motion_stays_where_the_finer_mesh_is_not_solved() {
        let problem = problem();
        let (mut interior, mut resolution, mut refined) = solved(&problem);
        let (unknowns, mu) = (interior.spline.unknowns.clone(), interior.mu);
        let one_step = SolverOptions { max_iterations: 1, ..options() };
        resolution.cost *= 0.999;
        let of = (&mut interior, &mut resolution, &mut refined);
        compare_with_finer_mesh(&problem, &one_step, of, &mut Recorder::default()).unwrap();
        assert!(refined.status.is_converged() && refined.finer_mesh.is_none());
        assert!(interior.spline.unknowns == unknowns && interior.mu.to_bits() == mu.to_bits());
        // The search does not go on from the finer mesh: no motion is that slow.
        let slow = MotionLimits::none().with_v_max(vec![0.1, 0.1]);
        let other = Problem { limits: slow, ..problem };
        let of = (&mut interior, &mut resolution, &mut refined);
        compare_with_finer_mesh(&other, &options(), of, &mut Recorder::default()).unwrap();
        let change = refined.finer_mesh.unwrap();
        assert!(refined.status == Status::MeshLimit && refined.error.to_bits() == change.to_bits());
        assert!((0.5e-3..2e-3).contains(&change), "{change}");
        assert_eq!(interior.spline.unknowns, unknowns);
    }
}
