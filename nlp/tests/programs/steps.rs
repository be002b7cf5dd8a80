//! Solutions one iteration at a time, from multipliers that are known, and in metrics of their own.

use super::by_duals::{ByDuals, Number, Parts};
use super::closed_forms::BrysonDenham;
use super::collocation::Collocated;
use super::hard::{OfNode, Small};
use costate_nlp::{
    Blocks, Element, Iteration, Layout, Scales, Settings, SolveError, Solver, StagedProblem, Start, Status,
    Values, Weights,
};
use std::ops::ControlFlow;
use std::time::Duration;

type Transfer = ByDuals<Collocated<BrysonDenham>>;

fn transfer(intervals: usize) -> (Transfer, Vec<f64>) {
    let problem = ByDuals::new(Collocated(BrysonDenham { height: 0.1, intervals, units: [1.0, 1.0] }));
    let start = problem.functions.start(|s| vec![s * (1.0 - s), 1.0 - 2.0 * s], |_| vec![-2.0], &[]);
    (problem, start)
}

#[test]
fn one_iteration_at_a_time_is_the_whole_solution() {
    let (mut problem, start) = transfer(20);
    let mut solver = Solver::new(problem.layout(), Settings::default());
    let mut seen: Vec<Iteration> = Vec::new();
    let observer = |iteration| {
        seen.push(iteration);
        ControlFlow::Continue(())
    };
    let solution = solver.solve_observed(&mut problem, Start::at(&start), observer).unwrap();
    let (cost, multipliers) = (solution.cost, solution.ranges.to_vec());
    let mut ended = solver.begin(&mut problem, Start::at(&start)).unwrap();
    for iteration in &seen {
        assert_eq!(solver.iteration(), *iteration);
        if ended.is_none() {
            ended = solver.advance(&mut problem).unwrap();
        }
    }
    assert_eq!(ended, Some(Status::Solved));
    let solution = solver.solution();
    assert_eq!(solution.status, Status::Solved);
    assert_eq!((solution.cost, solution.ranges), (cost, &multipliers[..]));
    assert_eq!(solution.iterations + 1, seen.len());
    // The decrement of the last step and the gap bound what is left.
    let last = seen.last().unwrap();
    assert!(last.decrement.abs() < 1e-6 && last.gap < 1e-5, "{last:?}");
    // Nothing is done after the end.
    assert_eq!(solver.advance(&mut problem).unwrap(), Some(Status::Solved));
    assert_eq!(solver.iteration(), *last);
    // Another solution begins anew.
    assert_eq!(solver.solve(&mut problem, &start).unwrap().iterations + 1, seen.len());
}

/// Values at the middles of intervals of twice as many.
fn onto_halves(values: &[f64], each: usize) -> Vec<f64> {
    values.chunks(each).flat_map(|of_interval| [of_interval, of_interval].concat()).map(|v| 0.5 * v).collect()
}

#[test]
fn known_multipliers_save_iterations() {
    let (mut problem, start) = transfer(20);
    let mut solver = Solver::new(problem.layout(), Settings::default());
    let cold = solver.solve(&mut problem, &start).unwrap();
    let (point, [y, v]) = (cold.point.to_vec(), [cold.equalities, cold.ranges].map(<[f64]>::to_vec));
    let iterations = cold.iterations;
    let known = |mu| Start { point: &point, equalities: Some(&y), ranges: Some(&v), mu: Some(mu) };
    let same = solver.solve_observed(&mut problem, known(1e-9), |_| ControlFlow::Continue(())).unwrap();
    assert!(same.status == Status::Solved && same.iterations <= 2, "{} {iterations}", same.iterations);
    let off = same.ranges.iter().zip(&v).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
    assert!(off < 1e-2, "{off}");
    // On halved intervals: the motion between the points, and half of each multiplier of a range.
    let (mut finer, start) = transfer(40);
    let mut solver = Solver::new(finer.layout(), Settings::default());
    let cold = solver.solve(&mut finer, &start).unwrap();
    let (cost, iterations) = (cold.cost, cold.iterations);
    let cold_point = cold.point.to_vec();
    let point: Vec<f64> = cold_point.iter().enumerate().map(|(i, x)| x + 1e-3 * (i as f64).sin()).collect();
    let ranges = onto_halves(&v, 3);
    let start = Start { point: &point, equalities: None, ranges: Some(&ranges), mu: Some(1e-4) };
    let warm = solver.solve_observed(&mut finer, start, |_| ControlFlow::Continue(())).unwrap();
    assert!(warm.status == Status::Solved && (warm.cost / cost - 1.0).abs() < 1e-6, "{warm:?}");
    assert!(warm.iterations < iterations, "{} {iterations}", warm.iterations);
}

