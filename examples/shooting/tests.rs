//! Independent checks of the solver: optimality by dual numbers, defects by a separate integrator, the log by
//! theory.

use crate::curvature::Curvature;
use crate::motions::{Motion, RobotProblem};
use crate::problem::{Bounds, Problem};
use crate::solver::{Options, Row, Solution, Status, solve};
use costate::derivative::Function;
use costate::dynamics::{Automatic, Cost, Dynamics, QuadraticCost};
use costate::lagrangian::LagrangianSecondOrder;
use costate::num_dual::Dual64;
use costate::scalar::Scalar;
use costate::step::{RungeKutta4, Step};
use nalgebra::DVector;
use std::convert::Infallible;

fn solved<D: Dynamics<f64>>(problem: &mut RobotProblem<D>, options: &Options) -> Solution {
    let guess = problem.straight_line(&vec![0.0; problem.controls()]);
    let solution = solve(problem, &guess, options);
    assert_eq!(solution.status, Status::Solved, "{}", crate::compare::iterations(&solution.log));
    solution
}

/// `sum h l + sum y'(Phi - x_next)` of nodes one after the other, over dual numbers.
fn lagrangian(motion: &Motion, nodes: &[Vec<Dual64>], costates: &[DVector<f64>]) -> Dual64 {
    let h = Dual64::from_f64(motion.duration / motion.intervals as f64);
    let mut step = RungeKutta4::<Dual64, _>::new(LagrangianSecondOrder::<Dual64>::new(&motion.robot));
    let weights: Vec<f64> = motion.unit.iter().map(|unit| unit.powi(-2)).collect();
    let n = 2 * weights.len();
    let mut cost = QuadraticCost::<Dual64>::running(&vec![0.0; n], &weights);
    let mut sum = Dual64::from_f64(0.0);
    for (pair, costate) in nodes.windows(2).zip(costates) {
        let (x, u) = pair[0].split_at(n);
        sum += h * cost.evaluate(x, u).unwrap();
        let next = step.evaluate(x, u, h).unwrap();
        for i in 0..n {
            sum += Dual64::from_f64(costate[i]) * (next[i] - pair[1][i]);
        }
    }
    sum
}

#[test]
fn the_conditions_of_optimality_hold_by_independent_means() {
    let motion = Motion::two_link().unwrap();
    let mut problem = motion.in_rates();
    let solution = solved(&mut problem, &Options::new(Curvature::Exact));
    let n = problem.states();

    // Stationarity: every derivative of the Lagrangian by a dual number, compared with the multipliers of the
    // bounds.
    let mut nodes: Vec<Vec<Dual64>> =
        solution.nodes.iter().map(|node| node.iter().map(|&z| Dual64::from_f64(z)).collect()).collect();
    for k in 0..problem.intervals {
        for i in (if k == 0 { n } else { 0 })..nodes[k].len() {
            nodes[k][i].eps = 1.0;
            let slope = lagrangian(&motion, &nodes, &solution.costates).eps;
            nodes[k][i].eps = 0.0;
            let multiplier = solution.multipliers[k][i];
            assert!((slope + multiplier).abs() < 1e-10, "node {k}, component {i}: {slope:e}");
        }
    }

    // Complementarity; the bounds are kept, and some hold the motion back.
    let mut active = [0, 0];
    for k in 0..problem.intervals {
        let bounds = problem.state_bounds.clone().then(&problem.control_bounds);
        for i in (if k == 0 { n } else { 0 })..solution.nodes[k].len() {
            let (z, multiplier) = (solution.nodes[k][i], solution.multipliers[k][i]);
            let sides = [(z - bounds.lower[i], -multiplier), (bounds.upper[i] - z, multiplier)];
            for (distance, multiplier) in sides {
                assert!(distance > -1e-10);
                assert!(distance.is_infinite() || distance * multiplier <= 1.1e-10);
                active[usize::from(i >= n)] += usize::from(multiplier > 1e-4);
            }
        }
    }
    assert!(active[0] > 3 && active[1] > 3, "active bounds on states and controls: {active:?}");

    // Defects: the classical scheme, written out, from start to end.
    let mut model = LagrangianSecondOrder::<f64>::new(&motion.robot);
    let mut x = problem.start.clone();
    for node in &solution.nodes[..problem.intervals] {
        let u = &node.as_slice()[n..];
        let mut slopes = vec![vec![0.0; n]];
        for part in [0.0, 0.5, 0.5, 1.0] {
            let at: Vec<f64> =
                x.iter().zip(slopes.last().unwrap()).map(|(x, f)| x + part * problem.h * f).collect();
            slopes.push(model.evaluate(&at, u).unwrap().to_vec());
        }
        for (i, x) in x.iter_mut().enumerate() {
            *x += problem.h / 6.0 * (slopes[1][i] + 2.0 * slopes[2][i] + 2.0 * slopes[3][i] + slopes[4][i]);
        }
    }
    for (reached, wanted) in x.iter().zip(problem.end.as_ref().unwrap()) {
        assert!((reached - wanted).abs() < 1e-9, "{reached} for {wanted}");
    }
}

