//! Multiple shooting against collocation and against known values.

use crate::{sharp, sledge};
use costate::robot::Robot;
use costate_control::{Bounds, FinalTime, Method, Objective, Penalty, Problem, Solution, Solver, Status};
use std::f64::consts::{FRAC_PI_2, PI};

fn two_link(time: f64) -> Problem {
    let robot = Robot::from_file("../robots/two_link.toml").unwrap();
    Problem::rest_to_rest(robot, &[0.0, 0.0], &[FRAC_PI_2, FRAC_PI_2], time)
}

fn solve(problem: &Problem, method: Method) -> Solution {
    let options = sharp().with_method(method);
    let started = std::time::Instant::now();
    let solution = Solver::new(problem, options).unwrap().solve();
    println!(
        "{method:?}: cost {} {} steps, {} nodes, shooting defect {:.1e}, errors {:.1e}, {:?}",
        solution.motion.cost,
        solution.newton_iterations,
        solution.nodes(),
        solution.motion.shooting_defect,
        solution.motion.errors.iter().fold(0.0_f64, |a, &b| a.max(b)),
        started.elapsed()
    );
    assert!(
        solution.motion.status.is_converged(),
        "{method:?}: {}\n{:?}",
        solution.motion.status,
        solution.motion.iterations
    );
    assert!(solution.motion.hamiltonian_drift < 1e-8, "drift {}", solution.motion.hamiltonian_drift);
    assert!(solution.end_defect < 1e-6, "end defect {}", solution.end_defect);
    assert!(solution.motion.shooting_defect < 1e-7, "shooting defect {}", solution.motion.shooting_defect);
    solution
}

fn close(found: f64, expected: f64, digits: f64) {
    assert!((found - expected).abs() <= digits * expected.abs().max(1.0), "{found}, not {expected}");
}

/// Solves by both methods, compares them, and returns the solution of multiple shooting.
fn both(problem: &Problem) -> Solution {
    let [collocation, shooting] =
        [Method::Collocation, Method::Shooting].map(|method| solve(problem, method));
    close(shooting.motion.cost, collocation.motion.cost, 1e-9);
    close(shooting.motion.penalty_cost, collocation.motion.penalty_cost, 1e-9);
    close(shooting.motion.final_time, collocation.motion.final_time, 1e-9);
    assert_eq!(shooting.motion.switches.len(), collocation.motion.switches.len());
    for (found, expected) in shooting.motion.switches.iter().zip(&collocation.motion.switches) {
        close(*found, *expected, 1e-8);
    }
    let parts =
        |solution: &Solution| [solution.costate_start().y_q.to_vec(), solution.costate_start().y_p.to_vec()];
    for (found, expected) in parts(&shooting).iter().zip(&parts(&collocation)) {
        let largest = expected.iter().fold(0.0_f64, |largest, y| largest.max(y.abs()));
        found.iter().zip(expected).for_each(|(y, expected)| {
            assert!((y - expected).abs() <= 5e-9 * largest, "{found:?}, not {expected:?}");
        });
    }
    shooting
}

#[test]
fn a_metre_in_a_second_costs_six() {
    let solution = both(&Problem::rest_to_rest(sledge(), &[0.0], &[1.0], 1.0));
    close(solution.motion.cost, 6.0, 1e-11);
    close(solution.costate_start().y_q[0], 12.0, 1e-11);
    close(solution.costate_start().y_p[0], 6.0, 1e-11);
}

#[test]
fn a_pendulum_swings_up_at_the_known_cost() {
    let robot = Robot::from_file("../robots/pendulum.toml").unwrap();
    let solution = both(&Problem::rest_to_rest(robot, &[0.0], &[PI], 1.0));
    close(solution.motion.cost, 74.061_659_220_2, 1e-11);
    close(solution.costate_start().y_q[0], -13.035_958_540_5, 1e-9);
    close(solution.costate_start().y_p[0], 18.071_734_530_7, 1e-9);
}

