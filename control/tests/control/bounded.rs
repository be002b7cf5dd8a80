//! Bounded controls: least time and least effort.

use crate::{sharp, sledge};
use costate::robot::Robot;
use costate_control::{
    Bounds, FinalTime, Method, Objective, Problem, Solution, Solver, SolverOptions, Status,
};

fn solve(problem: &Problem) -> Solution {
    let solution = Solver::new(problem, sharp()).unwrap().solve();
    assert!(solution.motion.status.is_converged(), "{}", solution.motion.status);
    assert!(solution.motion.hamiltonian_drift < 1e-8, "drift {}", solution.motion.hamiltonian_drift);
    assert!(solution.end_defect < 1e-6, "end defect {}", solution.end_defect);
    solution
}

fn least_time(robot: Robot, to: &[f64], bound: f64, guess: f64) -> Problem {
    let n = robot.dof();
    Problem::rest_to_rest(robot, &vec![0.0; n], to, guess)
        .with_time(FinalTime::Free { guess })
        .with_cost(Objective::new(1.0, vec![0.0; n]))
        .with_bounds(Bounds::symmetric(vec![bound; n]))
}

#[test]
fn a_metre_takes_two_seconds_and_one_switch() {
    for guess in [1.0, 2.0, 6.0] {
        let solution = solve(&least_time(sledge(), &[1.0], 1.0, guess));
        assert!((solution.motion.final_time - 2.0).abs() < 1e-9 && (solution.motion.cost - 2.0).abs() < 1e-9);
        assert_eq!(solution.motion.switches.len(), 1);
        assert!((solution.motion.switches[0] - 1.0).abs() < 1e-9, "{:?}", solution.motion.switches);
    }
}

#[test]
fn bounded_effort_saturates_at_both_ends() {
    // u = clip(a - b t), T = 1, |u| <= 5: at the bound for t < s, with 5 = b (1/2 - s) after 1 m.
    let bounds = Some(Bounds::symmetric(vec![5.0]));
    let problem = {
        let mut problem = Problem::rest_to_rest(sledge(), &[0.0], &[1.0], 1.0);
        problem.bounds = bounds;
        problem
    };
    let solution = solve(&problem);
    // Distance: 5 (1/4 - (1/2 - s)^2 / 3) = 1.
    let inside = (3.0_f64 * (0.25 - 0.2)).sqrt();
    let cost = 25.0 * (0.5 - inside) + 25.0 * inside / 3.0;
    assert_eq!(solution.motion.switches.len(), 2);
    assert!(
        (solution.motion.switches[0] - (0.5 - inside)).abs() < 1e-8,
        "{:?} {inside}",
        solution.motion.switches
    );
    assert!((solution.motion.switches[1] - (0.5 + inside)).abs() < 1e-8);
    assert!((solution.motion.cost - cost).abs() < 1e-8, "{} {cost}", solution.motion.cost);
    assert!(solution.trajectory.u.iter().all(|u| u[0].abs() <= 5.0));
}

#[test]
fn one_bound_saturates_on_its_side() {
    // u = 5 for t < s, then 5 - b (t - s): at rest at T = 1 with b = 10 / (1 - s)^2;
    // 1 m for 1 - s = 0.9.
    let cost = 12.5 * 0.1 + 0.5 * (25.0 * 0.9 - 50.0 + 100.0 / 2.7);
    let free = f64::INFINITY;
    for (u_min, u_max, switch) in [(-free, 5.0, 0.1), (-5.0, free, 0.9)] {
        let bounds = Bounds::new(vec![u_min], vec![u_max]);
        let solution = solve(&Problem::rest_to_rest(sledge(), &[0.0], &[1.0], 1.0).with_bounds(bounds));
        assert_eq!(solution.motion.switches.len(), 1);
        assert!((solution.motion.switches[0] - switch).abs() < 1e-8, "{:?}", solution.motion.switches);
        assert!((solution.motion.cost - cost).abs() < 1e-9, "{} {cost}", solution.motion.cost);
    }
}

#[test]
fn bounds_on_one_joint_do_not_bound_the_other() {
    let robot = Robot::from_file("../robots/two_link.toml").unwrap();
    let solve_with = |none: f64| {
        let bounds = Bounds::new(vec![-none, -1.0], vec![none, 1.0]);
        solve(&Problem::rest_to_rest(robot.clone(), &[0.0, 0.0], &[0.5, 0.8], 1.2).with_bounds(bounds))
    };
    let (one, far) = (solve_with(f64::INFINITY), solve_with(1e4));
    assert!(one.trajectory.u.iter().any(|u| u[1].abs() == 1.0) && !one.motion.switches.is_empty());
    assert!(one.trajectory.u.iter().any(|u| u[0].abs() > 2.0));
    assert!(
        (one.motion.cost - far.motion.cost).abs() < 1e-9 * far.motion.cost,
        "{} {}",
        one.motion.cost,
        far.motion.cost
    );
    assert!(
        one.motion.cost
            > 1.0001
                * solve(&Problem::rest_to_rest(robot.clone(), &[0.0, 0.0], &[0.5, 0.8], 1.2)).motion.cost
    );
}

