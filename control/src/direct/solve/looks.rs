//! Which guess a motion goes on from: several are looked at, each on one coarse mesh.
//!
//! The guesses are, in their order, the motion without obstacles where there are any, that of the start, and
//! others ([`candidates`]). Each is iterated roughly, and only until it is clear that it is dearer than the
//! best one so far; the problem goes on with the iterate of the best one.

use super::around::without_obstacles;
use super::candidates::candidates;
use super::dry_friction::move_within;
use super::first::First;
use super::prepare::{Dynamics, interior_of, interior_on, seed};
use super::refinement::{Start, iteration};
use super::waiting::rest_between;
use crate::constants::direct as constants;
use crate::constants::guesses;
use crate::direct::interior::figures::Figures;
use crate::direct::interior::iterate::{End, Interior};
use crate::direct::interior::looseness::Looseness;
use crate::direct::motion::spline::Spline;
use crate::options::SolverOptions;
use crate::problem::Problem;
use crate::result::stage_times::Clock;
use crate::result::start::GuessKind;
use crate::solve::Recorder;
use crate::solve::recorder::Interruption;
use crate::task::build::TaskRows;
use costate::EvalError;

/// A problem whose guesses are looked at.
pub(super) struct Looks<'a> {
    pub problem: &'a Problem,
    pub rows: &'a TaskRows,
    pub options: &'a SolverOptions,
    pub looseness: Looseness,
}

/// A guess, or what a look has made of it.
pub(super) struct Looked {
    pub kind: GuessKind,
    pub interior: Interior<Dynamics>,
    /// Where its refinement begins.
    pub start: Start,
    /// Its cost, if it is solved so far that the problem can go on there.
    cost: Option<f64>,
}

/// The guesses that were looked at.
pub(super) struct Found {
    pub best: Looked,
    /// The second best one.
    pub next: Option<Looked>,
    /// How many they were.
    pub looks: usize,
    /// Steps that were made with others than the best one.
    pub steps: usize,
}

impl Looked {
    /// A guess that nothing is known of.
    pub fn new(kind: GuessKind, interior: Interior<Dynamics>, start: Start) -> Self {
        Self { kind, interior, start, cost: None }
    }
}

impl Found {
    /// One guess that nothing is known of.
    pub fn alone(kind: GuessKind, interior: Interior<Dynamics>, start: Start) -> Self {
        Self { best: Looked::new(kind, interior, start), next: None, looks: 1, steps: 0 }
    }
}

impl Looks<'_> {
    /// The best one of the guesses for a start that begins at `first`.
    ///
    /// # Errors
    /// A motion that cannot be evaluated.
    pub fn best(
        &self,
        first: &First<'_>,
        clock: Clock,
        recorder: &mut Recorder<'_>,
    ) -> Result<Found, EvalError> {
        let Self { problem, rows, options, looseness } = *self;
        let mut own = interior_of(problem, rows, options, first);
        if first.kind == GuessKind::Straight {
            // States that cannot be evaluated are told when the iteration begins.
            let _ = rest_between(problem, options, &mut own);
            seed(options, &mut own);
            let _ = move_within(problem, options, &mut own);
        }
        own.looseness = looseness;
        let looks_on =
            options.starts.is_none() && problem.too_short().is_none() && recorder.interruption().is_none();
        let others = match looks_on {
            true => candidates(problem, rows, options, first, &mut own, || recorder.interruption().is_some()),
            false => Vec::new(),
        };
        let mut nodes = own.spline.mesh.nodes.clone();
        let (free, steps) = match problem.task.collision {
            Some(_) => without_obstacles(problem, options, looseness, recorder)?,
            None => (None, 0),
        };
        if free.is_none() && others.is_empty() {
            own.clock = clock;
            return Ok(Found { steps, ..Found::alone(first.kind, own, Start::Guess) });
        }
        let of_start = Race { options, own: first.kind, looks: 0, steps, clock };
        let mut ranking = match free {
            None => of_start.begin(first.kind, own, recorder)?,
            Some(spline) => {
                let mut other = interior_of(problem, rows, options, first);
                other.spline.copy_from(&spline);
                other.looseness = looseness;
                if nodes.len() < spline.mesh.nodes.len() {
                    // Costs on a mesh that was too coarse for the motion without obstacles compare with
                    // nothing.
                    nodes.clone_from(&spline.mesh.nodes);
                    own.spline = own.spline.on_nodes(nodes.clone());
                }
                let mut ranking = of_start.begin(GuessKind::WithoutObstacles, other, recorder)?;
                ranking.take(first.kind, own, recorder)?;
                ranking
            }
        };
        for candidate in others {
            if recorder.interruption().is_some() {
                break;
            }
            // What can be better by no more than looks resolve is none.
            let most = |best: f64| best - constants::FIRST_PRECISION * best.abs();
            if ranking.best.looked.cost.is_some_and(|best| candidate.least >= most(best)) {
                continue;
            }
            let mut other = interior_on(problem, rows, options, &candidate.first, &nodes);
            other.looseness = looseness;
            if candidate.first.kind == GuessKind::OtherPosition {
                let _ = rest_between(problem, options, &mut other);
            }
            ranking.take(candidate.first.kind, other, recorder)?;
        }
        Ok(ranking.end())
    }
}

/// What looks at guesses have in common.
struct Race<'a> {
    options: &'a SolverOptions,
    /// The kind of the guess that is preferred to others which are about as good.
    own: GuessKind,
    looks: usize,
    steps: usize,
    clock: Clock,
}

