//! From a problem that is solved to one that is not, step by step.

use crate::extremal::Extremal;
use crate::search::LOOSE;
use crate::solve::{Context, Extremum};
use crate::status::Status;

/// Smallest step, of a way of length 1.
const LEAST_STEP: f64 = 1.0 / 1024.0;
/// Most points that are tried.
const MOST_POINTS: usize = 60;
/// Most nodes on the way: what needs more takes too long.
const MOST_NODES: usize = 1001;
/// Most Newton steps for one point of the way.
const STEPS: usize = 20;
/// Smallest damping on the way: what needs a smaller one may lead to another solution.
const DAMPING: f64 = 0.02;

/// Follows solutions while `set` takes the problem from s = 0, where `at` is a solution, to s = 1.
///
/// Each point is predicted by the line through the last two; where Newton's method fails from there, half the step is tried,
/// and after a success twice as long a one. What stops at a step of 1/1024, at a turning point most often, is a
/// [`Status::ContinuationFailed`]; the problem is then the one that the solution returned belongs to.
pub(crate) fn follow<E: Extremal>(
    mut at: Extremum,
    extremal: &mut E,
    context: &mut Context<'_>,
    mut set: impl FnMut(&mut E, f64),
) -> Extremum {
    if !at.status.is_converged() {
        return at;
    }
    let tolerance = LOOSE.max(context.options.tolerance);
    let steps = std::mem::replace(&mut context.steps, STEPS);
    let damping = std::mem::replace(&mut context.damping, DAMPING);
    let fewer = context.options.max_nodes.min(MOST_NODES);
    let nodes = std::mem::replace(&mut context.options.max_nodes, fewer);
    let (mut position, mut step) = (0.0, 0.125_f64);
    let mut last: Option<(Extremum, f64)> = None;
    for point in 0.. {
        if position >= 1.0 {
            break;
        }
        let target = if position + 1.01 * step >= 1.0 { 1.0 } else { position + step };
        set(extremal, target);
        let ahead = last.as_ref().map(|(before, there)| (before, (target - position) / (position - there)));
        let mut found = at.predicted(extremal, ahead).solve(extremal, tolerance, context);
        if !found.status.is_converged() && last.is_some() {
            found = at.predicted(extremal, None).solve(extremal, tolerance, context);
        }
        if found.status.is_converged() && found.final_time(extremal) > 0.0 {
            last = Some((std::mem::replace(&mut at, found), position));
            position = target;
            step *= 2.0;
        } else {
            step = 0.5 * step.min(target - position);
            if step < LEAST_STEP || point > MOST_POINTS {
                set(extremal, position);
                at.status = Status::ContinuationFailed;
                break;
            }
        }
    }
    (context.steps, context.damping, context.options.max_nodes) = (steps, damping, nodes);
    at
}

impl Extremum {
    /// The same mesh and unknowns, moved by `factor` times what changed since `before`; not yet solved.
    pub(crate) fn predicted<E: Extremal>(&self, extremal: &mut E, before: Option<(&Self, f64)>) -> Self {
        let (mesh, points) = (self.equations.mesh.clone(), self.equations.method.len());
        let mut old = vec![0.0; self.equations.m];
        Self::guess(extremal, (self.clock, self.arcs.clone()), mesh, points, |arc, s, w| {
            self.equations.sample(arc, s, w);
            if let Some((before, factor)) = before {
                before.equations.sample(arc, s, &mut old);
                w.iter_mut().zip(&old).for_each(|(w, old)| *w += factor * (*w - old));
            }
        })
    }
}
