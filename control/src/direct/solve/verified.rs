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
use crate::verify::blame::blamed;
use costate::EvalError;

/// How often a motion that fails is solved again on a finer mesh.
const ROUNDS: usize = 3;

/// Verifies a converged motion. Where a check fails, the intervals that make it fail are divided, and the
/// search goes on from this motion, a few times, each new one [settled](settle) as the first one was; where
/// that leads to no verified motion, the last one that converged is not verified. Where the search is to
/// stop, so does the verification, and the status says so.
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
    let judge =
        |interior: &mut Interior<Dynamics>, costs: &[f64], refined: &Refined, recorder: &mut Recorder<'_>| {
            interior.refresh()?;
            let again = (refined.again.as_ref(), refined.finer_mesh.is_some());
            let mut stops = || recorder.interruption().is_some();
            let found = verify((problem, rows), options, interior, costs, again, &mut stops);
            interior.clock.lap(Stage::Verification);
            Ok::<_, EvalError>(found)
        };
    let mut found = judge(interior, &resolution.costs, refined, recorder)?;
    let mut status = Status::NotVerified;
    for _ in 0..ROUNDS {
        if found.verification.failure().is_none() || recorder.interruption().is_some() {
            break;
        }
        // The gap of jerks falls slowly with the widths of intervals.
        let is_loose = interior.spline.mesh.shape.is_smooth();
        if is_loose && found.verification.doubts_cost() && !found.verification.cost.fails() {
            break;
        }
        let Some(nodes) = divided(interior, &found, options) else { break };
        let solved = interior.snapshot();
        let mut finer = Resolution::default();
        match solve_on(nodes, (problem, rows), options, (interior, &mut finer), recorder) {
            Ok(next) if next.status.is_converged() => {
                found = judge(interior, &finer.costs, &next, recorder)?;
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
    if !found.is_complete {
        refined.status = recorder.interruption().map_or(Status::NotVerified, Status::from);
    } else if found.verification.failure().is_some() {
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
/// something narrow happens; `None` where that takes too many, or none can be divided.
fn divided(interior: &Interior<Dynamics>, found: &Independent, options: &SolverOptions) -> Option<Vec<f64>> {
    let (mesh, narrowest) = (&interior.spline.mesh, interior.narrowest()[0]);
    let mut nodes = vec![mesh.nodes[0]];
    for (k, is_marked) in blamed(&found.blame).into_iter().enumerate() {
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
    let count = mesh.shape.points_of(nodes.len() - 1);
    (nodes.len() > mesh.nodes.len() && count <= options.max_nodes).then_some(nodes)
}

#[cfg(test)]
mod tests {
    use super::super::last_solved::LastSolved;
    use super::*;
    use crate::direct::solve::prepare::interior;
    use crate::options::Polish;
    use crate::problem::MotionLimits;
    use costate::robot::Robot;

    fn solved(run: impl FnOnce(&Problem, &SolverOptions, &mut Interior<Dynamics>, Resolution, Refined)) {
        let robot = Robot::from_file("../robots/two_link.toml").unwrap();
        let problem =
            Problem::rest_to_rest(robot, &[0.0, 0.0], &[1.5, 1.5], 1.0).with_limits(MotionLimits::none());
        let options = SolverOptions::default().with_polish(Polish::Never);
        let rows = TaskRows::new(&problem).unwrap();
        let mut interior = interior(&problem, &rows, &options, 0, None);
        let mut resolution = Resolution::default();
        let (own, of_own) = (&mut interior, &mut resolution);
        let mut recorder = Recorder::default();
        let refined = refine(&problem, &options, Start::Guess, own, of_own, &mut recorder).unwrap();
        assert!(refined.status.is_converged());
        run(&problem, &options, &mut interior, resolution, refined);
    }

    /// The solver has a wrong cost of one interval: that one is divided.
    #[test]
    fn an_interval_with_a_wrong_cost_is_blamed_alone() {
        solved(|problem, options, interior, resolution, refined| {
            let rows = TaskRows::new(problem).unwrap();
            let mut costs = resolution.costs.clone();
            let wrong = costs.len() / 2;
            costs[wrong] += 10.0 * options.tolerance * interior.figures.size;
            interior.refresh().unwrap();
            let again = (refined.again.as_ref(), true);
            let found = verify((problem, &rows), options, interior, &costs, again, &mut || false);
            assert!(found.verification.cost.fails() && !found.verification.dynamics.fails(), "{found:?}");
            assert!((found.blame[wrong] / 10.0 - 1.0).abs() < 0.1, "{:?}", found.blame);
            let nodes = divided(interior, &found, options).unwrap();
            assert_eq!(nodes.len(), interior.spline.mesh.nodes.len() + 1);
        });
    }

    /// Where the search is over the verification is not done, and the motion is not converged.
    #[test]
    fn a_search_that_is_over_leaves_its_motion_unverified() {
        solved(|problem, options, interior, mut resolution, mut refined| {
            let rows = TaskRows::new(problem).unwrap();
            let mut recorder = Recorder::default();
            recorder.cancel();
            let iterate = (interior, &mut resolution, &mut refined);
            verify_and_repair((problem, &rows), options, iterate, &mut recorder).unwrap();
            assert_eq!(refined.status, Status::Cancelled);
        });
    }

    /// After a mesh that does not resolve its motion, the one that was solved before takes its place.
    #[test]
    fn the_last_solved_motion_is_taken_again() {
        solved(|_, options, interior, mut resolution, _| {
            let (nodes, cost) = (interior.spline.mesh.nodes.clone(), resolution.cost);
            let last = LastSolved {
                snapshot: interior.snapshot(),
                error: 1e-3,
                keeps_limits: true,
                accurate: false,
            };
            interior.move_to(interior.spline.mesh.halved(0.0)).unwrap();
            let mut refined = Refined::without(Status::MeshLimit);
            refined.fall_back_to(last, (&mut *interior, &mut resolution), options).unwrap();
            assert_eq!(interior.spline.mesh.nodes, nodes);
            assert!((resolution.cost / cost - 1.0).abs() < 1e-12 && refined.error == 1e-3);
            assert_eq!(refined.status, Status::MeshLimit);
        });
    }
}
