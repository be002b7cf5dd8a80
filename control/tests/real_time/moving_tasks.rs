//! Problems that are solved again with tools, obstacles and references that move.

use crate::resolve::options;
use costate::kinematics::Kinematics;
use costate::robot::Robot;
use costate_control::{
    Budget, Collision, JointReference, LinkCapsule, MotionLimits, Objective, Obstacle, Problem, Reference,
    Resolve, ResolveError, ResolveStatus, Shape, Task, TaskError, ToolCost, ToolPose, ToolReference,
};
use costate_test_support::allocations::allocations;

#[test]
fn goals_of_tools_move() {
    let robot = Robot::from_file("../robots/ur5.urdf").unwrap();
    let (q, free) = ([0.4, -1.3, 1.6, -1.8, -1.57, 0.3], f64::INFINITY);
    let arm = |end: [f64; 3], cost: [f64; 3]| {
        let mut arm = Problem::rest_to_rest(robot.clone(), &q, &q, 1.0).with_limits(MotionLimits::none());
        arm.cost = Objective::new(0.0, vec![1e-4, 1e-4, 1e-4, 1e-3, 1e-3, 1e-3]);
        arm.end.q_free = (0..6).collect();
        arm.task = Task::default()
            .with_end_tool(ToolPose::of("tool0").with_position(end))
            .with_tool_cost(ToolCost::new(ToolPose::of("wrist_1_link").with_position(cost), 1.0, 0.0));
        arm
    };
    let (end, cost) = ([0.5, 0.2, free], [0.3, 0.1, 0.5]);
    let mut motion = Resolve::new(&arm(end, cost), options(12, 1e-7)).unwrap();
    let first = motion.solve().unwrap();
    assert_eq!(first.status, ResolveStatus::Solved);
    let mut kinematics = Kinematics::<f64>::new(&robot);
    let frame = robot.frames().iter().position(|frame| frame.name == "tool0").unwrap();
    let mut costs = Vec::new();
    for k in [1.0, 2.0, 1.0, 0.0] {
        let to = [end[0] - 0.02 * k, end[1] + 0.03 * k];
        // What is free stays free.
        motion.set_end_tool(0, [to[0], to[1], 77.0]).unwrap();
        motion.set_tool_cost(0, [cost[0] - 0.03 * k, cost[1], cost[2] + 0.03 * k]).unwrap();
        let found = motion.solve_again(Budget::steps(60)).unwrap();
        assert_eq!((found.status, found.keeps_limits()), (ResolveStatus::Solved, true), "{k} {found:?}");
        let mut z = [0.0; 18];
        motion.state_at(1.0, &mut z).unwrap();
        kinematics.set_state(&z[..6], &z[6..12]).unwrap();
        let reached = kinematics.pose(frame).unwrap().position;
        assert!((0..2).all(|i| (reached[i] - to[i]).abs() < 1e-7), "{k}: {reached:?}");
        costs.push(found.cost);
    }
    // There and back again: the same motion, and one that is no dearer than the first.
    assert!((costs[2] / costs[0] - 1.0).abs() < 1e-5, "{costs:?}");
    assert!(costs[3] < (1.0 + 1e-5) * first.cost, "{costs:?} {}", first.cost);
    assert!((costs[1] / costs[0] - 1.0).abs() > 1e-3);
    let error = motion.set_start_tool(0, [0.0; 3]).unwrap_err().to_string();
    assert!(error.starts_with("start.tool: there is no entry 0"), "{error}");
    let error = motion.set_end_tool(0, [f64::NAN, 0.0, 0.0]).unwrap_err().to_string();
    assert!(error.starts_with("end.tool: entry 0 is not finite"), "{error}");
}

/// The two-link arm turns past a ball.
fn past_a_ball(at: [f64; 3]) -> Problem {
    let robot = Robot::from_file("../robots/two_link.toml").unwrap();
    let ball = Shape::Sphere { centre: at, radius: 0.1 };
    let tip = LinkCapsule::sphere("elbow", 0.05).with_from([1.0, 0.0, 0.0]);
    let task =
        Task::default().with_obstacle(Obstacle::new("ball", ball)).with_collision(Collision::of(vec![tip]));
    let mut arm =
        Problem::rest_to_rest(robot, &[0.0, 0.2], &[1.5, 0.2], 1.0).with_limits(MotionLimits::none());
    arm.cost = Objective::new(0.0, vec![1.0; 2]);
    arm.with_task(task)
}