#[test]
fn the_two_link_arm_moves_at_the_known_cost() {
    close(both(&two_link(1.0)).motion.cost, 145.131_137_54, 1e-9);
}

#[test]
fn the_two_link_arm_takes_the_known_time() {
    let cost = Objective::new(1.0, vec![1.0; 2]);
    let problem = two_link(2.0).with_time(FinalTime::Free { guess: 2.0 }).with_cost(cost);
    let solution = both(&problem);
    close(solution.motion.final_time, (3.0 * 145.131_137_54_f64).powf(0.25), 1e-9);
    assert!(solution.motion.hamiltonian.abs() < 1e-9);
}

#[test]
fn free_ends_are_the_same() {
    let robot = Robot::from_file("../robots/cart_pole.toml").unwrap();
    let mut problem = Problem::rest_to_rest(robot, &[0.0, 0.2], &[0.6, -0.3], 1.0);
    problem.end.q_free = vec![1];
    problem.end.v_free = vec![0];
    both(&problem);
}

#[test]
fn six_joints_move_as_with_collocation() {
    let robot = Robot::from_file("../robots/puma560.toml").unwrap();
    let limits: Vec<f64> = robot.independent_joints().map(|joint| joint.limits.effort).collect();
    let (from, to) = ([0.0, -0.8, 2.4, 0.0, 0.6, 0.0], [1.2, -0.2, 1.9, 0.4, 0.9, -0.5]);
    let mut problem = Problem::rest_to_rest(robot, &from, &to, 0.8);
    problem.cost.effort = limits.iter().map(|limit| 1.0 / (limit * limit)).collect();
    both(&problem);
}

#[test]
fn penalties_are_integrated_too() {
    let penalty = Penalty::new(100.0).with_v_max(vec![3.0; 2]);
    let solution = both(&two_link(1.0).with_penalty(penalty));
    assert!(solution.motion.penalty_cost > 1.0, "{}", solution.motion.penalty_cost);
}

#[test]
fn bounded_controls_switch_at_the_same_times() {
    let bounds = Bounds::symmetric(vec![5.0]);
    let solution = both(&Problem::rest_to_rest(sledge(), &[0.0], &[1.0], 1.0).with_bounds(bounds));
    assert_eq!(solution.motion.switches.len(), 2);
    let least_time = Problem::rest_to_rest(sledge(), &[0.0], &[1.0], 3.0)
        .with_time(FinalTime::Free { guess: 3.0 })
        .with_cost(Objective::new(1.0, vec![0.0]))
        .with_bounds(Bounds::symmetric(vec![1.0]));
    let solution = both(&least_time);
    close(solution.motion.final_time, 2.0, 1e-9);
    close(solution.motion.switches[0], 1.0, 1e-9);
}

#[test]
fn a_time_too_short_for_the_bounds_is_not_converged() {
    let bounds = Bounds::symmetric(vec![3.0]);
    let problem = Problem::rest_to_rest(sledge(), &[0.0], &[1.0], 1.0).with_bounds(bounds);
    let options = sharp().with_method(Method::Shooting);
    let solution = Solver::new(&problem, options).unwrap().solve();
    assert_ne!(solution.motion.status, Status::Converged);
    assert!(solution.trajectory.t.is_empty() && solution.motion.shooting_defect == f64::INFINITY);
}

#[test]
fn a_looser_tolerance_has_a_larger_shooting_defect() {
    let defect = |tolerance| {
        let options = sharp().with_tolerance(tolerance);
        Solver::new(&two_link(1.0), options).unwrap().solve().motion.shooting_defect
    };
    let (loose, tight) = (defect(1e-4), defect(1e-10));
    assert!(loose < 1e-2 && loose > 1e-8 && tight < 1e-8 && tight < 0.01 * loose, "{loose} {tight}");
}
