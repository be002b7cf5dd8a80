//! The loop over meshes: each is solved, judged, and mended or divided.

use super::last_solved::LastSolved;
use super::mending::{Beyond, Mended};
use super::prepare::Dynamics;
use super::refined::Refined;
use super::restore::{Patience, Restored, restore};
use crate::constants::direct as constants;
use crate::constants::elastic;
use crate::direct::interior::iterate::{End, Interior};
use crate::direct::motion::spline::Spline;
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

/// A refinement under way.
pub(super) struct Refinement<'a, 'r> {
    pub(super) problem: &'a Problem,
    pub(super) options: &'a SolverOptions,
    pub(super) interior: &'a mut Interior<Dynamics>,
    pub(super) resolution: &'a mut Resolution,
    pub(super) recorder: &'a mut Recorder<'r>,
    /// The motion that a mesh began with, and the gap of its barrier, in parts of the cost.
    pub(super) guess: Spline,
    pub(super) gap: f64,
    /// Gap and decrement to which this mesh is solved, and the last one, in parts of the cost.
    pub(super) precision: f64,
    pub(super) least: f64,
    pub(super) mended: Mended,
    /// The most accurate motion of the meshes before, if one was solved.
    pub(super) last_solved: Option<LastSolved>,
    /// Whether the iterate is that one.
    pub(super) stands_at_last: bool,
    /// Meshes that are done, and of these the last ones that did not resolve their motions.
    pub(super) mesh: usize,
    pub(super) left: usize,
    pub(super) restorations: usize,
    /// The outcome if nothing better is found.
    pub(super) refined: Refined,
}

/// Whether the loop goes on, on this mesh or another one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Next {
    Iterate,
    Done,
}

/// A mesh on which the iteration ended.
pub(super) struct Solved {
    pub(super) end: End,
    /// Whether the motion gains on this mesh what it loses on the next one.
    pub(super) unresolved: bool,
    /// The last motion that was looked at and is not so.
    pub(super) resolved: Spline,
}

/// A motion on its mesh.
#[derive(Clone, Copy)]
pub(super) struct Judged {
    /// Whether the problem on this mesh is solved.
    pub(super) is_solved: bool,
    /// Estimated error of the cost, relative to it.
    pub(super) error: f64,
    /// Whether limits are exceeded at the points.
    pub(super) violated: bool,
    /// Whether error and limits between the points are below their tolerances.
    pub(super) accurate: bool,
    /// Errors of the cost that are allowed.
    pub(super) allowed: f64,
    pub(super) beyond: Beyond,
}

impl Solved {
    /// Whether no step leads on.
    fn is_over(&self) -> bool {
        matches!(self.end, End::NoProgress | End::IterationLimit)
    }
}

impl<'a, 'r> Refinement<'a, 'r> {
    /// Of an iterate with slacks and multipliers.
    pub fn new(
        problem: &'a Problem,
        options: &'a SolverOptions,
        start: Start,
        interior: &'a mut Interior<Dynamics>,
        resolution: &'a mut Resolution,
        recorder: &'a mut Recorder<'r>,
    ) -> Self {
        // A coarse mesh is not solved much better than it resolves the motion.
        let least = interior.looseness.between(constants::PART_OF_TOLERANCE) * options.tolerance;
        // A mesh that resolves a good motion would be divided by the errors of a rough one.
        let precision = match start {
            Start::Resolved => least,
            Start::Guess | Start::Saved | Start::Solved => least.max(constants::FIRST_PRECISION),
        };
        interior.last_tolerance = Some(least);
        interior.clock.lap(Stage::Preparation);
        Self {
            guess: interior.spline.clone(),
            gap: constants::FIRST_GAP,
            precision,
            least,
            mended: Mended::default(),
            last_solved: None,
            stands_at_last: false,
            mesh: 0,
            left: 0,
            restorations: 0,
            refined: Refined::without(Status::MeshLimit),
            problem,
            options,
            interior,
            resolution,
            recorder,
        }
    }

    /// Solves one mesh after the other.
    ///
    /// # Errors
    /// A motion that cannot be evaluated.
    pub fn run(mut self) -> Result<Refined, EvalError> {
        while self.mesh < constants::MESHES && self.improve()? == Next::Iterate {}
        self.fall_back()?;
        Ok(self.refined)
    }

