//! Certificates, refined solutions and their derivatives.

use super::by_duals::{ByDuals, Number, Parts};
use super::hard::{OfNode, Small};
use costate_nlp::{
    Certificate, Changes, Held, Layout, Scales, Settings, Solver, StagedProblem, Start, Status,
};

/// Hock and Schittkowski 71 with parameters: the sum of squares, and the least product.
struct Hs71 {
    square: f64,
}

impl OfNode for Hs71 {
    fn of<D: Number>(&self, x: &[D]) -> Parts<D> {
        let square = x.iter().fold(D::from(0.0), |sum, &x| sum + x * x);
        Parts {
            cost: x[0] * x[3] * (x[0] + x[1] + x[2]) + x[2],
            equalities: vec![square - self.square],
            ranges: vec![x[0] * x[1] * x[2] * x[3], x[0], x[1], x[2], x[3]],
        }
    }
}

fn hs71(square: f64, product: f64, scales: Option<Scales>) -> ByDuals<Small<Hs71, 5>> {
    let inside = [1.0, 5.0];
    let bounds = [[product, f64::INFINITY], inside, inside, inside, inside];
    ByDuals::new(Small { unknowns: 4, equations: 1, bounds, of: Hs71 { square }, scales })
}

fn refined(square: f64, product: f64) -> Vec<f64> {
    let mut problem = hs71(square, product, None);
    let mut solver = Solver::new(problem.layout(), Settings::default());
    assert_eq!(solver.solve(&mut problem, &[1.0, 5.0, 5.0, 1.0]).unwrap().status, Status::Solved);
    let error = solver.refine(&mut problem, 1e-13).unwrap();
    assert!(error.largest() < 1e-12, "{error:?}");
    solver.point().to_vec()
}

#[test]
fn derivatives_of_a_solution_are_those_of_refined_neighbours() {
    let scales = Scales {
        cost: 20.0,
        steps: vec![3.0, 1.0, 0.5, 2.0],
        equalities: vec![40.0],
        ranges: vec![25.0, 1.0, 2.0, 3.0, 4.0],
    };
    for scales in [None, Some(scales)] {
        let mut problem = hs71(40.0, 25.0, scales);
        let mut solver = Solver::new(problem.layout(), Settings::default());
        solver.solve(&mut problem, &[1.0, 5.0, 5.0, 1.0]).unwrap();
        assert_eq!(solver.certify(&mut problem).unwrap(), Certificate::LocalMinimum);
        assert_eq!(solver.held(), [Held::Lower, Held::Lower, Held::Free, Held::Free, Held::Free]);
        solver.refine(&mut problem, 1e-13).unwrap();
        // c = x'x - square, and the bound of the product.
        let mut rates = [Changes::zeros(problem.layout()), Changes::zeros(problem.layout())];
        rates[0].equalities[0] = -1.0;
        rates[1].ranges[0] = -1.0;
        let step = 1e-4;
        let differences = [
            [refined(40.0 + step, 25.0), refined(40.0 - step, 25.0)],
            [refined(40.0, 25.0 + step), refined(40.0, 25.0 - step)],
        ];
        for (rates, [above, below]) in rates.iter().zip(&differences) {
            let changes = solver.respond(&problem, rates).unwrap();
            for (k, change) in changes.x.iter().enumerate() {
                // The third derivative times h^2 / 6, and rounding 1e-13 / h.
                let difference = (above[k] - below[k]) / (2.0 * step);
                assert!((change - difference).abs() < 1e-7, "{k}: {change} {difference}");
            }
        }
        // Backward: the derivatives of x_3 + 2 x_2 by both parameters from one solution.
        let mut gradient = Changes::zeros(problem.layout());
        (gradient.x[2], gradient.x[1]) = (1.0, 2.0);
        let adjoint = solver.respond(&problem, &gradient).unwrap();
        for rates in &rates {
            let changes = solver.respond(&problem, rates).unwrap();
            let forward = changes.x[2] + 2.0 * changes.x[1];
            let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
            let backward = product(&adjoint.x, &rates.x)
                + product(&adjoint.equalities, &rates.equalities)
                + product(&adjoint.ranges, &rates.ranges);
            assert!((forward - backward).abs() < 1e-10, "{forward} {backward}");
        }
    }
}

