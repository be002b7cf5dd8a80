//! User terms of the running cost, generic over the scalar.

use crate::{sharp, sledge};
use costate::derivative::Function;
use costate::dynamics::{AutomaticCost, Cost};
use costate::robot::Robot;
use costate::scalar::Scalar;
use costate_control::{
    BoundaryValueProblem, ControlLaw, FinalTime, JacobianRoute, Problem, RobotExtremal, RunningCost,
    Solution, Solver, UserTerm,
};
use std::convert::Infallible;

/// `1/2 (q^2 + v^2)`.
struct Quadratic;

impl RunningCost for Quadratic {
    fn evaluate<S: Scalar>(&self, q: &[S], v: &[S]) -> S {
        q.iter().chain(v).fold(S::zero(), |sum, &z| sum + z * z).times(0.5)
    }
}

/// Couples all positions and rates: a hill with a cost that grows with the speed.
#[derive(Clone)]
struct Hill;

impl RunningCost for Hill {
    fn evaluate<S: Scalar>(&self, q: &[S], v: &[S]) -> S {
        let (mut sum, mut speed) = (S::zero(), S::one());
        for (i, (&q, &v)) in q.iter().zip(v).enumerate() {
            sum += q.times(1.0 + 0.3 * i as f64).sin_cos().0;
            speed += (v - q.times(0.2)) * v;
        }
        (-(sum * sum)).exp() * speed * speed.plus(3.0)
    }
}

fn solve(problem: &Problem) -> Solution {
    let solution = Solver::new(problem, sharp()).unwrap().solve();
    assert!(solution.motion.status.is_converged(), "{}", solution.motion.status);
    assert!(solution.motion.hamiltonian_drift < 1e-8, "drift {}", solution.motion.hamiltonian_drift);
    assert!(solution.end_defect < 1e-7, "end defect {}", solution.end_defect);
    solution
}

/// Cost of the double integrator from 0 to a in the time T, rest to rest, with `l = 1/2 (x^2 + v^2 + u^2)`.
///
/// Its extremals obey `x'''' - x'' + x = 0`: four solutions `e^{±αt} cos βt`, `e^{±αt} sin βt` with α + iβ =
/// e^{iπ/6}, four conditions at the ends. Along them 2 l is the rate of `x'' x' - x''' x + x' x`.
fn linear_quadratic_cost(a: f64, time: f64) -> f64 {
    let (alpha, beta) = (0.75_f64.sqrt(), 0.5_f64);
    // Derivatives of e^{st}: complex powers of s; real and imaginary part are two solutions.
    let value = |k: usize, order: i32, t: f64| {
        let sign = if k < 2 { 1.0 } else { -1.0 };
        let angle = beta.atan2(sign * alpha) * f64::from(order) + beta * t;
        let size = (sign * alpha * t).exp();
        if k.is_multiple_of(2) { size * angle.cos() } else { size * angle.sin() }
    };
    let rows = [(0, 0.0), (1, 0.0), (0, time), (1, time)];
    let matrix = nalgebra::Matrix4::from_fn(|i, k| value(k, rows[i].0, rows[i].1));
    let c = matrix.lu().solve(&nalgebra::Vector4::new(0.0, 0.0, a, 0.0)).unwrap();
    let x = |order: i32, t: f64| (0..4).map(|k| c[k] * value(k, order, t)).sum::<f64>();
    let boundary = |t: f64| x(2, t) * x(1, t) - x(3, t) * x(0, t) + x(1, t) * x(0, t);
    0.5 * (boundary(time) - boundary(0.0))
}

#[test]
fn a_linear_quadratic_problem_has_its_closed_form_cost() {
    for (to, time) in [(1.0, 1.0), (0.7, 3.0)] {
        let mut problem = Problem::rest_to_rest(sledge(), &[0.0], &[to], time);
        problem.terms = vec![UserTerm::new(Quadratic)];
        let (solution, expected) = (solve(&problem), linear_quadratic_cost(to, time));
        assert!((solution.motion.cost - expected).abs() < 1e-9, "{} {expected}", solution.motion.cost);
        assert_eq!(solution.motion.penalty_cost, 0.0);
    }
}

