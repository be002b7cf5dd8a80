//! What is done where limits are not kept: a motion that keeps them, or what they would have to give.

use crate::constants::direct as constants;
use crate::constants::elastic;
use crate::direct::interior::iterate::{End, Interior};
use crate::direct::motion::spline::Spline;
use crate::direct::motion::times::FreeTimes;
use crate::direct::outcome::infeasible::relaxed;
use crate::direct::points::values::PointDynamics;
use crate::options::SolverOptions;
use crate::problem::{FinalTime, Problem};
use crate::progress::{Iteration, Phase};
use crate::result::infeasibility::Infeasibility;
use crate::solve::Recorder;
use crate::solve::recorder::Interruption;
use costate::EvalError;

/// How an elastic phase ended.
#[derive(Debug)]
pub(super) enum Restored {
    /// With a motion that keeps all limits at its points, perhaps on a finer mesh.
    Kept,
    /// At a local minimum of what limits give.
    Infeasible(Infeasibility),
    /// Without an answer; the motion is that of before.
    Unknown,
    Interrupted(Interruption),
}

/// How the elastic phase ended on a mesh.
enum OnMesh {
    Kept,
    /// The largest violation, in parts of the range.
    Least(f64),
    Stuck,
    Interrupted(Interruption),
}

/// Looks for a motion that keeps all limits, beginning at the iterate, or at `guess` if that is closer to
/// them and the iterate is far away. The barrier is then that of this gap, in parts of the cost.
///
/// # Errors
/// A motion that cannot be evaluated.
pub(super) fn restore<D: PointDynamics>(
    problem: &Problem,
    interior: &mut Interior<D>,
    guess: &Spline,
    gap: f64,
    options: &SolverOptions,
    recorder: &mut Recorder<'_>,
) -> Result<Restored, EvalError> {
    if interior.barrier.all_sides().next().is_none() {
        return Ok(Restored::Unknown);
    }
    let before = interior.spline.clone();
    let from = |interior: &mut Interior<D>, spline: Spline| {
        interior.spline = spline;
        interior.start(None).map(|()| interior.figures.violation)
    };
    let begun = guess.clone();
    let guess = guess.on_nodes(before.mesh.nodes.clone());
    let (far, near) = (from(interior, before.clone())?, from(interior, guess)?);
    if far <= near || far < elastic::WILD {
        from(interior, before.clone())?;
    }
    let (mut last, mut coarser) = (f64::INFINITY, None);
    for _ in 0..elastic::MESHES {
        let kept = interior.relax(coarser.as_ref())?;
        let found = least(interior, coarser.is_none(), options, recorder)?;
        let part = match found {
            OnMesh::Kept => {
                interior.tighten(kept, gap)?;
                return Ok(Restored::Kept);
            }
            OnMesh::Least(part) => part,
            OnMesh::Stuck | OnMesh::Interrupted(_) => {
                interior.spline = before;
                interior.tighten(kept, gap)?;
                return Ok(match found {
                    OnMesh::Interrupted(interruption) => Restored::Interrupted(interruption),
                    _ => Restored::Unknown,
                });
            }
        };
        if part > elastic::SAME_RELIEF * last {
            let mut infeasible = relaxed(problem, interior);
            interior.tighten(kept, gap)?;
            if infeasible.limits.is_empty() {
                // Nothing but equations at the ends is off, which do not give.
                break;
            }
            if slows_down(problem, interior, &begun)? {
                return Ok(Restored::Kept);
            }
            infeasible.final_time = later(problem, interior, &infeasible, options, recorder)?;
            return Ok(Restored::Infeasible(infeasible));
        }
        // On a finer mesh less may be enough.
        last = part;
        coarser = Some((interior.relaxation.price(), interior.barrier.ranges()));
        let mesh = &interior.spline.mesh;
        let is_fine = mesh.intervals() > elastic::INTERVALS;
        let nodes = mesh.halved(constants::NARROWEST);
        let is_full = mesh.shape.points_of(nodes.len() - 1) > options.max_nodes;
        if !is_full {
            interior.spline = interior.spline.on_nodes(nodes);
        }
        interior.tighten(kept, gap)?;
        if is_fine || is_full {
            break;
        }
    }
    interior.spline = before;
    interior.start(None)?;
    Ok(Restored::Unknown)
}

/// Minimises what limits give on a mesh, at a price that is raised until it does not matter, if it `raises`.
fn least<D: PointDynamics>(
    interior: &mut Interior<D>,
    raises: bool,
    options: &SolverOptions,
    recorder: &mut Recorder<'_>,
) -> Result<OnMesh, EvalError> {
    let (mut last, mut cheaper) = (f64::INFINITY, None);
    for round in 1..=elastic::PRICES {
        let end = steps(interior, options, recorder, |iterate| iterate.violation_without_relief() <= 0.0)?;
        let part = interior.violation_without_relief();
        if part <= 0.0 {
            return Ok(OnMesh::Kept);
        }
        match end {
            End::Interrupted(interruption) => return Ok(OnMesh::Interrupted(interruption)),
            End::Solved => {}
            End::NoProgress | End::IterationLimit => {
                // The minimum at a lower price is one too.
                let Some(kept) = cheaper else { return Ok(OnMesh::Stuck) };
                interior.come_back(kept)?;
                break;
            }
        }
        if part > elastic::SAME_PRICE * last || !raises || round == elastic::PRICES {
            break;
        }
        (last, cheaper) = (part, Some(interior.keep()));
        interior.raise_price(elastic::DEARER);
    }
    Ok(OnMesh::Least(interior.violation_without_relief()))
}

