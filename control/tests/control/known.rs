//! Robots against values in closed form, published values and identities.

use crate::{sharp, sledge};
use costate::robot::{JointSpec, LinkInertia, Robot};
use costate_control::{
    Certificate, FinalTime, JacobianRoute, Method, Objective, Problem, Solution, Solver, SolverOptions,
    Status, Strategy,
};
use std::f64::consts::{FRAC_PI_2, PI};

fn pendulum() -> Robot {
    let link = LinkInertia::point(1.0, [0.0, 0.0, -1.0]);
    let joint = JointSpec::revolute("pivot").axis([0.0, 1.0, 0.0]).carrying(link);
    Robot::builder("pendulum").joint(joint).build().unwrap()
}

fn two_link(time: f64) -> Problem {
    let robot = Robot::from_file("../robots/two_link.toml").unwrap();
    Problem::rest_to_rest(robot, &[0.0, 0.0], &[FRAC_PI_2, FRAC_PI_2], time)
}

fn solve(problem: &Problem) -> Solution {
    solve_with(problem, sharp())
}

fn solve_with(problem: &Problem, options: SolverOptions) -> Solution {
    let solution = Solver::new(problem, options).unwrap().solve();
    assert!(
        solution.motion.status.is_converged(),
        "{}\n{:?}",
        solution.motion.status,
        solution.motion.iterations
    );
    assert!(solution.motion.hamiltonian_drift < 1e-8, "drift {}", solution.motion.hamiltonian_drift);
    assert!(solution.end_defect < 1e-6, "end defect {}", solution.end_defect);
    solution
}

fn close(found: f64, expected: f64, digits: f64) {
    assert!((found - expected).abs() <= digits * expected.abs().max(1.0), "{found}, not {expected}");
}

#[test]
fn a_metre_in_a_second_costs_six() {
    let problem = Problem::rest_to_rest(sledge(), &[0.0], &[1.0], 1.0);
    let options = SolverOptions::of(Method::Collocation).with_strategy(Strategy::Direct);
    let solution = solve_with(&problem, options.with_tolerance(1e-9));
    close(solution.motion.cost, 6.0, 1e-12);
    close(solution.costate_start().y_q[0], 12.0, 1e-11);
    close(solution.costate_start().y_p[0], 6.0, 1e-11);
    assert_eq!(solution.motion.certificate, Certificate::LocalMinimum);
    assert!(
        solution.newton_iterations <= 2,
        "a linear problem takes one step: {:?}",
        solution.motion.iterations
    );
}

#[test]
fn a_pendulum_swings_up_at_the_known_cost() {
    let solution = solve(&Problem::rest_to_rest(pendulum(), &[0.0], &[PI], 1.0));
    close(solution.motion.cost, 74.061_659_220_2, 1e-10);
    close(solution.costate_start().y_q[0], -13.035_958_540_5, 1e-9);
    close(solution.costate_start().y_p[0], 18.071_734_530_7, 1e-9);
}

#[test]
fn the_two_link_arm_moves_at_the_known_cost_in_any_time() {
    for time in [1.0, 2.5] {
        let solution = solve(&two_link(time));
        close(solution.motion.cost * time.powi(3), 145.131_137_54, 1e-9);
        // J ~ T^-3 and dJ/dT = -H*.
        close(solution.motion.hamiltonian, 3.0 * solution.motion.cost / time, 1e-8);
    }
}

#[test]
fn all_three_matrices_lead_to_the_same_motion() {
    let exact = solve(&two_link(1.0));
    for jacobian in [JacobianRoute::Differences, JacobianRoute::WithoutHessian] {
        let solution = Solver::new(&two_link(1.0), sharp().with_jacobian(jacobian)).unwrap().solve();
        if jacobian == JacobianRoute::Differences {
            assert!(solution.motion.status.is_converged());
        }
        if solution.motion.status.is_converged() {
            close(solution.motion.cost, exact.motion.cost, 1e-8);
        }
    }
}

#[test]
fn the_two_link_arm_takes_the_known_time() {
    let problem =
        two_link(2.0).with_time(FinalTime::Free { guess: 2.0 }).with_cost(Objective::new(1.0, vec![1.0; 2]));
    let solution = solve(&problem);
    let time = (3.0 * 145.131_137_54_f64).powf(0.25);
    close(solution.motion.final_time, time, 1e-9);
    close(solution.motion.cost, 4.0 / 3.0 * time, 1e-9);
    assert!(solution.motion.hamiltonian.abs() < 1e-9);
}

#[test]
fn costates_are_the_slopes_of_the_cost() {
    let robot = Robot::from_file("../robots/cart_pole.toml").unwrap();
    let problem = Problem::rest_to_rest(robot, &[0.1, 0.3], &[0.8, -0.4], 1.3);
    let options = || sharp().with_tolerance(1e-11);
    let solution = solve_with(&problem, options());
    let step = 1e-4;
    let cost = |change: &dyn Fn(&mut Problem, f64)| {
        let at = |h: f64| {
            let mut problem = problem.clone();
            change(&mut problem, h);
            solve_with(&problem, options()).motion.cost
        };
        (at(step) - at(-step)) / (2.0 * step)
    };
    let slope = cost(&|problem, h| problem.time = FinalTime::Fixed(problem.time.value() + h));
    close(slope, -solution.motion.hamiltonian, 1e-6);
    // The start is at rest: a change of q keeps p = 0, a change of v_j changes p by M e_j.
    let mut hamiltonian = costate::hamiltonian::Hamiltonian::<f64>::new(&problem.robot);
    let mass = hamiltonian.mass_matrix(&problem.start.q).unwrap().clone();
    for j in 0..2 {
        close(cost(&|problem, h| problem.start.q[j] += h), -solution.costate_start().y_q[j], 1e-6);
        let expected: f64 = (0..2).map(|k| -solution.costate_start().y_p[k] * mass[(k, j)]).sum();
        close(cost(&|problem, h| problem.start.v[j] += h), expected, 1e-6);
    }
}