/// `x^2 - y^2` with a range of y.
struct Saddle;

impl OfNode for Saddle {
    fn of<D: Number>(&self, x: &[D]) -> Parts<D> {
        Parts { cost: x[0] * x[0] - x[1] * x[1], equalities: Vec::new(), ranges: vec![x[1]] }
    }
}

/// `min x^2` beside y, which nothing depends on.
struct Valley;

impl OfNode for Valley {
    fn of<D: Number>(&self, x: &[D]) -> Parts<D> {
        Parts { cost: x[0] * x[0] + x[1] * 0.0, equalities: vec![], ranges: vec![x[0], x[1]] }
    }
}

/// Without equations, and without a range that is held.
#[test]
fn a_valley_is_undecided_and_has_finite_derivatives() {
    let bounds = [[-1.0, 1.0]; 2];
    let mut problem = ByDuals::new(Small { unknowns: 2, equations: 0, bounds, of: Valley, scales: None });
    let mut solver = Solver::new(problem.layout(), Settings::default());
    assert_eq!(solver.solve(&mut problem, &[0.3, 0.2]).unwrap().status, Status::Solved);
    assert_eq!(solver.certify(&mut problem).unwrap(), Certificate::Undecided);
    let mut rates = Changes::zeros(problem.layout());
    rates.x.copy_from_slice(&[1.0, 1.0]);
    assert_eq!(solver.respond(&problem, &rates).unwrap().x, [-0.5, 0.0]);
}

/// `min w (x^2 + y^2)` for `x = y`.
struct Rounding(f64);

impl OfNode for Rounding {
    fn of<D: Number>(&self, x: &[D]) -> Parts<D> {
        let cost = (x[0] * x[0] + x[1] * x[1]) * self.0;
        Parts { cost, equalities: vec![x[0] - x[1]], ranges: vec![] }
    }
}

/// Curvature as small as the rounding of functions of size 1 decides nothing.
#[test]
fn rounding_is_no_curvature() {
    let expected = [(1e-14, Certificate::Undecided), (-1e-14, Certificate::Undecided)];
    for (w, expected) in [&expected[..], &[(1e-6, Certificate::LocalMinimum)]].concat() {
        let small = Small { unknowns: 2, equations: 1, bounds: [], of: Rounding(w), scales: None };
        let mut problem = ByDuals::new(small);
        let mut solver = Solver::new(problem.layout(), Settings::default());
        solver.solve(&mut problem, &[0.0, 0.0]).unwrap();
        assert_eq!(solver.certify(&mut problem).unwrap(), expected, "{w}");
    }
}

#[test]
fn saddles_and_ranges_without_multipliers_are_no_certified_minima() {
    let solved = |range: [f64; 2], start: [f64; 2]| {
        let mut problem =
            ByDuals::new(Small { unknowns: 2, equations: 0, bounds: [range], of: Saddle, scales: None });
        let mut solver = Solver::new(problem.layout(), Settings::default());
        let solution = solver.solve(&mut problem, &start).unwrap();
        let (status, y) = (solution.status, solution.point[1]);
        (status, y, solver.certify(&mut problem).unwrap())
    };
    // The central path of a symmetric range goes through the saddle.
    let (status, y, certificate) = solved([-1e6, 1e6], [0.3, 0.0]);
    assert_eq!((status, certificate), (Status::Solved, Certificate::NotMinimum), "y = {y}");
    // A range without interior holds y where its multiplier is zero.
    let (status, y, certificate) = solved([0.0, 0.0], [0.3, 0.0]);
    assert_eq!((status, certificate), (Status::Solved, Certificate::Undecided), "y = {y}");
    let (status, y, certificate) = solved([-1.0, 2.0], [0.3, 0.1]);
    assert_eq!((status, certificate), (Status::Solved, Certificate::LocalMinimum), "y = {y}");
    assert!((y - 2.0).abs() < 1e-6, "{y}");
}

