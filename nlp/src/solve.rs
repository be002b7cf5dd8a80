//! The primal-dual interior-point method with a filter line search.
//!
//! Waechter and Biegler 2006, with the pivots of the stages in place of a general factorisation.

use crate::active::Active;
use crate::barrier::{BarrierSettings, barrier_residuals, longest_steps, reset_multipliers, slope};
use crate::blocks::{Blocks, Weights};
use crate::elements::{Room, gather};
use crate::filter::{Acceptance, Filter, FilterSettings, Measure};
use crate::iterate::{Bounds, Iterate, KktError, Residuals, Step};
use crate::layout::{Element, Layout};
use crate::newton::{Newton, NoStep, RegularisationSettings};
use crate::outcome::{Iteration, Solution, SolveError, Status};
use crate::problem::StagedProblem;
use crate::restoration::{Elastic, Places};
use crate::scaled::Scaled;
use crate::vectors::{largest, move_along};
use std::ops::ControlFlow;

/// What steers a solution. Each group stands beside the algorithm that it steers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Largest error of the conditions of optimality, of the scaled program.
    pub tolerance: f64,
    /// Most iterations.
    pub iterations: usize,
    /// The barrier parameter.
    pub barrier: BarrierSettings,
    /// The line search.
    pub filter: FilterSettings,
    /// The regularisation of Hessians.
    pub regularisation: RegularisationSettings,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            tolerance: 1e-8,
            iterations: 1000,
            barrier: BarrierSettings::default(),
            filter: FilterSettings::default(),
            regularisation: RegularisationSettings::default(),
        }
    }
}

impl Settings {
    /// The first setting that is out of its range: name, value, least, most.
    fn first_wrong(&self) -> Option<(&'static str, f64, [f64; 2])> {
        let Self { tolerance, barrier, filter, regularisation, .. } = self;
        const BELOW_ONE: [f64; 2] = [f64::MIN_POSITIVE, 1.0 - f64::EPSILON];
        const POSITIVE: [f64; 2] = [f64::MIN_POSITIVE, f64::MAX];
        const ABOVE_ONE: [f64; 2] = [1.0 + f64::EPSILON, f64::MAX];
        let all = [
            ("tolerance", *tolerance, BELOW_ONE),
            ("barrier.start", barrier.start, POSITIVE),
            ("barrier.accuracy", barrier.accuracy, POSITIVE),
            ("barrier.decrease.0", barrier.decrease.0, BELOW_ONE),
            ("barrier.decrease.1", barrier.decrease.1, [1.0 + f64::EPSILON, 2.0 - f64::EPSILON]),
            ("barrier.part", barrier.part, BELOW_ONE),
            ("barrier.neighbourhood", barrier.neighbourhood, ABOVE_ONE),
            ("barrier.inside[0]", barrier.inside[0], POSITIVE),
            ("barrier.inside[1]", barrier.inside[1], [f64::MIN_POSITIVE, 0.5]),
            ("filter.margins[0]", filter.margins[0], BELOW_ONE),
            ("filter.margins[1]", filter.margins[1], BELOW_ONE),
            ("filter.switching[0]", filter.switching[0], POSITIVE),
            ("filter.switching[1]", filter.switching[1], ABOVE_ONE),
            ("filter.switching[2]", filter.switching[2], [1.0, f64::MAX]),
            ("filter.armijo", filter.armijo, [f64::MIN_POSITIVE, 0.5]),
            ("filter.violations[0]", filter.violations[0], POSITIVE),
            ("filter.violations[1]", filter.violations[1], POSITIVE),
            ("filter.correction.0", filter.correction.0, BELOW_ONE),
            ("regularisation.first", regularisation.first, POSITIVE),
            ("regularisation.least", regularisation.least, POSITIVE),
            ("regularisation.largest", regularisation.largest, [regularisation.first, f64::MAX]),
            ("regularisation.decrease", regularisation.decrease, BELOW_ONE),
            ("regularisation.increase[0]", regularisation.increase[0], ABOVE_ONE),
            ("regularisation.increase[1]", regularisation.increase[1], ABOVE_ONE),
        ];
        // Not true for NaN.
        all.into_iter().find(|(_, value, [least, most])| !(value >= least && value <= most))
    }
}

/// Steps shorter than this, relative to the point, are rounding.
const TINY: f64 = 10.0 * f64::EPSILON;

