//! Starts and steps of the interior-point method.

use super::Interior;
use crate::cubics::Disturbance;
use crate::direct::limits::ends::Ends;
use crate::direct::limits::model::Model;
use crate::direct::limits::power::Powers;
use crate::direct::limits::side::{Limited, Side};
use crate::direct::limits::tasks::Tasks;
use crate::direct::motion::guess::guess;
use crate::direct::motion::mesh::Mesh;
use crate::direct::motion::shape::Shape;
use crate::direct::points::generic_points::RobotPoints;
use crate::direct::points::phases::PhaseDynamics;
use crate::direct::points::running::Running;
use crate::problem::{
    FinalTime, Keep, Kept, MotionLimits, Objective, Payload, Problem, Task, Tool, ToolPose, Via,
};
use crate::task::build::TaskRows;
use costate::robot::Robot;

/// A motion of the two-link arm with a free time, which exceeds some of its limits.
pub(in crate::direct) fn started(shape: Shape) -> Interior<PhaseDynamics<RobotPoints>> {
    started_with(shape, &[])
}

/// The same with these vias.
pub(in crate::direct) fn started_with(shape: Shape, vias: &[Via]) -> Interior<PhaseDynamics<RobotPoints>> {
    let robot = Robot::from_file("../robots/two_link.toml").unwrap();
    let mut problem = Problem::rest_to_rest(robot, &[0.0, 0.0], &[1.0, -0.7], 1.2);
    problem.time = FinalTime::Free { guess: 1.2 };
    problem.cost = Objective::new(0.5, vec![1.0, 0.3]).with_energy(vec![0.4, 0.2]);
    problem.limits = MotionLimits::none()
        .with_power_max(vec![1.1; 2])
        .with_total_power_max(1.1)
        .with_torque_max(vec![1.1; 2])
        .with_torque_speed(vec![0.3; 2], vec![1.2; 2]);
    problem.start.v = vec![0.3, -0.2];
    let mut kinds = vec![Limited::Position, Limited::Rate, Limited::Acceleration, Limited::Torque];
    if shape.is_smooth() {
        problem.start.a = Some(vec![0.2, 0.1]);
        kinds.extend([Limited::Jerk, Limited::TorqueRate]);
    }
    let pair = |kind| (0..2).flat_map(move |joint| Side::pair(kind, joint, -1.1, 1.1));
    let sides = kinds.into_iter().flat_map(pair).collect();
    problem.vias = vias.to_vec();
    let spline = guess(&problem, None, &Disturbance::default(), Mesh::even(problem.phases(), 3));
    let dynamics = PhaseDynamics::new(&problem.robots(), RobotPoints::new);
    let tool = || Tool::new("joint:elbow").with_offset([0.3, 0.1, 0.0]);
    let through = [0.1; 3];
    problem.end.q_free = vec![0, 1];
    problem.task = Task::default()
        .with_end_tool(ToolPose::of(tool()).with_position([f64::INFINITY, 0.3, f64::INFINITY]))
        .with_keep(Keep::new(tool(), Kept::Plane { through, normal: [1.0, 0.5, 0.0], distance: 0.0 }))
        .with_keep(Keep::new(tool(), Kept::Speed { max: 1.0 }))
        .with_keep(Keep::new(tool(), Kept::Acceleration { max: 2.0 }));
    let rows = TaskRows::new(&problem).unwrap();
    let running = Running::new(&problem, &rows);
    let powers = Powers::new(&problem);
    let (tasks, ends) = (Tasks::new(&rows, 2, powers.rows()), Ends::new(&problem));
    let model = Model { dynamics, tasks, powers };
    let mut interior = Interior::new(spline, sides, model, running, ends);
    interior.start(None).unwrap();
    interior
}

#[test]
fn slacks_and_multipliers_begin_on_the_central_path() {
    let interior = started(Shape::Quartic);
    let barrier = &interior.barrier;
    assert!(interior.figures.violation > 0.1, "the guess exceeds a limit");
    let nodes = interior.spline.mesh.nodes.len();
    // What is given at the ends, and the equation beside the start, which holds there. The tool's height that
    // is given at the end does not put it on the plane.
    let ends = &interior.ends;
    let of_nodes = [(0, 0), (nodes - 1, 1)]
        .into_iter()
        .flat_map(|(k, end)| barrier.at_node(k).filter(move |&at| ends.is_given(end, barrier.side(at))));
    let of_points = barrier.at_point(0);
    let given: Vec<usize> = of_nodes.chain(of_points.filter(|&at| barrier.side(at).is_equation)).collect();
    assert_eq!(given.len(), 8 + 4 + 1);
    let mut equations = 0;
    for at in 0..barrier.count() {
        let (slack, multiplier) = (barrier.slack[at], barrier.multiplier[at]);
        assert_eq!(slack.is_infinite(), given.contains(&at), "{at}");
        if slack.is_infinite() || slack == 0.0 {
            assert_eq!(multiplier, 0.0);
            assert_eq!(slack == 0.0, barrier.is_on(at) && barrier.side(at).is_equation);
            equations += usize::from(slack == 0.0);
            continue;
        }
        assert!(slack > 0.0 && slack >= barrier.distance[at]);
        let product = interior.mu * barrier.weight[at];
        assert!((slack * multiplier / product - 1.0).abs() < 1e-12);
    }
    assert_eq!(equations, barrier.points() - 1 + 1);
}

