//! Continuation in a parameter: branches against problems solved directly, and a turning point that exists.

use crate::sharp;
use costate::robot::{JointSpec, LinkInertia, Robot, RobotError};
use costate_control::{
    Bounds, Branch, BranchEnd, Continuation, FinalTime, Method, Motion, Objective, Parameter, Penalty,
    Problem, ProblemError, RobotExtremal, Solution, Solver, Status, UnknownParameter, solve_extremal,
};
use std::f64::consts::{FRAC_PI_2, PI};

fn sledge(armature: f64) -> Robot {
    let joint = JointSpec::prismatic("x").axis([1.0, 0.0, 0.0]).armature(armature);
    let joint = joint.carrying(LinkInertia::point(1.0, [0.0; 3]));
    Robot::builder("sledge").joint(joint).build().unwrap()
}

fn swing_up(time: f64) -> Problem {
    let robot = Robot::from_file("../robots/pendulum.toml").unwrap();
    Problem::rest_to_rest(robot, &[0.0], &[PI], time)
}

fn two_link() -> Problem {
    let robot = Robot::from_file("../robots/two_link.toml").unwrap();
    Problem::rest_to_rest(robot, &[0.0, 0.0], &[FRAC_PI_2, FRAC_PI_2], 1.0)
}

fn follow(problem: &Problem, parameter: Parameter, from: f64, to: f64) -> Branch {
    Continuation::new(problem, parameter, from, to, sharp()).unwrap().follow()
}

fn reach(problem: &Problem, parameter: Parameter, from: f64, to: f64) -> Branch {
    let branch = follow(problem, parameter, from, to);
    assert_eq!(branch.end, BranchEnd::Reached, "{:?}", branch.points);
    assert_eq!(branch.solution.motion.status, Status::Converged);
    assert!(branch.turning_points.is_empty(), "{:?}", branch.turning_points);
    let (first, last) = (&branch.points[0], branch.points.last().unwrap());
    assert_eq!((first.parameter, last.parameter), (from, to));
    assert!(branch.solution.motion.hamiltonian_drift < 1e-8 && branch.solution.end_defect < 1e-6);
    close(branch.solution.motion.cost, last.cost, 1e-12);
    branch
}

/// Newton's method from a motion, without a parameter among the unknowns.
fn solve_from(start: &Solution, problem: &Problem) -> Motion {
    let trajectory = &start.trajectory;
    let mut extremal = RobotExtremal::new(problem.check().unwrap(), sharp().jacobian).unwrap();
    solve_extremal(&mut extremal, problem.time, &sharp(), |s, z| {
        let t = s * start.motion.final_time;
        let i = trajectory.t.partition_point(|&node| node < t).clamp(1, trajectory.t.len() - 1);
        let part = (t - trajectory.t[i - 1]) / (trajectory.t[i] - trajectory.t[i - 1]);
        let parts = [&trajectory.q, &trajectory.p, &trajectory.y_q, &trajectory.y_p];
        for (z, part_of) in z.iter_mut().zip(parts) {
            *z = part_of[i - 1][0] + part * (part_of[i][0] - part_of[i - 1][0]);
        }
    })
    .motion
}

fn close(found: f64, expected: f64, digits: f64) {
    assert!((found - expected).abs() <= digits * expected.abs().max(1.0), "{found}, not {expected}");
}

#[test]
fn gravity_leads_to_the_cost_of_the_problem_itself() {
    let branch = reach(&swing_up(1.0), Parameter::Gravity, 0.0, 1.0);
    close(branch.points[0].cost, 6.0 * PI * PI, 1e-9);
    close(branch.solution.motion.cost, 74.061_659_220_2, 1e-10);
    close(branch.solution.costate_start().y_q[0], -13.035_958_540_5, 1e-8);
}

#[test]
fn without_gravity_the_cost_falls_like_the_cube_of_the_time() {
    let branch = reach(&two_link(), Parameter::FinalTime, 1.0, 2.5);
    assert!(branch.points.len() > 5);
    for point in &branch.points {
        close(point.cost * point.parameter.powi(3), 145.131_137_54, 1e-9);
        close(point.hamiltonian, 3.0 * point.cost / point.parameter, 1e-8);
        close(point.final_time, point.parameter, 1e-14);
    }
}

