//! The way from a guess to a solution, for any extremal.

use super::arcs::solve_arcs;
use super::extremal::{Ease, Extremal};
use super::final_time::free_time;
use super::mesh::Mesh;
use super::motion::Motion;
use super::options::Options;
use super::problem::Time;
use super::refine::{Context, Extremum};
use super::stages::by_stages;
use super::status::Status;
use super::timed::{Arcs, Clock};

/// Tolerance of solutions that only lead to the next one.
pub(super) const LOOSE: f64 = 1e-4;

/// Solves an extremal from a guess of z at t/T in [0, 1].
///
/// With a free final time, first at the fixed time of the guess: at zero costates H* = 0 does not determine T.
///
/// ```
/// use costate::control::{Options, Time, solve_extremal};
/// # use costate::control::{Extremal, Law, Rate};
/// # use costate::EvalError;
/// # struct Line;
/// # impl Extremal for Line {
/// #     fn states(&self) -> usize { 1 }
/// #     fn rate(&mut self, z: &[f64], _: Law<'_>, g: &mut [f64]) -> Result<Rate, EvalError> {
/// #         g.copy_from_slice(&[z[1], 0.0]);
/// #         let cost = 0.5 * z[1] * z[1];
/// #         Ok(Rate { hamiltonian: z[1] * z[1] - cost, cost, penalty: 0.0 })
/// #     }
/// #     fn linear(&mut self, z: &[f64], law: Law<'_>, g: &mut [f64], j: &mut [f64]) -> Result<Rate, EvalError> {
/// #         j.copy_from_slice(&[0.0, 1.0, 0.0, 0.0]);
/// #         self.rate(z, law, g)
/// #     }
/// #     fn start(&mut self, z: &[f64], r: &mut [f64], j: &mut [f64]) -> Result<(), EvalError> {
/// #         r[0] = z[0];
/// #         j.copy_from_slice(&[1.0, 0.0]);
/// #         Ok(())
/// #     }
/// #     fn end(&mut self, z: &[f64], r: &mut [f64], j: &mut [f64]) -> Result<(), EvalError> {
/// #         r[0] = z[0] - 1.0;
/// #         j.copy_from_slice(&[1.0, 0.0]);
/// #         Ok(())
/// #     }
/// #     fn state_rate(&mut self, _: &[f64], u: &[f64], f: &mut [f64]) -> Result<(), EvalError> {
/// #         f.copy_from_slice(u);
/// #         Ok(())
/// #     }
/// #     fn controls(&self) -> usize { 1 }
/// #     fn unbounded_controls(&self, z: &[f64], u: &mut [f64]) { u[0] = z[1]; }
/// # }
/// // `Line`: dx/dt = u from 0 to 1, l = u^2/2.
/// let motion = solve_extremal(&mut Line, Time::Fixed(2.0), &Options::default(), |s, z| z[0] = s);
/// assert!(motion.status.is_converged() && (motion.cost - 0.25).abs() < 1e-12);
/// ```
pub fn solve_extremal<E: Extremal>(
    extremal: &mut E,
    time: Time,
    options: &Options,
    guess: impl FnMut(f64, &mut [f64]),
) -> Motion {
    let mut context = Context::new(options, None);
    let mut guess = guess;
    let found = search(extremal, time, |_, s, z| guess(s, z), &mut context);
    found.into_motion(extremal, context.iterations)
}

/// As [`solve_extremal`], with the table of iterations in `context`; the guess is also asked for a part of the way to the end.
///
/// First the problem itself. Where that fails, an easier one: without penalties and bounds, and to an end that is nearer;
/// then each of these is brought back.
pub(super) fn search<E: Extremal>(
    extremal: &mut E,
    time: Time,
    mut guess: impl FnMut(f64, f64, &mut [f64]),
    context: &mut Context<'_>,
) -> Extremum {
    let tolerance = context.options.tolerance;
    let loose = LOOSE.max(tolerance);
    let easiest = extremal.easiest();
    context.phase = "fixed time";
    let mut best = None;
    if easiest.effort == 0.0 {
        context.steps = context.options.max_iterations.min(DIRECT_STEPS);
        let first = at_fixed_time(extremal, time, (1.0, &mut guess), context).solve(extremal, loose, context);
        context.steps = context.options.max_iterations;
        let found = finish(first, extremal, time, context);
        if found.status.is_converged() || easiest == Ease::NONE {
            return found;
        }
        best = Some(found);
    }
    let found = by_stages(extremal, time, &mut guess, context);
    if found.status != Status::SwitchesNotRefined {
        extremal.set_ease(Ease::NONE);
    }
    match best {
        Some(best) if !found.status.is_converged() => best,
        _ => found,
    }
}

/// Most Newton steps of the first attempt, where there is another way.
pub(super) const DIRECT_STEPS: usize = 25;

/// z at (part of the way to the end, part of the time).
pub(super) type Guess<'a> = &'a mut dyn FnMut(f64, f64, &mut [f64]);

/// The equations of one arc at a fixed time, with the guess of what leads to a part of the end.
pub(super) fn at_fixed_time<E: Extremal>(
    extremal: &mut E,
    time: Time,
    (goal, guess): (f64, Guess<'_>),
    context: &Context<'_>,
) -> Extremum {
    let Options { nodes, points, .. } = context.options;
    let (mesh, clock) = (Mesh::uniform(&[nodes - 1]), Clock::Fixed(time.value()));
    Extremum::guess(extremal, (clock, Arcs::one()), mesh, points, |_, s, z| guess(goal, s, z))
}

/// From a rough solution at a fixed time to an exact one in the time asked for.
fn finish<E: Extremal>(first: Extremum, extremal: &mut E, time: Time, context: &mut Context<'_>) -> Extremum {
    if !first.status.is_converged() {
        return first;
    }
    match time {
        Time::Fixed(_) => sharpen(first, extremal, context),
        Time::Free { .. } => {
            let loose = LOOSE.max(context.options.tolerance);
            let found = free_time(first, extremal, loose, context);
            sharpen(found, extremal, context)
        }
    }
}

/// From a rough solution to an exact one: with arcs where a control reaches a bound, else, or where that fails, on finer
/// meshes.
pub(super) fn sharpen<E: Extremal>(rough: Extremum, extremal: &mut E, context: &mut Context<'_>) -> Extremum {
    if !rough.status.is_converged() {
        return rough;
    }
    let tolerance = context.options.tolerance;
    match solve_arcs(&rough, extremal, tolerance, context) {
        Some(found) => found,
        None => rough.solve(extremal, tolerance, context),
    }
}
