//! Limits on the accelerations of tools.

use crate::sledge;
use costate::hamiltonian::Hamiltonian;
use costate::kinematics::{Kinematics, ReferenceFrame};
use costate::robot::{LoadOptions, Robot};
use costate_control::{
    BoundaryState, FinalTime, Keep, Kept, MotionLimits, Polish, Problem, ProblemFile, Solution, Solver,
    SolverOptions, Status, Task, Tool,
};
use std::f64::consts::FRAC_PI_2;

fn solve(problem: &Problem, tolerance: f64) -> Solution {
    let options = SolverOptions::default().with_polish(Polish::Never).with_tolerance(tolerance);
    let solution = Solver::new(problem, options).unwrap().solve();
    assert_eq!(solution.motion.status, Status::Converged, "{:?}", solution.limits);
    solution
}

fn limited(tool: impl Into<Tool>, max: f64) -> Task {
    Task::default().with_keep(Keep::new(tool, Kept::Acceleration { max }))
}

#[test]
fn a_mass_goes_a_metre_at_the_exact_cost() {
    // u falls in a straight line, 2 c x at the time x before the middle, where that is less than the limit a;
    // the limit is reached at x_1 with x_1^2 = 3 (1/4 - 1/a). The cost is a^2 (1/2 - 2 x_1/3), 6 without a
    // limit.
    let most = 5.0_f64;
    let reached = (3.0 * (0.25 - 1.0 / most)).sqrt();
    let expected = most * most * (0.5 - 2.0 / 3.0 * reached);
    let problem = Problem::rest_to_rest(sledge(), &[0.0], &[1.0], 1.0).with_limits(MotionLimits::none());
    let solution = solve(&problem.with_task(limited("joint:x", most)), 1e-8);
    let cost = solution.total();
    assert!((cost / expected - 1.0).abs() < 1e-6, "{cost} instead of {expected}");
    let usage = solution.limits.task.as_ref().unwrap();
    assert_eq!(usage.active.len(), 2);
    assert!(usage.active.iter().all(|active| active.name == "acceleration of the tool 'joint:x'"));
    // From the start to x_1 before the middle, within an interval.
    assert!((usage.active[0].to - (0.5 - reached)).abs() < 0.05, "{:?}", usage.active);
}

fn tip() -> Tool {
    Tool::new("joint:elbow").with_offset([1.0, 0.0, 0.0])
}

/// A quarter turn of both joints of the unit arm, in 1 s, with little acceleration of its tip.
fn arm(max: f64, smooth: bool) -> Problem {
    let robot = Robot::from_file("../robots/two_link.toml").unwrap();
    let problem = Problem::rest_to_rest(robot, &[0.0; 2], &[FRAC_PI_2; 2], 1.0);
    let mut problem = problem.with_limits(MotionLimits::none()).with_task(limited(tip(), max));
    if smooth {
        problem.cost = problem.cost.with_jerk(vec![1e-3, 1e-3]);
    }
    problem
}

/// The largest acceleration of the tip along a motion, by differences of its velocity.
fn largest(solution: &Solution) -> f64 {
    let robot = Robot::from_file("../robots/two_link.toml").unwrap();
    let robot = robot.with_frame(
        costate::robot::FrameSpec::new("tip")
            .on("joint:elbow")
            .placed(costate::robot::Placement::from_xyz_rpy([1.0, 0.0, 0.0], [0.0; 3])),
    );
    let robot = robot.unwrap();
    let (mut kinematics, frame) = (Kinematics::<f64>::new(&robot), robot.frame_index("tip").unwrap());
    let mut velocity = |t: f64| {
        let point = solution.trajectory.at(t).unwrap();
        kinematics.set_state(&point.q, &point.v).unwrap();
        kinematics.twist(frame, ReferenceFrame::LocalWorldAligned).unwrap().linear.to_array()
    };
    let step = 1e-4;
    let mut most = 0.0_f64;
    for k in 1..400 {
        let t = f64::from(k) / 400.0;
        let (before, after) = (velocity(t - step), velocity(t + step));
        let square: f64 = before.iter().zip(&after).map(|(a, b)| ((b - a) / (2.0 * step)).powi(2)).sum();
        most = most.max(square.sqrt());
    }
    most
}