#[test]
fn starts_that_do_not_fit_are_named() {
    let (mut problem, start) = transfer(4);
    let mut solver = Solver::new(problem.layout(), Settings::default());
    let short = Start { equalities: Some(&[0.0]), ..Start::at(&start) };
    let error = solver.begin(&mut problem, short).unwrap_err();
    assert!(error.to_string().starts_with("the list of multipliers of equations has 1 entries"), "{error}");
    for mu in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = solver.begin(&mut problem, Start { mu: Some(mu), ..Start::at(&start) }).unwrap_err();
        assert!(matches!(error, SolveError::Setting { name: "start.mu", .. }), "{error}");
    }
    let unknown = vec![f64::NAN; problem.layout().ranges()];
    let error =
        solver.begin(&mut problem, Start { ranges: Some(&unknown), ..Start::at(&start) }).unwrap_err();
    assert_eq!(error.to_string(), "the list of multipliers of ranges is not finite at the start");
    // What did not begin is not solved.
    assert_eq!(solver.advance(&mut problem).unwrap(), Some(Status::Stopped));
    assert!(solver.iteration().error.largest().is_infinite());
    let (mut other, _) = transfer(5);
    assert_eq!(solver.advance(&mut other).unwrap_err(), SolveError::Layout);
}

/// `x^4 / 4 - x^2 / 2 + 50 y^2`, which is not convex about 0.
struct TwoWells;

impl OfNode for TwoWells {
    fn of<D: Number>(&self, x: &[D]) -> Parts<D> {
        let (x, y) = (x[0], x[1]);
        Parts { cost: x * x * x * x * 0.25 - x * x * 0.5 + y * y * 50.0, equalities: vec![], ranges: vec![] }
    }
}

/// The same with a range of x.
struct BoundedWells;

impl OfNode for BoundedWells {
    fn of<D: Number>(&self, x: &[D]) -> Parts<D> {
        Parts { ranges: vec![x[0]], ..TwoWells.of(x) }
    }
}

/// The same with lengths of its own, of each unknown, and with diagonal Hessians that are convex.
struct InMetric<P> {
    problem: P,
    squares: [f64; 2],
    added: Vec<f64>,
    convex: fn(&[f64]) -> Option<[f64; 2]>,
    asked: usize,
}

impl<P> InMetric<P> {
    fn new(problem: P, squares: [f64; 2]) -> Self {
        Self { problem, squares, added: Vec::new(), convex: |_| None, asked: 0 }
    }
}

impl<P: StagedProblem> StagedProblem for InMetric<P> {
    type Error = P::Error;
    fn layout(&self) -> &Layout {
        self.problem.layout()
    }
    fn bounds(&self) -> [&[f64]; 2] {
        self.problem.bounds()
    }
    fn evaluate(&mut self, point: &[f64], values: &mut Values) -> Result<(), P::Error> {
        self.problem.evaluate(point, values)
    }
    fn linearise(
        &mut self,
        point: &[f64],
        weights: Weights<'_>,
        blocks: &mut Blocks,
    ) -> Result<(), P::Error> {
        self.problem.linearise(point, weights, blocks)
    }
    fn convexify(&mut self, x: &[f64], w: Weights<'_>, blocks: &mut Blocks) -> Result<bool, P::Error> {
        self.asked += 1;
        let Some(diagonal) = (self.convex)(x) else { return Ok(false) };
        blocks.clear_hessians();
        for (i, entry) in diagonal.into_iter().enumerate() {
            blocks.of(Element::Node(0)).hessian[(i, i)] = w.cost * entry;
        }
        Ok(true)
    }
    fn add_metric(&mut self, _: &[f64], factor: f64, blocks: &mut Blocks) -> Result<(), P::Error> {
        self.added.push(factor);
        for (i, square) in self.squares.into_iter().enumerate() {
            blocks.of(Element::Node(0)).hessian[(i, i)] += factor * square;
        }
        Ok(())
    }
}

