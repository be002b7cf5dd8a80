//! The iteration on one mesh: the program of the motion, solved by [`costate_nlp`].

use super::figures::Figures;
use super::iterate::{End, Interior};
use super::on_mesh::OnMesh;
use super::squares::Stall;
use crate::constants::direct as constants;
use crate::direct::points::values::PointDynamics;
use crate::direct::program::staged::{Program, Work};
use crate::direct::program::structure::Structure;
use crate::result::stage_times::Stage;
use crate::solve::recorder::Interruption;
use costate::EvalError;
use costate_nlp::{BarrierSettings, ConvexSettings, FilterSettings, Settings, SolveError, Solver, Start, Status};

/// Largest part of the cost that the barrier may have at the start.
const MOST_FIRST_GAP: f64 = 0.1;

/// It has at least this part of the tolerance then.
const LEAST_FIRST_GAP: f64 = 0.1;

/// The conditions of optimality are met to this part of the tolerance of the cost, where gap and decrement do
/// not say before that nothing is left to gain.
const OF_TOLERANCE: f64 = 1e-3;

/// .. and no further than this.
const LEAST_TOLERANCE: f64 = 1e-12;

/// Iterates whose violations, in parts of ranges, sum up to more than this, or to more than so many times that
/// of the start, are refused: they lead to other motions, if to any.
const MOST_VIOLATION: f64 = 2.0;

/// A motion that costs less than this part of the one that a program began with is solved once more from
/// there, with that cost as the typical one.
const CHEAPER: f64 = 0.5;

impl<D: PointDynamics> Interior<D> {
    /// Iterates until gap and decrement are below `tolerance` times the cost; `watch` sees each iterate with
    /// the part of the step that led to it, and may stop it. It begins near the slacks and multipliers of the
    /// barrier, and leaves those of its last iterate there; equations have true multipliers.
    ///
    /// # Errors
    /// A motion that cannot be evaluated.
    pub fn iterate(
        &mut self,
        tolerance: f64,
        most: usize,
        mut watch: impl FnMut(&mut Self, f64) -> Option<Interruption>,
    ) -> Result<End, EvalError> {
        let last = self.figures.iterations + most;
        loop {
            let (size, left) = (self.figures.size, last.saturating_sub(self.figures.iterations));
            let mut on = self.on_this_mesh(tolerance, left);
            let found = self.iterate_on(&mut on, tolerance, &mut watch);
            self.on_mesh = Some(on);
            let end = found?;
            // A program is solved to parts of the cost that it began with, which may be far larger.
            let is_cheaper = self.figures.size < CHEAPER * size && !self.is_stationary(tolerance);
            if !(end == End::Solved && is_cheaper) {
                return Ok(end);
            }
        }
    }

    fn iterate_on(
        &mut self,
        on: &mut OnMesh,
        tolerance: f64,
        watch: &mut impl FnMut(&mut Self, f64) -> Option<Interruption>,
    ) -> Result<End, EvalError> {
        let figures = &mut self.figures;
        (figures.is_minimum, figures.is_exact, figures.shortfall) = (false, true, 0.0);
        self.damping = 0.0;
        let first_step = figures.iterations;
        // Without limits the gap is not a number.
        let gap = self.mu * self.barrier.total_weight() / figures.size;
        let gap = gap.max(LEAST_FIRST_GAP * tolerance).min(MOST_FIRST_GAP);
        let mut ended = match self.begin_on(on, gap) {
            Ok(ended) => ended,
            Err(SolveError::Problem(error)) => return Err(error),
            // Where a motion has no finite values or derivatives nothing leads on.
            Err(_) => return Ok(End::NoProgress),
        };
        let (mut at_rounding, mut stall) = (0, Stall::default());
        loop {
            let seen = on.solver.iteration();
            self.take_iterate(on, ended.is_some())?;
            self.figures.iterations = first_step + seen.number;
            self.figures.is_exact = seen.is_exact;
            if seen.number > 0
                && let Some(interruption) = watch(self, seen.length)
            {
                return Ok(End::Interrupted(interruption));
            }
            let is_near = self.look_ahead(on)?;
            at_rounding = if is_near && self.is_at_rounding(tolerance) { at_rounding + 1 } else { 0 };
            let is_solved = match ended {
                Some(Status::Solved | Status::SolvedToRounding) => true,
                Some(Status::Stalled) => self.is_at_rounding(tolerance),
                _ => is_near && (self.is_solved(tolerance) || at_rounding > constants::STEPS_AT_ROUNDING),
            };
            if is_solved && (ended.is_some() || self.is_no_shorter(tolerance, &mut stall)?) {
                // The program has its own in their place.
                on.set_multipliers(&mut self.barrier, seen.mu * on.structure.scales.cost);
                self.figures.is_minimum = is_near;
                return Ok(End::Solved);
            }
            match ended {
                Some(Status::IterationLimit) => return Ok(End::IterationLimit),
                Some(_) => return Ok(End::NoProgress),
                None => {}
            }
            let (mut program, solver) = self.program(on);
            ended = match solver.advance(&mut program) {
                Ok(ended) => ended,
                Err(error) => return self.end_by(on, error),
            };
            self.clock.lap(Stage::Equations);
        }
    }

    /// Takes note of what the next step promises; whether it is one of the program itself.
    fn look_ahead(&mut self, on: &mut OnMesh) -> Result<bool, EvalError> {
        let (mut program, solver) = self.program(on);
        let promise = match solver.promise(&mut program) {
            Ok(promise) => promise,
            Err(SolveError::Problem(error)) => return Err(error),
            Err(_) => None,
        };
        let decrement = promise.map_or(f64::INFINITY, |promise| promise.decrement);
        self.figures.decrement = decrement * on.structure.scales.cost;
        Ok(promise.is_some_and(|promise| promise.is_exact))
    }

