//! The way from a guess to a solution, for any extremal.

pub(crate) mod guess;
pub(crate) mod stages;

use crate::bvp::Solvable;
use crate::bvp::mesh::Mesh;
use crate::bvp::timed::{Arcs, Clock, Timed};
use crate::extremal::{Extremal, Relaxation};
use crate::options::{SolverOptions, Ways};
use crate::path::{INTERVALS, Wish};
use crate::problem::FinalTime;
use crate::result::motion::ExtremalSolution;
use crate::search::stages::{by_stages, to_the_problem_itself};
use crate::solve::arcs::solve_arcs;
use crate::solve::free_time::free_time;
use crate::solve::homotopy::follow;
use crate::solve::{Context, Extremum};
use crate::status::Status;

/// Tolerance of solutions that only lead to the next one.
pub(crate) const LOOSE: f64 = 1e-4;

/// Solves an extremal from a guess of z at t/T in [0, 1].
///
/// With a free final time, first at the fixed time of the guess: at zero costates H* = 0 does not determine T.
///
/// ```
/// use costate_control::{SolverOptions, FinalTime, solve_extremal};
/// # use costate_control::{BoundaryValueProblem, BoundedControls, ControlLaw, HamiltonianTerms, Homotopy};
/// # use costate::EvalError;
/// # struct Line;
/// # impl BoundaryValueProblem for Line {
/// #     fn states(&self) -> usize { 1 }
/// #     fn evaluate(&mut self, z: &[f64], _: ControlLaw<'_>, g: &mut [f64]) -> Result<HamiltonianTerms, EvalError> {
/// #         g.copy_from_slice(&[z[1], 0.0]);
/// #         let cost = 0.5 * z[1] * z[1];
/// #         Ok(HamiltonianTerms { hamiltonian: z[1] * z[1] - cost, cost, ..HamiltonianTerms::default() })
/// #     }
/// #     fn linearise(
/// #         &mut self, z: &[f64], law: ControlLaw<'_>, g: &mut [f64], j: &mut [f64],
/// #     ) -> Result<HamiltonianTerms, EvalError> {
/// #         j.copy_from_slice(&[0.0, 1.0, 0.0, 0.0]);
/// #         self.evaluate(z, law, g)
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
/// # }
/// # impl BoundedControls for Line {}
/// # impl Homotopy for Line {}
/// // `Line`: dx/dt = u from 0 to 1, l = u^2/2.
/// let motion = solve_extremal(&mut Line, FinalTime::Fixed(2.0), &SolverOptions::default(), |s, z| z[0] = s);
/// assert!(motion.status.is_converged() && (motion.cost - 0.25).abs() < 1e-12);
/// ```
pub fn solve_extremal<E: Extremal>(
    extremal: &mut E,
    time: FinalTime,
    options: &SolverOptions,
    guess: impl FnMut(f64, &mut [f64]),
) -> ExtremalSolution {
    let mut context = Context::new(options, None);
    let found = search(extremal, time, &mut Plain(guess), &mut context);
    found.into_solution(extremal, context.iterations, options.tolerance)
}

/// Where a search begins: z at s = t/T.
pub(crate) trait Guess {
    /// That of a motion to a part of the way to the end.
    fn simple(&mut self, goal: f64, s: f64, z: &mut [f64]);

    /// Duration of a saved motion, where the simple guess is one.
    fn saved(&self) -> Option<f64> {
        None
    }

    /// Looks for a path of low cost; its cost and duration.
    fn find_path(&mut self, _wish: Wish, _context: &mut Context<'_>) -> Option<(f64, f64)> {
        None
    }

    /// That of the path found last.
    fn path(&mut self, _s: f64, _z: &mut [f64]) {}
}

/// A guess of z alone.
struct Plain<F>(F);

impl<F: FnMut(f64, &mut [f64])> Guess for Plain<F> {
    fn simple(&mut self, _: f64, s: f64, z: &mut [f64]) {
        (self.0)(s, z);
    }
}