/// Newton's method squares the error once it is small, down to rounding.
fn assert_quadratic(log: &[Row], factor: f64) {
    let errors: Vec<f64> = log.iter().map(Row::error).collect();
    let from = errors.iter().rposition(|&e| e > 0.03).unwrap() + 1;
    assert!(errors.len() - from >= 3, "{errors:?}");
    for pair in errors[from..].windows(2) {
        assert!(pair[1] <= factor * pair[0] * pair[0] + 1e-12, "{errors:?}");
    }
    assert!(log.iter().all(|row| row.added == 0.0));
}

#[test]
fn the_exact_hessian_converges_quadratically_and_gauss_newton_linearly() {
    let motion = Motion::two_link().unwrap();
    let mut problem = motion.in_rates().without_bounds();
    let exact = solved(&mut problem, &Options::new(Curvature::Exact));
    assert_quadratic(&exact.log, 2.0);
    assert!(exact.iterations() <= 7);

    let approximate = solved(&mut problem, &Options::new(Curvature::CostOnly));
    let errors: Vec<f64> = approximate.log.iter().map(Row::error).collect();
    // The last errors are those of steps that are solved to six digits.
    for triple in errors[errors.len() - 8..errors.len() - 2].windows(3) {
        let [before, after] = [triple[1] / triple[0], triple[2] / triple[1]];
        assert!(after > 0.05 && after < 0.5 && (after / before - 1.0).abs() < 0.2, "{errors:?}");
    }
    assert!(approximate.iterations() >= exact.iterations() + 5);

    // With bounds that the motion touches: faster than linearly.
    let bounded = solved(&mut motion.in_rates(), &Options::new(Curvature::Exact));
    assert!(crate::compare::last_ratio(&bounded.log).unwrap() < 0.02);
    let barrier = [1e-2; 2];
    let fixed = solved(&mut motion.in_rates(), &Options { barrier, ..Options::new(Curvature::Exact) });
    assert_quadratic(&fixed.log, 50.0);
}

#[test]
fn every_kind_of_hessian_finds_the_same_motion() {
    let mut problem = Motion::two_link().unwrap().in_momenta();
    let exact = solved(&mut problem, &Options::new(Curvature::Exact));
    for curvature in [Curvature::CostOnly, Curvature::Bfgs] {
        let other = solved(&mut problem, &Options::new(curvature));
        for (a, b) in exact.nodes.iter().zip(&other.nodes) {
            assert!((a - b).amax() < 1e-6);
        }
        assert!(other.iterations() > exact.iterations());
    }
}

#[test]
fn a_larger_robot_is_solved_in_both_coordinates() {
    let motion = Motion::ur5().unwrap();
    let exact = Options::new(Curvature::Exact);
    let rates = solved(&mut motion.in_rates(), &exact);
    let n = motion.rates.len();
    for node in &rates.nodes {
        assert!(node.iter().skip(n).zip(&motion.rates).all(|(v, limit)| v.abs() < limit + 1e-10));
        assert!(node.iter().skip(2 * n).zip(&motion.effort).all(|(u, limit)| u.abs() < limit + 1e-10));
    }
    solved(&mut motion.in_momenta(), &exact);
}