/// So far outside of a place of the tip of the arm.
fn beside(tip: [f64; 2], out: f64) -> [f64; 3] {
    let part = 1.0 + out / tip[0].hypot(tip[1]);
    [part * tip[0], part * tip[1], 0.0]
}

#[test]
fn obstacles_move_between_solves() {
    let mut motion = Resolve::new(&past_a_ball([9.0, 0.0, 0.0]), options(16, 1e-6)).unwrap();
    let free = motion.solve().unwrap();
    let mut z = [0.0; 6];
    motion.state_at(0.5, &mut z).unwrap();
    let tip = [z[0].cos() + (z[0] + z[1]).cos(), z[0].sin() + (z[0] + z[1]).sin()];
    let ball = |out: f64| Shape::Sphere { centre: beside(tip, out), radius: 0.1 };
    let mut costs = Vec::new();
    let mut again = |out: f64| {
        motion.set_obstacle(0, &ball(out)).unwrap();
        motion.solve_again(Budget::steps(80)).unwrap()
    };
    again(0.3);
    let mut found = Vec::with_capacity(8);
    let allocated = allocations(|| {
        for out in [0.3, 0.14, 0.1, 0.14, 0.3] {
            found.push((out, again(out)));
        }
    });
    assert_eq!(allocated, 0);
    for (out, found) in found {
        assert_eq!((found.status, found.keeps_limits()), (ResolveStatus::Solved, true), "{out} {found:?}");
        let fresh = Resolve::new(&past_a_ball(beside(tip, out)), options(16, 1e-6)).unwrap().solve().unwrap();
        // From scratch the arm may pass on the other side, which costs more.
        assert!(found.cost < fresh.cost * (1.0 + 1e-4), "{out}: {found:?} {fresh:?}");
        costs.push(found.cost);
    }
    // Out of the way; closer than both radii; there and back.
    assert!((0..2).all(|k| (costs[k] / costs[4 - k] - 1.0).abs() < 1e-4), "{costs:?}");
    assert!((costs[0] / free.cost - 1.0).abs() < 1e-4 && costs[2] > 1.001 * costs[0], "{costs:?}");
    assert!(costs[1] > costs[0] && costs[2] > costs[1], "{costs:?}");
    let other = Shape::Sphere { centre: [0.0; 3], radius: 0.2 };
    match motion.set_obstacle(0, &other) {
        Err(ResolveError::Task { table: "obstacle", entry: 0, cause: TaskError::OtherShape }) => {}
        other => panic!("{other:?}"),
    }
    let nowhere = Shape::Sphere { centre: [f64::NAN; 3], radius: 0.1 };
    let error = motion.set_obstacle(0, &nowhere).unwrap_err().to_string();
    assert_eq!(error, "obstacle, entry 0: must be finite");
    let error = motion.set_obstacle(1, &ball(0.3)).unwrap_err().to_string();
    assert!(error.starts_with("obstacle: there is no entry 1"), "{error}");
}

/// A post that is thinner than the way from point to point of the mesh stands in the way of the tip.
#[test]
fn bodies_that_pass_through_each_other_do_not_keep_their_limits() {
    let with_post = |centre: [f64; 3], radius: f64| {
        let tip = LinkCapsule::sphere("elbow", 1e-4).with_from([1.0, 0.0, 0.0]);
        let post = Obstacle::new("post", Shape::Sphere { centre, radius });
        let task = Task::default().with_obstacle(post).with_collision(Collision::of(vec![tip]));
        let robot = Robot::from_file("../robots/two_link.toml").unwrap();
        let arm = Problem::rest_to_rest(robot, &[0.0, 0.3], &[1.5, 0.3], 1.0);
        arm.with_limits(MotionLimits::none()).with_task(task)
    };
    let tip = |z: &[f64]| [z[0].cos() + (z[0] + z[1]).cos(), z[0].sin() + (z[0] + z[1]).sin(), 0.0];
    let mut through = 0;
    for radius in [0.1, 0.01, 1e-3] {
        for place in [0.45, 0.515] {
            let mut motion = Resolve::new(&with_post([5.0, 5.0, 0.0], radius), options(20, 1e-2)).unwrap();
            let free = motion.solve().unwrap();
            assert!(free.keeps_limits() && free.clearance_violation == 0.0, "{free:?}");
            let mut z = [0.0; 6];
            motion.state_at(place, &mut z).unwrap();
            let centre = tip(&z);
            motion.set_obstacle(0, &Shape::Sphere { centre, radius }).unwrap();
            let mut found = free;
            let allocated = allocations(|| found = motion.solve_again(Budget::steps(40)).unwrap());
            assert_eq!(allocated, 0);
            // The least distance at many places.
            let mut least = f64::INFINITY;
            for k in 0..=100_000 {
                motion.state_at(f64::from(k) * 1e-5, &mut z).unwrap();
                let at = tip(&z);
                least = least.min((at[0] - centre[0]).hypot(at[1] - centre[1]));
            }
            let overlap = 1.0 - least / (radius + 1e-4);
            assert!(overlap < 0.02 || !found.keeps_limits(), "{radius} {place}: {overlap} {found:?}");
            through += usize::from(overlap > 0.5);
        }
    }
    assert!(through > 0, "some posts are too thin for the mesh");
}

