//! The primal-dual interior-point method with a filter line search.
//!
//! Waechter and Biegler 2006, with the pivots of the stages in place of a general factorisation.

use crate::active::Active;
use crate::barrier::{barrier_residuals, longest_steps, reset_multipliers};
use crate::blocks::{Blocks, Weights};
use crate::centrality::Targets;
use crate::elements::Room;
use crate::filter::Filter;
use crate::iterate::{Bounds, Iterate, KktError, Residuals, Step};
use crate::layout::{Element, Layout};
use crate::newton::{Accuracy, Newton};
use crate::outcome::{Iteration, Promise, Solution, SolveError, Status};
use crate::problem::StagedProblem;
use crate::restoration::{ElasticRoom, Places};
use crate::scaled::{Scaled, Scaling};
use crate::settings::Settings;
use crate::vectors::largest;
use std::ops::ControlFlow;
use std::time::Instant;

/// Largest multipliers of equations that the first estimate may have: lambda_max of IPOPT.
pub(crate) const LARGEST_ESTIMATE: f64 = 1e3;

/// Error up to which restoration solves its program: whether a minimum of the violation was found needs no
/// more digits.
const LEAST_VIOLATION: f64 = 1e-6;

/// Where a solution begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start<'a> {
    /// The point.
    pub point: &'a [f64],
    /// Multipliers of the equations, as in [`Solution::equalities`]; `None`: by least squares.
    pub equalities: Option<&'a [f64]>,
    /// Multipliers of the functions with ranges, as in [`Solution::ranges`]; `None`: those of the central
    /// path.
    pub ranges: Option<&'a [f64]>,
    /// The barrier parameter, of the scaled program; `None`:
    /// [`BarrierSettings::start`](crate::BarrierSettings).
    pub mu: Option<f64>,
}

impl<'a> Start<'a> {
    /// A point of which nothing else is known.
    pub fn at(point: &'a [f64]) -> Self {
        Self { point, equalities: None, ranges: None, mu: None }
    }
}

