//! By way of easier problems.

use crate::extremal::{Extremal, Relaxation};
use crate::problem::FinalTime;
use crate::search::{DIRECT_STEPS, Guess, LOOSE, at_fixed_time, sharpen};
use crate::solve::arcs::solve_arcs;
use crate::solve::free_time::free_time;
use crate::solve::homotopy::follow;
use crate::solve::{Context, Extremum};
use crate::status::Status;

/// Without limits and to a nearer end first; then the end, the time and the limits that were asked for.
pub(crate) fn by_stages<E: Extremal>(
    extremal: &mut E,
    time: FinalTime,
    guess: &mut dyn Guess,
    context: &mut Context<'_>,
) -> Extremum {
    let loose = LOOSE.max(context.options.tolerance);
    let easiest = extremal.easiest();
    let mut ease = Relaxation { goal: 1.0, ..easiest };
    context.phase = "without limits";
    extremal.set_relaxation(ease);
    context.steps = context.options.max_iterations.min(DIRECT_STEPS);
    let mut at = at_fixed_time(extremal, time, (1.0, guess), context).solve(extremal, loose, context);
    if !at.status.is_converged() && easiest.goal < 1.0 {
        context.phase = "nearer end";
        ease.goal = easiest.goal;
        extremal.set_relaxation(ease);
        at = at_fixed_time(extremal, time, (ease.goal, guess), context).solve(extremal, loose, context);
        at = follow(at, extremal, context, |extremal, s| {
            extremal.set_relaxation(Relaxation { goal: easiest.goal + s * (1.0 - easiest.goal), ..ease });
        });
        ease.goal = 1.0;
    }
    context.steps = context.options.max_iterations;
    if let (FinalTime::Free { .. }, true) = (time, at.status.is_converged()) {
        at = free_time(at, extremal, loose, context);
    }
    if easiest.penalty < 1.0 {
        context.phase = "penalties";
        at = follow(at, extremal, context, |extremal, s| {
            let penalty = 1e-6_f64.powf(1.0 - s);
            extremal.set_relaxation(Relaxation { penalty, ..ease });
        });
        ease.penalty = 1.0;
    }
    if easiest.bounds > 1.0 {
        context.phase = "bounds";
        extremal.set_relaxation(Relaxation { bounds: 1.0, ..ease });
        let excess = at.excess(extremal).max(1.0);
        at = follow(at, extremal, context, |extremal, s| {
            extremal.set_relaxation(Relaxation { bounds: excess.powf(1.0 - s), ..ease });
        });
        ease.bounds = 1.0;
    }
    to_the_problem_itself(at, extremal, (time, ease), context)
}

/// From a solution of a problem that is easier by its smoothing alone, if at all, to one of the problem itself.
pub(crate) fn to_the_problem_itself<E: Extremal>(
    at: Extremum,
    extremal: &mut E,
    (time, ease): (FinalTime, Relaxation),
    context: &mut Context<'_>,
) -> Extremum {
    if ease.effort > 0.0 {
        return without_effort(at, extremal, ease, context);
    }
    extremal.set_relaxation(Relaxation::NONE);
    context.phase = if let FinalTime::Fixed(_) = time { "fixed time" } else { "free time" };
    sharpen(at, extremal, context)
}

/// The weight of the effort goes to zero by steps; after each the arcs are tried that its solution shows.
fn without_effort<E: Extremal>(
    mut at: Extremum,
    extremal: &mut E,
    ease: Relaxation,
    context: &mut Context<'_>,
) -> Extremum {
    let tolerance = context.options.tolerance;
    let mut ease = ease;
    let mut change = f64::INFINITY;
    for next in SMOOTHINGS {
        context.phase = "smoothing";
        let effort = ease.effort;
        let before = at.total(extremal);
        at = follow(at, extremal, context, |extremal, s| {
            ease.effort = effort * (next / effort).powf(s);
            extremal.set_relaxation(ease);
        });
        extremal.set_relaxation(Relaxation::NONE);
        let steps = std::mem::replace(&mut context.steps, DIRECT_STEPS);
        let found = solve_arcs(&at, extremal, tolerance, context);
        context.steps = steps;
        if let Some(found) = found {
            return found;
        }
        let changed = (at.total(extremal) - before).abs() / before.abs();
        if !at.status.is_converged() {
            // What got stuck on the way has gone a part of the step: as much as that says of the whole one.
            if ease.effort < effort {
                change = changed * (effort / next).ln() / (effort / ease.effort).ln();
            }
            break;
        }
        change = changed;
        if change < NEGLIGIBLE && at.equations.mesh.nodes() > MOST_NODES {
            break;
        }
    }
    // The motion of the smoothed problem; it keeps to the bounds and meets the end.
    extremal.set_relaxation(ease);
    context.phase = "smoothing";
    let smoothed = at.solve(extremal, tolerance.max(SMOOTHED), context);
    match smoothed.status {
        Status::Converged if change.is_nan() || change > NEGLIGIBLE => {
            smoothed.with_status(Status::SwitchesNotRefined)
        }
        _ => smoothed,
    }
}

/// Change of the cost with the weight of the effort, in parts of it, below which the smoothed problem stands for the one asked
/// for: where a control stays inside its bounds for a while there are no switches to be found.
const NEGLIGIBLE: f64 = 2e-5;

/// Tolerance of the smoothed problem where it stands for the one asked for.
const SMOOTHED: f64 = 1e-8;

/// Nodes from which on a smoothed problem is not made sharper without need: where a control that costs nothing stays between
/// its bounds, meshes grow without end.
const MOST_NODES: usize = 500;

/// Weights of the effort at which the arcs are tried, in parts of one that makes it matter.
const SMOOTHINGS: [f64; 13] = [0.1, 0.03, 0.01, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5, 1e-5, 3e-6, 1e-6, 3e-7, 1e-7];
