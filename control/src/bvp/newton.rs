//! Damped Newton steps with the natural monotonicity test.
//!
//! With the matrix A of the linearised equations at z and the correction `s = -A^-1 r(z)`, a step `z + d s`
//! with the damping `0 < d <= 1` is accepted when the *simplified* correction, with the same matrix, is
//! shorter:
//!
//! $$ \lVert A^{-1} r(z + d s) \rVert < (1 - d/4) \lVert A^{-1} r(z) \rVert $$
//!
//! The test does not change when the equations are multiplied by a regular matrix. Without curvature the
//! simplified correction `t = -A^-1 r(z + d s)` would be `(1 - d) s`. The distance from it predicts the
//! damping:
//!
//! $$ d^+ = \frac{d^2 \lVert s \rVert}{2 \lVert t - (1 - d) s \rVert} $$
//!
//! The norm is the root mean square of scaled components. Source: P. Deuflhard, *Newton Methods for Nonlinear
//! Problems*, Springer 2004, section 3.3 (algorithm NLEQ-ERR).

use crate::bvp::scales::Scales;
use crate::bvp::timed::Timed;
use crate::bvp::values::Values;
use crate::bvp::{Failure, Solvable};
use crate::constants::newton::{DECREASE, LEAST_PREDICTION, RAISE};
use crate::extremal::Extremal;

/// How Newton's method ended on one mesh.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Outcome {
    Converged,
    /// No damping made the correction shorter.
    Stalled,
    /// Too many steps.
    Limit,
    /// The observer asked to stop.
    Interrupted,
    Failed(Failure),
}

/// One step, as it is reported.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Step {
    pub number: usize,
    pub correction: f64,
    pub damping: f64,
}

/// When to stop.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limits {
    /// Length of the last correction.
    pub tolerance: f64,
    pub max_steps: usize,
    pub least_damping: f64,
}

/// Watches the steps and may stop them.
pub(crate) trait Observer<Q, E: ?Sized> {
    /// Asked before each step: whether to stop.
    fn interrupts(&mut self) -> bool;

    /// Called after each step.
    fn step(&mut self, equations: &Q, timed: &Timed<'_, E>, step: Step);
}

/// Values that steps need: all that Newton's method allocates.
struct Workspace {
    correction: Values,
    simplified: Values,
    trial: Values,
}

/// A step that passed the test.
struct Accepted {
    damping: f64,
    /// Length of the simplified correction.
    next: f64,
}

/// Newton's method on discretised equations from their current values; converged when the correction of a new
/// linearisation is no longer than the tolerance.
pub(crate) fn newton<Q: Solvable<E>, E: Extremal + ?Sized>(
    equations: &mut Q,
    timed: &mut Timed<'_, E>,
    limits: Limits,
    observer: &mut impl Observer<Q, E>,
) -> Outcome {
    let mut work =
        Workspace { correction: equations.zeros(), simplified: equations.zeros(), trial: equations.zeros() };
    let tolerance = limits.tolerance;
    let mut predicted = 1.0;
    let mut last = None::<f64>;
    if set_scales(equations, timed, None) == Scales::Unknown {
        // Costates that start at zero have no size yet; the first correction gives them one.
        if let Err(failure) = equations.linearise(timed) {
            return Outcome::Failed(failure);
        }
        equations.correction(&mut work.correction);
        if work.correction.norm().is_finite() {
            set_scales(equations, timed, Some(&work.correction));
        }
    }
    for number in 1..=limits.max_steps {
        if observer.interrupts() {
            return Outcome::Interrupted;
        }
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
        let first = predicted.max(LEAST_PREDICTION);
        let Some(Accepted { damping, next }) = damped(equations, timed, &mut work, first, limits) else {
            return Outcome::Stalled;
        };
        last = Some(length * next * damping);
        std::mem::swap(equations.current_mut(), &mut work.trial);
        observer.step(equations, timed, Step { number, correction: length, damping });
        if damping == 1.0 && (next <= tolerance || length <= tolerance) {
            set_scales(equations, timed, None);
            last = None;
            predicted = 1.0;
            if finished(equations, timed, &mut work, tolerance) {
                return Outcome::Converged;
            }
        }
    }
    Outcome::Limit
}

/// Sets the scales, with the coupling where costates may be rounding errors around zero.
pub(crate) fn set_scales<Q: Solvable<E>, E: Extremal + ?Sized>(
    equations: &mut Q,
    timed: &mut Timed<'_, E>,
    with: Option<&Values>,
) -> Scales {
    let scales = equations.set_scales(timed, with);
    if scales == Scales::Small {
        equations.set_coupling(timed);
        return equations.set_scales(timed, with);
    }
    scales
}

/// Finds a damping for which the step passes the test, from `first` on; leaves the new values in `trial`.
fn damped<Q: Solvable<E>, E: Extremal + ?Sized>(
    equations: &mut Q,
    timed: &mut Timed<'_, E>,
    work: &mut Workspace,
    first: f64,
    limits: Limits,
) -> Option<Accepted> {
    let length = work.correction.norm();
    let (mut damping, mut raised) = (first, false);
    while damping >= limits.least_damping {
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
        if next >= (1.0 - damping * DECREASE) * length && length > limits.tolerance {
            damping = better.min(0.5 * damping);
        } else if !raised && damping < 1.0 && better.min(1.0) >= RAISE * damping {
            (raised, damping) = (true, better.min(1.0));
        } else {
            return Some(Accepted { damping, next });
        }
    }
    None
}

/// Whether the correction of a new linearisation is short enough; if so, takes it and evaluates there.
fn finished<Q: Solvable<E>, E: Extremal + ?Sized>(
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
