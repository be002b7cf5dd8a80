//! Extremals in (q, v): their equations, and the same motions as in (q, p).

use crate::equations::{assert_canonical, assert_jacobians_agree};
use crate::extremals::{point, problems as without_terms};
use crate::{sharp, sledge};
use costate::robot::{JointSpec, LinkInertia, Robot};
use costate::scalar::Scalar;
use costate_control::{
    BoundSide, BoundaryValueProblem, BoundedControls, Bounds, ControlLaw, Coordinates, FinalTime, Homotopy,
    JacobianRoute, LagrangianExtremal, Objective, Problem, Relaxation, RunningCost, SideChange, Solution,
    Solver, UserTerm,
};
use std::f64::consts::{FRAC_PI_2, PI};

/// A running cost of positions and rates together.
struct Coupled;

impl RunningCost for Coupled {
    fn evaluate<S: Scalar>(&self, q: &[S], v: &[S]) -> S {
        let last = q.len() - 1;
        (q[last].sin_cos().0 * v[0] * v[last] + q[0] * q[0] * v[last]).times(0.7)
    }
}

/// The problems of `extremals`, without and with a user term.
fn problems() -> Vec<(Problem, Relaxation)> {
    let (mut problems, again) = (without_terms(), without_terms());
    problems.extend(again.into_iter().map(|(mut problem, relaxation)| {
        problem.terms = vec![UserTerm::new(Coupled)];
        (problem, relaxation)
    }));
    problems
}

#[test]
fn the_equations_in_q_and_v_are_those_of_the_maximised_hamiltonian() {
    let mut random = fastrand::Rng::with_seed(15);
    for (problem, relaxation) in problems() {
        let mut extremal = LagrangianExtremal::new(problem.check().unwrap(), JacobianRoute::Exact).unwrap();
        extremal.set_relaxation(relaxation);
        let z = point(problem.robot.dof(), &mut random);
        assert_canonical(&mut extremal, &z, 1e-6, problem.robot.name());
    }
}

#[test]
fn the_exact_jacobian_in_q_and_v_agrees_with_central_differences() {
    let mut random = fastrand::Rng::with_seed(16);
    for (problem, relaxation) in problems() {
        let z = point(problem.robot.dof(), &mut random);
        let [mut exact, mut differences] = [JacobianRoute::Exact, JacobianRoute::Differences].map(|route| {
            let mut extremal = LagrangianExtremal::new(problem.check().unwrap(), route).unwrap();
            extremal.set_relaxation(relaxation);
            extremal
        });
        assert_jacobians_agree(&mut exact, &mut differences, &z, problem.robot.name());
    }
}

#[test]
fn without_second_derivatives_only_their_blocks_change() {
    let mut random = fastrand::Rng::with_seed(17);
    for (problem, relaxation) in problems() {
        let n = problem.robot.dof();
        let (m, z) = (4 * n, point(n, &mut random));
        let matrix = |kind| {
            let mut extremal = LagrangianExtremal::new(problem.check().unwrap(), kind).unwrap();
            extremal.set_relaxation(relaxation);
            let (mut g, mut jacobian) = (vec![0.0; m], vec![0.0; m * m]);
            extremal.linearise(&z, ControlLaw::Maximal, &mut g, &mut jacobian).unwrap();
            (g, jacobian)
        };
        let ((g, exact), (h, without)) =
            (matrix(JacobianRoute::Exact), matrix(JacobianRoute::WithoutHessian));
        let close = |a: f64, b: f64| (a - b).abs() <= 1e-10 * a.abs().max(b.abs()).max(1.0);
        assert!(g.iter().zip(&h).all(|(&g, &h)| close(g, h)));
        for row in 0..m {
            for column in 0..m {
                // y_v'a_xx and W_q enter dy'/dx and, through u, dv'/dq and dy_q'/dy_v.
                let (of_y, in_x) = (row >= 2 * n, column < 2 * n);
                let through_u = (n..2 * n).contains(&row) && column < n
                    || (2 * n..3 * n).contains(&row) && column >= 3 * n;
                if !(of_y && in_x || through_u) {
                    let (a, b) = (exact[row * m + column], without[row * m + column]);
                    assert!(close(a, b), "{}: {row} {column}: {a} {b}", problem.robot.name());
                }
            }
        }
        // Of dy'/dx only penalties and user terms are left.
        if !problem.terms.is_empty() {
            continue;
        }
        let penalised = problem.penalty.is_some();
        let left = (2 * n..m).flat_map(|row| (0..2 * n).map(move |column| (row, column)));
        for (row, column) in left.filter(|(row, column)| row - 2 * n != *column || !penalised) {
            assert_eq!(without[row * m + column], 0.0);
        }
    }
}