/// Workspace for programs of one layout. [`solve`](Self::solve) runs until the end;
/// [`begin`](Self::begin) and [`advance`](Self::advance) do the same one iteration at a time. Room for
/// restoration is allocated the first time that no acceptable step is found, that of
/// [`certify`](Self::certify) and [`refine`](Self::refine) at their first call, and
/// [`respond`](Self::respond) allocates its result; nothing else allocates after the workspace is built.
///
/// ```
/// use costate_nlp::{Blocks, Element, Layout, Rows, Settings, Solver, StagedProblem, Values, Weights};
///
/// /// A double integrator from (0, 0) to (1, 0) in N equal steps of Euler's method, least effort.
/// struct Transfer { layout: Layout }
///
/// impl StagedProblem for Transfer {
///     type Error = std::convert::Infallible;
///     fn layout(&self) -> &Layout { &self.layout }
///     fn bounds(&self) -> [&[f64]; 2] { [&[], &[]] }
///     fn evaluate(&mut self, z: &[f64], to: &mut Values) -> Result<(), Self::Error> {
///         let n = self.layout.intervals();
///         let h = 1.0 / n as f64;
///         to.cost = 0.0;
///         (to.equalities[0], to.equalities[1]) = (z[0], z[1]);
///         for k in 0..n {
///             let [q, v, u, q_next, v_next] = [0, 1, 2, 3, 4].map(|i| z[3 * k + i]);
///             to.cost += 0.5 * h * u * u;
///             to.equalities[2 + 2 * k] = q_next - q - h * v;
///             to.equalities[3 + 2 * k] = v_next - v - h * u;
///         }
///         (to.equalities[2 + 2 * n], to.equalities[3 + 2 * n]) = (z[3 * n] - 1.0, z[3 * n + 1]);
///         Ok(())
///     }
///     fn linearise(&mut self, z: &[f64], w: Weights<'_>, blocks: &mut Blocks) -> Result<(), Self::Error> {
///         let n = self.layout.intervals();
///         let h = 1.0 / n as f64;
///         for k in 0..n {
///             let block = blocks.of(Element::Interval(k));
///             block.gradient[2] = h * z[3 * k + 2];
///             block.hessian[(2, 2)] = w.cost * h;
///             block.equalities.row_mut(0).copy_from_slice(&[-1.0, -h, 0.0, 1.0, 0.0]);
///             block.equalities.row_mut(1).copy_from_slice(&[0.0, -1.0, -h, 0.0, 1.0]);
///         }
///         for k in [0, n] {
///             let block = blocks.of(Element::Node(k));
///             (block.equalities[(0, 0)], block.equalities[(1, 1)]) = (1.0, 1.0);
///         }
///         Ok(())
///     }
/// }
///
/// let mut layout = Layout::uniform(50, 2, 1, 0);
/// for k in 0..50 {
///     layout = layout.with_rows(Element::Interval(k), Rows::new(2, 0));
/// }
/// let layout = layout.with_rows(Element::Node(0), Rows::new(2, 0));
/// let layout = layout.with_rows(Element::Node(50), Rows::new(2, 0));
/// let mut problem = Transfer { layout };
/// let mut solver = Solver::new(&problem.layout, Settings::default());
/// let solution = solver.solve(&mut problem, &[0.0; 152])?;
/// // 6 in the limit of short steps.
/// assert!((solution.cost - 6.0).abs() < 0.01 && solution.iterations == 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Solver {
    pub(crate) layout: Layout,
    pub(crate) settings: Settings,
    pub(crate) bounds: Bounds,
    pub(crate) iterate: Iterate,
    pub(crate) trial: Iterate,
    pub(crate) blocks: Blocks,
    pub(crate) residuals: Residuals,
    /// Right-hand sides of steps.
    pub(crate) corrected: Residuals,
    pub(crate) newton: Newton,
    pub(crate) room: Room,
    pub(crate) step: Step,
    pub(crate) correction: Step,
    /// Complementarity products that the step and its second-order corrections are for.
    pub(crate) targets: Targets,
    /// Those of the step before a corrector.
    pub(crate) targets_before: Targets,
    /// Whether the step is a corrected one.
    is_corrected: bool,
    /// The step from the iterate, if it is known already: whether there is one, its mu and its decrement.
    pub(crate) next: Option<(bool, [f64; 2])>,
    pub(crate) filter: Filter,
    pub(crate) progress: Progress,
    scaling: Scaling,
    dependent: Vec<usize>,
    /// Multipliers of the program itself: the iterate has those of the scaled one.
    multipliers: [Vec<f64>; 2],
    /// The factorisation at a solution, once one was asked for.
    pub(crate) active: Option<Box<Active>>,
    /// The elastic program and its solver, once they were needed.
    pub(crate) restoration: Option<Box<Restoration>>,
    /// Whether this is that solver.
    pub(crate) is_restoring: bool,
}

/// How far a solution has come.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Progress {
    /// How it ended, once it has.
    pub ended: Option<Status>,
    /// When it began, if there is a limit of time.
    pub begun: Option<Instant>,
    /// Iterations, those of restoration too.
    pub number: usize,
    pub mu: f64,
    /// mu_max.
    pub largest_mu: f64,
    /// Of the iterate.
    pub error: KktError,
    /// Of the step that led there.
    pub length: f64,
    pub regularisation: f64,
    pub is_exact: bool,
    pub decrement: f64,
}

/// The elastic program about a point, and its solver.
#[derive(Clone, Debug)]
pub(crate) struct Restoration {
    /// Whether the solution is in it.
    pub is_on: bool,
    pub solver: Solver,
    pub places: Places,
    pub room: ElasticRoom,
    pub centre: Vec<f64>,
    /// Where its solver begins.
    pub start: Vec<f64>,
    /// The violation at the centre, and the one that is wanted.
    pub before: f64,
    pub most: f64,
    /// Slacks of the program, and their gaps.
    pub slacks: Vec<f64>,
    pub gaps: [Vec<f64>; 2],
}

impl Restoration {
    pub fn new(solver: &Solver) -> Self {
        let places = Places::new(&solver.layout);
        let len = solver.iterate.point.len();
        let settings = Self::settings(solver.settings);
        let mut inner = Solver::for_points(&places.layout, places.layout.steps() + len, settings);
        inner.is_restoring = true;
        Self {
            is_on: false,
            solver: inner,
            room: ElasticRoom::new(&solver.layout, &places),
            start: vec![0.0; places.layout.steps() + len],
            places,
            centre: vec![0.0; len],
            before: 0.0,
            most: 0.0,
            slacks: vec![0.0; solver.layout.ranges()],
            gaps: [vec![0.0; solver.layout.ranges()], vec![0.0; solver.layout.ranges()]],
        }
    }

