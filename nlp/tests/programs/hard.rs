//! Programs that need restoration, have no solution, or have equations that depend on others.

use super::by_duals::{ByDuals, Functions, Number, Parts};
use costate_nlp::{
    Element, Iteration, Layout, Rows, Scales, Settings, Solver, StagedProblem, Start, Status, Values,
};
use std::ops::ControlFlow;

/// A program of one node.
pub struct Small<F, const RANGES: usize> {
    pub unknowns: usize,
    pub equations: usize,
    pub bounds: [[f64; 2]; RANGES],
    pub of: F,
    pub scales: Option<Scales>,
}

/// Functions of one node for all numbers.
pub trait OfNode {
    fn of<D: Number>(&self, x: &[D]) -> Parts<D>;
}

impl<F: OfNode, const RANGES: usize> Functions for Small<F, RANGES> {
    fn layout(&self) -> Layout {
        let rows = Rows::new(self.equations, RANGES);
        Layout::new(vec![self.unknowns], Vec::new(), 0).with_rows(Element::Node(0), rows)
    }
    fn bounds(&self, element: Element) -> Vec<[f64; 2]> {
        if element == Element::Node(0) { self.bounds.to_vec() } else { Vec::new() }
    }
    fn of<D: Number>(&self, element: Element, z: &[D]) -> Parts<D> {
        if element == Element::Node(0) { self.of.of(z) } else { Parts::none() }
    }
    fn scales(&self) -> Option<Scales> {
        self.scales.clone()
    }
}

const ABOVE_ZERO: [f64; 2] = [0.0, f64::INFINITY];

/// `min x_1` with `x_1^2 - x_2 = 1`, `x_1 - x_3 = 1/2`, `x_2, x_3 >= 0`: interior-point methods that only
/// shorten steps fail from (-2, 3, 1) (Waechter and Biegler, "Failure of global convergence for a class of
/// interior point methods", Mathematical Programming 88 (2000), 565-574).
struct Failure;

impl OfNode for Failure {
    fn of<D: Number>(&self, x: &[D]) -> Parts<D> {
        Parts {
            cost: x[0],
            equalities: vec![x[0] * x[0] - x[1] - 1.0, x[0] - x[2] - 0.5],
            ranges: vec![x[1], x[2]],
        }
    }
}

#[test]
fn steps_that_end_at_a_bound_are_restored() {
    let small = Small { unknowns: 3, equations: 2, bounds: [ABOVE_ZERO; 2], of: Failure, scales: None };
    let mut problem = ByDuals::new(small);
    let mut solver = Solver::new(problem.layout(), Settings::default());
    let solution = solver.solve(&mut problem, &[-2.0, 3.0, 1.0]).unwrap();
    assert_eq!(solution.status, Status::Solved, "{solution:?}");
    assert!((solution.cost - 1.0).abs() < 1e-7, "{solution:?}");
}