#[test]
fn an_end_out_of_reach_is_said_to_be_so() {
    let motion = Motion { duration: 1.5, ..Motion::two_link().unwrap() };
    fn defect<D: Dynamics<f64>>(mut problem: RobotProblem<D>) -> f64 {
        let guess = problem.straight_line(&[0.0; 2]);
        let solution = solve(&mut problem, &guess, &Options::new(Curvature::Exact));
        let Status::Infeasible { defect } = solution.status else { panic!("{:?}", solution.status) };
        defect
    }
    assert!(defect(motion.in_momenta()) > 0.1 && defect(motion.in_rates()) > 0.1);
}

#[test]
fn other_ends_are_statuses_too() {
    let mut problem = Motion::two_link().unwrap().in_rates();
    let mut guess = problem.straight_line(&[0.0; 2]);
    let hasty = Options { iterations: 2, ..Options::new(Curvature::Exact) };
    assert_eq!(solve(&mut problem, &guess, &hasty).status, Status::IterationLimit);
    guess[3][0] = f64::NAN;
    let solution = solve(&mut problem, &guess, &hasty);
    assert!(matches!(solution.status, Status::NotEvaluated(_)), "{:?}", solution.status);
}

/// A mass pushed by a force, with a spring: linear.
#[derive(Clone)]
struct Mass;

impl Function for Mass {
    type Workspace<S: Scalar> = ();
    type Error = Infallible;

    fn inputs(&self) -> usize {
        3
    }

    fn outputs(&self) -> usize {
        2
    }

    fn workspace<S: Scalar>(&self) {}

    fn evaluate<S: Scalar>(&self, _: &mut (), z: &[S], f: &mut [S]) -> Result<(), Infallible> {
        f[0] = z[1];
        f[1] = z[2] - z[0].times(0.5);
        Ok(())
    }
}

#[test]
fn a_linear_quadratic_problem_takes_one_step() {
    for end in [None, Some(vec![1.0, 0.0])] {
        let mut problem = Problem {
            step: RungeKutta4::<f64, _>::new(Automatic::<Mass>::new(Mass)),
            running: QuadraticCost::running(&[1.0, 0.0], &[0.1]).about(&[0.5, 0.0], &[0.2]),
            terminal: QuadraticCost::terminal(&[3.0, 1.0]).about(&[1.0, 0.0], &[]),
            intervals: 20,
            h: 0.1,
            start: vec![-1.0, 0.3],
            end,
            state_bounds: Bounds::none(2),
            control_bounds: Bounds::none(1),
        };
        let guess = problem.straight_line(&[0.7]);
        let solution = solve(&mut problem, &guess, &Options::new(Curvature::Exact));
        assert_eq!((&solution.status, solution.iterations()), (&Status::Solved, 1));
    }
}

/// The free end and the states before it stay below a bound that holds them back, of one interval too.
#[test]
fn a_free_end_has_bounds_on_one_side() {
    for intervals in [1, 20] {
        let mut problem = Problem {
            step: RungeKutta4::<f64, _>::new(Automatic::<Mass>::new(Mass)),
            running: QuadraticCost::running(&[0.0, 0.0], &[0.1]),
            terminal: QuadraticCost::terminal(&[30.0, 1.0]).about(&[1.0, 0.0], &[]),
            intervals,
            h: 2.0 / intervals as f64,
            start: vec![-1.0, 0.3],
            end: None,
            state_bounds: Bounds { lower: vec![f64::NEG_INFINITY; 2], upper: vec![0.5, f64::INFINITY] },
            control_bounds: Bounds { lower: vec![-50.0], upper: vec![f64::INFINITY] },
        };
        let guess = problem.straight_line(&[0.7]);
        let solution = solve(&mut problem, &guess, &Options::new(Curvature::Exact));
        assert_eq!(solution.status, Status::Solved);
        let (end, multipliers) = (&solution.nodes[intervals], &solution.multipliers[intervals]);
        assert!((end[0] - 0.5).abs() < 1e-8 && multipliers[0] > 1.0 && multipliers[1] == 0.0, "{end}");
        // The slope of the terminal cost, less the costate and with the multiplier of the bound.
        let slope = [30.0 * (end[0] - 1.0) + multipliers[0], end[1]];
        let costate = &solution.costates[intervals - 1];
        assert!((0..2).all(|i| (slope[i] - costate[i]).abs() < 1e-8), "{slope:?} {costate}");
    }
}
