//! Independent checks of the solver: optimality by dual numbers, defects by a separate integrator, the log by
//! theory.

use crate::curvature::Curvature;
use crate::motions::{Motion, RobotProblem};
use crate::problem::{Bounds, Problem};
use crate::reach::solve_or_explain;
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
    assert_eq!(solution.status, Status::Solved, "{}", crate::table::iterations(&solution.log));
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
            let [lower, upper] = [0, 1].map(|side| solution.barrier.sides[side].multipliers[k][i]);
            assert!((slope - lower + upper).abs() < 1e-10, "node {k}, component {i}: {slope:e}");
        }
    }

    // Signs and complementarity; the bounds hold strictly, and some hold the motion back.
    let mut active = [0, 0];
    for k in 0..problem.intervals {
        let bounds = problem.bounds(k);
        for (i, z) in solution.nodes[k].iter().enumerate() {
            for (side, distance) in [z - bounds.lower[i], bounds.upper[i] - z].into_iter().enumerate() {
                let multiplier = solution.barrier.sides[side].multipliers[k][i];
                assert!(distance > 0.0 && multiplier >= 0.0);
                assert!(distance.is_infinite() || distance * multiplier <= 1.0e-10);
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
    let errors: Vec<f64> = log.iter().map(Row::barrier_error).collect();
    let from = errors.iter().rposition(|&e| e > 0.03).unwrap() + 1;
    assert!(errors.len() - from >= 4, "{errors:?}");
    for pair in errors[from..].windows(2) {
        assert!(pair[1] <= factor * pair[0] * pair[0] + 1e-12, "{errors:?}");
    }
    assert!(log.iter().all(|row| row.convexified == 0.0));
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
    for triple in errors[errors.len() - 6..].windows(3) {
        let [before, after] = [triple[1] / triple[0], triple[2] / triple[1]];
        assert!(after > 0.05 && after < 0.5 && (after / before - 1.0).abs() < 0.2, "{errors:?}");
    }
    assert!(approximate.iterations() >= exact.iterations() + 5);
}

#[test]
fn so_it_does_with_bounds_at_a_fixed_barrier() {
    let mut problem = Motion::two_link().unwrap().in_rates();
    let barrier = 1e-2;
    let options = Options { barrier, least_barrier: barrier, ..Options::new(Curvature::Exact) };
    let exact = solved(&mut problem, &options);
    assert_quadratic(&exact.log, 50.0);
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
        assert!(node.iter().skip(n).zip(&motion.rates).all(|(v, limit)| v.abs() < *limit));
        assert!(node.iter().skip(2 * n).zip(&motion.effort).all(|(u, limit)| u.abs() < *limit));
    }
    solved(&mut motion.in_momenta(), &exact);
}

#[test]
fn an_end_out_of_reach_is_said_to_be_so() {
    let motion = Motion { duration: 1.5, ..Motion::two_link().unwrap() };
    let mut problem = motion.in_momenta();
    let guess = problem.straight_line(&[0.0; 2]);
    for curvature in [Curvature::Exact, Curvature::CostOnly] {
        let solution = solve_or_explain(&mut problem, &guess, &Options::new(curvature));
        let Status::Infeasible { distance } = solution.status else { panic!("{:?}", solution.status) };
        assert!(distance > 0.1);
    }
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
        assert_eq!((solution.status, solution.log.len()), (Status::Solved, 2));
        assert!(solution.log[1].error() < 1e-12);
    }
}