#[test]
fn the_two_link_arm_is_fastest_with_torques_at_their_bounds() {
    let robot = Robot::from_file("../robots/two_link.toml").unwrap();
    let solution = solve(&least_time(robot, &[1.0, 0.6], 1.0, 4.0));
    let at_bounds = solution.trajectory.u.iter().flatten().all(|u| (u.abs() - 1.0).abs() < 1e-12);
    assert!(at_bounds && !solution.motion.switches.is_empty());
    assert!((solution.motion.cost - solution.motion.final_time).abs() < 1e-12);
}

#[test]
fn bounds_that_are_not_reached_change_nothing() {
    let bounds = Bounds::symmetric(vec![7.0]);
    let problem = Problem::rest_to_rest(sledge(), &[0.0], &[1.0], 1.0).with_bounds(bounds);
    let solution = solve(&problem);
    assert!((solution.motion.cost - 6.0).abs() < 1e-10 && solution.motion.switches.is_empty());
}

#[test]
fn a_time_too_short_for_the_bounds_is_not_converged() {
    let bounds = Bounds::symmetric(vec![3.0]);
    let problem = Problem::rest_to_rest(sledge(), &[0.0], &[1.0], 1.0).with_bounds(bounds);
    let directly = Solver::new(&problem, sharp()).unwrap().solve();
    assert_eq!(directly.motion.status, Status::LocallyInfeasible);
    let limit = &directly.limits.infeasible.as_ref().unwrap().limits[0];
    assert!(limit.kind == "torque" && (limit.amount - 1.0).abs() < 0.05, "{limit:?}");
    let options = SolverOptions::of(Method::Collocation).with_tolerance(1e-9);
    let solution = Solver::new(&problem, options).unwrap().solve();
    assert_eq!(solution.motion.status, Status::BoundsNotReached);
    // A motion that breaks the bounds is no result.
    assert!(solution.trajectory.t.is_empty() && solution.end_defect == f64::INFINITY);
}

#[test]
fn published_optima_are_met() {
    // Luus: the two-link arm from (0, 0.5) to (0.522, 0.5), |u| <= 1: 2.98 s.
    let robot = Robot::from_file("../robots/two_link.toml").unwrap();
    let mut problem = least_time(robot, &[0.522, 0.5], 1.0, 3.0);
    problem.start.q[1] = 0.5;
    let solution = solve(&problem);
    assert!(
        (solution.motion.final_time - 2.98).abs() < 5e-3 && solution.motion.switches.len() == 3,
        "{}",
        solution.motion.final_time
    );
    // von Stryk and Schlemmer: Manutec r3 in 0.53 s, integral of |u|^2, |u| <= 7.5 V: 20.404.
    let robot = Robot::from_file("../robots/manutec_r3.toml").unwrap();
    let mut problem = Problem::rest_to_rest(robot, &[0.0, -1.5, 0.0], &[1.0, -1.95, 1.0], 0.53);
    problem.gain = vec![-126.0, 252.0, 72.0];
    problem.cost.effort = vec![2.0; 3];
    problem.bounds = Some(Bounds::symmetric(vec![7.5; 3]));
    let solution = solve(&problem);
    assert!((solution.motion.cost - 20.404).abs() < 5e-4, "{}", solution.motion.cost);
}

#[test]
fn a_saved_least_time_motion_starts_a_search_for_a_similar_one() {
    let robot = Robot::from_file("../robots/two_link.toml").unwrap();
    let problem = least_time(robot.clone(), &[1.0, 0.6], 1.0, 4.0);
    let first = solve(&problem);
    let text = serde_json::to_string(&first).unwrap();
    let saved: Solution = serde_json::from_str(&text).unwrap();
    for to in [[1.0, 0.6], [1.02, 0.58]] {
        let problem = least_time(robot.clone(), &to, 1.0, 9.0);
        let again = Solver::new(&problem, sharp()).unwrap().with_start(&saved.trajectory).unwrap().solve();
        let fresh = solve(&problem);
        assert!(
            (again.motion.final_time - fresh.motion.final_time).abs() < 1e-8,
            "{} {}",
            again.motion.final_time,
            fresh.motion.final_time
        );
        assert!(2 * again.newton_iterations < fresh.newton_iterations, "{:?}", again.motion.iterations);
    }
}
