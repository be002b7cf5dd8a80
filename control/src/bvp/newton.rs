//! Damped Newton steps with the natural monotonicity test.

use crate::bvp::timed::Timed;
use crate::bvp::values::Values;
use crate::bvp::{Failure, Solvable};
use crate::extremal::Extremal;

/// How Newton's method ended on one mesh.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Outcome {
    Converged,
    /// No damping made the correction shorter.
    Stalled,
    /// Too many steps.
    Limit,
    Failed(Failure),
}

/// One step, as it is told to whoever listens.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Step {
    pub number: usize,
    pub correction: f64,
    pub damping: f64,
}

/// When to stop.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limits {
    pub tolerance: f64,
    pub steps: usize,
    /// Smallest damping.
    pub damping: f64,
}

/// Smallest damping tried, unless said otherwise.
pub(crate) const LEAST_DAMPING: f64 = 1e-6;

/// Values that steps go through: all that Newton's method allocates.
struct Workspace {
    correction: Values,
    simplified: Values,
    trial: Values,
}

/// Newton's method on discretised equations from their current values.
///
/// A step `z + d s` with s = -A^-1 r is taken when the correction `-A^-1 r(z + d s)`, with the same matrix, is shorter by the
/// factor `1 - d/4`: a test that does not change when equations are multiplied by a regular matrix. The damping d is
/// predicted from how far that correction is from `(1 - d) s`, what it would be without curvature. Converged when the
/// correction of a new linearisation is no longer than the tolerance, in parts of the size of the components.
pub(crate) fn newton<Q: Solvable<E>, E: Extremal>(
    equations: &mut Q,
    timed: &mut Timed<'_, E>,
    Limits { tolerance, steps, damping: least }: Limits,
    mut listen: impl FnMut(&Q, &Timed<'_, E>, Step),
) -> Outcome {
    let mut work =
        Workspace { correction: equations.zeros(), simplified: equations.zeros(), trial: equations.zeros() };
    let mut predicted = 1.0;
    let mut last = None::<f64>;
    if equations.set_scales(timed, None) {
        // Costates that start at zero have no size yet; the first correction gives them one.
        if let Err(failure) = equations.linearise(timed) {
            return Outcome::Failed(failure);
        }
        equations.correction(&mut work.correction);
        if work.correction.norm().is_finite() {
            equations.set_scales(timed, Some(&work.correction));
        }
    }
    for number in 1..=steps {
        if let Err(failure) = equations.linearise(timed) {
            return Outcome::Failed(failure);
        }
        equations.correction(&mut work.correction);
        let length = work.correction.norm();
        if !length.is_finite() {
            return Outcome::Stalled;
        }
        if let Some(product) = last {
            let change = work.simplified.norm_of_sum(-1.0, &work.correction);
            predicted = if change > 0.0 { (product / (change * length)).min(1.0) } else { 1.0 };
        }
        let Some((damping, next)) =
            damped(equations, timed, &mut work, predicted.max(1e-3), (tolerance, least))
        else {
            return Outcome::Stalled;
        };
        last = Some(length * next * damping);
        std::mem::swap(equations.current_mut(), &mut work.trial);
        listen(equations, timed, Step { number, correction: length, damping });
        if damping == 1.0 && (next <= tolerance || length <= tolerance) {
            equations.set_scales(timed, None);
            last = None;
            predicted = 1.0;
            if finished(equations, timed, &mut work, tolerance) {
                return Outcome::Converged;
            }
        }
    }
    Outcome::Limit
}

/// Finds a damping for which the step passes the test; leaves the new values in `trial`.
fn damped<Q: Solvable<E>, E: Extremal>(
    equations: &mut Q,
    timed: &mut Timed<'_, E>,
    work: &mut Workspace,
    predicted: f64,
    (tolerance, least): (f64, f64),
) -> Option<(f64, f64)> {
    let length = work.correction.norm();
    let (mut damping, mut raised) = (predicted, false);
    while damping >= least {
        work.trial.set_sum(equations.current(), damping, equations.scale(), &work.correction);
        if equations.evaluate(timed, &work.trial).is_err() {
            damping *= 0.5;
            continue;
        }
        equations.correction(&mut work.simplified);
        let next = work.simplified.norm();
        if !next.is_finite() {
            damping *= 0.5;
            continue;
        }
        let curvature = work.simplified.norm_of_sum(damping - 1.0, &work.correction);
        let better = if curvature > 0.0 { 0.5 * length * damping * damping / curvature } else { 1.0 };
        if next >= (1.0 - damping / 4.0) * length && length > tolerance {
            damping = better.min(0.5 * damping);
        } else if !raised && damping < 1.0 && better.min(1.0) >= 4.0 * damping {
            (raised, damping) = (true, better.min(1.0));
        } else {
            return Some((damping, next));
        }
    }
    None
}

/// Whether the correction of a new linearisation is short enough; takes it then, and evaluates there.
fn finished<Q: Solvable<E>, E: Extremal>(
    equations: &mut Q,
    timed: &mut Timed<'_, E>,
    work: &mut Workspace,
    tolerance: f64,
) -> bool {
    if equations.linearise(timed).is_err() {
        return false;
    }
    equations.correction(&mut work.correction);
    let length = work.correction.norm();
    if length.is_nan() || length > tolerance {
        return false;
    }
    work.trial.set_sum(equations.current(), 1.0, equations.scale(), &work.correction);
    if equations.evaluate(timed, &work.trial).is_err() {
        return false;
    }
    std::mem::swap(equations.current_mut(), &mut work.trial);
    true
}