/// A first step from 0.1 along which the Hessian is regularised, in a metric and by default.
#[test]
fn hessians_are_regularised_in_the_metric_of_the_program() {
    let problem =
        || ByDuals::new(Small { unknowns: 2, equations: 0, bounds: [], of: TwoWells, scales: None });
    let from = [0.1, 0.5];
    let mut plain = problem();
    let mut solver = Solver::new(plain.layout(), Settings::default());
    solver.begin(&mut plain, Start::at(&from)).unwrap();
    solver.advance(&mut plain).unwrap();
    let Iteration { regularisation, length, .. } = solver.iteration();
    // x' = x - f' / (f'' + delta), with f = x^4 / 4 - x^2 / 2.
    let slope = 0.1_f64.powi(3) - 0.1;
    let step = -slope / (0.03 - 1.0 + regularisation);
    assert!((solver.point()[0] - 0.1 - length * step).abs() < 1e-12, "{:?}", solver.point());
    let mut own = InMetric::new(problem(), [1000.0, 1e-3]);
    let mut solver = Solver::new(own.layout(), Settings::default());
    solver.begin(&mut own, Start::at(&from)).unwrap();
    solver.advance(&mut own).unwrap();
    let Iteration { regularisation, length, .. } = solver.iteration();
    let sum: f64 = own.added.iter().sum();
    assert!(regularisation > 0.0 && (sum / regularisation - 1.0).abs() < 1e-12, "{:?}", own.added);
    let step = -slope / (0.03 - 1.0 + 1000.0 * regularisation);
    assert!((solver.point()[0] - 0.1 - length * step).abs() < 1e-12, "{:?}", solver.point());
    let y = 0.5 - length * 50.0 / (100.0 + 1e-3 * regularisation);
    assert!((solver.point()[1] - y).abs() < 1e-12, "{:?}", solver.point());
    let solution = solver.solve(&mut own, &from).unwrap();
    assert!(solution.status == Status::Solved && (solution.cost + 0.25).abs() < 1e-12, "{solution:?}");
}

/// Steps from 0.1 with the part 3 x^2 of the second derivative `3 x^2 - 1`.
#[test]
fn convex_hessians_take_the_place_of_indefinite_ones() {
    let small = Small { unknowns: 2, equations: 0, bounds: [], of: TwoWells, scales: None };
    let convex = |x: &[f64]| Some([3.0 * x[0] * x[0], 100.0]);
    let mut own = InMetric { convex, ..InMetric::new(ByDuals::new(small), [1.0, 1.0]) };
    let mut solver = Solver::new(own.layout(), Settings::default());
    let from = [0.1, 0.5];
    solver.begin(&mut own, Start::at(&from)).unwrap();
    assert!(solver.iteration().is_exact);
    solver.advance(&mut own).unwrap();
    let Iteration { is_exact, regularisation, length, .. } = solver.iteration();
    assert!(!is_exact && regularisation == 0.0 && own.asked == 1 && own.added.is_empty());
    let step = -(0.1_f64.powi(3) - 0.1) / 0.03;
    assert!((solver.point()[0] - 0.1 - length * step).abs() < 1e-12, "{:?}", solver.point());
    let solution = solver.solve(&mut own, &from).unwrap();
    assert!(solution.status == Status::Solved && (solution.cost + 0.25).abs() < 1e-12, "{solution:?}");
    // The last steps are exact ones.
    assert!(solver.iteration().is_exact);
    // Where the inertia is wrong with them too, the metric is added.
    own.convex = |_| Some([-0.5, 100.0]);
    solver.begin(&mut own, Start::at(&from)).unwrap();
    solver.advance(&mut own).unwrap();
    assert!(!solver.iteration().is_exact && solver.iteration().regularisation > 0.5 && !own.added.is_empty());
    // Without such steps the program is not asked.
    own.asked = 0;
    solver.settings_mut().convex.most = 0;
    let solution = solver.solve(&mut own, &from).unwrap();
    assert!(solution.status == Status::Solved && own.asked == 0 && !own.added.is_empty(), "{solution:?}");
}