/// Error up to which restoration solves its program: whether a minimum of the violation was found needs no
/// more digits.
const LEAST_VIOLATION: f64 = 1e-6;

/// Relative decrease of the violation from one centre of restoration to the next below which it has a
/// minimum.
const LEAST_DECREASE: f64 = 1e-3;

/// Part of the violation that restoration may leave: kappa_resto of IPOPT.
const RESTORED: f64 = 0.9;

/// Largest multipliers of equations that the first estimate may have: lambda_max of IPOPT.
const LARGEST_ESTIMATE: f64 = 1e3;

/// Workspace for programs of one layout. [`solve`](Self::solve) allocates the bounds and scales of the
/// program, and what restoration needs the first time that no acceptable step is found.
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
    settings: Settings,
    pub(crate) iterate: Iterate,
    pub(crate) trial: Iterate,
    pub(crate) blocks: Blocks,
    pub(crate) residuals: Residuals,
    /// Right-hand sides of second-order corrections.
    corrected: Residuals,
    newton: Newton,
    room: Room,
    step: Step,
    correction: Step,
    filter: Filter,
    dependent: Vec<usize>,
    /// Multipliers of the program itself: the iterate has those of the scaled one.
    multipliers: [Vec<f64>; 2],
    /// The factorisation at a solution, once it was asked for.
    pub(crate) active: Option<Box<Active>>,
    /// The elastic program and its solver, once they were needed.
    restoration: Option<Box<(Places, Solver)>>,
    /// Whether this is that solver.
    is_restoring: bool,
    /// Iterations of restoration that the others are numbered after.
    restoring: usize,
}

/// What a line search found.
enum Search {
    /// The trial point is accepted, at this length of the step.
    Accepted(f64),
    Failed,
    /// There was no step to try.
    NoStep,
}

impl Solver {
    /// Builds the workspace for programs of this layout, whose points have as many entries as their steps.
    pub fn new(layout: &Layout, settings: Settings) -> Self {
        Self::for_points(layout, layout.steps(), settings)
    }

    /// The same for points of another length.
    pub fn for_points(layout: &Layout, point_len: usize, settings: Settings) -> Self {
        let iterate = Iterate::new(layout, point_len);
        Self {
            settings,
            trial: iterate.clone(),
            iterate,
            blocks: Blocks::new(layout),
            residuals: Residuals::zeros(layout),
            corrected: Residuals::zeros(layout),
            newton: Newton::new(layout, settings.regularisation),
            room: Room::new(layout),
            step: Step::zeros(layout),
            correction: Step::zeros(layout),
            filter: Filter::new(settings.filter),
            dependent: Vec::with_capacity(layout.equalities()),
            multipliers: [vec![0.0; layout.equalities()], vec![0.0; layout.ranges()]],
            active: None,
            restoration: None,
            is_restoring: false,
            restoring: 0,
            layout: layout.clone(),
        }
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
        self.solve_observed(problem, start, |_| ControlFlow::Continue(()))
    }