/// A term as a function of (q, v) for the automatic costs of the library.
#[derive(Clone)]
struct AsFunction(usize);

impl Function for AsFunction {
    type Workspace<S: Scalar> = ();
    type Error = Infallible;
    fn inputs(&self) -> usize {
        2 * self.0
    }
    fn outputs(&self) -> usize {
        1
    }
    fn workspace<S: Scalar>(&self) {}
    fn evaluate<S: Scalar>(&self, _: &mut (), z: &[S], l: &mut [S]) -> Result<(), Infallible> {
        l[0] = Hill.evaluate(&z[..self.0], &z[self.0..]);
        Ok(())
    }
}

fn problems() -> Vec<Problem> {
    let files = [
        "../robots/two_link.toml",
        "../robots/cart_pole.toml",
        "../robots/manutec_r3.toml",
        "../robots/puma560.toml",
    ];
    let problem = |file: &&str| {
        let robot = Robot::from_file(file).unwrap();
        let n = robot.dof();
        let mut problem = Problem::rest_to_rest(robot, &vec![0.0; n], &vec![0.7; n], 1.0);
        problem.terms = vec![UserTerm::new(Hill), UserTerm::new(Quadratic)];
        problem
    };
    files.iter().map(problem).collect()
}

fn point(n: usize, random: &mut fastrand::Rng) -> Vec<f64> {
    (0..4 * n).map(|_| 2.0 * random.f64() - 1.0).collect()
}

/// The gradient in (q, p) against hyper-dual numbers of num-dual.
#[test]
fn costates_change_by_the_gradient_of_the_running_cost() {
    let mut random = fastrand::Rng::with_seed(11);
    for problem in problems() {
        let n = problem.robot.dof();
        let mut plain = problem.clone();
        plain.terms.clear();
        let one = plain.clone().with_term(UserTerm::new(Hill));
        let z = point(n, &mut random);
        let at = |problem: &Problem| {
            let mut extremal = RobotExtremal::new(problem.check().unwrap(), JacobianRoute::Exact).unwrap();
            let mut g = vec![0.0; 4 * n];
            let rate = extremal.evaluate(&z, ControlLaw::Maximal, &mut g).unwrap();
            (g, rate)
        };
        let ((with, rate), (without, other)) = (at(&one), at(&plain));
        let mut hamiltonian = costate::hamiltonian::Hamiltonian::<f64>::new(&problem.robot);
        let (q, p) = z[..2 * n].split_at(n);
        let v = hamiltonian.velocity(q, p).unwrap().to_vec();
        let mut judge: AutomaticCost<_> = AutomaticCost::running(AsFunction(n), 2 * n);
        let gradient = judge.gradient(&[q, &v].concat(), &[]).unwrap();
        assert!((rate.cost - other.cost - gradient.value).abs() < 1e-12 * gradient.value);
        let (l_q, l_v) = gradient.x.split_at(n);
        let map = hamiltonian.linearise_velocity(q, p).unwrap();
        let size = with.iter().fold(1.0_f64, |size, g| size.max(g.abs()));
        for i in 0..n {
            let along =
                |block: costate::matrix::Block<'_, f64>| (0..n).map(|k| block[(k, i)] * l_v[k]).sum::<f64>();
            let (l_x_q, l_x_p) = (l_q[i] + along(map.dv_dq), along(map.dv_dp));
            assert!((with[2 * n + i] - without[2 * n + i] - l_x_q).abs() < 1e-12 * size);
            assert!((with[3 * n + i] - without[3 * n + i] - l_x_p).abs() < 1e-12 * size);
        }
    }
}