    /// Those of its solver.
    pub fn settings(mut settings: Settings) -> Settings {
        // Elastic variables start where their conditions hold, close to zero if need be.
        settings.barrier.inside = [4.0 * f64::EPSILON; 2];
        settings.barrier.least = 0.0;
        // It begins at mu of the program, or at the violation.
        settings.barrier.largest = 1.0;
        // Elastic variables at their bounds are no reason to stay away from them.
        settings.centrality.correctors = 0;
        settings.tolerance = settings.tolerance.max(LEAST_VIOLATION);
        settings.feasibility = settings.tolerance;
        // Its iterations and its time are counted by the solution.
        settings.iterations = usize::MAX;
        settings.time_limit = None;
        settings
    }
}

impl Progress {
    /// Of a solution that has not begun.
    fn none() -> Self {
        let error = KktError { stationarity: f64::INFINITY, ..KktError::default() };
        let (mu, largest_mu, length, regularisation) = (0.0, 0.0, 0.0, 0.0);
        Self {
            ended: Some(Status::Stopped),
            begun: None,
            number: 0,
            mu,
            largest_mu,
            error,
            length,
            regularisation,
            is_exact: true,
            decrement: f64::INFINITY,
        }
    }
}

impl Solver {
    /// Builds the workspace for programs of this layout, whose points have as many entries as their steps.
    pub fn new(layout: &Layout, settings: Settings) -> Self {
        Self::for_points(layout, layout.steps(), settings)
    }

    /// The same for points of another length.
    pub fn for_points(layout: &Layout, point_len: usize, settings: Settings) -> Self {
        let iterate = Iterate::new(layout, point_len);
        let ranges = layout.ranges();
        Self {
            settings,
            bounds: Bounds::new(ranges),
            trial: iterate.clone(),
            iterate,
            blocks: Blocks::new(layout),
            residuals: Residuals::zeros(layout),
            corrected: Residuals::zeros(layout),
            newton: Newton::new(layout, settings.regularisation),
            room: Room::new(layout),
            step: Step::zeros(layout),
            correction: Step::zeros(layout),
            targets: [vec![0.0; ranges], vec![0.0; ranges]],
            targets_before: [vec![0.0; ranges], vec![0.0; ranges]],
            is_corrected: false,
            next: None,
            filter: Filter::new(settings.filter),
            progress: Progress::none(),
            scaling: Scaling::new(layout),
            dependent: Vec::with_capacity(layout.equalities()),
            multipliers: [vec![0.0; layout.equalities()], vec![0.0; ranges]],
            active: None,
            restoration: None,
            is_restoring: false,
            layout: layout.clone(),
        }
    }

    /// What steers the next solution.
    pub fn settings_mut(&mut self) -> &mut Settings {
        &mut self.settings
    }