#[test]
fn free_ends_cost_least_among_all_ends() {
    let robot = Robot::from_file("../robots/cart_pole.toml").unwrap();
    let mut problem = Problem::rest_to_rest(robot, &[0.0, 0.2], &[0.6, -0.3], 1.0);
    problem.end.q_free = vec![1];
    problem.end.v_free = vec![0];
    let free = solve(&problem);
    let (q, v) = (free.trajectory.q.last().unwrap(), free.trajectory.v.last().unwrap());
    (problem.end.q[1], problem.end.v[0]) = (q[1], v[0]);
    (problem.end.q_free, problem.end.v_free) = (Vec::new(), Vec::new());
    close(solve(&problem).motion.cost, free.motion.cost, 1e-9);
    for (dq, dv) in [(0.02, 0.0), (-0.02, 0.0), (0.0, 0.02), (0.0, -0.02)] {
        let mut other = problem.clone();
        other.end.q[1] += dq;
        other.end.v[0] += dv;
        let cost = solve(&other).motion.cost;
        assert!(
            cost > free.motion.cost && cost < free.motion.cost * 1.05,
            "{cost} against {}",
            free.motion.cost
        );
    }
}

#[test]
fn six_joints_take_a_few_steps() {
    let robot = Robot::from_file("../robots/puma560.toml").unwrap();
    let limits: Vec<f64> = robot.independent_joints().map(|joint| joint.limits.effort).collect();
    let mut problem = Problem::rest_to_rest(
        robot,
        &[0.0, -0.8, 2.4, 0.0, 0.6, 0.0],
        &[1.2, -0.2, 1.9, 0.4, 0.9, -0.5],
        0.8,
    );
    problem.cost.effort = limits.iter().map(|limit| 1.0 / (limit * limit)).collect();
    assert!(problem.cost.effort.iter().all(|&r| r > 0.0), "{limits:?}");
    let started = std::time::Instant::now();
    let solution = solve(&problem);
    println!(
        "cost {} nodes {} steps {} in {:?}",
        solution.motion.cost,
        solution.nodes(),
        solution.newton_iterations,
        started.elapsed()
    );
    assert!(solution.newton_iterations <= 20, "{:?}", solution.motion.iterations);
}

#[test]
fn the_motion_between_nodes_satisfies_the_state_equation() {
    let robot = Robot::from_file("../robots/two_link.toml").unwrap();
    let problem = Problem::rest_to_rest(robot.clone(), &[0.0, 0.0], &[1.0, -0.5], 1.0);
    let solution = Solver::new(&problem, sharp()).unwrap().solve();
    let trajectory = &solution.trajectory;
    let mut hamiltonian = costate::hamiltonian::Hamiltonian::<f64>::new(&robot);
    for k in 0..=200 {
        let point = trajectory.at(f64::from(k) / 200.0).unwrap();
        let v = hamiltonian.velocity(&point.q, &point.p).unwrap();
        for (found, expected) in point.v.iter().zip(v) {
            assert!((found - expected).abs() < 1e-6, "t = {}: {found}, not {expected}", point.t);
        }
        // u = y_p: unit weights and gains.
        for (u, y_p) in point.u.iter().zip(&point.y_p) {
            assert!((u - y_p).abs() < 1e-4 * (1.0 + y_p.abs()), "t = {}: {u}, not {y_p}", point.t);
        }
    }
    let i = trajectory.t.len() / 2;
    let at_node = trajectory.at(trajectory.t[i]).unwrap();
    assert_eq!((&at_node.q, &at_node.p), (&trajectory.q[i], &trajectory.p[i]));
}

/// Both ends are free, or the end alone, so the robot moves without control and all costates vanish.
#[test]
fn a_motion_that_needs_no_control_costs_nothing() {
    for (name, q, v) in [
        ("pendulum", vec![0.4], vec![0.3]),
        ("two_link", vec![0.3, -0.2], vec![0.5, 1.0]),
        ("two_link", vec![0.3, -0.2], vec![0.0; 2]),
        ("two_link", vec![0.0; 2], vec![0.0; 2]),
    ] {
        let robot = Robot::from_file(format!("../robots/{name}.toml")).unwrap();
        let all: Vec<usize> = (0..q.len()).collect();
        let to: Vec<f64> = q.iter().map(|q| q + 0.2).collect();
        let mut problem = Problem::rest_to_rest(robot, &q, &to, 1.0);
        problem.start.v = v;
        (problem.end.q_free, problem.end.v_free) = (all.clone(), all);
        for method in [Method::Collocation, Method::Shooting] {
            let options = sharp().with_method(method);
            let solution = Solver::new(&problem, options).unwrap().solve();
            assert!(
                solution.motion.status.is_converged(),
                "{name}: {} {:?}",
                solution.motion.status,
                solution.motion.iterations
            );
            assert!(solution.motion.cost < 1e-20, "{name}: {}", solution.motion.cost);
        }
    }
}

#[test]
fn a_motion_that_is_not_verified_gets_no_certificate() {
    let robot = Robot::from_file("../robots/pendulum.toml").unwrap();
    let problem = Problem::rest_to_rest(robot, &[3.0], &[PI], 5.0);
    let options = SolverOptions::of(Method::Collocation).with_tolerance(1e-9);
    let motion = Solver::new(&problem, options).unwrap().solve().motion;
    assert_eq!(motion.status, Status::NotVerified);
    assert_eq!((motion.certificate, motion.conjugate_time), (Certificate::NotChecked, None));
}