/// Iterates until the problem is solved roughly or `enough` says so.
fn steps<D: PointDynamics>(
    interior: &mut Interior<D>,
    options: &SolverOptions,
    recorder: &mut Recorder<'_>,
    enough: impl Fn(&Interior<D>) -> bool,
) -> Result<End, EvalError> {
    let first = interior.figures.iterations;
    let watch = |iterate: &mut Interior<D>, step: f64| {
        let figures = &iterate.figures;
        recorder.record(Iteration {
            phase: Phase::Restoration,
            nodes: iterate.spline.mesh.points(),
            number: figures.iterations - first,
            residual: iterate.violation_without_relief().max(0.0),
            step,
            final_time: iterate.spline.duration(),
            cost: figures.cost,
        });
        // Any interruption ends the iteration; which one is asked for below.
        if enough(iterate) { Some(Interruption::Cancelled) } else { recorder.interruption() }
    };
    let most = elastic::STEPS.min(options.max_iterations);
    let end = interior.iterate(elastic::PRECISION, most, watch)?;
    Ok(match (end, recorder.interruption()) {
        (End::Interrupted(_), None) => End::Solved,
        (_, Some(interruption)) => End::Interrupted(interruption),
        (end, None) => end,
    })
}

/// Slows down the motion, or the first guess, until it keeps all limits, if its time is free: the search goes
/// on there. Whether that is so; the iterate is left as it was otherwise.
fn slows_down<D: PointDynamics>(
    problem: &Problem,
    interior: &mut Interior<D>,
    guess: &Spline,
) -> Result<bool, EvalError> {
    let is_free = matches!(problem.time, FinalTime::Free { .. });
    if !is_free || problem.vias.iter().any(|via| via.time.is_some()) {
        return Ok(false);
    }
    let before = interior.spline.clone();
    for spline in [before.clone(), guess.on_nodes(before.mesh.nodes.clone())] {
        for factor in elastic::SLOWER {
            interior.spline = spline.clone();
            interior.slow_down(factor);
            interior.start(None)?;
            if interior.figures.violation <= constants::VIOLATION_AT_POINTS {
                return Ok(true);
            }
        }
    }
    interior.spline = before;
    interior.start(None)?;
    Ok(false)
}

/// A final time with which a motion keeps all limits, if a longer one helps and is found soon: the motion is
/// slowed down until it keeps them, then its time is minimised with the limits.
fn later<D: PointDynamics>(
    problem: &Problem,
    interior: &mut Interior<D>,
    infeasible: &Infeasibility,
    options: &SolverOptions,
    recorder: &mut Recorder<'_>,
) -> Result<Option<f64>, EvalError> {
    let FinalTime::Fixed(time) = problem.time else { return Ok(None) };
    if !infeasible.depends_on_time() || problem.has_via_times() {
        return Ok(None);
    }
    let before = interior.spline.clone();
    let slowed = |interior: &mut Interior<D>, factor: f64| {
        interior.spline = before.clone();
        interior.slow_down(factor);
        interior.start(None).map(|()| interior.figures.violation <= constants::VIOLATION_AT_POINTS)
    };
    let mut found = None;
    for factor in elastic::SLOWER {
        if slowed(interior, factor)? {
            found = Some(factor * time);
            break;
        }
    }
    if found.is_some() {
        let running = interior.running.time;
        interior.running.time = running + elastic::HURRY * interior.figures.size / interior.spline.duration();
        let given = std::mem::replace(&mut interior.ends.times, FreeTimes::all(before.times.len()));
        interior.start(None)?;
        let end = steps(interior, options, recorder, |_| false)?;
        if end == End::Solved && interior.figures.violation <= constants::VIOLATION_ACCEPTED {
            found = found.map(|time: f64| time.min(interior.spline.duration()));
        }
        interior.ends.times = given;
        interior.running.time = running;
    }
    interior.spline = before;
    interior.start(None)?;
    Ok(found)
}

/// Whether an iteration still makes progress towards its limits.
#[derive(Debug)]
pub(super) struct Patience {
    best: f64,
    waited: usize,
}

impl Default for Patience {
    fn default() -> Self {
        Self { best: f64::INFINITY, waited: 0 }
    }
}

impl Patience {
    /// Whether limits were violated for so many steps that none reduced the violation noticeably.
    pub fn is_over(&mut self, violation: f64) -> bool {
        if violation <= constants::VIOLATION_ACCEPTED || violation < elastic::PROGRESS * self.best {
            *self = Self { best: violation, waited: 0 };
        }
        self.waited += 1;
        self.waited > elastic::PATIENCE
    }
}