/// Such a step says as little about how far mu may fall as a regularised one.
#[test]
fn mu_stays_where_hessians_are_convex_ones() {
    let bounds = [[-10.0, 10.0]];
    let small = Small { unknowns: 2, equations: 0, bounds, of: BoundedWells, scales: None };
    let convex = |x: &[f64]| Some([3.0 * x[0] * x[0] + 1.0, 100.0]);
    let mut own = InMetric { convex, ..InMetric::new(ByDuals::new(small), [1.0, 1.0]) };
    let mut solver = Solver::new(own.layout(), Settings::default());
    solver.begin(&mut own, Start::at(&[0.1, 0.0])).unwrap();
    let before = solver.iteration().mu;
    solver.advance(&mut own).unwrap();
    assert!(
        !solver.iteration().is_exact && solver.iteration().mu >= 0.5 * before,
        "{:?}",
        solver.iteration()
    );
    assert_eq!(solver.solve(&mut own, &[0.1, 0.0]).unwrap().status, Status::Solved);
}

/// From multipliers and slacks far from the central path.
#[test]
fn centrality_correctors_save_iterations() {
    let (mut problem, start) = transfer(40);
    let count = problem.layout().ranges();
    let off: Vec<f64> = (0..count).map(|i| 10.0_f64.powf(4.0 * (i as f64).sin())).collect();
    let mut solver = Solver::new(problem.layout(), Settings::default());
    let mut solve = |correctors: usize| {
        solver.settings_mut().centrality.correctors = correctors;
        let start = Start { point: &start, equalities: None, ranges: Some(&off), mu: Some(0.1) };
        let solution = solver.solve_observed(&mut problem, start, |_| ControlFlow::Continue(())).unwrap();
        assert_eq!(solution.status, Status::Solved);
        (solution.cost, solution.iterations)
    };
    let [(plain, before), (cost, iterations)] = [solve(0), solve(2)];
    assert!(
        (cost / plain - 1.0).abs() < 1e-6 && iterations < before,
        "{cost} {plain}, {iterations} {before}"
    );
}

/// `min x` with `x >= 0`.
struct Least;

impl OfNode for Least {
    fn of<D: Number>(&self, x: &[D]) -> Parts<D> {
        Parts { cost: x[0], equalities: vec![], ranges: vec![x[0]] }
    }
}

/// `min 0.783 x + 29.7 y` with x, y and two sums of their multiples above bounds.
struct Linear;

impl OfNode for Linear {
    fn of<D: Number>(&self, x: &[D]) -> Parts<D> {
        let (x, y) = (x[0], x[1]);
        let sums = [x * 1.0764 + y * 1.4689, x * 0.5916 + y * 0.9672];
        Parts { cost: x * 0.783 + y * 29.7, equalities: vec![], ranges: vec![x, y, sums[0], sums[1]] }
    }
}

/// Long corrected steps would lead uphill here.
#[test]
fn corrected_steps_descend() {
    let above = [0.0, f64::INFINITY];
    let small = Small { unknowns: 1, equations: 0, bounds: [above], of: Least, scales: None };
    let mut least = ByDuals::new(small);
    let mut solver = Solver::new(least.layout(), Settings::default());
    let mut costs = Vec::new();
    let observer = |iteration: Iteration| {
        costs.push(iteration.cost);
        ControlFlow::Continue(())
    };
    let solution = solver.solve_observed(&mut least, Start::at(&[1.0]), observer).unwrap();
    assert!(solution.status == Status::Solved && solution.cost < 1e-7, "{solution:?}");
    assert!(costs.windows(2).all(|pair| pair[1] < pair[0] + 1e-9), "{costs:?}");
    let bounds = [above, above, [1.0, f64::INFINITY], [0.5, f64::INFINITY]];
    let mut linear = ByDuals::new(Small { unknowns: 2, equations: 0, bounds, of: Linear, scales: None });
    let mut solver = Solver::new(linear.layout(), Settings::default());
    let solution = solver.solve(&mut linear, &[0.2561, 2.3699]).unwrap();
    assert_eq!(solution.status, Status::Solved);
    assert!((solution.cost - 0.783 / 1.0764).abs() < 1e-6, "{solution:?}");
}

/// `min x`, and another unknown without effect: every Hessian is regularised.
struct Flat;

impl OfNode for Flat {
    fn of<D: Number>(&self, x: &[D]) -> Parts<D> {
        Parts { cost: x[0] + x[1] * 0.0, equalities: vec![], ranges: vec![x[0]] }
    }
}