/// As [`solve_extremal`], with the table of iterations in `context`.
///
/// First from the simple guess; a motion that a saved one led to is kept. Then from a path of low cost, where that failed or costs more. Where both fail, by way of
/// easier problems: without penalties and bounds, and to an end that is nearer; then each of these is brought back.
pub(crate) fn search<E: Extremal>(
    extremal: &mut E,
    time: FinalTime,
    guess: &mut dyn Guess,
    context: &mut Context<'_>,
) -> Extremum {
    let loose = LOOSE.max(context.options.tolerance);
    let easiest = extremal.easiest();
    context.phase = "fixed time";
    if context.options.ways == Ways::Direct {
        let first = at_fixed_time(extremal, time, (1.0, guess), context).solve(extremal, loose, context);
        return finish(first, extremal, time, context);
    }
    let saved = guess.saved();
    let begin = match (time, saved) {
        (FinalTime::Free { .. }, Some(guess)) => FinalTime::Free { guess },
        _ => time,
    };
    let mut best = None;
    if easiest.effort == 0.0 {
        context.steps = context.options.max_iterations.min(DIRECT_STEPS);
        let first = at_fixed_time(extremal, begin, (1.0, guess), context).solve(extremal, loose, context);
        context.steps = context.options.max_iterations;
        best = Some(finish(first, extremal, begin, context));
    } else if saved.is_some() {
        best = from_saved(extremal, begin, guess, context);
    }
    if saved.is_some()
        && let Some(found) = best.take_if(|best| best.status.is_converged())
    {
        return found;
    }
    let solved = best.as_ref().filter(|best| best.status.is_converged());
    let cost = solved.map(|best| best.total(extremal));
    for wish in WISHES {
        context.phase = PATH;
        let Some((lower, duration)) = guess.find_path(wish, context) else { break };
        if cost.is_some_and(|cost| lower >= cost - NOTICEABLE * cost.abs()) {
            break;
        }
        let found = from_path(extremal, (time, duration), (wish, guess), context);
        let close = [Status::Converged, Status::MeshLimit, Status::SwitchesNotRefined];
        // What is not quite solved does not stand for a solution.
        let enough = match cost {
            Some(cost) => found.status.is_converged() && found.total(extremal) < cost,
            None => close.contains(&found.status),
        };
        if enough {
            return found;
        }
        best = best.filter(|best| best.status.is_converged()).or(Some(found));
    }
    if let Some(best) = best
        && (best.status.is_converged() || easiest == Relaxation::NONE)
    {
        return best;
    }
    extremal.set_relaxation(Relaxation::NONE);
    by_stages(extremal, time, guess, context)
}

/// The name of the phase that looks for a path.
pub(crate) const PATH: &str = "path";

/// Most Newton steps of an attempt where there is another way.
pub(crate) const DIRECT_STEPS: usize = 25;

/// Part of the cost by which a path must be cheaper than a solution to be followed up.
const NOTICEABLE: f64 = 1e-3;

/// Paths that are tried in turn.
const WISHES: [Wish; 4] = [
    Wish { smoothing: 0.1, penalty: 1.0, halvings: 0 },
    Wish { smoothing: 0.1, penalty: 1.0, halvings: 1 },
    Wish { smoothing: 1.0, penalty: 1e-2, halvings: 1 },
    Wish { smoothing: 1.0, penalty: 1e-2, halvings: 2 },
];

/// From a saved motion with controls at their bounds to a solution with the arcs that it shows.
fn from_saved<E: Extremal>(
    extremal: &mut E,
    time: FinalTime,
    guess: &mut dyn Guess,
    context: &mut Context<'_>,
) -> Option<Extremum> {
    let evaluated = |mut rough: Extremum, extremal: &mut E| {
        let values = rough.equations.current.clone();
        let mut timed = Timed::new(extremal, rough.clock, rough.arcs.clone());
        rough.equations.evaluate(&mut timed, &values).ok().map(|()| rough)
    };
    let mut rough = evaluated(at_fixed_time(extremal, time, (1.0, guess), context), extremal)?;
    if let FinalTime::Free { .. } = time {
        rough = evaluated(rough.with_clock(extremal, Clock::Free), extremal)?;
    }
    solve_arcs(&rough, extremal, context.options.tolerance, context)
}