    /// The same; `observer` is called after each iteration, and may stop the solution.
    ///
    /// # Errors
    /// [`SolveError`].
    pub fn solve_observed<P: StagedProblem>(
        &mut self,
        problem: &mut P,
        start: &[f64],
        mut observer: impl FnMut(Iteration) -> ControlFlow<()>,
    ) -> Result<Solution<'_>, SolveError<P::Error>> {
        self.check(problem)?;
        SolveError::check_length("the start", self.iterate.point.len(), start.len())?;
        // It belongs to another solution.
        self.active = None;
        let mut scaled = Scaled::new(problem);
        let bounds = Bounds::new(scaled.bounds());
        let mu = self.settings.barrier.start;
        self.begin(&mut scaled, &bounds, start, mu)?;
        let (status, error, iterations) =
            self.iterate_to_end(&mut scaled, &bounds, mu, &mut |_, iteration| observer(iteration))?;
        let Self { iterate, newton, dependent, layout, .. } = self;
        dependent.clear();
        dependent.extend(newton.dependent(layout));
        let [y, v] = &mut self.multipliers;
        y.copy_from_slice(&iterate.y);
        v.copy_from_slice(&iterate.v);
        scaled.unscale(y, v);
        let cost = scaled.unscaled_cost(iterate.values.cost);
        let ([y, v], point) = (&self.multipliers, &self.iterate.point);
        Ok(Solution {
            status,
            point,
            cost,
            equalities: y,
            ranges: v,
            dependent: &self.dependent,
            error,
            iterations,
        })
    }

    /// Whether the program is one of this layout, with ranges and scales that hold numbers.
    pub(crate) fn check<P: StagedProblem>(&self, problem: &P) -> Result<(), SolveError<P::Error>> {
        if let Some((name, value, [least, most])) = self.settings.first_wrong() {
            return Err(SolveError::Setting { name, value, least, most });
        }
        if *problem.layout() != self.layout {
            return Err(SolveError::Layout);
        }
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

    /// The first iterate: slacks inside their bounds, multipliers of bounds on the central path, those of
    /// equations by least squares.
    fn begin<P: StagedProblem>(
        &mut self,
        problem: &mut Scaled<'_, P>,
        bounds: &Bounds,
        start: &[f64],
        mu: f64,
    ) -> Result<(), SolveError<P::Error>> {
        self.newton.forget();
        self.restoring = 0;
        let Self { settings, iterate, .. } = self;
        iterate.point.copy_from_slice(start);
        problem.evaluate(start, &mut iterate.values)?;
        if !iterate.values.are_finite() {
            let finite = |values: &[f64]| values.iter().all(|value| value.is_finite());
            let what = match (iterate.values.cost.is_finite(), finite(&iterate.values.equalities)) {
                (false, _) => "the cost",
                (true, false) => "an equation",
                (true, true) => "a function with a range",
            };
            return Err(SolveError::NotFinite { what });
        }
        for i in 0..iterate.slacks.len() {
            let (lower, upper) = (bounds.lower[i], bounds.upper[i]);
            iterate.slacks[i] = settings.barrier.inside(iterate.values.ranges[i], lower, upper);
            let gaps = bounds.gaps(&iterate.slacks, i);
            for (z, gap) in iterate.z.iter_mut().zip(gaps) {
                z[i] = if gap.is_finite() { mu / gap } else { 0.0 };
            }
            iterate.v[i] = iterate.z[1][i] - iterate.z[0][i];
        }
        self.estimate_multipliers(problem)
    }

    /// Least-squares multipliers of the equations.
    fn estimate_multipliers<P: StagedProblem>(
        &mut self,
        problem: &mut Scaled<'_, P>,
    ) -> Result<(), SolveError<P::Error>> {
        self.iterate.y.fill(0.0);
        self.linearise(problem)?;
        let Self { layout, iterate, blocks, residuals, newton, step, .. } = self;
        if !residuals.x.iter().all(|slope| slope.is_finite()) {
            return Err(SolveError::NotFinite { what: "a derivative" });
        }
        let ends = layout.position(Element::Ends);
        if !layout.couples_ends() && blocks.all()[ends].gradient.iter().any(|&slope| slope != 0.0) {
            return Err(SolveError::CostOfEnds);
        }
        if layout.equalities() > 0 {
            newton.estimate(layout, blocks, &residuals.x, step);
            if largest(&step.y) <= LARGEST_ESTIMATE {
                iterate.y.copy_from_slice(&step.y);
            }
        }
        Ok(())
    }

    /// Iterates until the end.
    fn iterate_to_end<P: StagedProblem>(
        &mut self,
        problem: &mut Scaled<'_, P>,
        bounds: &Bounds,
        mut mu: f64,
        observer: &mut dyn FnMut(&Iterate, Iteration) -> ControlFlow<()>,
    ) -> Result<(Status, KktError, usize), SolveError<P::Error>> {
        let Settings { tolerance, barrier, .. } = self.settings;
        let has_bounds = bounds.lower.iter().chain(&bounds.upper).any(|bound| bound.is_finite());
        if !has_bounds {
            mu = 0.0;
        }
        self.filter.restart(self.iterate.violation());
        let mut length = 0.0;
        let mut regularisation = 0.0;
        for own in 0.. {
            let number = own + self.restoring;
            self.linearise(problem)?;
            let error = self.iterate.error(bounds, &self.residuals, 0.0);
            let seen = Iteration {
                number,
                cost: self.iterate.values.cost,
                violation: self.iterate.violation(),
                error,
                mu,
                regularisation,
                length,
                is_restoration: self.is_restoring,
            };
            let stopped = observer(&self.iterate, seen).is_break();
            if error.largest() <= tolerance {
                return Ok((Status::Solved, error, number));
            }
            if stopped {
                return Ok((Status::Stopped, error, number));
            }
            if number >= self.settings.iterations {
                return Ok((Status::IterationLimit, error, number));
            }
            // The next barrier problems that this iterate solves are passed.
            let error_at =
                |mu| KktError { complementarity: self.iterate.complementarity(bounds, mu), ..error };
            while mu > 0.1 * tolerance && error_at(mu).largest() <= barrier.accuracy * mu {
                mu = barrier.next(mu, tolerance);
                self.filter.clear();
            }
            let found = self.newton_step(bounds, mu);
            regularisation = self.newton.regularisation();
            let tau = barrier.part_of_way(mu);
            let search = match found {
                Ok(()) => self.search(problem, bounds, (mu, tau))?,
                Err(NoStep::Inertia | NoStep::NotFinite) => Search::NoStep,
            };
            let is_feasible = error.feasibility <= tolerance;
            match search {
                Search::Accepted(alpha) => {
                    length = alpha;
                    std::mem::swap(&mut self.iterate, &mut self.trial);
                    reset_multipliers(&mut self.iterate, bounds, mu, barrier.neighbourhood);
                }
                // The barrier problem is solved up to rounding.
                Search::Failed if is_feasible && self.is_tiny(problem) => {
                    if mu <= 0.1 * tolerance {
                        return Ok((Status::SolvedToRounding, error, number));
                    }
                    mu = barrier.next(mu, tolerance);
                    self.filter.clear();
                }
                Search::Failed | Search::NoStep if self.is_restoring || is_feasible => {
                    return Ok((Status::Stalled, error, number));
                }
                Search::Failed | Search::NoStep => {
                    if let Err(status) = self.restore(problem, bounds, (mu, own), observer)? {
                        self.linearise(problem)?;
                        let error = self.iterate.error(bounds, &self.residuals, 0.0);
                        return Ok((status, error, own + self.restoring));
                    }
                }
            }
        }
        unreachable!("numbers do not end")
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

    /// The Newton step of the barrier problem.
    fn newton_step(&mut self, bounds: &Bounds, mu: f64) -> Result<(), NoStep> {
        let Self { layout, iterate, blocks, residuals, corrected, newton, step, .. } = self;
        newton.factorise(layout, (iterate, bounds), blocks)?;
        corrected.copy_from(residuals);
        barrier_residuals(iterate, newton.reciprocals(), mu, corrected);
        newton.step(layout, iterate, blocks, (corrected, mu), step)
    }

    /// Whether the step is rounding.
    fn is_tiny<P: StagedProblem>(&self, problem: &Scaled<'_, P>) -> bool {
        let Self { step, iterate, .. } = self;
        let of_slacks =
            step.slacks.iter().zip(&iterate.slacks).all(|(d, s)| d.abs() <= TINY * (1.0 + s.abs()));
        of_slacks && step.x.iter().enumerate().all(|(k, d)| d.abs() <= TINY * problem.size(&iterate.point, k))
    }

    /// The derivative of the objective of the barrier problem along the step.
    fn slope(&mut self, mu: f64) -> f64 {
        let Self { layout, blocks, newton, room, step, .. } = self;
        let mut sum = slope(newton.reciprocals(), step, mu);
        for (element, block) in layout.elements().zip(blocks.all()) {
            let (d, ..) = room.of(block.gradient.len());
            gather(layout, element, (&step.x, &blocks.units.steps), d);
            let products = block.gradient.iter().zip(d).map(|(slope, d)| slope * *d);
            sum += blocks.units.cost * products.sum::<f64>();
        }
        sum
    }

    /// Shortens the step until the filter accepts the trial point.
    fn search<P: StagedProblem>(
        &mut self,
        problem: &mut Scaled<'_, P>,
        bounds: &Bounds,
        (mu, tau): (f64, f64),
    ) -> Result<Search, SolveError<P::Error>> {
        let current = Measure::of(&self.iterate, bounds, mu);
        let slope = self.slope(mu);
        let [longest, of_multipliers] =
            longest_steps(&self.iterate, self.newton.reciprocals(), &self.step, tau);
        let least = self.filter.least_length(current.violation, slope);
        let mut alpha = longest;
        let mut is_first = true;
        loop {
            self.try_step(problem, false, alpha)?;
            let trial = Measure::of(&self.trial, bounds, mu);
            if let Some(accepted) = self.filter.judge(current, trial, alpha, slope) {
                self.accept(accepted, current, (alpha, slope));
                self.move_multipliers(false, (alpha, of_multipliers));
                return Ok(Search::Accepted(alpha));
            }
            if is_first
                && trial.violation >= current.violation
                && let Some(length) =
                    self.correct(problem, bounds, (current, trial), (mu, tau, alpha, slope))?
            {
                return Ok(Search::Accepted(length));
            }
            is_first = false;
            alpha *= 0.5;
            if alpha < least.max(f64::EPSILON) {
                return Ok(Search::Failed);
            }
        }
    }

    /// Looks for a point with less violation that the filter accepts; else how the solution ends.
    fn restore<P: StagedProblem>(
        &mut self,
        problem: &mut Scaled<'_, P>,
        bounds: &Bounds,
        (mu, own): (f64, usize),
        observer: &mut dyn FnMut(&Iterate, Iteration) -> ControlFlow<()>,
    ) -> Result<Result<(), Status>, SolveError<P::Error>> {
        let current = Measure::of(&self.iterate, bounds, mu);
        self.filter.add(current);
        let (layout, mut settings) = (self.layout.clone(), self.settings);
        // Elastic variables start where their conditions hold, close to zero if need be.
        settings.barrier.inside = [f64::MIN_POSITIVE; 2];
        settings.tolerance = settings.tolerance.max(LEAST_VIOLATION);
        let len = self.iterate.point.len();
        let (places, solver) = &mut **self.restoration.get_or_insert_with(|| {
            let places = Places::new(&layout);
            let len = places.layout.steps() + len;
            let solver = Self { is_restoring: true, ..Self::for_points(&places.layout, len, settings) };
            Box::new((places, solver))
        });
        let mut slacks = self.iterate.slacks.clone();
        let mut most = RESTORED * current.violation;
        let mut before = current.violation;
        self.trial.point.copy_from_slice(&self.iterate.point);
        self.trial.slacks.copy_from_slice(&self.iterate.slacks);
        problem.evaluate(&self.trial.point, &mut self.trial.values)?;
        loop {
            let centre = self.trial.point.clone();
            let start_mu = mu.max(before.min(1.0));
            let mut elastic = Elastic::new(&mut *problem.problem, places, &centre);
            let start = elastic.start(&self.trial.values, &self.trial.slacks, start_mu);
            let scales = elastic.step_scales().to_vec();
            let mut scaled = Scaled::new(&mut elastic);
            let elastic_bounds = Bounds::new(scaled.bounds());
            solver.begin(&mut scaled, &elastic_bounds, &start, start_mu)?;
            let (mut violation, mut is_stopped, first) = (before, false, own + self.restoring + 1);
            solver.settings.iterations = self.settings.iterations.saturating_sub(first);
            let mut stop_below = |iterate: &Iterate, seen: Iteration| {
                violation = places.violation(&layout, &scales, iterate, &mut slacks);
                is_stopped = observer(iterate, Iteration { number: first + seen.number, ..seen }).is_break();
                if violation <= most || is_stopped {
                    ControlFlow::Break(())
                } else {
                    ControlFlow::Continue(())
                }
            };
            let (status, _, iterations) =
                solver.iterate_to_end(&mut scaled, &elastic_bounds, start_mu, &mut stop_below)?;
            self.restoring += iterations + 1;
            let trial = &mut self.trial;
            trial.point.copy_from_slice(elastic.original_point(&solver.iterate.point));
            problem.evaluate(&trial.point, &mut trial.values)?;
            for (i, slack) in trial.slacks.iter_mut().enumerate() {
                *slack = slacks[i].clamp(bounds.lower[i], bounds.upper[i]);
            }
            if is_stopped || violation > most {
                let is_minimum = matches!(status, Status::Solved | Status::SolvedToRounding);
                // The minimum about one centre lowers the violation a little: go on from there.
                if !is_stopped && is_minimum && violation < (1.0 - LEAST_DECREASE) * before {
                    before = violation;
                    continue;
                }
                let status = match status {
                    _ if is_stopped => Status::Stopped,
                    _ if is_minimum => Status::LocallyInfeasible,
                    Status::IterationLimit => status,
                    _ => Status::Stalled,
                };
                if trial.values.are_finite() {
                    trial.y.fill(0.0);
                    trial.v.fill(0.0);
                    trial.z.iter_mut().for_each(|z| z.fill(0.0));
                    std::mem::swap(&mut self.iterate, &mut self.trial);
                }
                return Ok(Err(status));
            }
            if self.filter.accepts(Measure::of(trial, bounds, mu)) {
                break;
            }
            before = violation;
            most = RESTORED * violation;
            if most <= f64::MIN_POSITIVE {
                return Ok(Err(Status::Stalled));
            }
        }
        for i in 0..self.trial.slacks.len() {
            let gaps = bounds.gaps(&self.trial.slacks, i);
            for (z, gap) in self.trial.z.iter_mut().zip(gaps) {
                z[i] = if gap.is_finite() { (mu / gap).min(LARGEST_ESTIMATE) } else { 0.0 };
            }
            self.trial.v[i] = self.trial.z[1][i] - self.trial.z[0][i];
        }
        std::mem::swap(&mut self.iterate, &mut self.trial);
        match self.estimate_multipliers(problem) {
            Err(SolveError::NotFinite { .. }) => Ok(Err(Status::Stalled)),
            other => other.map(Ok),
        }
    }

    /// Second-order corrections of a step of length alpha: Waechter and Biegler 2006, section 2.4.
    fn correct<P: StagedProblem>(
        &mut self,
        problem: &mut Scaled<'_, P>,
        bounds: &Bounds,
        (current, trial): (Measure, Measure),
        (mu, tau, mut alpha, slope): (f64, f64, f64, f64),
    ) -> Result<Option<f64>, SolveError<P::Error>> {
        let (factor, most) = self.settings.filter.correction;
        let first = alpha;
        let mut violation = trial.violation;
        self.corrected.copy_from(&self.residuals);
        barrier_residuals(&self.iterate, self.newton.reciprocals(), mu, &mut self.corrected);
        for _ in 0..most {
            if !violation.is_finite() {
                break;
            }
            let Self { layout, iterate, trial, blocks, corrected, newton, correction, .. } = self;
            for (to, c) in corrected.equalities.iter_mut().zip(&trial.values.equalities) {
                *to = alpha * *to + c;
            }
            for (i, to) in corrected.ranges.iter_mut().enumerate() {
                *to = alpha * *to + trial.values.ranges[i] - trial.slacks[i];
            }
            if newton.step(layout, iterate, blocks, (corrected, mu), correction).is_err() {
                break;
            }
            let [longest, of_multipliers] = longest_steps(iterate, newton.reciprocals(), correction, tau);
            alpha = longest;
            self.try_step(problem, true, alpha)?;
            let measure = Measure::of(&self.trial, bounds, mu);
            if let Some(accepted) = self.filter.judge(current, measure, first, slope) {
                self.accept(accepted, current, (first, slope));
                self.move_multipliers(true, (alpha, of_multipliers));
                return Ok(Some(alpha));
            }
            if measure.violation > factor * violation {
                break;
            }
            violation = measure.violation;
        }
        Ok(None)
    }

    /// The point and slacks at a length along the step, or along its correction.
    fn try_step<P: StagedProblem>(
        &mut self,
        problem: &mut Scaled<'_, P>,
        is_corrected: bool,
        alpha: f64,
    ) -> Result<(), SolveError<P::Error>> {
        let Self { iterate, trial, step, correction, .. } = self;
        let step = if is_corrected { correction } else { step };
        problem.retract(&iterate.point, &step.x, alpha, &mut trial.point);
        move_along(&mut trial.slacks, &iterate.slacks, &step.slacks, alpha);
        Ok(problem.evaluate(&trial.point, &mut trial.values)?)
    }

    /// Multipliers of the trial point.
    fn move_multipliers(&mut self, is_corrected: bool, (alpha, of_bounds): (f64, f64)) {
        let Self { iterate, trial, step, correction, .. } = self;
        let step = if is_corrected { correction } else { step };
        move_along(&mut trial.y, &iterate.y, &step.y, alpha);
        move_along(&mut trial.v, &iterate.v, &step.v, alpha);
        for side in 0..2 {
            move_along(&mut trial.z[side], &iterate.z[side], &step.z[side], of_bounds);
        }
    }

    /// Notes the current iterate in the filter unless the objective decided.
    fn accept(&mut self, accepted: Acceptance, current: Measure, (alpha, slope): (f64, f64)) {
        if accepted == Acceptance::Either || !self.filter.switches(current.violation, alpha, slope) {
            self.filter.add(current);
        }
    }
}