    /// Solves a program from a point.
    ///
    /// # Errors
    /// [`SolveError`].
    pub fn solve<P: StagedProblem>(
        &mut self,
        problem: &mut P,
        start: &[f64],
    ) -> Result<Solution<'_>, SolveError<P::Error>> {
        self.solve_observed(problem, Start::at(start), |_| ControlFlow::Continue(()))
    }

    /// The same from any start; `observer` is called after each iteration, and may stop the solution.
    ///
    /// # Errors
    /// [`SolveError`].
    pub fn solve_observed<P: StagedProblem>(
        &mut self,
        problem: &mut P,
        start: Start<'_>,
        mut observer: impl FnMut(Iteration) -> ControlFlow<()>,
    ) -> Result<Solution<'_>, SolveError<P::Error>> {
        let mut ended = self.begin(problem, start)?;
        loop {
            let is_stopped = observer(self.iteration()).is_break();
            if ended.is_some() || is_stopped {
                return self.stop(problem);
            }
            ended = self.advance(problem)?;
        }
    }

    /// Begins a solution: slacks inside their bounds, multipliers as given. Returns how it ended, if that is
    /// at the start.
    ///
    /// # Errors
    /// [`SolveError`].
    pub fn begin<P: StagedProblem>(
        &mut self,
        problem: &mut P,
        start: Start<'_>,
    ) -> Result<Option<Status>, SolveError<P::Error>> {
        self.check(problem)?;
        let length = SolveError::check_length;
        length("the start", self.iterate.point.len(), start.point.len())?;
        for (what, given, expected) in [
            ("the list of multipliers of equations", start.equalities, self.layout.equalities()),
            ("the list of multipliers of ranges", start.ranges, self.layout.ranges()),
        ] {
            let Some(given) = given else { continue };
            length(what, expected, given.len())?;
            if !given.iter().all(|multiplier| multiplier.is_finite()) {
                return Err(SolveError::NotFinite { what });
            }
        }
        if let Some(value) = start.mu.filter(|mu| !(*mu > 0.0 && mu.is_finite())) {
            let (name, least, most) = ("start.mu", f64::MIN_POSITIVE, f64::MAX);
            return Err(SolveError::Setting { name, value, least, most });
        }
        self.begin_unchecked(problem, start)
    }

    pub(crate) fn begin_unchecked<P: StagedProblem>(
        &mut self,
        problem: &mut P,
        start: Start<'_>,
    ) -> Result<Option<Status>, SolveError<P::Error>> {
        // They belong to another solution.
        self.forget_active();
        self.next = None;
        self.progress = Progress::none();
        self.progress.begun = self.settings.time_limit.map(|_| Instant::now());
        self.dependent.clear();
        self.newton.restart(self.settings.regularisation, self.settings.convex);
        self.take_sizes(problem);
        self.with_scaled(problem, |solver, scaled| solver.begin_scaled(scaled, start))?;
        self.progress.ended = self.judge();
        Ok(self.progress.ended)
    }

    /// Takes the typical sizes of a program, and its bounds in units of them.
    pub(crate) fn take_sizes<P: StagedProblem>(&mut self, problem: &P) {
        self.scaling.take(problem.scales());
        self.bounds.take(problem.bounds(), self.scaling.scales());
    }

    /// One iteration, of restoration if no acceptable step is found. Returns how the solution ended, or
    /// `None` if it goes on; nothing is done after its end. The program is the one that it began with.
    ///
    /// # Errors
    /// [`SolveError`]; the solution has ended then.
    pub fn advance<P: StagedProblem>(
        &mut self,
        problem: &mut P,
    ) -> Result<Option<Status>, SolveError<P::Error>> {
        self.check_layout(problem)?;
        if self.progress.ended.is_none() {
            self.forget_active();
            self.progress.number += 1;
            // Of an error.
            self.progress.ended = Some(Status::Stopped);
            let ended = self.with_scaled(problem, Self::advance_scaled)?.or_else(|| self.judge());
            if ended.is_some() {
                self.leave_restoration(problem)?;
            }
            self.progress.ended = ended;
        }
        Ok(self.progress.ended)
    }

    /// What the next step from the iterate promises; [`advance`](Self::advance) takes it then. `None` in
    /// restoration, and where there is no step.
    ///
    /// # Errors
    /// [`SolveError`].
    pub fn promise<P: StagedProblem>(
        &mut self,
        problem: &mut P,
    ) -> Result<Option<Promise>, SolveError<P::Error>> {
        self.check_layout(problem)?;
        if self.is_in_restoration() {
            return Ok(None);
        }
        if self.next.is_none() {
            self.forget_active();
            let before = self.progress;
            let found = self.with_scaled(problem, Self::newton_step)?;
            self.next = Some((found, [self.progress.mu, self.progress.decrement]));
            self.progress = before;
        }
        let next = self.next.filter(|(found, _)| *found);
        Ok(next.map(|(_, [_, decrement])| Promise { decrement, is_exact: self.newton.is_exact() }))
    }

    /// Ends a solution that has not ended: in restoration at its last point.
    ///
    /// # Errors
    /// [`SolveError`].
    pub fn stop<P: StagedProblem>(&mut self, problem: &mut P) -> Result<Solution<'_>, SolveError<P::Error>> {
        self.leave_restoration(problem)?;
        self.progress.ended.get_or_insert(Status::Stopped);
        Ok(self.solution())
    }

    /// The iterate of a solution under way.
    pub fn iteration(&self) -> Iteration {
        let Progress { number, mu, error, length, regularisation, is_exact, decrement, .. } = self.progress;
        if let Some(restoration) = self.restoration.as_ref().filter(|restoration| restoration.is_on) {
            return Iteration { number, is_restoration: true, ..restoration.solver.iteration() };
        }
        Iteration {
            number,
            cost: self.iterate.values.cost,
            violation: self.iterate.violation(),
            error,
            mu,
            regularisation,
            is_exact,
            length,
            gap: self.iterate.gap(),
            decrement,
            is_restoration: false,
        }
    }

    /// The iterate, with multipliers of the program itself.
    pub fn solution(&mut self) -> Solution<'_> {
        let Self { iterate, newton, dependent, layout, scaling, progress, .. } = self;
        dependent.clear();
        if progress.number > 0 {
            dependent.extend(newton.dependent(layout));
        }
        let [y, v] = &mut self.multipliers;
        y.copy_from_slice(&iterate.y);
        v.copy_from_slice(&iterate.v);
        scaling.unscale(y, v);
        Solution {
            status: progress.ended.unwrap_or(Status::Stopped),
            point: &iterate.point,
            cost: scaling.unscaled_cost(iterate.values.cost),
            equalities: y,
            ranges: v,
            dependent,
            error: progress.error,
            iterations: progress.number,
        }
    }

    /// Whether the iterate is a solution, or there were enough of them.
    fn judge(&self) -> Option<Status> {
        let Settings { tolerance, feasibility, iterations, time_limit, .. } = self.settings;
        let Progress { error, number, begun, .. } = self.progress;
        let is_restoring = self.is_in_restoration();
        match () {
            () if !is_restoring && error.largest() <= tolerance && error.feasibility <= feasibility => {
                Some(Status::Solved)
            }
            () if number >= iterations => Some(Status::IterationLimit),
            () if begun.zip(time_limit).is_some_and(|(begun, most)| begun.elapsed() >= most) => {
                Some(Status::TimeLimit)
            }
            () => None,
        }
    }

    /// Lends the room for scales.
    pub(crate) fn with_scaled<P: StagedProblem, T>(
        &mut self,
        problem: &mut P,
        f: impl FnOnce(&mut Self, &mut Scaled<'_, P>) -> T,
    ) -> T {
        let mut scaled = Scaled::with(problem, std::mem::take(&mut self.scaling));
        let found = f(self, &mut scaled);
        self.scaling = scaled.into_scaling();
        found
    }

    fn check_layout<P: StagedProblem>(&self, problem: &P) -> Result<(), SolveError<P::Error>> {
        if *problem.layout() == self.layout { Ok(()) } else { Err(SolveError::Layout) }
    }

    /// Whether the program is one of this layout, with ranges and scales that hold numbers.
    pub(crate) fn check<P: StagedProblem>(&self, problem: &P) -> Result<(), SolveError<P::Error>> {
        if let Some((name, value, [least, most])) = self.settings.first_wrong() {
            return Err(SolveError::Setting { name, value, least, most });
        }
        self.check_layout(problem)?;
        let length = SolveError::check_length;
        length("the program's point", self.iterate.point.len(), problem.point_len())?;
        let [lower, upper] = problem.bounds();
        length("the lower bounds", self.layout.ranges(), lower.len())?;
        length("the upper bounds", self.layout.ranges(), upper.len())?;
        for (row, (&lower, &upper)) in lower.iter().zip(upper).enumerate() {
            let holds_numbers = lower <= upper && lower < f64::INFINITY && upper > f64::NEG_INFINITY;
            if !holds_numbers {
                return Err(SolveError::EmptyRange { row, lower, upper });
            }
        }
        if let Some(scales) = problem.scales() {
            length("the scales of steps", self.layout.steps(), scales.steps.len())?;
            length("the scales of equations", self.layout.equalities(), scales.equalities.len())?;
            length("the scales of ranges", self.layout.ranges(), scales.ranges.len())?;
            let all = [
                ("the cost", std::slice::from_ref(&scales.cost)),
                ("steps", &scales.steps),
                ("equations", &scales.equalities),
                ("ranges", &scales.ranges),
            ];
            for (what, sizes) in all {
                let bad = |value: &f64| !(*value > 0.0 && value.is_finite());
                if let Some(index) = sizes.iter().position(bad) {
                    return Err(SolveError::Scale { what, index, value: sizes[index] });
                }
            }
        }
        Ok(())
    }

    /// The first iterate: slacks inside their bounds, multipliers of bounds on the central path or near it,
    /// those of equations by least squares.
    fn begin_scaled<P: StagedProblem>(
        &mut self,
        problem: &mut Scaled<'_, P>,
        start: Start<'_>,
    ) -> Result<(), SolveError<P::Error>> {
        self.stop_restoring();
        let Self { settings: Settings { barrier, .. }, iterate, bounds, .. } = self;
        let mu = if bounds.count() > 0 { start.mu.unwrap_or(barrier.start) } else { 0.0 };
        (self.progress.mu, self.progress.largest_mu) = (mu, barrier.largest * mu.max(barrier.start));
        iterate.point.copy_from_slice(start.point);
        problem.evaluate(start.point, &mut iterate.values)?;
        if !iterate.values.are_finite() {
            let finite = |values: &[f64]| values.iter().all(|value| value.is_finite());
            let what = match (iterate.values.cost.is_finite(), finite(&iterate.values.equalities)) {
                (false, _) => "the cost",
                (true, false) => "an equation",
                (true, true) => "a function with a range",
            };
            return Err(SolveError::NotFinite { what });
        }
        for (to, given) in [(&mut iterate.y, start.equalities), (&mut iterate.v, start.ranges)] {
            match given {
                Some(given) => to.copy_from_slice(given),
                None => to.fill(0.0),
            }
        }
        problem.scale(&mut iterate.y, &mut iterate.v);
        barrier.begin(iterate, bounds, (mu, start.ranges.is_some()));
        match start.equalities {
            Some(_) => {
                self.linearise(problem)?;
                self.check_derivatives()?;
            }
            None => self.estimate_multipliers(problem)?,
        }
        self.filter.restart(self.settings.filter, self.iterate.violation());
        self.measure();
        Ok(())
    }

    /// Least-squares multipliers of the equations, and derivatives with them.
    pub(crate) fn estimate_multipliers<P: StagedProblem>(
        &mut self,
        problem: &mut Scaled<'_, P>,
    ) -> Result<(), SolveError<P::Error>> {
        self.iterate.y.fill(0.0);
        self.linearise(problem)?;
        self.check_derivatives()?;
        let Self { layout, iterate, blocks, residuals, newton, step, .. } = self;
        if layout.equalities() == 0 {
            return Ok(());
        }
        newton.estimate(layout, blocks, &residuals.x, step);
        if largest(&step.y) > LARGEST_ESTIMATE {
            return Ok(());
        }
        iterate.y.copy_from_slice(&step.y);
        self.linearise(problem)
    }

    /// Whether the first derivatives are finite, and where the layout says.
    fn check_derivatives<E: std::error::Error>(&self) -> Result<(), SolveError<E>> {
        if !self.residuals.x.iter().all(|slope| slope.is_finite()) {
            return Err(SolveError::NotFinite { what: "a derivative" });
        }
        let ends = self.layout.position(Element::Ends);
        let slopes = &self.blocks.all()[ends].gradient;
        if !self.layout.couples_ends() && slopes.iter().any(|&slope| slope != 0.0) {
            return Err(SolveError::CostOfEnds);
        }
        Ok(())
    }

    /// A step from the iterate, whose derivatives are known; how the solution ended, if it did.
    fn advance_scaled<P: StagedProblem>(
        &mut self,
        problem: &mut Scaled<'_, P>,
    ) -> Result<Option<Status>, SolveError<P::Error>> {
        if self.is_in_restoration() {
            return self.go_on_restoring(problem);
        }
        let Settings { tolerance, feasibility, barrier, .. } = self.settings;
        let last = barrier.last(tolerance);
        let found = match self.next.take() {
            Some((found, step)) => {
                [self.progress.mu, self.progress.decrement] = step;
                found
            }
            None => self.newton_step(problem)?,
        };
        let mu = self.progress.mu;
        self.progress.regularisation = self.newton.regularisation();
        self.progress.is_exact = self.newton.is_exact();
        let is_feasible = self.progress.error.feasibility <= feasibility;
        if found {
            let tau = barrier.part_of_way(mu);
            let mut length = self.search(problem, (mu, tau))?;
            // Without correctors the step is one of descent.
            if length.is_none() && self.is_corrected && self.step_for(mu, Accuracy::Refined) {
                length = self.search(problem, (mu, tau))?;
            }
            if let Some(length) = length {
                self.progress.length = length;
                std::mem::swap(&mut self.iterate, &mut self.trial);
                reset_multipliers(&mut self.iterate, mu, barrier.neighbourhood);
                self.linearise(problem)?;
                self.measure();
                return Ok(None);
            }
            if is_feasible && mu <= last && self.is_tiny(problem) {
                return Ok(Some(Status::SolvedToRounding));
            }
            // Iterates with another mu may have made the filter too narrow: once more without them, and with
            // less of the metric.
            if self.filter.forget() {
                self.stay(problem)?;
                return Ok(None);
            }
        }
        if self.is_restoring || is_feasible {
            return Ok(Some(Status::Stalled));
        }
        self.begin_restoration(problem)
    }

    /// Derivatives at the iterate, and residuals.
    pub(crate) fn linearise<P: StagedProblem>(
        &mut self,
        problem: &mut Scaled<'_, P>,
    ) -> Result<(), SolveError<P::Error>> {
        let Self { layout, iterate, blocks, residuals, room, .. } = self;
        let weights = Weights { cost: 1.0, equalities: &iterate.y, ranges: &iterate.v };
        problem.linearise(&iterate.point, weights, blocks)?;
        iterate.residuals(layout, blocks, room, residuals);
        Ok(())
    }

    /// Takes values and derivatives at the iterate again, to which no step led.
    pub(crate) fn stay<P: StagedProblem>(
        &mut self,
        problem: &mut Scaled<'_, P>,
    ) -> Result<(), SolveError<P::Error>> {
        problem.evaluate(&self.iterate.point, &mut self.iterate.values)?;
        self.linearise(problem)?;
        self.measure_without_step();
        Ok(())
    }

    /// The error of the iterate, whose derivatives are known.
    pub(crate) fn measure(&mut self) {
        let target = if self.progress.mu > 0.0 { self.settings.barrier.least } else { 0.0 };
        self.progress.error = self.iterate.error(&self.residuals, target);
    }

    /// The same of an iterate to which no step led.
    pub(crate) fn measure_without_step(&mut self) {
        self.measure();
        (self.progress.length, self.progress.decrement) = (0.0, f64::INFINITY);
        (self.progress.regularisation, self.progress.is_exact) = (0.0, true);
    }

    /// The Newton step of the barrier problem, with mu as Mehrotra chooses it; whether there is one.
    fn newton_step<P: StagedProblem>(&mut self, problem: &mut Scaled<'_, P>) -> Result<bool, P::Error> {
        let Self { layout, iterate, bounds, blocks, newton, .. } = self;
        if newton.factorise(layout, iterate, blocks, problem)?.is_err() {
            return Ok(false);
        }
        let has_bounds = bounds.count() > 0;
        if has_bounds && !self.choose_mu() {
            return Ok(false);
        }
        let is_found = self.step_for(self.progress.mu, Accuracy::Refined);
        self.is_corrected = is_found && has_bounds && self.correct_products(self.progress.mu);
        Ok(is_found)
    }

    /// The step for this mu with the factors of the last factorisation; whether it is finite.
    fn step_for(&mut self, mu: f64, accuracy: Accuracy) -> bool {
        let Self { layout, iterate, blocks, residuals, corrected, newton, step, progress, targets, .. } =
            self;
        corrected.copy_from(residuals);
        targets.iter_mut().for_each(|targets| targets.fill(mu));
        barrier_residuals(iterate, newton.reciprocals(), targets, corrected);
        let is_found = newton.step(layout, iterate, blocks, (corrected, targets), (accuracy, step)).is_ok();
        progress.decrement = corrected.decrement(step);
        is_found
    }

    /// Chooses mu by the step for mu = 0; whether that is finite.
    fn choose_mu(&mut self) -> bool {
        let before = self.progress.decrement.abs();
        if !self.step_for(0.0, Accuracy::Rough) {
            return false;
        }
        let Self { iterate, bounds, newton, step, progress, settings, .. } = self;
        let Settings { barrier, tolerance, .. } = settings;
        let (count, gap) = (bounds.count() as f64, iterate.gap());
        let part = newton.is_exact().then(|| {
            let tau = barrier.part_of_way(progress.mu);
            let lengths = longest_steps(iterate, newton.reciprocals(), step, tau);
            iterate.gap_after(step, lengths) / gap
        });
        let decrements = [progress.decrement.abs(), before].map(|decrement| decrement / count);
        progress.mu =
            barrier.next(gap / count, part, decrements, [barrier.last(*tolerance), progress.largest_mu]);
        true
    }
}