#[test]
fn the_switching_function_has_an_exact_gradient() {
    let robot = Robot::from_file("../robots/puma560.toml").unwrap();
    let n = robot.dof();
    let mut problem = Problem::rest_to_rest(robot, &vec![0.0; n], &vec![0.7; n], 1.0);
    problem.bounds = Some(Bounds::new(vec![-0.4; n], vec![0.5; n]));
    let mut extremal = LagrangianExtremal::new(problem.check().unwrap(), JacobianRoute::Exact).unwrap();
    let z = point(n, &mut fastrand::Rng::with_seed(18));
    let (mut gradient, mut other) = (vec![0.0; 4 * n], vec![0.0; 4 * n]);
    let change = SideChange::new(BoundSide::Inside, BoundSide::High);
    extremal.switching(2, change, &z, &mut gradient);
    let size = gradient.iter().fold(0.0_f64, |size, entry| size.max(entry.abs()));
    for i in 0..4 * n {
        let mut beside = |h: f64| {
            let mut z = z.clone();
            z[i] += h;
            extremal.switching(2, change, &z, &mut other)
        };
        let difference = (beside(1e-5) - beside(-1e-5)) / 2e-5;
        assert!((difference - gradient[i]).abs() < 1e-7 * size, "{i}: {difference} {}", gradient[i]);
    }
}

/// The same problem in both coordinates.
fn both(problem: &Problem) -> [Solution; 2] {
    [Coordinates::Hamiltonian, Coordinates::Lagrangian].map(|coordinates| {
        let options = sharp().with_coordinates(coordinates).with_tolerance(1e-11);
        let solution = Solver::new(problem, options).unwrap().solve();
        assert!(solution.motion.status.is_converged(), "{coordinates:?}: {}", solution.motion.status);
        assert!(solution.motion.hamiltonian_drift < 1e-8 && solution.end_defect < 1e-6);
        solution
    })
}

/// Costs to 1e-9, costates at the start to 1e-7 of the largest.
fn agree(problem: &Problem) -> [Solution; 2] {
    let [a, b] = both(problem);
    assert!((a.total() - b.total()).abs() < 1e-9 * a.total().abs(), "{} {}", a.total(), b.total());
    assert!((a.motion.final_time - b.motion.final_time).abs() < 1e-8 * a.motion.final_time);
    for (a, b) in
        [(&a.costate_start().y_q, &b.costate_start().y_q), (&a.costate_start().y_p, &b.costate_start().y_p)]
    {
        let size = a.iter().fold(0.0_f64, |size, y| size.max(y.abs()));
        assert!(a.iter().zip(*b).all(|(a, b)| (a - b).abs() < 1e-7 * size), "{a:?} {b:?}");
    }
    [a, b]
}

#[test]
fn both_coordinates_give_an_arm_and_a_pendulum_the_same_motion() {
    let robot = Robot::from_file("../robots/two_link.toml").unwrap();
    let [_, found] = agree(&Problem::rest_to_rest(robot, &[0.0; 2], &[FRAC_PI_2; 2], 1.0));
    assert!((found.motion.cost - 145.131_137_54).abs() < 1e-7, "{}", found.motion.cost);
    let link = LinkInertia::point(1.0, [0.0, 0.0, -1.0]);
    let joint = JointSpec::revolute("pivot").axis([0.0, 1.0, 0.0]).carrying(link);
    let pendulum = Robot::builder("pendulum").joint(joint).build().unwrap();
    let [_, found] = agree(&Problem::rest_to_rest(pendulum, &[0.0], &[PI], 1.0));
    assert!((found.motion.cost - 74.061_659_220_2).abs() < 1e-9, "{}", found.motion.cost);
    assert!((found.costate_start().y_q[0] + 13.035_958_540_5).abs() < 1e-7);
}