    /// Whether squares of torques promise no more than the tolerance either, where there is dry friction, or
    /// steps do not lead on.
    fn is_no_shorter(&mut self, tolerance: f64, stall: &mut Stall) -> Result<bool, EvalError> {
        if !self.has_squares_alone() || self.crossed.friction().features.is_empty() {
            return Ok(true);
        }
        self.refresh()?;
        self.measure_shortfall(0.0);
        let Figures { shortfall, size, cost, iterations, .. } = self.figures;
        let least = tolerance * size;
        Ok(shortfall <= least || stall.is_over(iterations, cost, least))
    }

    /// The program on the mesh of the iterate, with settings for this tolerance.
    fn on_this_mesh(&mut self, tolerance: f64, most: usize) -> Box<OnMesh> {
        let of_both = self.model.tasks.rows_of_both_ends();
        let Self { spline, barrier, ends, figures, running, least_violation, on_mesh, .. } = self;
        let others = (of_both, figures.size);
        let renew = |on: &mut Box<OnMesh>| on.structure.renew(spline, barrier, ends, others);
        let kept = on_mesh.take().and_then(|mut on| renew(&mut on).then_some(on));
        let mut on = kept.unwrap_or_else(|| {
            let structure = Structure::new(spline, barrier, ends, others);
            let solver = Solver::new(&structure.layout, Settings::default());
            let (start, multipliers) = (Vec::new(), Default::default());
            Box::new(OnMesh { work: Work::new(spline), solver, structure, start, multipliers, bounds: 1.0 })
        });
        on.work.begin(spline, ends, &on.structure);
        on.take_multipliers(barrier);
        let bounds = on.structure.bounds().into_iter().flatten().filter(|bound| bound.is_finite()).count();
        on.bounds = bounds.max(1) as f64;
        // Gauss-Newton steps say how far to go where only torques do; limits would be far away then.
        let mut convex = ConvexSettings::default();
        if bounds > 0 || !running.costs_torques() {
            convex.most = 0;
        }
        let filter = FilterSettings::default();
        let [_, least_violations] = filter.violations;
        *on.solver.settings_mut() = Settings {
            tolerance: (OF_TOLERANCE * tolerance / on.bounds.sqrt()).max(LEAST_TOLERANCE),
            feasibility: *least_violation,
            iterations: most,
            barrier: BarrierSettings {
                least: constants::LEAST_GAP * tolerance / on.bounds,
                ..BarrierSettings::default()
            },
            convex,
            filter: FilterSettings { violations: [MOST_VIOLATION, least_violations], ..filter },
            ..Settings::default()
        };
        on
    }

    /// Begins a solution with a barrier that is this part of the cost.
    fn begin_on(&mut self, on: &mut OnMesh, gap: f64) -> Result<Option<Status>, SolveError<EvalError>> {
        on.start.clone_from(&on.work.origin);
        let (start, [equalities, ranges]) =
            (std::mem::take(&mut on.start), std::mem::take(&mut on.multipliers));
        let is_cold = equalities.iter().all(|y| *y == 0.0);
        let begin = Start {
            point: &start,
            equalities: (!is_cold).then_some(&equalities[..]),
            ranges: Some(&ranges),
            mu: Some(gap / on.bounds),
        };
        let (mut program, solver) = self.program(on);
        let begun = solver.begin(&mut program, begin);
        (on.start, on.multipliers) = (start, [equalities, ranges]);
        begun
    }

    /// The program of the motion, and its solver.
    fn program<'a>(&'a mut self, on: &'a mut OnMesh) -> (Program<'a, D>, &'a mut Solver) {
        let Self { spline, points, barrier, running, model, system, ends, clock, .. } = self;
        let OnMesh { structure, work, solver, .. } = on;
        (Program { spline, points, barrier, running, model, system, ends, clock, structure, work }, solver)
    }

    /// Takes the iterate of the solver, with slacks, multipliers and figures; if it is the last one, with
    /// derivatives too.
    fn take_iterate(&mut self, on: &mut OnMesh, is_last: bool) -> Result<(), EvalError> {
        let seen = on.solver.iteration();
        let is_placed = on.work.is_at(on.solver.point());
        if !is_placed {
            on.start.clear();
            on.start.extend_from_slice(on.solver.point());
            let point = std::mem::take(&mut on.start);
            self.program(on).0.place(&point);
            on.start = point;
            self.measure_distances();
        }
        let size = on.structure.scales.cost;
        // In restoration they are not those of this program.
        if !seen.is_restoration {
            let mu = seen.mu * size;
            self.mu = mu * on.bounds / self.barrier.total_weight().max(f64::MIN_POSITIVE);
            on.set_multipliers(&mut self.barrier, mu);
        }
        let cost = match seen.is_restoration || !is_placed {
            true => self.running.cost(&self.spline, &self.points),
            false => seen.cost * size,
        };
        self.measure_figures_of(cost);
        if is_last && !is_placed { self.refresh() } else { Ok(()) }
    }

    /// The end of an iteration with an error.
    fn end_by(&mut self, on: &mut OnMesh, error: SolveError<EvalError>) -> Result<End, EvalError> {
        match error {
            SolveError::Problem(error) => Err(error),
            // Where a motion has no finite values or derivatives, nothing leads on.
            _ => self.take_iterate(on, true).map(|()| End::NoProgress),
        }
    }
}
