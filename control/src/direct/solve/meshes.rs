//! One mesh after the other, until the motion is accurate.

use super::mending::{Beyond, Mended};
use super::prepare::Dynamics;
use super::refined::Refined;
use super::restore::{Patience, Restored, restore};
use crate::constants::direct as constants;
use crate::direct::interior::iterate::{End, Interior};
use crate::direct::motion::spline::Spline;
use crate::direct::outcome::infeasible::with_proof;
use crate::direct::outcome::verify::{Again, integrate_again};
use crate::direct::refine::resolution::Resolution;
use crate::options::{SolverOptions, Verify};
use crate::problem::Problem;
use crate::progress::{Iteration, Phase};
use crate::result::stage_times::Stage;
use crate::solve::Recorder;
use crate::solve::recorder::Interruption;
use crate::status::Status;
use costate::EvalError;

/// Where a refinement begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Start {
    Guess,
    /// At a motion that was solved before, on its mesh or another one.
    Saved,
    /// At a motion that was solved on this mesh, which resolves it, without its slacks and multipliers.
    Resolved,
    /// At an iterate that is solved on its mesh, with slacks and multipliers.
    Solved,
}

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
    let tolerance = options.tolerance;
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
    let mut refined = Refined::without(Status::MeshLimit);
    let (mut guess, mut gap, mut restorations) = (interior.spline.clone(), constants::FIRST_GAP, 0);
    // A coarse mesh is not solved much better than it resolves the motion.
    let least = interior.looseness.between(constants::PART_OF_TOLERANCE) * tolerance;
    // A mesh that resolves a good motion would be divided by the errors of a rough one.
    let mut precision = match start {
        Start::Resolved => least,
        Start::Guess | Start::Saved | Start::Solved => least.max(constants::FIRST_PRECISION),
    };
    interior.last_tolerance = Some(least);
    let (mut mesh, mut left, mut mended) = (0, 0, Mended::default());
    // Where accelerations are continuous only limits of jerks and of rates of torques move.
    let smooth = interior.spline.mesh.shape.is_smooth();
    interior.clock.lap(Stage::Preparation);
    while mesh < constants::MESHES {
        let first = interior.figures.iterations;
        let mut resolved = interior.spline.clone();
        let (mut patience, mut stuck, mut unresolved) = (Patience::default(), false, false);
        let watch = |iterate: &mut Interior<Dynamics>, step: f64| {
            recorder.record(iteration(iterate, first, step));
            stuck = patience.is_over(iterate.figures.violation);
            let looks = iterate.running.costs_torques()
                && (iterate.figures.iterations - first).is_multiple_of(constants::LOOK);
            unresolved = looks && resolution.is_far_off(iterate);
            if looks && !unresolved {
                resolved.clone_from(&iterate.spline);
            }
            if stuck || unresolved { Some(Interruption::TimeLimit) } else { recorder.interruption() }
        };
        let mut end = interior.iterate(precision, options.max_iterations, watch)?;
        if end == End::Solved && precision <= least {
            interior.take_last_step();
        }
        if stuck || unresolved {
            end = recorder.interruption().map_or(End::NoProgress, End::Interrupted);
        }
        let is_over = matches!(end, End::NoProgress | End::IterationLimit);
        if is_over && mended.comes_back(interior)? {
            precision = least;
            continue;
        }
        let mut figures = interior.figures;
        if is_over
            && figures.violation > constants::VIOLATION_ACCEPTED
            && restorations < constants::RESTORATIONS
            && !unresolved
        {
            restorations += 1;
            match restore(problem, interior, &guess, gap, options, recorder)? {
                Restored::Kept => continue,
                Restored::Infeasible(infeasible) => {
                    resolution.measure(interior)?;
                    let infeasible = Some(infeasible);
                    return Ok(Refined { infeasible, ..Refined::without(Status::Infeasible) });
                }
                Restored::Interrupted(interruption) => end = End::Interrupted(interruption),
                Restored::Unknown => {}
            }
            figures = interior.figures;
        }
        resolution.measure(interior)?;
        interior.clock.lap(Stage::Meshes);
        let error = (resolution.error() + figures.gap) / figures.size;
        let violated = figures.violation > constants::VIOLATION_ACCEPTED;
        let accurate = error <= tolerance && resolution.violation() <= constants::VIOLATION_BETWEEN;
        let can_move = !smooth || resolution.violation() <= constants::VIOLATION_BETWEEN;
        let mut beyond = Beyond::new(resolution, figures.size, error);
        if options.verify == Verify::None {
            // A motion that is not verified is one to begin with.
            beyond.overshoots = [0.0; 2];
        }
        let is_solved = end == End::Solved && !unresolved;
        if is_solved && accurate && mended.wants_hulls(&beyond) && resolution.take_hulls(interior, false) {
            mended.keep(&interior.spline);
            mended.begin_mesh();
            precision = least;
            interior.begin_inside();
            continue;
        }
        let moves = if is_solved && can_move { mended.moves_limits(&beyond, tolerance) } else { None };
        let allowed = tolerance * figures.size;
        let enough = interior.looseness.between(constants::ENOUGH) * allowed;
        let stride = interior.spline.mesh.shape.stride();
        let finer = match is_solved && accurate && moves.is_none() && mesh + 1 < constants::MESHES {
            true => {
                let most = (options.max_nodes - 1) / stride + 1;
                mended.finer(&beyond, (resolution, &interior.spline), allowed, most)
            }
            false => None,
        };
        if let Some(nodes) = finer {
            interior.move_to(nodes)?;
            interior.clock.lap(Stage::Meshes);
            (guess, gap, mesh) = (interior.spline.clone(), constants::WARM, mesh + 1);
            precision = least;
            continue;
        }
        let moves = moves.filter(|inside| resolution.move_limits_inside(interior, *inside)).is_some();
        let mut again = None;
        let status = match end {
            End::Interrupted(interruption) => {
                let far_off = resolution.error() > constants::UNRESOLVED * figures.size;
                let error = match far_off && interior.running.costs_torques() {
                    true => come_back(interior, resolved, resolution)?,
                    false => error,
                };
                return Ok(Refined { error, ..Refined::without(interruption.into()) });
            }
            _ if unresolved => Status::MeshLimit,
            End::NoProgress | End::IterationLimit if violated => Status::LimitsNotKept,
            End::NoProgress => Status::NewtonFailed,
            End::IterationLimit => Status::IterationLimit,
            End::Solved if accurate && precision <= least && !moves => {
                let status = verified(problem, options, interior, resolution, &mut again, recorder);
                if status.is_interruption() {
                    return Ok(Refined { error, again, ..Refined::without(status) });
                }
                status
            }
            End::Solved => Status::MeshLimit,
        };
        let is_cut = status == Status::NotVerified && mended.wants_torques(&beyond);
        refined = Refined { error, again, ..Refined::without(status) };
        if is_cut && resolution.take_hulls(interior, true) {
            mended.keep(&interior.spline);
            mended.begin_mesh();
            interior.begin_inside();
            continue;
        }
        let kept = accurate && precision <= least && !moves;
        let unverified = kept && options.verify == Verify::None;
        if refined.status.is_converged()
            || unverified
            || (violated && !unresolved && mesh >= constants::MESHES_WITHOUT_MOTION)
        {
            break;
        }
        if moves {
            precision = least;
            interior.begin_inside();
            continue;
        }
        if accurate && precision > least {
            precision = least;
            continue;
        }
        mended.begin_mesh();
        precision = (constants::PRECISION * error).clamp(least, constants::FIRST_PRECISION.max(least));
        let narrowest = resolution.narrowest;
        let nodes = match (violated, accurate) {
            (true, _) if !unresolved => interior.spline.mesh.halved(narrowest),
            // What the estimate does not see, the integration may.
            (false, true) => resolution.nodes_for_torques(&interior.spline, allowed),
            _ => resolution.nodes(&interior.spline, allowed, enough),
        };
        let same = nodes == interior.spline.mesh.nodes;
        let nodes = if same { interior.spline.mesh.halved(narrowest) } else { nodes };
        left = if unresolved { left + 1 } else { 0 };
        let is_last = mesh + 1 == constants::MESHES || left == constants::UNRESOLVED_MESHES;
        if stride * (nodes.len() - 1) + 1 > options.max_nodes || is_last {
            if mended.comes_back(interior)? {
                precision = least;
                continue;
            }
            if unresolved {
                refined.error = come_back(interior, resolved, resolution)?;
            }
            break;
        }
        if unresolved {
            interior.spline = resolved;
        }
        interior.move_to(nodes)?;
        interior.clock.lap(Stage::Meshes);
        // What solves a mesh is near a solution on the next one.
        if end == End::Solved {
            (guess, gap) = (interior.spline.clone(), constants::WARM);
        }
        mesh += 1;
    }
    Ok(refined)
}