#[test]
fn steps_where_accelerations_jump() {
    both_steps_are_those_of_the_linearised_conditions(Shape::Quartic);
}

#[test]
fn steps_where_accelerations_are_continuous() {
    both_steps_are_those_of_the_linearised_conditions(Shape::Quintic);
}

/// In one phase, and with two vias.
fn both_steps_are_those_of_the_linearised_conditions(shape: Shape) {
    steps_are_those_of_the_linearised_conditions(started(shape));
    let tip = Payload::point("joint:elbow", 0.5, [1.0, 0.0, 0.0]);
    let first = Via::at(&[0.4, 0.3]).with_q_free(&[1]).with_payload(tip);
    let vias = [first, Via::at(&[0.8, -0.2]).with_v(&[0.1, 0.2]).with_time(0.6)];
    steps_are_those_of_the_linearised_conditions(started_with(shape, &vias));
}

fn steps_are_those_of_the_linearised_conditions(mut interior: Interior<PhaseDynamics<RobotPoints>>) {
    interior.refresh().unwrap();
    interior.system.assemble(
        &interior.spline,
        &interior.points,
        &interior.barrier,
        &mut interior.running,
        &interior.ends,
    );
    assert!(interior.factorise(1.0));
    interior.solve();
    // Changes of the distances along each part of the step.
    let (base, step) = (interior.spline.clone(), 1e-5);
    for part in 0..2 {
        let size = interior.steps[part].iter().fold(1e-300, |most: f64, dx| most.max(dx.abs()));
        let mut along = |sign: f64| {
            let factor = sign * step / size;
            let mut spline = base.clone();
            let pairs = spline.unknowns.iter_mut().zip(&interior.steps[part]);
            pairs.for_each(|(unknown, dx)| *unknown += factor * dx);
            let times = spline.times.iter_mut().zip(&interior.time_steps[part]);
            times.for_each(|(time, dt)| *time += factor * dt);
            interior.spline = spline;
            interior.evaluate().unwrap();
            let distance = interior.barrier.distance.clone();
            interior.spline = base.clone();
            interior.evaluate().unwrap();
            distance
        };
        let (above, below) = (along(1.0), along(-1.0));
        let differences = above.iter().zip(&below).map(|(above, below)| (above - below) / (2.0 * step));
        let scale = interior.changes[part].iter().fold(0.0, |most: f64, c| most.max(c.abs())) / size;
        for (change, difference) in interior.changes[part].iter().zip(differences) {
            let change = change / size;
            assert!((change - difference).abs() < 1e-6 * scale, "{part}: {change} {difference}");
        }
    }
    // s deta + eta ds = mu w - eta s, ds = dd + d - s, and both stay positive.
    let mu = 0.3 * interior.mu;
    let (primal, dual) = interior.steps_of(mu);
    assert!(primal > 0.0 && primal <= 1.0 && dual > 0.0 && dual <= 1.0);
    for at in 0..interior.barrier.slack.len() {
        let (s, eta) = (interior.barrier.slack[at], interior.barrier.multiplier[at]);
        if s.is_infinite() {
            continue;
        }
        let (ds, deta) = (interior.trial.slack_step[at], interior.trial.multiplier_step[at]);
        if s == 0.0 {
            // The multiplier goes up with what is left of the equation.
            let left = interior.barrier.distance[at] + interior.changes[0][at] + mu * interior.changes[1][at];
            assert!(ds == 0.0 && (deta + interior.barrier.curvature(at) * left).abs() < 1e-12 * deta.abs());
            continue;
        }
        let weight = interior.barrier.weight[at];
        let terms = [s * deta, eta * ds, -mu * weight, eta * s];
        let size: f64 = terms.iter().map(|term| term.abs()).sum();
        assert!(terms.iter().sum::<f64>().abs() < 1e-12 * size);
        assert!(s + primal * ds > 0.0 && eta + dual * deta > 0.0);
    }
}