/// A joint reference that goes to and fro, and one of the tip, later by `shift`.
fn followed(shift: f64) -> [Reference; 2] {
    let times: Vec<f64> = (0..5).map(|k| 0.4 * f64::from(k) - shift).collect();
    let at = |k: f64| 0.4 * (2.0 * k).sin();
    let rows = (0..5).map(|k| vec![at(f64::from(k)), 0.3 + at(f64::from(k) + 0.3)]).collect();
    let places = (0..5).map(|k| [1.5, at(f64::from(k)), f64::INFINITY]).collect();
    [
        JointReference::new(times.clone(), rows, vec![40.0, 20.0]).into(),
        ToolReference::of("elbow", times).with_positions(places, 15.0).into(),
    ]
}

fn following(shift: f64) -> Problem {
    let robot = Robot::from_file("../robots/two_link.toml").unwrap();
    let mut arm =
        Problem::rest_to_rest(robot, &[0.0, 0.2], &[0.3, 0.2], 0.8).with_limits(MotionLimits::none());
    arm.cost = Objective::new(0.0, vec![1.0; 2]);
    let [joints, tip] = followed(shift);
    arm.with_task(Task::default().with_reference(joints).with_reference(tip))
}

#[test]
fn references_go_on_by_the_start_time_or_by_new_knots() {
    let mut motion = Resolve::new(&following(0.0), options(12, 1e-8)).unwrap();
    motion.solve().unwrap();
    let fresh =
        |shift: f64| Resolve::new(&following(shift), options(12, 1e-8)).unwrap().solve().unwrap().cost;
    motion.set_start_time(0.05).unwrap();
    motion.solve_again(Budget::steps(40)).unwrap();
    let times = [0.1, 0.3, 0.7];
    let mut costs = [0.0; 3];
    let found = allocations(|| {
        for (cost, &time) in costs.iter_mut().zip(&times) {
            motion.set_start_time(time).unwrap();
            *cost = motion.solve_again(Budget::steps(40)).unwrap().cost;
        }
    });
    assert_eq!(found, 0);
    for (cost, time) in costs.into_iter().zip(times) {
        assert!((cost / fresh(time) - 1.0).abs() < 1e-6, "{time}");
    }
    // The same as other knots, which are no more than before.
    motion.set_start_time(0.0).unwrap();
    let [joints, tip] = followed(0.3);
    let mut cost = 0.0;
    let found = allocations(|| {
        motion.set_reference(0, &joints).unwrap();
        motion.set_reference(1, &tip).unwrap();
        cost = motion.solve_again(Budget::steps(40)).unwrap().cost;
    });
    assert!(found == 0 && (cost / costs[1] - 1.0).abs() < 1e-6, "{cost} {costs:?}");
    let says = |error: ResolveError, words: &str| assert!(error.to_string().contains(words), "{error}");
    says(motion.set_reference(2, &tip).unwrap_err(), "cost.reference: there is no entry 2");
    says(
        motion.set_reference(0, &tip).unwrap_err(),
        "cost.reference, entry 0: is a reference of something else",
    );
    let short = JointReference::new(vec![0.0], vec![vec![0.0]], vec![1.0; 2]);
    says(motion.set_reference(0, &short.into()).unwrap_err(), "one for each joint, but has 1");
    says(motion.set_start_time(f64::NAN).unwrap_err(), "the start time");
}
