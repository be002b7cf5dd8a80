//! Refused problems, warnings and saved solutions.

use crate::sharp;
use costate::robot::Robot;
use costate_control::{
    BodyPairs, Bounds, Collision, FinalTime, LinkCapsule, Method, Obstacle, Penalty, Problem, Shape,
    Solution, Solver, SolverOptions, Task,
};
use std::ops::ControlFlow;

fn problem() -> Problem {
    let robot = Robot::from_file("../robots/two_link.toml").unwrap();
    Problem::rest_to_rest(robot, &[0.0, 0.0], &[0.5, 0.5], 1.0)
}

#[test]
fn errors_name_the_key() {
    let refused = |change: &dyn Fn(&mut Problem), key: &str| {
        let mut problem = problem();
        change(&mut problem);
        let error = problem.check().unwrap_err();
        let message = format!("{}: {}", error.key().unwrap(), error.reason());
        assert!(message.contains(key), "{key}: {message}");
    };
    refused(&|p| p.start.q = vec![0.0], "start.q");
    refused(&|p| p.start.v[1] = f64::NAN, "start.v");
    refused(&|p| p.end.q = vec![0.0; 3], "end.q");
    refused(&|p| p.end.v = vec![], "end.v");
    refused(&|p| p.start.q_free = vec![2], "start.q_free");
    refused(&|p| p.start.v_free = vec![3], "start.v_free");
    refused(&|p| p.end.q_free = vec![2], "end.q_free");
    refused(&|p| p.end.v_free = vec![5], "end.v_free");
    refused(&|p| p.time = FinalTime::Fixed(0.0), "time.final");
    refused(&|p| p.time = FinalTime::Free { guess: -1.0 }, "time.guess");
    refused(&|p| p.time = FinalTime::Free { guess: 1.0 }, "cost.time");
    refused(&|p| p.cost.time = -1.0, "cost.time");
    refused(&|p| p.cost.effort[0] = -1.0, "cost.effort: the entry of joint 'shoulder'");
    refused(&|p| p.cost.effort[1] = 0.0, "'elbow'");
    refused(&|p| p.cost.effort = vec![1.0], "cost.effort");
    let bounds = Some(Bounds::symmetric(vec![1.0; 2]));
    refused(&|p| (p.cost.effort, p.bounds) = (vec![0.0; 2], bounds.clone()), "nothing is left to minimise");
    refused(&|p| p.gain = vec![1.0, 0.0], "actuation.gain: the gain of joint 'elbow'");
    refused(&|p| p.bounds = Some(Bounds::new(vec![-1.0, 1.0], vec![1.0, 1.0])), "bounds.u_min");
    refused(&|p| p.bounds = Some(Bounds::new(vec![-1.0], vec![1.0, 1.0])), "bounds.u_min");
    refused(&|p| p.bounds = Some(Bounds::new(vec![-1.0; 2], vec![1.0])), "bounds.u_max");
    let infinite = f64::INFINITY;
    let bounds = |u_min: f64, u_max: f64| Some(Bounds::new(vec![-1.0, u_min], vec![1.0, u_max]));
    refused(&|p| p.bounds = bounds(f64::NAN, 1.0), "bounds.u_min: the entry of joint 'elbow'");
    refused(&|p| p.bounds = bounds(-1.0, f64::NAN), "bounds.u_max: the entry of joint 'elbow'");
    refused(&|p| p.bounds = bounds(infinite, infinite), "bounds.u_min: the lower bound inf of joint 'elbow'");
    for (u_min, u_max) in [(-infinite, infinite), (-1.0, infinite), (-infinite, 1.0)] {
        let change = |p: &mut Problem| (p.cost.effort[1], p.bounds) = (0.0, bounds(u_min, u_max));
        refused(&change, "cost.effort: the weight of joint 'elbow'");
        let mut weighted = problem();
        weighted.bounds = bounds(u_min, u_max);
        weighted.cost.effort[0] = 0.0;
        assert!(weighted.check().is_ok());
    }
    let penalty = |q_min: f64| Penalty::new(1.0).with_q_min(vec![q_min; 2]).with_q_max(vec![1.0; 2]);
    refused(&|p| p.penalty = Some(penalty(2.0)), "penalty.q_min");
    refused(&|p| p.penalty = Some(penalty(0.0).with_weight(-1.0)), "penalty.weight");
    refused(&|p| p.penalty = Some(penalty(0.0).with_v_max(vec![-1.0; 2])), "penalty.v_max");
    let limits = |q_min, q_max, v_max| {
        let with = |entry: f64| vec![entry, 0.5];
        Some(Penalty::new(1.0).with_q_min(with(q_min)).with_q_max(vec![q_max; 2]).with_v_max(with(v_max)))
    };
    refused(&|p| p.penalty = limits(f64::NAN, 1.0, 1.0), "penalty.q_min: the entry of joint 'shoulder'");
    refused(&|p| p.penalty = limits(0.0, 1.0, f64::NAN), "penalty.v_max: the entry of joint 'shoulder'");
    refused(&|p| p.penalty = limits(infinite, infinite, 1.0), "lower limit inf of joint 'shoulder'");
    refused(&|p| p.penalty = limits(-infinite, -infinite, 1.0), "penalty.q_max = -inf");
    let mut held = problem();
    held.penalty = limits(-infinite, infinite, infinite);
    assert!(held.check().is_ok());
    assert!(problem().check().is_ok());
    let options = sharp().with_tolerance(0.0);
    assert!(Solver::new(&problem(), options).is_err_and(|error| error.to_string().contains("tolerance")));
}