#[test]
fn products_after_a_correction_are_those_that_it_aims_at() {
    [Shape::Quartic, Shape::Quintic].into_iter().for_each(corrections_reach_their_aims);
}

fn corrections_reach_their_aims(shape: Shape) {
    let mut interior = started(shape);
    interior.refresh().unwrap();
    interior.assemble();
    assert!(interior.factorise(1.0));
    interior.solve();
    // The gradient of what corrections add is that of the sum of -(c/s) d.
    let count = interior.barrier.count();
    let mut random = fastrand::Rng::with_seed(5);
    let corrections: Vec<f64> = (0..count).map(|_| random.f64() - 0.5).collect();
    let Interior { system, spline, points, barrier, ends, steps, changes, time_steps, .. } = &mut interior;
    system.collect_corrections(spline, points, barrier, ends, &corrections);
    let on = (0..count).filter(|&at| barrier.is_limit(at));
    let terms: Vec<f64> = on.map(|at| -corrections[at] / barrier.slack[at] * changes[0][at]).collect();
    let along: f64 = system.correction.iter().zip(&steps[0]).map(|(g, dx)| g * dx).sum();
    let along = along + system.time_correction[0] * time_steps[0][0];
    let size: f64 = terms.iter().map(|term| term.abs()).sum();
    assert!((terms.iter().sum::<f64>() - along).abs() < 1e-11 * size, "{along} {size}");

    // A step that is kept is no shorter; products after a corrected step are those that are aimed at.
    let before = interior.steps_of(interior.mu);
    let after = interior.correct();
    assert_eq!(after, interior.steps_of(interior.mu));
    assert!(after.0 >= before.0 && after.1 >= before.1, "{before:?} {after:?}");
    interior.aim([0.5, 0.5]);
    interior.solve_correction();
    interior.swap_corrections();
    interior.steps_of(interior.mu);
    assert!(interior.corrections[0].iter().any(|correction| *correction != 0.0));
    for at in (0..count).filter(|&at| interior.barrier.is_limit(at)) {
        let (s, eta) = (interior.barrier.slack[at], interior.barrier.multiplier[at]);
        let (ds, deta) = (interior.trial.slack_step[at], interior.trial.multiplier_step[at]);
        let aim = interior.mu * interior.barrier.weight[at] + interior.corrections[0][at];
        let terms = [s * deta, eta * ds, eta * s, -aim];
        let size: f64 = terms.iter().map(|term| term.abs()).sum();
        assert!(terms.iter().sum::<f64>().abs() < 1e-12 * size);
    }
}

#[test]
fn limits_move_inside_at_the_points_and_nodes_of_an_interval() {
    let mut interior = started(Shape::Quartic);
    let side = interior.barrier.sides().iter().position(|side| side.limited == Limited::Rate).unwrap();
    let before = interior.barrier.distance.clone();
    interior.barrier.move_inside(1, side, 0.01, 1.0);
    interior.begin_again();
    let barrier = &interior.barrier;
    let mut moved = 0;
    for (at, before) in before.iter().enumerate() {
        let change = before - barrier.distance[at];
        assert!((barrier.true_distance(at) - before).abs() < 1e-12);
        assert!(change.abs() < 1e-12 || (change - 0.01).abs() < 1e-12);
        moved += usize::from(change > 1e-3);
        assert!(!barrier.is_limit(at) || (barrier.slack[at] > 0.0 && barrier.multiplier[at] > 0.0));
    }
    assert_eq!(moved, 3 + 2);
}

#[test]
fn damping_of_squares_is_that_of_one_mesh() {
    let mut interior = started(Shape::Quartic);
    interior.squares.damping = 1e3;
    interior.iterate(1e-3, 0, |_, _| None).unwrap();
    assert_eq!(interior.squares.damping, 0.0);
}

#[test]
fn what_is_undefined_keeps_no_limit() {
    let mut interior = started(Shape::Quartic);
    for kind in [Limited::Torque, Limited::Task] {
        let barrier = &interior.barrier;
        let is = |at: &usize| barrier.is_on(*at) && barrier.side(*at).limited == kind;
        let at = (0..barrier.count()).find(is).unwrap();
        assert_eq!(barrier.side(at).violation(f64::NAN), f64::INFINITY);
        let distance = std::mem::replace(&mut interior.barrier.distance[at], f64::NAN);
        interior.measure_figures();
        assert_eq!(interior.figures.violation, f64::INFINITY);
        interior.barrier.distance[at] = distance;
        interior.measure_figures();
        assert!(interior.figures.violation.is_finite());
    }
}