/// A guess that was looked at, with what it began as.
struct Entry {
    looked: Looked,
    guess: Spline,
}

/// The two best guesses so far.
struct Ranking<'a> {
    race: Race<'a>,
    best: Entry,
    next: Option<Entry>,
}

impl<'a> Race<'a> {
    /// Looks at a first guess.
    fn begin(
        mut self,
        kind: GuessKind,
        interior: Interior<Dynamics>,
        recorder: &mut Recorder<'_>,
    ) -> Result<Ranking<'a>, EvalError> {
        let best = self.look(kind, interior, None, recorder)?;
        Ok(Ranking { race: self, best, next: None })
    }

    fn look(
        &mut self,
        kind: GuessKind,
        mut interior: Interior<Dynamics>,
        rival: Option<f64>,
        recorder: &mut Recorder<'_>,
    ) -> Result<Entry, EvalError> {
        let guess = interior.spline.clone();
        interior.clock = std::mem::take(&mut self.clock);
        let cost = first_motion(&mut interior, self.options, rival, recorder)?;
        self.clock = std::mem::take(&mut interior.clock);
        self.looks += 1;
        self.steps += interior.figures.iterations;
        Ok(Entry { looked: Looked { kind, interior, start: Start::Solved, cost }, guess })
    }

    /// Whether a guess comes before one that was looked at earlier.
    fn is_better(&self, one: &Looked, other: &Looked) -> bool {
        let clearly = |less: f64, more: f64| less < more - constants::FIRST_PRECISION * more.abs();
        match (one.cost, other.cost) {
            (Some(one_cost), Some(cost)) if one.kind == self.own => !clearly(cost, one_cost),
            (Some(one_cost), Some(cost)) => clearly(one_cost, cost),
            (None, None) if self.options.starts.is_some() => one.kind == self.own,
            (None, None) => one.interior.figures.violation < other.interior.figures.violation,
            (cost, _) => cost.is_some(),
        }
    }
}

impl Ranking<'_> {
    /// Looks at another guess, and puts it in its place.
    fn take(
        &mut self,
        kind: GuessKind,
        interior: Interior<Dynamics>,
        recorder: &mut Recorder<'_>,
    ) -> Result<(), EvalError> {
        let mut entry = self.race.look(kind, interior, self.best.looked.cost, recorder)?;
        let is_better = |one: &Entry, other: &Entry| self.race.is_better(&one.looked, &other.looked);
        if is_better(&entry, &self.best) {
            std::mem::swap(&mut entry, &mut self.best);
        }
        if self.next.as_ref().is_none_or(|next| is_better(&entry, next)) {
            self.next = Some(entry);
        }
        Ok(())
    }

    /// The best ones. What could not be solved goes back to its guess.
    fn end(self) -> Found {
        let begun = |Entry { mut looked, guess }: Entry| {
            if looked.cost.is_none() {
                (looked.interior.spline, looked.start) = (guess, Start::Guess);
            }
            looked
        };
        let Self { race: Race { options, looks, steps, clock, .. }, best, next } = self;
        let mut best = begun(best);
        best.interior.clock = clock;
        let mut next = next.filter(|_| options.starts.is_none()).map(begun);
        if let Some(next) = &mut next {
            next.interior.clock = Clock::new(best.interior.clock.times().is_some());
        }
        let steps = steps - best.interior.figures.iterations;
        Found { best, next, looks, steps }
    }
}

/// The cost of the motion on the mesh of a guess, solved roughly; `None` if that fails or limits are not
/// kept. It need not be solved further than to tell on which side of the cost of a `rival` it ends, by what
/// is still to be gained: the gap, and what the next step promises. With much damping a step promises little
/// however much there is to gain: no guess counts as dearer then, unless it took [`guesses::PATIENT`] steps.
fn first_motion(
    interior: &mut Interior<Dynamics>,
    options: &SolverOptions,
    rival: Option<f64>,
    recorder: &mut Recorder<'_>,
) -> Result<Option<f64>, EvalError> {
    let is_short = options.starts.is_none();
    let most = if is_short { options.max_iterations.min(guesses::STEPS) } else { options.max_iterations };
    let mut watch = |iterate: &mut Interior<Dynamics>, step: f64| {
        recorder.record(iteration(iterate, 0, step));
        recorder.interruption()
    };
    if interior.needs_smoothing() {
        let effort = interior.smooth_effort();
        interior.begin_smoothed(effort, most, &mut watch)?;
    } else {
        interior.start(None)?;
    }
    let mut is_decided = false;
    let end = interior.iterate(constants::FIRST_PRECISION, most, |iterate, step| {
        let Figures { cost, gap, decrement, violation, iterations, .. } = iterate.figures;
        let open = constants::DECIDED * (gap + decrement.abs());
        let tells = iterate.damping <= constants::SOLVED_DAMPING || iterations >= guesses::PATIENT;
        let decides = |rival: f64| rival - cost > open || (tells && cost - rival > open);
        is_decided = violation < constants::DECIDED_VIOLATION && rival.is_some_and(decides);
        watch(iterate, step).or(is_decided.then_some(Interruption::TimeLimit))
    })?;
    let Figures { cost, violation, .. } = interior.figures;
    let is_kept = is_short && end == End::IterationLimit && violation < constants::DECIDED_VIOLATION;
    Ok((end == End::Solved || is_decided || is_kept).then_some(cost))
}