#[test]
fn angles_in_degrees_are_a_warning() {
    let mut problem = problem();
    assert!(problem.warnings().is_empty());
    problem.end.q[1] = 90.0;
    let warnings = problem.warnings();
    assert_eq!(warnings.len(), 1);
    assert_eq!(warnings[0].key().to_string(), "end.q");
    let message = warnings[0].to_string();
    assert!(message.contains("'elbow'") && message.contains("1.5708 rad"), "{message}");
    assert!(problem.check().is_ok());
}

#[test]
fn bodies_that_keep_away_from_nothing_are_a_warning() {
    let with = |collision: Collision| problem().with_task(Task::default().with_collision(collision));
    let tip = || Collision::of(vec![LinkCapsule::sphere("joint:elbow", 0.1)]);
    let nothing = with(tip());
    let warnings = nothing.warnings();
    assert_eq!(warnings.len(), 1);
    assert_eq!(warnings[0].key().to_string(), "collision.pairs");
    assert!(warnings[0].to_string().contains("give [[obstacle]]"), "{}", warnings[0]);
    assert!(nothing.check().is_ok());
    assert!(with(tip().with_pairs(BodyPairs::All)).warnings().is_empty());
    let ball = Obstacle::new("ball", Shape::Sphere { centre: [0.0, 0.0, 3.0], radius: 0.1 });
    let task = Task::default().with_collision(tip()).with_obstacle(ball);
    assert!(problem().with_task(task).warnings().is_empty());
}