#[test]
fn mu_falls_where_hessians_are_regularised() {
    let bounds = [[0.0, 1.0]];
    let mut flat = ByDuals::new(Small { unknowns: 2, equations: 0, bounds, of: Flat, scales: None });
    let mut solver = Solver::new(flat.layout(), Settings::default());
    let solution = solver.solve(&mut flat, &[0.5, 0.0]).unwrap();
    assert!(solution.status == Status::Solved && solution.point[0].abs() < 1e-7, "{solution:?}");
    assert!(solution.iterations < 30, "{}", solution.iterations);
}

#[test]
fn solutions_end_at_their_time_limit() {
    let (mut problem, start) = transfer(20);
    let settings = Settings { time_limit: Some(Duration::ZERO), ..Settings::default() };
    let mut solver = Solver::new(problem.layout(), settings);
    let solution = solver.solve(&mut problem, &start).unwrap();
    assert_eq!((solution.status, solution.iterations), (Status::TimeLimit, 0));
    assert_eq!(solution.point, start);
    // What is solved in time is solved, and the time begins with each solution.
    solver.settings_mut().time_limit = Some(Duration::from_secs(3600));
    assert_eq!(solver.solve(&mut problem, &start).unwrap().status, Status::Solved);
    solver.settings_mut().time_limit = Some(Duration::from_millis(50));
    let mut seen = 0;
    let observer = |_| {
        seen += 1;
        std::thread::sleep(Duration::from_millis(30));
        ControlFlow::Continue(())
    };
    let solution = solver.solve_observed(&mut problem, Start::at(&start), observer).unwrap();
    // Two observations take longer than that.
    assert!(solution.status == Status::TimeLimit && solution.iterations <= 2, "{solution:?}");
    assert_eq!(seen, solution.iterations + 1);
}

/// A clone has room of its own for the filter, and settings may change between solutions.
#[test]
fn solvers_are_cloned_and_their_settings_changed() {
    let (mut problem, start) = transfer(6);
    let mut solver = Solver::new(problem.layout(), Settings::default()).clone();
    let cost = solver.solve(&mut problem, &start).unwrap().cost;
    let mut wells = ByDuals::new(Small { unknowns: 2, equations: 0, bounds: [], of: TwoWells, scales: None });
    let mut of_wells = Solver::new(wells.layout(), Settings::default());
    of_wells.solve(&mut wells, &[0.1, 0.5]).unwrap();
    of_wells.settings_mut().regularisation.first = 2.0;
    of_wells.begin(&mut wells, Start::at(&[0.1, 0.5])).unwrap();
    of_wells.advance(&mut wells).unwrap();
    assert_eq!(of_wells.iteration().regularisation, 2.0);
    assert_eq!(solver.solve(&mut problem, &start).unwrap().cost, cost);
}

/// Ranges far from zero, and without room: slacks begin inside.
#[test]
fn starts_on_large_bounds_are_inside() {
    let bounds = [[1e9, 2e9], [-0.5, 0.87]];
    struct Sum;
    impl OfNode for Sum {
        fn of<D: Number>(&self, x: &[D]) -> Parts<D> {
            Parts { cost: x[0] + x[1], equalities: vec![], ranges: vec![x[0], x[1]] }
        }
    }
    let scales = Scales { steps: vec![1e9, 1.0], cost: 1e9, equalities: vec![], ranges: vec![1.0, 1.0] };
    let mut sum = ByDuals::new(Small { unknowns: 2, equations: 0, bounds, of: Sum, scales: Some(scales) });
    let mut settings = Settings::default();
    settings.barrier.inside = [1.0, 0.5];
    let mut solver = Solver::new(sum.layout(), settings);
    let start = Start { point: &[1e9, 0.0], equalities: None, ranges: Some(&[-1.0, 0.0]), mu: Some(1e-9) };
    solver.begin(&mut sum, start).unwrap();
    assert!(solver.iteration().gap.is_finite(), "{:?}", solver.iteration());
    // Half of the range to both sides leaves its middle.
    solver.begin(&mut sum, Start::at(&[1e9, 0.0])).unwrap();
    assert!(solver.iteration().gap.is_finite(), "{:?}", solver.iteration());
}