#[test]
fn the_tip_of_an_arm_keeps_its_limit() {
    for smooth in [false, true] {
        let free = largest(&solve(&arm(1e6, smooth), 1e-6));
        let most = 0.8 * free;
        let solution = solve(&arm(most, smooth), 1e-6);
        // Between points it may overshoot next to the ends of arcs.
        let found = largest(&solution);
        assert!(found < 1.02 * most && found > 0.97 * most, "{found} {most} {free}");
        let usage = solution.limits.task.as_ref().unwrap();
        assert!(!usage.active.is_empty() && usage.at_points < 1e-6);
    }
}

/// dJ by changes of the state where a motion begins that ends as `problem` does: exact costates against
/// solving again.
fn costates_at(problem: &Problem, solution: &Solution, t: f64, within: f64) {
    let point = solution.trajectory.at(t).unwrap();
    let rest = solution.motion.final_time - t;
    let mut model = Hamiltonian::<f64>::new(&problem.robot);
    let size = point.y_q.iter().chain(&point.y_p).fold(0.0, |most: f64, y| most.max(y.abs()));
    let step = 1e-3;
    for j in 0..4 {
        let mut at = |sign: f64| {
            let mut x = [&point.q[..], &point.v].concat();
            x[j] += sign * step;
            let momentum = model.momentum(&x[..2], &x[2..]).unwrap().to_vec();
            let start = BoundaryState::fixed(&x[..2], &x[2..]);
            let again = problem.clone().with_start(start).with_time(FinalTime::Fixed(rest));
            (solve(&again, 1e-9).total(), momentum)
        };
        let ((up, p_up), (down, p_down)) = (at(1.0), at(-1.0));
        let by_q = if j < 2 { point.y_q[j] } else { 0.0 };
        let by_p: f64 = (0..2).map(|i| point.y_p[i] * (p_up[i] - p_down[i]) / (2.0 * step)).sum();
        let (expected, slope) = (-(by_q + by_p), (up - down) / (2.0 * step));
        assert!((expected - slope).abs() < within * size, "{t} {j}: {expected} {slope} {size}");
    }
}

#[test]
fn costates_are_derivatives_of_the_cost_of_what_remains() {
    let free = largest(&solve(&arm(1e6, false), 1e-6));
    let problem = arm(0.8 * free, false);
    let solution = solve(&problem, 1e-9);
    let active = &solution.limits.task.as_ref().unwrap().active;
    // At the start, on an arc at the limit, between the arcs.
    let inside = active.iter().map(|span| 0.5 * (span.from + span.to)).find(|t| *t > 0.05 && *t < 0.8);
    for t in [0.0, inside.unwrap_or(0.1), 0.5] {
        costates_at(&problem, &solution, t, 5e-3);
    }
}

#[test]
fn what_does_not_go_with_it_is_refused() {
    let top = "robot = \"two_link.toml\"\n[start]\nq = [0, 0]\n[end]\nq = [1, 1]\n[time]\nfinal = 1\n\
               [cost]\neffort = [1, 1]\n[[keep]]\nkind = \"acceleration\"\nframe = \"elbow\"\n";
    let read = |lines: &str| {
        ProblemFile::from_text(&format!("{top}{lines}"), "../robots", LoadOptions::default())
            .map_err(|error| error.to_string())
    };
    let file = read("acceleration = 4\noffset = [1, 0, 0]\n").unwrap();
    let tool = Tool::new("elbow").with_offset([1.0, 0.0, 0.0]);
    assert_eq!(
        file.problem.task,
        Task::default().with_keep(Keep::new(tool, Kept::Acceleration { max: 4.0 }))
    );
    for (lines, expected) in [
        ("acceleration = 0\n", "keep.acceleration: must be positive and finite"),
        ("acceleration = inf\n", "must be positive and finite"),
        ("speed = 1\n", "speed"),
        ("", "acceleration"),
    ] {
        let message = read(lines).unwrap_err();
        assert!(message.contains(expected), "{message}");
    }
}