#[test]
fn a_saved_solution_saves_newton_steps() {
    let first = Solver::new(&problem(), sharp()).unwrap().solve();
    let text = serde_json::to_string(&first).unwrap();
    let saved: Solution = serde_json::from_str(&text).unwrap();
    let rows = |solution: &Solution| {
        let trajectory = solution.trajectory.clone();
        (
            trajectory.t,
            [trajectory.q, trajectory.v, trajectory.p, trajectory.u, trajectory.y_q, trajectory.y_p],
        )
    };
    assert_eq!(rows(&saved), rows(&first));
    assert_eq!(saved.motion.status, first.motion.status);
    let mut longer = problem();
    longer.time = FinalTime::Fixed(1.1);
    let again = Solver::new(&longer, sharp()).unwrap().with_start(&saved.trajectory).unwrap().solve();
    let fresh = Solver::new(&longer, sharp()).unwrap().solve();
    assert!((again.motion.cost - fresh.motion.cost).abs() < 1e-9 * fresh.motion.cost);
    let same = Solver::new(&problem(), sharp()).unwrap().with_start(&saved.trajectory).unwrap().solve();
    assert!(
        same.newton_iterations < first.newton_iterations,
        "{} {}",
        same.newton_iterations,
        first.newton_iterations
    );
    let pendulum = Robot::from_file("../robots/pendulum.toml").unwrap();
    let other = Problem::rest_to_rest(pendulum, &[0.0], &[1.0], 1.0);
    let solver = Solver::new(&other, sharp()).unwrap();
    let error = solver.with_start(&saved.trajectory).unwrap_err().to_string();
    assert!(error.contains("`q`") && error.contains("needs 1"), "{error}");
}

#[test]
fn exceeded_joint_limits_are_warnings() {
    let problem = problem();
    let solution = Solver::new(&problem, sharp()).unwrap().solve();
    let warnings = problem.limit_warnings(&solution.trajectory);
    assert_eq!(warnings.len(), 2, "{warnings:?}");
    assert!(warnings[0].contains("effort of joint 'shoulder'"), "{warnings:?}");
    let mut slow = problem.clone();
    slow.time = FinalTime::Fixed(10.0);
    assert!(slow.limit_warnings(&Solver::new(&slow, sharp()).unwrap().solve().trajectory).is_empty());
}

#[test]
fn penalties_slow_a_motion_and_are_reported_apart_from_the_cost() {
    let free = Solver::new(&problem(), sharp()).unwrap().solve();
    let fastest = |solution: &Solution| {
        solution.trajectory.v.iter().flatten().fold(0.0_f64, |most, v| most.max(v.abs()))
    };
    let limit = 0.8 * fastest(&free);
    let mut slower = problem();
    slower.penalty = Some(Penalty::new(1e4).with_q_max(vec![0.5; 2]).with_v_max(vec![limit; 2]));
    let held = Solver::new(&slower, sharp()).unwrap().solve();
    assert!(held.motion.status.is_converged(), "{} {:?}", held.motion.status, held.motion.iterations);
    assert!(
        fastest(&held) < 1.05 * limit
            && held.motion.penalty_cost > 0.0
            && held.motion.cost > free.motion.cost
    );
    assert!(held.motion.hamiltonian_drift < 1e-7, "{}", held.motion.hamiltonian_drift);
}

#[test]
fn an_infinite_limit_is_no_limit() {
    let infinite = f64::INFINITY;
    let solve = |none: f64| {
        let mut held = problem();
        held.penalty = Some(
            Penalty::new(1e3)
                .with_q_min(vec![-none; 2])
                .with_q_max(vec![none, 0.5])
                .with_v_max(vec![none, 0.6]),
        );
        Solver::new(&held, sharp()).unwrap().solve()
    };
    let (without, far) = (solve(infinite), solve(1e9));
    assert!(without.motion.status.is_converged() && without.motion.penalty_cost > 0.0);
    assert!((without.total() - far.total()).abs() < 1e-10 * far.total());
}

#[test]
fn the_best_of_several_starts_is_kept() {
    let mut steps = 0;
    let problem = problem();
    let options = SolverOptions::of(Method::Collocation).with_tolerance(1e-9).with_starts(3).with_seed(7);
    let solution = Solver::new(&problem, options)
        .unwrap()
        .on_iteration(|_| {
            steps += 1;
            ControlFlow::Continue(())
        })
        .solve();
    assert_eq!(solution.starts.len(), 3);
    assert_eq!(solution.newton_iterations, steps);
    let converged = solution.starts.iter().filter(|other| other.status.is_converged());
    assert_eq!(converged.map(|other| other.total).fold(f64::INFINITY, f64::min), solution.total());
}