/// From a path of low cost to a solution.
fn from_path<E: Extremal>(
    extremal: &mut E,
    (time, duration): (FinalTime, f64),
    (wish, guess): (Wish, &mut dyn Guess),
    context: &mut Context<'_>,
) -> Extremum {
    let loose = LOOSE.max(context.options.tolerance);
    let SolverOptions { nodes, points, .. } = context.options;
    let easiest = extremal.easiest();
    let mut ease = Relaxation {
        effort: if easiest.effort > 0.0 { wish.smoothing } else { 0.0 },
        penalty: if easiest.penalty < 1.0 { wish.penalty } else { 1.0 },
        ..Relaxation::NONE
    };
    extremal.set_relaxation(ease);
    context.phase = "from path";
    let intervals = (2 * (nodes - 1)).max(INTERVALS << wish.halvings);
    let (mesh, clock) = (Mesh::uniform(&[intervals]), Clock::Fixed(duration));
    let first = Extremum::guess(extremal, (clock, Arcs::one()), mesh, points, |_, s, z| guess.path(s, z));
    let mut at = first.solve(extremal, loose, context);
    if let (FinalTime::Free { .. }, true) = (time, at.status.is_converged()) {
        // The path has nearly the right time already.
        let free = at.with_clock(extremal, Clock::Free).solve(extremal, loose, context);
        let found = free.status.is_converged() && free.final_time(extremal) > 0.0;
        at = if found { free } else { free_time(at, extremal, loose, context) };
    }
    if ease.penalty < 1.0 {
        context.phase = "penalties";
        at = follow(at, extremal, context, |extremal, s| {
            extremal.set_relaxation(Relaxation { penalty: wish.penalty.powf(1.0 - s), ..ease });
        });
        ease.penalty = 1.0;
    }
    to_the_problem_itself(at, extremal, (time, ease), context)
}

/// The equations of one arc at a fixed time, with the guess of what leads to a part of the end.
pub(crate) fn at_fixed_time<E: Extremal>(
    extremal: &mut E,
    time: FinalTime,
    (goal, guess): (f64, &mut dyn Guess),
    context: &Context<'_>,
) -> Extremum {
    let SolverOptions { nodes, points, .. } = context.options;
    let (mesh, clock) = (Mesh::uniform(&[nodes - 1]), Clock::Fixed(time.value()));
    Extremum::guess(extremal, (clock, Arcs::one()), mesh, points, |_, s, z| guess.simple(goal, s, z))
}

/// From a rough solution at a fixed time to an exact one in the time asked for.
fn finish<E: Extremal>(
    first: Extremum,
    extremal: &mut E,
    time: FinalTime,
    context: &mut Context<'_>,
) -> Extremum {
    if !first.status.is_converged() {
        return first;
    }
    match time {
        FinalTime::Fixed(_) => sharpen(first, extremal, context),
        FinalTime::Free { .. } => {
            let loose = LOOSE.max(context.options.tolerance);
            let found = free_time(first, extremal, loose, context);
            sharpen(found, extremal, context)
        }
    }
}

/// From a rough solution to an exact one: with arcs where a control reaches a bound, else, or where that fails, on finer
/// meshes.
pub(crate) fn sharpen<E: Extremal>(rough: Extremum, extremal: &mut E, context: &mut Context<'_>) -> Extremum {
    if !rough.status.is_converged() {
        return rough;
    }
    let tolerance = context.options.tolerance;
    match solve_arcs(&rough, extremal, tolerance, context) {
        Some(found) => found,
        None => rough.solve(extremal, tolerance, context),
    }
}