    /// From an iterate to the next one, or to the end of the loop.
    fn improve(&mut self) -> Result<Next, EvalError> {
        let mut solved = self.iterate()?;
        if solved.is_over() && self.comes_back()? {
            return Ok(Next::Iterate);
        }
        if let Some(next) = self.restore(&mut solved)? {
            return Ok(next);
        }
        self.resolution.measure(self.interior)?;
        self.interior.clock.lap(Stage::Meshes);
        let judged = self.judge(&solved);
        self.keep_solved(&judged);
        if self.limits_coefficients(&judged) {
            return Ok(Next::Iterate);
        }
        let moves = self.moves(&judged);
        if moves.is_none() && self.moves_to_finer(&judged)? {
            return Ok(Next::Iterate);
        }
        let moves = moves.filter(|inside| self.resolution.move_limits_inside(self.interior, *inside));
        let solves = judged.accurate && self.precision <= self.least && moves.is_none();
        if let Some(next) = self.conclude(&solved, &judged, solves)? {
            return Ok(next);
        }
        if moves.is_some() {
            self.goes_on_inside();
            return Ok(Next::Iterate);
        }
        if judged.accurate && self.precision > self.least {
            self.precision = self.least;
            return Ok(Next::Iterate);
        }
        self.divide(solved, &judged)
    }

    /// Iterates on this mesh, until it is solved, stuck, or does not resolve the motion.
    fn iterate(&mut self) -> Result<Solved, EvalError> {
        self.stands_at_last = false;
        let Self { interior, resolution, recorder, .. } = self;
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
        let mut end = interior.iterate(self.precision, self.options.max_iterations, watch)?;
        if end == End::Solved && self.precision <= self.least {
            interior.take_last_step();
        }
        if stuck || unresolved {
            end = recorder.interruption().map_or(End::NoProgress, End::Interrupted);
        }
        Ok(Solved { end, unresolved, resolved })
    }

    /// Looks for a motion that keeps its limits where the iteration is stuck beyond them.
    fn restore(&mut self, solved: &mut Solved) -> Result<Option<Next>, EvalError> {
        let is_beyond = self.interior.figures.violation > constants::VIOLATION_ACCEPTED;
        // Another mesh may resolve the motion, and keep the limits then.
        let has_meshes = solved.unresolved && self.left + 1 < constants::UNRESOLVED_MESHES;
        if !(solved.is_over() && is_beyond && self.restorations < elastic::RESTORATIONS) || has_meshes {
            return Ok(None);
        }
        self.restorations += 1;
        let Self { problem, options, interior, recorder, .. } = self;
        match restore(problem, interior, &self.guess, self.gap, options, recorder)? {
            Restored::Kept => return Ok(Some(Next::Iterate)),
            Restored::Infeasible(infeasible) => {
                self.resolution.measure(self.interior)?;
                let infeasible = Some(infeasible);
                self.refined = Refined { infeasible, ..Refined::without(Status::LocallyInfeasible) };
                return Ok(Some(Next::Done));
            }
            Restored::Interrupted(interruption) => solved.end = End::Interrupted(interruption),
            Restored::Unknown => {}
        }
        Ok(None)
    }

    fn judge(&self, solved: &Solved) -> Judged {
        let (figures, resolution) = (&self.interior.figures, &self.resolution);
        let error = (resolution.error() + figures.gap + figures.shortfall) / figures.size;
        let tolerance = self.options.tolerance;
        let mut beyond = Beyond::new(resolution, figures.size, error);
        if self.options.verify == Verify::None {
            // A motion that is not verified is one to begin with.
            beyond.overshoots = [0.0; 2];
        }
        Judged {
            is_solved: solved.end == End::Solved && !solved.unresolved,
            error,
            violated: figures.violation > constants::VIOLATION_ACCEPTED,
            accurate: error <= tolerance && beyond.violation <= constants::VIOLATION_BETWEEN,
            allowed: tolerance * figures.size,
            beyond,
        }
    }
}

/// A step for the log; `first` steps were made on other meshes.
pub(super) fn iteration(iterate: &Interior<Dynamics>, first: usize, step: f64) -> Iteration {
    let figures = &iterate.figures;
    Iteration {
        phase: Phase::Direct,
        nodes: iterate.spline.mesh.shape.points_of(iterate.spline.mesh.intervals()),
        number: figures.iterations - first,
        residual: (figures.gap.max(figures.decrement.abs()) / figures.size).max(figures.violation),
        step,
        final_time: iterate.spline.duration(),
        cost: figures.cost,
    }
}