#[test]
fn the_slope_of_the_cost_in_the_weight_is_the_penalty() {
    let penalty = Some(Penalty::new(1.0).with_v_max(vec![3.0; 2]));
    let branch = reach(
        &{
            let mut problem = two_link();
            problem.penalty = penalty;
            problem
        },
        Parameter::PenaltyWeight,
        0.0,
        1e4,
    );
    close(branch.points[0].cost, 145.131_137_54, 1e-9);
    // d(cost + penalties)/d weight is the penalty of the weight 1, which falls along the branch.
    for pair in branch.points[1..].windows(2) {
        let total = |i: usize| pair[i].cost + pair[i].penalty_cost;
        let slope = (total(1) - total(0)) / (pair[1].parameter - pair[0].parameter);
        let ends = [0, 1].map(|i: usize| pair[i].penalty_cost / pair[i].parameter);
        assert!(ends[1] < slope && slope < ends[0], "{slope} outside {ends:?}");
    }
}

#[test]
fn armature_acts_as_mass() {
    let problem = Problem::rest_to_rest(sledge(1.0), &[0.0], &[1.0], 1.0);
    let branch = reach(&problem, Parameter::Armature, 0.0, 1.0);
    for point in &branch.points {
        close(point.cost, 6.0 * (1.0 + point.parameter).powi(2), 1e-9);
    }
}

#[test]
fn bounds_tighten_until_the_control_is_clipped() {
    let bounds = Some(Bounds::symmetric(vec![5.0]));
    let problem = {
        let mut problem = Problem::rest_to_rest(sledge(0.0), &[0.0], &[1.0], 1.0);
        problem.bounds = bounds;
        problem
    };
    let branch = reach(&problem, Parameter::Bounds, 1.6, 0.9);
    for point in &branch.points {
        let bound = 5.0 * point.parameter;
        // u is linear from bound to bound, for a time of twice `inside`.
        let inside = if bound < 6.0 { (3.0 * (0.25 - 1.0 / bound)).sqrt() } else { 0.5 };
        let cost = if bound < 6.0 { bound * bound * (0.5 - 2.0 / 3.0 * inside) } else { 6.0 };
        assert_eq!(point.status, Status::Converged);
        close(point.cost, cost, 1e-8);
    }
}

#[test]
fn bounds_change_the_least_time() {
    let problem = {
        let mut problem = Problem::rest_to_rest(sledge(0.0), &[0.0], &[1.0], 2.0);
        problem.time = FinalTime::Free { guess: 2.0 };
        problem.cost = Objective::new(1.0, vec![0.0]);
        problem.bounds = Some(Bounds::symmetric(vec![1.0]));
        problem
    };
    let branch = reach(&problem, Parameter::Bounds, 1.0, 4.0);
    for point in &branch.points {
        close(point.final_time, 2.0 / point.parameter.sqrt(), 1e-8);
    }
    assert_eq!(branch.solution.motion.switches.len(), 1);
    let smooth = reach(&problem, Parameter::Smoothing, 1.0, 1e-3);
    assert!(smooth.points.windows(2).all(|pair| pair[1].final_time < pair[0].final_time));
    assert!(smooth.solution.motion.final_time > 2.0 && smooth.solution.motion.final_time < 2.0 + 1e-4);
}

/// The extremal of the swing-up in 3 s that first swings in the opposite direction.
fn with_a_swing_back() -> Solution {
    let solutions = (0..30).map(|seed| {
        let options = sharp().with_starts(2).with_seed(seed);
        Solver::new(&swing_up(3.0), options).unwrap().solve()
    });
    solutions.into_iter().find(|solution| (solution.motion.cost - 18.320_144_5).abs() < 1e-5).unwrap()
}

#[test]
fn the_swing_back_has_a_shortest_time() {
    let long = with_a_swing_back();
    let (problem, options) = (swing_up(3.0), sharp());
    let from = |start: &Solution, to: f64| {
        let continuation =
            Continuation::new(&problem, Parameter::FinalTime, 3.0, to, options.clone()).unwrap();
        continuation.with_start(&start.trajectory).unwrap().follow()
    };
    let branch = from(&long, 1.0);
    assert_eq!(branch.end, BranchEnd::TurnedBack);
    assert_eq!(branch.turning_points.len(), 1);
    let turn = &branch.turning_points[0];
    let least = branch.points.iter().fold(f64::INFINITY, |least, point| least.min(point.parameter));
    assert!(turn.parameter <= least && turn.parameter > least - 0.02, "{turn:?} {least}");

    // Beyond it the branch returns to another extremal of the same problem, which is also found directly.
    let back = &branch.solution;
    close(back.motion.cost, 33.421_583_190, 1e-8);
    let direct = solve_from(back, &problem);
    assert!(direct.status.is_converged());
    close(direct.cost, back.motion.cost, 1e-9);

    // On this side of it there are two that approach each other; H* differs by the square root of the
    // distance.
    let parted = |time: f64| {
        let [one, other] = [&long, back].map(|start| {
            let there = from(start, time);
            assert_eq!(there.end, BranchEnd::Reached);
            let direct = solve_from(&there.solution, &swing_up(time));
            assert!(direct.status.is_converged());
            close(direct.cost, there.solution.motion.cost, 1e-9);
            direct
        });
        assert!(one.hamiltonian > other.hamiltonian + 0.1);
        (one.hamiltonian - other.hamiltonian).powi(2)
    };
    let (near, far) = (parted(1.903), parted(1.906));
    let meeting = 1.903 - 0.003 * near / (far - near);
    close(turn.parameter, meeting, 1e-4);

    // On the other side there is none nearby.
    let beyond = solve_from(&from(&long, 1.903).solution, &swing_up(turn.parameter - 0.02));
    assert!(!beyond.status.is_converged() || (beyond.cost - turn.cost).abs() > 1.0, "{}", beyond.cost);
}