/// A solution that is asked after each iteration goes the same way, to the bit.
#[test]
fn promises_change_nothing_and_tell_minima_from_saddles() {
    let small = |bounds: [f64; 2]| {
        ByDuals::new(Small { unknowns: 2, equations: 0, bounds: [bounds], of: Saddle, scales: None })
    };
    let mut problem = small([-1.0, 2.0]);
    let mut solvers = [(); 2].map(|()| Solver::new(problem.layout(), Settings::default()));
    let mut ended =
        solvers.each_mut().map(|solver| solver.begin(&mut problem, Start::at(&[0.3, 0.1])).unwrap());
    let (mut regularised, mut steps) = (0, 0);
    while ended[0].is_none() {
        let promise = solvers[1].promise(&mut problem).unwrap().unwrap();
        regularised += usize::from(!promise.is_exact);
        steps += 1;
        for (solver, ended) in solvers.iter_mut().zip(&mut ended) {
            *ended = solver.advance(&mut problem).unwrap();
        }
        assert_eq!(solvers[1].iteration(), solvers[0].iteration());
        assert_eq!(solvers[1].point(), solvers[0].point());
    }
    assert!(ended == [Some(Status::Solved); 2] && regularised > 0 && steps > regularised);
    let promise = solvers[1].promise(&mut problem).unwrap().unwrap();
    assert!(promise.is_exact && promise.decrement.abs() < 1e-8, "{promise:?}");
    // At the saddle of a symmetric range.
    let mut problem = small([-1e6, 1e6]);
    let solver = &mut solvers[0];
    solver.solve(&mut problem, &[0.3, 0.0]).unwrap();
    assert!(!solver.promise(&mut problem).unwrap().unwrap().is_exact);
    assert_eq!(solver.certify(&mut problem).unwrap(), Certificate::NotMinimum);
}

#[test]
fn what_is_known_of_one_solution_is_not_said_of_another() {
    let mut problem = hs71(40.0, 25.0, None);
    let mut solver = Solver::new(problem.layout(), Settings::default());
    let rates = Changes { equalities: vec![-1.0], ..Changes::zeros(problem.layout()) };
    let start = [1.0, 5.0, 5.0, 1.0];
    solver.solve(&mut problem, &start).unwrap();
    assert!(solver.held().is_empty() && solver.respond(&problem, &rates).is_none());
    assert_eq!(solver.certify(&mut problem).unwrap(), Certificate::LocalMinimum);
    assert!(solver.held().len() == 5 && solver.respond(&problem, &rates).is_some());
    let short = Changes { equalities: Vec::new(), ..rates.clone() };
    assert_eq!(solver.respond(&problem, &short), None);
    // Far from a solution nothing is factored.
    solver.settings_mut().iterations = 1;
    assert_eq!(solver.solve(&mut problem, &start).unwrap().status, Status::IterationLimit);
    assert!(solver.held().is_empty() && solver.respond(&problem, &rates).is_none());
    assert_eq!(solver.certify(&mut problem).unwrap(), Certificate::NotStationary);
    assert!(solver.held().len() == 5 && solver.respond(&problem, &rates).is_none());
}

#[test]
fn wrong_arguments_are_named() {
    let mut problem = hs71(40.0, 25.0, None);
    let mut solver = Solver::new(problem.layout(), Settings::default());
    let error = solver.solve(&mut problem, &[1.0; 3]).unwrap_err().to_string();
    assert_eq!(error, "the start has 3 entries, not 4");
    let error = solver.solve(&mut problem, &[f64::NAN; 4]).unwrap_err().to_string();
    assert_eq!(error, "the cost is not finite at the start");
    let mut other = Solver::new(&Layout::uniform(2, 1, 1, 0), Settings::default());
    assert!(other.solve(&mut problem, &[1.0; 4]).unwrap_err().to_string().contains("another layout"));
    let mut empty = hs71(40.0, f64::NAN, None);
    assert!(solver.solve(&mut empty, &[1.0; 4]).unwrap_err().to_string().contains("range 0 is empty"));
    let scales = Scales { steps: vec![1.0, 0.0, 1.0, 1.0], ..Scales::ones(problem.layout()) };
    let mut scaled = hs71(40.0, 25.0, Some(scales));
    let error = solver.solve(&mut scaled, &[1.0; 4]).unwrap_err().to_string();
    assert_eq!(error, "scale 1 of steps is 0: sizes are positive");
}
