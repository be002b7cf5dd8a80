//! From a problem that is solved to one that is not, step by step.
//!
//! Natural continuation in s from 0 to 1 with a secant predictor:
//!
//! $$ z_{guess}(s) = z(s_k) + \frac{s - s_k}{s_k - s_{k-1}} \bigl( z(s_k) - z(s_{k-1}) \bigr) $$
//!
//! Source: E. L. Allgower, K. Georg, *Numerical Continuation Methods*, Springer 1990, chapter 2.

use crate::constants::homotopy::{
    FIRST_STEP, LEAST_DAMPING, LEAST_STEP, MOST_NODES, MOST_POINTS, MOST_STEPS,
};
use crate::extremal::Extremal;
use crate::solve::discretisation::Change;
use crate::solve::{Attempt, Discretisation, Recorder, Solved};
use crate::status::Status;

/// Follows solutions while `set` takes the problem from s = 0, where `at` is a solution, to s = 1.
///
/// Where Newton's method fails, the step is halved; after a success it is doubled. If the step gets too
/// small, at a turning point most often, the status is [`Status::ContinuationFailed`]; the problem is then
/// the one that the solution returned belongs to.
pub(crate) fn follow(
    at: Solved,
    extremal: &mut dyn Extremal,
    attempt: &Attempt,
    recorder: &mut Recorder<'_>,
    set: impl FnMut(&mut dyn Extremal, f64),
) -> Solved {
    follow_from(FIRST_STEP, at, extremal, attempt, recorder, set)
}

/// The same with another first step.
pub(crate) fn follow_from(
    first: f64,
    mut at: Solved,
    extremal: &mut dyn Extremal,
    attempt: &Attempt,
    recorder: &mut Recorder<'_>,
    mut set: impl FnMut(&mut dyn Extremal, f64),
) -> Solved {
    if !at.is_converged() {
        return at;
    }
    let attempt = Attempt {
        max_steps: attempt.max_steps.min(MOST_STEPS),
        least_damping: LEAST_DAMPING,
        max_nodes: attempt.max_nodes.min(MOST_NODES),
        ..attempt.loose()
    };
    let (mut position, mut step) = (0.0, first);
    let mut last: Option<Point> = None;
    for point in 0.. {
        if position >= 1.0 {
            break;
        }
        let target = if position + 1.01 * step >= 1.0 { 1.0 } else { position + step };
        set(extremal, target);
        let change = last.as_ref().map(|last| Change {
            since: &last.found,
            factor: (target - position) / (position - last.position),
        });
        let mut next = at.found.predicted(extremal, change).solve(extremal, &attempt, recorder);
        if !next.is_converged() && last.is_some() {
            next = at.found.predicted(extremal, None).solve(extremal, &attempt, recorder);
        }
        if next.is_converged() && next.found.final_time(extremal) > 0.0 {
            last = Some(Point { found: std::mem::replace(&mut at, next).found, position });
            position = target;
            step *= 2.0;
            continue;
        }
        step = 0.5 * step.min(target - position);
        let interruption = recorder.interruption();
        if step < LEAST_STEP || point > MOST_POINTS || interruption.is_some() {
            set(extremal, position);
            at.status = interruption.map_or(Status::ContinuationFailed, Status::from);
            break;
        }
    }
    at
}

/// An intermediate solution.
struct Point {
    found: Discretisation,
    position: f64,
}