#[test]
fn shooting_can_solve_the_first_problem() {
    let options = sharp().with_method(Method::Shooting);
    let problem = swing_up(1.0);
    let branch = Continuation::new(&problem, Parameter::Gravity, 0.5, 1.0, options).unwrap().follow();
    assert_eq!(branch.end, BranchEnd::Reached);
    close(branch.solution.motion.cost, 74.061_659_220_2, 1e-10);
}

#[test]
fn a_continuation_that_cannot_start_or_finish_says_so() {
    let bounds = Some(Bounds::symmetric(vec![3.0]));
    let problem = {
        let mut problem = Problem::rest_to_rest(sledge(0.0), &[0.0], &[1.0], 1.0);
        problem.bounds = bounds;
        problem
    };
    // More nodes would only show that there is no solution.
    let options = sharp().with_max_nodes(601);
    let follow = |from: f64, to: f64| {
        Continuation::new(&problem, Parameter::Bounds, from, to, options.clone()).unwrap().follow()
    };
    let branch = follow(1.0, 2.0);
    assert_eq!(branch.end, BranchEnd::NotStarted);
    assert!(branch.points.is_empty() && !branch.solution.motion.status.is_converged());
    // In the other direction it stops before the bounds are too tight: a metre in a second takes 4 N.
    let branch = follow(2.0, 1.0);
    assert!(matches!(branch.end, BranchEnd::Stuck | BranchEnd::TooManyPoints), "{:?}", branch.end);
    assert_eq!(branch.solution.motion.status, Status::ContinuationFailed);
    let last = branch.points.last().unwrap().parameter;
    assert!(last > 4.0 / 3.0 && last < 1.4, "{last}");
}

#[test]
fn parameters_that_a_problem_does_not_have_are_refused() {
    let problem = swing_up(1.0);
    let refused = |problem: &Problem, parameter, from, to| {
        let error = Continuation::new(problem, parameter, from, to, sharp()).err().unwrap();
        error.to_string()
    };
    let message = refused(&problem, Parameter::PenaltyWeight, 0.0, 1.0);
    assert!(message.contains("penalty_weight") && message.contains("[penalty]"), "{message}");
    assert!(refused(&problem, Parameter::Bounds, 1.0, 2.0).contains("[bounds]"));
    assert!(refused(&problem, Parameter::Smoothing, 1.0, 0.1).contains("effort"));
    assert!(refused(&problem, Parameter::Gravity, 1.0, 1.0).contains("elsewhere"));
    assert!(refused(&problem, Parameter::Gravity, f64::NAN, 1.0).contains("finite"));
    let message = refused(&problem, Parameter::FinalTime, 1.0, -2.0);
    assert!(message.contains("time") && message.contains("-2"), "{message}");
    let free = {
        let mut problem = problem.clone();
        problem.time = FinalTime::Free { guess: 1.0 };
        problem.cost = Objective::new(1.0, vec![1.0]);
        problem
    };
    assert!(refused(&free, Parameter::FinalTime, 1.0, 2.0).contains("free"));
    let negative = Parameter::Armature.apply(&Problem::rest_to_rest(sledge(1.0), &[0.0], &[1.0], 1.0), -1.0);
    assert!(
        matches!(negative, Err(ProblemError::Continuation { parameter: "armature", .. })),
        "{negative:?}"
    );
    let negative = negative.unwrap_err();
    let cause = std::error::Error::source(&negative).unwrap();
    assert!(cause.is::<RobotError>() && negative.to_string().contains(&cause.to_string()), "{negative}");
    for parameter in Parameter::ALL {
        assert_eq!(parameter.name().parse::<Parameter>(), Ok(parameter));
    }
    let error = "mass".parse::<Parameter>().unwrap_err();
    assert_eq!(error, UnknownParameter { name: "mass".into() });
    assert!(error.to_string().contains("final_time"), "{error}");
}