/// Comes back to a motion that its mesh resolved. The estimated error of its cost, relative to it.
fn come_back(
    interior: &mut Interior<Dynamics>,
    resolved: Spline,
    resolution: &mut Resolution,
) -> Result<f64, EvalError> {
    interior.spline = resolved;
    interior.start(Some(interior.mu))?;
    resolution.measure(interior)?;
    Ok(resolution.error() / interior.figures.size)
}

/// Whether the torques lead along the motion, to the tolerance of the options; or what stopped the search.
fn verified(
    problem: &Problem,
    options: &SolverOptions,
    interior: &mut Interior<Dynamics>,
    resolution: &Resolution,
    again: &mut Option<Again>,
    recorder: &mut Recorder<'_>,
) -> Status {
    let mut stops = || recorder.interruption().is_some();
    let found = again.insert(integrate_again(problem, options, interior, resolution, &mut stops));
    interior.clock.lap(Stage::Verification);
    if !found.is_complete {
        return recorder.interruption().map_or(Status::NotVerified, Status::from);
    }
    if found.leads { Status::Converged } else { Status::NotVerified }
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

/// A step for the log; `first` steps were made on other meshes.
pub(super) fn iteration(iterate: &Interior<Dynamics>, first: usize, step: f64) -> Iteration {
    let figures = &iterate.figures;
    Iteration {
        phase: Phase::Direct,
        nodes: iterate.spline.mesh.shape.stride() * iterate.spline.mesh.intervals() + 1,
        number: figures.iterations - first,
        residual: (figures.gap.max(figures.decrement.abs()) / figures.size).max(figures.violation),
        step,
        final_time: iterate.spline.duration(),
        cost: figures.cost,
    }
}
