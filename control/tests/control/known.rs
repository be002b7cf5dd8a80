//! Robots against values in closed form, published values and identities.

use crate::sledge;
use costate::robot::{JointSpec, LinkInertia, Robot};
use costate_control::{Certificate, Cost, Jacobian, Options, Problem, Solution, Solver, Time};
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
    solve_with(problem, Options::default())
}

fn solve_with(problem: &Problem, options: Options) -> Solution {
    let solution = Solver::new(problem, options).unwrap().solve();
    assert!(solution.status.is_converged(), "{}\n{:?}", solution.status, solution.iterations);
    assert!(solution.hamiltonian_drift < 1e-8, "drift {}", solution.hamiltonian_drift);
    assert!(solution.end_defect < 1e-6, "end defect {}", solution.end_defect);
    solution
}

fn close(found: f64, expected: f64, digits: f64) {
    assert!((found - expected).abs() <= digits * expected.abs().max(1.0), "{found}, not {expected}");
}

#[test]
fn a_metre_in_a_second_costs_six() {
    let solution = solve(&Problem::rest_to_rest(sledge(), &[0.0], &[1.0], 1.0));
    close(solution.cost, 6.0, 1e-12);
    close(solution.costate_start.0[0], 12.0, 1e-11);
    close(solution.costate_start.1[0], 6.0, 1e-11);
    assert_eq!(solution.certificate, Certificate::LocalMinimum);
    assert!(solution.newton_iterations <= 2, "a linear problem takes one step: {:?}", solution.iterations);
}

#[test]
fn a_pendulum_swings_up_at_the_known_cost() {
    let solution = solve(&Problem::rest_to_rest(pendulum(), &[0.0], &[PI], 1.0));
    close(solution.cost, 74.061_659_220_2, 1e-11);
    close(solution.costate_start.0[0], -13.035_958_540_5, 1e-9);
    close(solution.costate_start.1[0], 18.071_734_530_7, 1e-9);
}

#[test]
fn the_two_link_arm_moves_at_the_known_cost_in_any_time() {
    for time in [1.0, 2.5] {
        let solution = solve(&two_link(time));
        close(solution.cost * time.powi(3), 145.131_137_54, 1e-9);
        // J ~ T^-3 and dJ/dT = -H*.
        close(solution.hamiltonian, 3.0 * solution.cost / time, 1e-8);
    }
}

#[test]
fn all_three_matrices_lead_to_the_same_motion() {
    let exact = solve(&two_link(1.0));
    for jacobian in [Jacobian::Differences, Jacobian::WithoutHessian] {
        let solution =
            Solver::new(&two_link(1.0), Options { jacobian, ..Options::default() }).unwrap().solve();
        if jacobian == Jacobian::Differences {
            assert!(solution.status.is_converged());
        }
        if solution.status.is_converged() {
            close(solution.cost, exact.cost, 1e-8);
        }
    }
}

#[test]
fn the_two_link_arm_takes_the_known_time() {
    let problem = Problem {
        time: Time::Free { guess: 2.0 },
        cost: Cost { time: 1.0, effort: vec![1.0; 2] },
        ..two_link(2.0)
    };
    let solution = solve(&problem);
    let time = (3.0 * 145.131_137_54_f64).powf(0.25);
    close(solution.final_time, time, 1e-9);
    close(solution.cost, 4.0 / 3.0 * time, 1e-9);
    assert!(solution.hamiltonian.abs() < 1e-9);
}

#[test]
fn costates_are_the_slopes_of_the_cost() {
    let robot = Robot::from_file("../robots/cart_pole.toml").unwrap();
    let problem = Problem::rest_to_rest(robot, &[0.1, 0.3], &[0.8, -0.4], 1.3);
    let options = || Options { tolerance: 1e-11, ..Options::default() };
    let solution = solve_with(&problem, options());
    let step = 1e-4;
    let cost = |change: &dyn Fn(&mut Problem, f64)| {
        let at = |h: f64| {
            let mut problem = problem.clone();
            change(&mut problem, h);
            solve_with(&problem, options()).cost
        };
        (at(step) - at(-step)) / (2.0 * step)
    };
    let slope = cost(&|problem, h| problem.time = Time::Fixed(problem.time.value() + h));
    close(slope, -solution.hamiltonian, 1e-6);
    // The start is at rest: a change of q keeps p = 0, a change of v_j changes p by M e_j.
    let mut hamiltonian = costate::hamiltonian::Hamiltonian::<f64>::new(&problem.robot);
    let mass = hamiltonian.mass_matrix(&problem.start.q).unwrap().clone();
    for j in 0..2 {
        close(cost(&|problem, h| problem.start.q[j] += h), -solution.costate_start.0[j], 1e-6);
        let expected: f64 = (0..2).map(|k| -solution.costate_start.1[k] * mass[(k, j)]).sum();
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
    close(solve(&problem).cost, free.cost, 1e-9);
    for (dq, dv) in [(0.02, 0.0), (-0.02, 0.0), (0.0, 0.02), (0.0, -0.02)] {
        let mut other = problem.clone();
        other.end.q[1] += dq;
        other.end.v[0] += dv;
        let cost = solve(&other).cost;
        assert!(cost > free.cost && cost < free.cost * 1.05, "{cost} against {}", free.cost);
    }
}

#[test]
fn six_joints_take_a_few_steps() {
    let robot = Robot::from_file("../robots/puma560.toml").unwrap();
    let limits: Vec<f64> = robot.joints().iter().map(|joint| joint.limits.effort).collect();
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
        solution.cost,
        solution.nodes,
        solution.newton_iterations,
        started.elapsed()
    );
    assert!(solution.newton_iterations <= 20, "{:?}", solution.iterations);
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
        (problem.end.q_free, problem.end.v_free) = (all.clone(), all.clone());
        for start_is_free in [false, true] {
            if start_is_free {
                (problem.start.q_free, problem.start.v_free) = (all.clone(), all.clone());
            }
            let solution = Solver::new(&problem, Options::default()).unwrap().solve();
            assert!(solution.status.is_converged(), "{name} {problem:?}: {}", solution.status);
            assert!(solution.cost < 1e-20, "{name}: {}", solution.cost);
        }
    }
}