#[test]
fn both_coordinates_find_the_same_free_end() {
    let robot = Robot::from_file("../robots/cart_pole.toml").unwrap();
    let mut problem = Problem::rest_to_rest(robot, &[0.0, 0.2], &[0.6, -0.3], 1.0);
    problem.start.v = vec![0.3, -0.2];
    problem.end.q_free = vec![1];
    problem.end.v_free = vec![0];
    problem.start.v_free = vec![1];
    let [a, b] = agree(&problem);
    let last = |rows: &[Vec<f64>]| rows.last().unwrap().clone();
    for (a, b) in
        [(last(&a.trajectory.q), last(&b.trajectory.q)), (last(&a.trajectory.p), last(&b.trajectory.p))]
    {
        assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-8), "{a:?} {b:?}");
    }
}

#[test]
fn both_coordinates_agree_for_the_puma() {
    let robot = Robot::from_file("../robots/puma560.toml").unwrap();
    let (from, to) = ([0.0, 0.7, 2.8, 0.0, 0.4, 0.0], [0.6, 0.2, 2.9, 0.3, 0.2, 0.4]);
    let mut problem = Problem::rest_to_rest(robot, &from, &to, 0.9);
    problem.cost = Objective::new(0.0, vec![1e-4, 3e-5, 1e-4, 2e-3, 2e-3, 2e-3]);
    agree(&problem);
}

#[test]
fn both_coordinates_find_the_same_switches() {
    let bounds = Bounds::symmetric(vec![5.0]);
    let bounded = Problem::rest_to_rest(sledge(), &[0.0], &[1.0], 1.0).with_bounds(bounds);
    let fastest = Problem::rest_to_rest(sledge(), &[0.0], &[1.0], 1.0)
        .with_time(FinalTime::Free { guess: 1.0 })
        .with_cost(Objective::new(1.0, vec![0.0]))
        .with_bounds(Bounds::symmetric(vec![1.0]));
    let arm = Robot::from_file("../robots/two_link.toml").unwrap();
    let bounds = Bounds::symmetric(vec![4.5; 2]);
    let arm = Problem::rest_to_rest(arm, &[0.0, 0.5], &[0.6, 0.4], 2.0).with_bounds(bounds);
    for problem in [bounded, fastest, arm] {
        let [a, b] = agree(&problem);
        assert!(
            a.motion.switches.len() == b.motion.switches.len(),
            "{:?} {:?}",
            a.motion.switches,
            b.motion.switches
        );
        assert!(a.motion.switches.iter().zip(&b.motion.switches).all(|(a, b)| (a - b).abs() < 1e-8));
    }
}

#[test]
fn a_saved_motion_starts_a_search_in_other_coordinates() {
    let robot = Robot::from_file("../robots/two_link.toml").unwrap();
    let problem = Problem::rest_to_rest(robot, &[0.0; 2], &[FRAC_PI_2; 2], 1.0);
    let [a, b] = both(&problem);
    for (saved, coordinates) in [(&a, Coordinates::Lagrangian), (&b, Coordinates::Hamiltonian)] {
        let options = sharp().with_coordinates(coordinates);
        let again = Solver::new(&problem, options).unwrap().with_start(&saved.trajectory).unwrap().solve();
        assert!(
            again.motion.status.is_converged() && again.newton_iterations <= 6,
            "{}",
            again.newton_iterations
        );
        assert!((again.motion.cost - a.motion.cost).abs() < 1e-8 * a.motion.cost);
    }
}