#[test]
fn the_jacobian_with_user_terms_agrees_with_differences() {
    let mut random = fastrand::Rng::with_seed(12);
    for problem in problems() {
        let m = 4 * problem.robot.dof();
        let z = point(problem.robot.dof(), &mut random);
        let found = [JacobianRoute::Exact, JacobianRoute::Differences].map(|kind| {
            let mut extremal = RobotExtremal::new(problem.check().unwrap(), kind).unwrap();
            let (mut g, mut jacobian) = (vec![0.0; m], vec![0.0; m * m]);
            extremal.linearise(&z, ControlLaw::Maximal, &mut g, &mut jacobian).unwrap();
            jacobian
        });
        let size = found[1].iter().fold(0.0_f64, |size, entry| size.max(entry.abs()));
        for (i, (exact, difference)) in found[0].iter().zip(&found[1]).enumerate() {
            assert!(
                (exact - difference).abs() < 1e-7 * size,
                "{}: {} {}: {exact} {difference}",
                problem.robot.name(),
                i / m,
                i % m
            );
        }
    }
}

/// A cost around a point of the plane near which the tip of the arm would pass.
struct Obstacle;

impl RunningCost for Obstacle {
    fn evaluate<S: Scalar>(&self, q: &[S], _: &[S]) -> S {
        let ((s1, c1), (s12, c12)) = (q[0].sin_cos(), (q[0] + q[1]).sin_cos());
        let (x, y) = ((c1 + c12).plus(-1.0), (s1 + s12).plus(-1.2));
        (-(x * x + y * y).times(8.0)).exp().times(400.0)
    }
}

#[test]
fn an_obstacle_is_avoided() {
    let robot = Robot::from_file("../robots/two_link.toml").unwrap();
    let mut problem = Problem::rest_to_rest(robot, &[0.0, 0.5], &[1.2, 0.9], 1.0);
    let price = |solution: &Solution| {
        let of = |q: &Vec<f64>| Obstacle.evaluate(q, &[]);
        solution.trajectory.q.iter().map(of).fold(0.0_f64, f64::max)
    };
    let free = solve(&problem);
    problem.terms = vec![UserTerm::new(Obstacle)];
    let around = solve(&problem);
    assert!(
        around.motion.cost > free.motion.cost && price(&around) < 0.8 * price(&free),
        "{} {}",
        price(&around),
        price(&free)
    );
    // The cost counts the term, and y(0) = -dJ/dx(0) with it.
    let mut beside = problem.clone();
    let cost = |problem: &Problem| solve(problem).motion.cost;
    beside.start.q[1] += 1e-4;
    let more = cost(&beside);
    beside.start.q[1] -= 2e-4;
    let slope = (more - cost(&beside)) / 2e-4;
    assert!((slope + around.costate_start().y_q[1]).abs() < 1e-4 * slope.abs().max(1.0));
}

/// A cost of time.
struct Constant(f64);

impl RunningCost for Constant {
    fn evaluate<S: Scalar>(&self, _: &[S], _: &[S]) -> S {
        S::from_f64(self.0)
    }
}

#[test]
fn a_term_can_be_the_cost_of_time() {
    // 6 / T^3 + 2 T has its minimum at T^4 = 9.
    let mut problem = Problem::rest_to_rest(sledge(), &[0.0], &[1.0], 1.0);
    problem.time = FinalTime::Free { guess: 1.5 };
    assert!(problem.check().is_err());
    problem.terms = vec![UserTerm::new(Constant(1.5)), UserTerm::new(Constant(0.5))];
    assert!(problem.check().is_ok());
    let solution = solve(&problem);
    let time = 3.0_f64.sqrt();
    assert!((solution.motion.final_time - time).abs() < 1e-8, "{}", solution.motion.final_time);
    assert!((solution.motion.cost - (6.0 / time.powi(3) + 2.0 * time)).abs() < 1e-9);
}

#[test]
fn terms_equal_only_their_clones() {
    let mut problem = Problem::rest_to_rest(sledge(), &[0.0], &[1.0], 1.0);
    problem.terms = vec![UserTerm::new(Quadratic)];
    assert_eq!(problem, problem.clone());
    assert_ne!(problem.terms, vec![UserTerm::new(Quadratic)]);
    assert!(format!("{problem:?}").contains("Quadratic"));
    assert_eq!(problem.terms[0].value(&[3.0], &[4.0]), 12.5);
}