/// The failure example, from where it needs restoration, stopped after so many iterations by the limit or by
/// the observer.
fn stopped_after(most: usize, by_limit: bool) -> (Status, Vec<bool>) {
    let small = Small { unknowns: 3, equations: 2, bounds: [ABOVE_ZERO; 2], of: Failure, scales: None };
    let mut problem = ByDuals::new(small);
    let iterations = if by_limit { most } else { 1000 };
    let settings = Settings { iterations, ..Settings::default() };
    let mut solver = Solver::new(problem.layout(), settings);
    let mut seen = Vec::new();
    let observer = |iteration: Iteration| {
        assert_eq!(iteration.number, seen.len());
        seen.push(iteration.is_restoration);
        if !by_limit && iteration.number == most { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    };
    let solution = solver.solve_observed(&mut problem, Start::at(&[-2.0, 3.0, 1.0]), observer).unwrap();
    assert!(solution.point.iter().all(|entry| entry.is_finite()));
    let (status, error, point) = (solution.status, solution.error, solution.point.to_vec());
    // Slacks are those of this point: nothing is off by more than its functions.
    let mut values = Values::new(problem.layout());
    problem.evaluate(&point, &mut values).unwrap();
    let below = values.ranges.iter().map(|value| (-value).max(0.0));
    let most = values.equalities.iter().map(|c| c.abs()).chain(below).fold(0.0, f64::max);
    assert!(error.feasibility <= most + 1e-6, "{status:?} {error:?} {most}");
    (status, seen)
}

#[test]
fn restoration_is_seen_and_stops() {
    let (status, seen) = stopped_after(1000, true);
    assert_eq!(status, Status::Solved);
    let first = seen.windows(2).position(|pair| pair[0] && pair[1]).unwrap();
    for most in [first, first + 1] {
        for (by_limit, expected) in [(true, Status::IterationLimit), (false, Status::Stopped)] {
            let (status, seen) = stopped_after(most, by_limit);
            assert_eq!((status, seen.len()), (expected, most + 1), "{seen:?}");
            // At the limit the solver has left it.
            assert_eq!(seen[most], !by_limit);
        }
    }
}

#[test]
fn settings_out_of_their_ranges_are_named() {
    let wrong = |change: fn(&mut Settings)| {
        let small = Small { unknowns: 3, equations: 2, bounds: [ABOVE_ZERO; 2], of: Failure, scales: None };
        let (mut problem, mut settings) = (ByDuals::new(small), Settings::default());
        change(&mut settings);
        let mut solver = Solver::new(problem.layout(), settings);
        let message = solver.solve(&mut problem, &[-2.0, 3.0, 1.0]).unwrap_err().to_string();
        assert!(message.len() < 120, "{message}");
        message
    };
    let tolerance = wrong(|settings| settings.tolerance = f64::NAN);
    assert!(tolerance.starts_with("the setting tolerance is NaN, not between"), "{tolerance}");
    let change = wrong(|settings| settings.barrier.change[1] = 0.5);
    assert!(change.starts_with("the setting barrier.change[1] is 0.5"), "{change}");
    assert!(wrong(|settings| settings.regularisation.largest = 0.0).contains("regularisation.largest"));
}

/// `x^2 + 1 = 0`, and `y = 3` with `y <= 2`.
struct Contradiction(bool);

impl OfNode for Contradiction {
    fn of<D: Number>(&self, x: &[D]) -> Parts<D> {
        let equation = if self.0 { x[0] * x[0] + 1.0 } else { x[1] - 3.0 };
        Parts { cost: x[0] * x[0] + x[1] * x[1], equalities: vec![equation], ranges: vec![x[1]] }
    }
}

#[test]
fn what_has_no_solution_ends_at_the_least_violation() {
    for of_x in [true, false] {
        let small =
            Small { unknowns: 2, equations: 1, bounds: [[-2.0, 2.0]], of: Contradiction(of_x), scales: None };
        let mut problem = ByDuals::new(small);
        let mut solver = Solver::new(problem.layout(), Settings::default());
        let solution = solver.solve(&mut problem, &[1.5, 1.0]).unwrap();
        assert_eq!(solution.status, Status::LocallyInfeasible, "{of_x}: {solution:?}");
        // A point of the least sum of violations, x = 0 or y from 2 to 3, not that before.
        let [x, y] = [solution.point[0], solution.point[1]];
        let is_least = if of_x { x.abs() < 2e-3 } else { (1.998..3.002).contains(&y) };
        assert!(is_least && solution.error.feasibility > 0.4, "{of_x}: {solution:?}");
    }
}

/// `x = 0` and `x = 1`: the first step solves one of them, the next is zero.
struct Twofold;

impl OfNode for Twofold {
    fn of<D: Number>(&self, x: &[D]) -> Parts<D> {
        Parts { cost: x[0] * x[0], equalities: vec![x[0], x[0] - 1.0], ranges: Vec::new() }
    }
}

/// `0.005 x = 1` from 0: the way is long in units of x.
struct FarAway;

impl OfNode for FarAway {
    fn of<D: Number>(&self, x: &[D]) -> Parts<D> {
        Parts { cost: x[0] * x[0] * 1e-6, equalities: vec![(x[0] * 0.005).tanh() - 0.9], ranges: vec![x[0]] }
    }
}

#[test]
fn nothing_is_called_solved_that_is_not() {
    let mut problem =
        ByDuals::new(Small { unknowns: 1, equations: 2, bounds: [], of: Twofold, scales: None });
    let mut solver = Solver::new(problem.layout(), Settings::default());
    let solution = solver.solve(&mut problem, &[0.5]).unwrap();
    assert_eq!(solution.status, Status::LocallyInfeasible, "{solution:?}");
    let mut problem =
        ByDuals::new(Small { unknowns: 1, equations: 1, bounds: [[-1e4, 1e4]], of: FarAway, scales: None });
    let mut solver = Solver::new(problem.layout(), Settings::default());
    let solution = solver.solve(&mut problem, &[-900.0]).unwrap();
    assert_eq!(solution.status, Status::Solved, "{solution:?}");
    assert!((solution.point[0] - 200.0 * 0.9_f64.atanh()).abs() < 1e-5, "{solution:?}");
}

/// A stage without unknowns, and a program without any.
#[test]
fn stages_may_be_empty() {
    let layout = Layout::new(vec![0; 4], vec![2; 3], 0).with_rows(Element::Interval(1), Rows::new(1, 0));
    let mut problem = ByDuals::new(Squares(layout));
    let mut solver = Solver::new(problem.layout(), Settings::default());
    let solution = solver.solve(&mut problem, &[1.0; 6]).unwrap();
    assert_eq!(solution.status, Status::Solved);
    // The sum of squares with x + y = 1 on one interval.
    assert!((solution.cost - 0.5).abs() < 1e-12, "{solution:?}");
    assert_eq!(solver.certify(&mut problem).unwrap(), costate_nlp::Certificate::LocalMinimum);
    let mut problem = ByDuals::new(Squares(Layout::new(vec![0], Vec::new(), 0)));
    let mut solver = Solver::new(problem.layout(), Settings::default());
    assert_eq!(solver.solve(&mut problem, &[]).unwrap().status, Status::Solved);
}

/// Squares of all unknowns of intervals; the sum of those of interval 1 is 1.
struct Squares(Layout);

impl Functions for Squares {
    fn layout(&self) -> Layout {
        self.0.clone()
    }
    fn bounds(&self, _: Element) -> Vec<[f64; 2]> {
        Vec::new()
    }
    fn of<D: Number>(&self, element: Element, z: &[D]) -> Parts<D> {
        let mut parts = Parts::none();
        if let Element::Interval(k) = element {
            parts.cost = z.iter().fold(D::from(0.0), |sum, &x| sum + x * x);
            if k == 1 {
                parts.equalities.push(z[0] + z[1] - 1.0);
            }
        }
        parts
    }
}

/// Rosenbrock's function on a circle, the equation of which stands there twice.
struct Twice;

impl OfNode for Twice {
    fn of<D: Number>(&self, x: &[D]) -> Parts<D> {
        let (a, b) = (-x[0] + 1.0, x[1] - x[0] * x[0]);
        let circle = x[0] * x[0] + x[1] * x[1] - 1.0;
        Parts { cost: a * a + b * b * 100.0, equalities: vec![circle, circle * 3.0], ranges: Vec::new() }
    }
}

#[test]
fn equations_that_repeat_others_are_named() {
    let small = Small { unknowns: 2, equations: 2, bounds: [], of: Twice, scales: None };
    let mut problem = ByDuals::new(small);
    let mut solver = Solver::new(problem.layout(), Settings::default());
    let solution = solver.solve(&mut problem, &[0.5, 0.5]).unwrap();
    assert_eq!(solution.status, Status::Solved, "{solution:?}");
    assert_eq!(solution.dependent.len(), 1, "{solution:?}");
    // The minimum on the circle: x = 0.78641515, y = 0.61769831 by elimination of y.
    let [x, y] = [solution.point[0], solution.point[1]];
    assert!((x - 0.786_415_15).abs() < 1e-7 && (y - 0.617_698_31).abs() < 1e-7, "{x} {y}");
}

/// Hock and Schittkowski, "Test examples for nonlinear programming codes", problem 71.
struct Hs71;

impl OfNode for Hs71 {
    fn of<D: Number>(&self, x: &[D]) -> Parts<D> {
        let square = x.iter().fold(D::from(0.0), |sum, &x| sum + x * x);
        Parts {
            cost: x[0] * x[3] * (x[0] + x[1] + x[2]) + x[2],
            equalities: vec![square - 40.0],
            ranges: vec![x[0] * x[1] * x[2] * x[3], x[0], x[1], x[2], x[3]],
        }
    }
}

#[test]
fn problem_71_of_hock_and_schittkowski() {
    let box_of = [1.0, 5.0];
    let bounds = [[25.0, f64::INFINITY], box_of, box_of, box_of, box_of];
    let mut problem = ByDuals::new(Small { unknowns: 4, equations: 1, bounds, of: Hs71, scales: None });
    let mut solver = Solver::new(problem.layout(), Settings::default());
    let solution = solver.solve(&mut problem, &[1.0, 5.0, 5.0, 1.0]).unwrap();
    assert_eq!(solution.status, Status::Solved, "{solution:?}");
    assert!((solution.cost - 17.014_017_3).abs() < 1e-6, "{solution:?}");
    assert!(solution.iterations <= 12, "{solution:?}");
    // At its lower bound, and inside.
    assert!(solution.ranges[0] < -0.1 && solution.ranges[1] < -0.1 && solution.ranges[2].abs() < 1e-6);
}

/// `min 1e3 x` for `x >= 1e6 / 3`, beside `x + y = 3e6`.
struct Pushed;

impl OfNode for Pushed {
    fn of<D: Number>(&self, x: &[D]) -> Parts<D> {
        Parts { cost: x[0] * 1e3, equalities: vec![x[0] + x[1] - 3e6], ranges: vec![x[0]] }
    }
}

/// Slacks come far closer to their bound than any number beside it is, and from far away stay beside it.
#[test]
fn slacks_come_closer_to_bounds_than_rounding() {
    let least = 1e6 / 3.0;
    let bounds = [[least, f64::INFINITY]];
    let mut problem = ByDuals::new(Small { unknowns: 2, equations: 1, bounds, of: Pushed, scales: None });
    let mut solver = Solver::new(problem.layout(), Settings { tolerance: 1e-9, ..Settings::default() });
    for start in [[least, 2e6], [1e15, -1e15]] {
        let solution = solver.solve(&mut problem, &start).unwrap();
        assert_eq!(solution.status, Status::Solved);
        assert!(solution.iterations <= 32, "{}", solution.iterations);
        assert!((solution.point[0] - least).abs() < 1e-9, "{}", solution.point[0] - least);
        assert!((solution.ranges[0] + 1e3).abs() < 1e-6);
    }
}

/// Two angles with couplings of the kind that a two-link arm has, from rest to rest in too short a time:
/// `min h |u|^2 / 2` within limits of torques, rates and angles; unknowns (q, v) and u, steps of Euler's
/// method.
struct Hurried {
    intervals: usize,
    duration: f64,
}

impl Hurried {
    const ENDS: [[f64; 4]; 2] = [[0.0, 2.0, 0.0, 0.0], [1.5, -0.4, 0.0, 0.0]];
}

impl Functions for Hurried {
    fn layout(&self) -> Layout {
        let last = self.intervals;
        Layout::uniform(last, 4, 2, 0).with_rows_of(|element| match element {
            Element::Node(0) => Rows::new(4, 0),
            Element::Node(k) if k == last => Rows::new(4, 0),
            Element::Node(_) => Rows::new(0, 4),
            Element::Interval(_) => Rows::new(4, 2),
            Element::Ends => Rows::default(),
        })
    }

    fn bounds(&self, element: Element) -> Vec<[f64; 2]> {
        match element {
            Element::Node(k) if k > 0 && k < self.intervals => {
                vec![[-0.05, 3.0], [-0.5, 3.0], [-1.2, 1.2], [-1.5, 1.5]]
            }
            Element::Interval(_) => vec![[-1.0, 1.0]; 2],
            Element::Node(_) | Element::Ends => Vec::new(),
        }
    }

    fn of<D: Number>(&self, element: Element, z: &[D]) -> Parts<D> {
        let h = self.duration / self.intervals as f64;
        match element {
            Element::Node(k) if k == 0 || k == self.intervals => {
                let end = Self::ENDS[usize::from(k > 0)];
                let equalities = z.iter().zip(end).map(|(z, end)| *z - end).collect();
                Parts { equalities, ..Parts::none() }
            }
            Element::Node(_) => Parts { ranges: z.to_vec(), ..Parts::none() },
            Element::Interval(_) => {
                let [q, v, u, q_next, v_next] = [0, 2, 4, 6, 8].map(|at| [z[at], z[at + 1]]);
                // M(q) v' + c(q, v) = u of an arm with equal links.
                let (sine, cosine) = (q[1].sin(), q[1].cos());
                let (a, b, d) = (cosine + 5.0 / 3.0, cosine * 0.5 + 1.0 / 3.0, D::from(1.0 / 3.0));
                let pull = [(v[0] * v[1] * 2.0 + v[1] * v[1]) * sine * -0.5, v[0] * v[0] * sine * 0.5];
                let [f, g] = [u[0] - pull[0], u[1] - pull[1]];
                let determinant = a * d - b * b;
                let change = [(d * f - b * g) / determinant, (a * g - b * f) / determinant];
                Parts {
                    cost: (u[0] * u[0] + u[1] * u[1]) * (0.5 * h),
                    equalities: vec![
                        q_next[0] - q[0] - v[0] * h,
                        q_next[1] - q[1] - v[1] * h,
                        v_next[0] - v[0] - change[0] * h,
                        v_next[1] - v[1] - change[1] * h,
                    ],
                    ranges: u.to_vec(),
                }
            }
            Element::Ends => Parts::none(),
        }
    }
}

/// Multipliers grow where a program has no solution; the barrier must not follow them.
#[test]
fn motions_in_too_short_a_time_end_at_the_least_violation() {
    let mut problem = ByDuals::new(Hurried { intervals: 40, duration: 1.5 });
    let start: Vec<f64> = (0..=40)
        .flat_map(|k| {
            let along = f64::from(k) / 40.0;
            let [from, to] = Hurried::ENDS;
            let state = (0..4).map(move |i| from[i] + along * (to[i] - from[i]));
            state.chain((0..if k < 40 { 2 } else { 0 }).map(|_| 0.0))
        })
        .collect();
    for (largest, is_bounded) in [(1e3, true), (f64::MAX, false)] {
        let mut settings = Settings::default();
        settings.barrier.largest = largest;
        let mut solver = Solver::new(problem.layout(), settings);
        let mut most: f64 = 0.0;
        let observer = |iteration: Iteration| {
            most = most.max(iteration.mu);
            ControlFlow::Continue(())
        };
        let solution = solver.solve_observed(&mut problem, Start::at(&start), observer).unwrap();
        assert_eq!(solution.status, Status::LocallyInfeasible);
        assert!((solution.error.feasibility - 0.461).abs() < 1e-3, "{}", solution.error.feasibility);
        assert!(solution.iterations < 300 && (most <= 1e3 * settings.barrier.start) == is_bounded, "{most}");
    }
}
