use super::slide::cheaper;
use super::*;
use crate::problem::tools::{Tool, ToolPose};
use crate::problem::{BoundaryState, Problem, Task};
use crate::task::build::TaskRows;
use costate::robot::Robot;
use nalgebra::Rotation3;

/// A problem whose end is this pose of a tool.
fn problem(robot: Robot, pose: ToolPose) -> Problem {
    let n = robot.dof();
    let free: Vec<usize> = (0..n).collect();
    let end = BoundaryState::fixed(&vec![0.1; n], &vec![0.0; n]).with_q_free(&free);
    Problem::rest_to_rest(robot, &vec![0.0; n], &vec![0.0; n], 1.0)
        .with_end(end)
        .with_task(Task::default().with_end_tool(pose))
}

fn search(problem: &Problem, limits: &[[f64; 2]]) -> (TaskRows, Reached) {
    let mut rows = TaskRows::new(problem).unwrap();
    let found = reach(&mut rows.end, &problem.end.q, &problem.end.q_free, limits, 0);
    (rows, found)
}

/// Poses that are those of random positions are reached within the limits, from a start far away.
#[test]
fn poses_of_known_positions_are_reached() {
    let arm = Robot::from_file("../robots/ur5.urdf").unwrap();
    let limits: Vec<[f64; 2]> =
        arm.joints().iter().map(|joint| [joint.limits.lower, joint.limits.upper]).collect();
    let mut kinematics = costate::kinematics::Kinematics::<f64>::new(&arm);
    let tool = arm.frame_index("tool0").unwrap();
    let mut rng = fastrand::Rng::with_seed(3);
    for k in 0..40 {
        let q: Vec<f64> = limits.iter().map(|[low, high]| low + (high - low) * rng.f64()).collect();
        kinematics.set_position(&q).unwrap();
        let pose = kinematics.pose(tool).unwrap();
        let rotation = crate::problem::tools::rotation(pose.rotation).unwrap();
        let problem =
            problem(arm.clone(), ToolPose::of("tool0").with_position(pose.position).with_rotation(rotation));
        let (mut rows, found) = search(&problem, &limits);
        assert!(found.is_there(), "{k}: {found:?}");
        assert!(found.q.iter().zip(&limits).all(|(q, [low, high])| (low..=high).contains(&q)));
        let mut g = [f64::NAN; 6];
        rows.end.values(&found.q, &[0.0; 6], &mut g).unwrap();
        let off = rows.end.bounds().iter().zip(g).map(|(row, g)| row.violation(g)).fold(0.0, f64::max);
        assert!(off < 1e-9, "{off}");
    }
}

/// Outside of the workspace the nearest position is found; given joints and limits stay.
#[test]
fn what_is_out_of_reach_is_off_by_the_distance() {
    let arm = Robot::from_file("../robots/two_link.toml").unwrap();
    let last = arm.joints()[1].name.clone();
    let tip = Tool::new(last).with_offset([1.0, 0.0, 0.0]);
    let far = |x: f64| problem(arm.clone(), ToolPose::of(tip.clone()).with_position([x, 0.0, f64::INFINITY]));
    let unlimited = [[f64::NEG_INFINITY, f64::INFINITY]; 2];
    let (_, inside) = search(&far(1.5), &unlimited);
    assert!(inside.is_there());
    let (_, outside) = search(&far(2.5), &unlimited);
    assert!((outside.miss - 0.5).abs() < 1e-4, "{outside:?}");
    let (_, limited) = search(&far(-1.9), &[[-1.0, 1.0], [-1.0, 1.0]]);
    assert!(!limited.is_there() && limited.q.iter().all(|q| q.abs() <= 1.0), "{limited:?}");
    let mut given = far(1.5);
    given.end.q_free = vec![1];
    assert!((search(&given, &unlimited).1.q[0] - 0.1).abs() == 0.0);
    let turned = ToolPose::of(tip.clone()).with_rotation(Rotation3::from_euler_angles(1.0, 0.0, 0.0));
    assert!(
        !search(&problem(arm.clone(), turned), &unlimited).1.is_there(),
        "a planar arm turns about z alone"
    );
    // Stretched out, x has no slope, but it moves elsewhere; z does nowhere.
    let still = |pose: ToolPose| {
        immovable(&mut TaskRows::new(&problem(arm.clone(), pose)).unwrap().end, &[0.0; 2], &[0, 1])
    };
    assert_eq!(still(ToolPose::of(tip.clone()).with_position([2.0, f64::INFINITY, f64::INFINITY])), None);
    assert_eq!(still(ToolPose::of(tip).with_position([1.0, 0.5, 0.0])), Some(2));
}

/// A UR5 whose base has turned around once stays there, and takes the elbow that it has.
#[test]
fn the_nearest_of_several_positions_is_found() {
    let arm = Robot::from_file("../robots/ur5.urdf").unwrap();
    let limits: Vec<[f64; 2]> =
        arm.joints().iter().map(|joint| [joint.limits.lower, joint.limits.upper]).collect();
    let mut kinematics = costate::kinematics::Kinematics::<f64>::new(&arm);
    let tool = arm.frame_index("tool0").unwrap();
    for q in [[-5.0, -1.2, 1.4, -1.8, -1.5, 4.6], [2.9, -2.0, -1.3, 0.2, 1.6, -5.9]] {
        kinematics.set_position(&q).unwrap();
        let pose = kinematics.pose(tool).unwrap();
        let rotation = crate::problem::tools::rotation(pose.rotation).unwrap();
        let pose = ToolPose::of("tool0").with_position(pose.position).with_rotation(rotation);
        let problem = problem(arm.clone(), pose);
        let functions = &mut TaskRows::new(&problem).unwrap().end;
        let near: Vec<f64> = q.iter().zip([0.2, -0.1, 0.15, 0.1, -0.2, 0.3]).map(|(q, by)| q + by).collect();
        let found = reach_near(functions, &near, &problem.end.q_free, &limits, 0);
        assert!(found.is_there() && found.q.iter().zip(q).all(|(a, b)| (a - b).abs() < 1e-6), "{found:?}");
        // From zero, where other branches are nearer to the search, no joint goes farther than it must.
        let found = reach_near(functions, &[0.0; 6], &problem.end.q_free, &limits, 0);
        let mut search = Search::new(functions, &problem.end.q_free, &limits);
        for (i, q) in found.q.iter().enumerate() {
            assert!(found.is_there() && q.abs() <= std::f64::consts::PI, "{i}: {found:?}");
        }
        // Whole turns aside it is the same position.
        let mut away = found.q.clone();
        away[5] += if away[5] > 0.0 { -TAU } else { TAU };
        let away = Reached { q: away, ..found.clone() };
        assert!(
            search.turned_back(away, &[0.0; 6]).q.iter().zip(&found.q).all(|(a, b)| (a - b).abs() < 1e-12)
        );
    }
}

/// Along a line, the position that is nearest to a given one; where rows fix all joints, none.
#[test]
fn a_cheaper_position_keeps_the_rows() {
    let arm = Robot::from_file("../robots/two_link.toml").unwrap();
    let tip = Tool::new("joint:elbow").with_offset([1.0, 0.0, 0.0]);
    let unlimited = [[f64::NEG_INFINITY, f64::INFINITY]; 2];
    let line =
        problem(arm.clone(), ToolPose::of(tip.clone()).with_position([f64::INFINITY, 1.2, f64::INFINITY]));
    let (mut rows, known) = search(&line, &unlimited);
    let wanted = [0.3, 1.0];
    let cost = |q: &[f64]| q.iter().zip(wanted).map(|(q, wanted)| (q - wanted).powi(2)).sum::<f64>();
    let first = cost(&known.q);
    let found = cheaper(&mut rows.end, &known.q, &[0, 1], &unlimited, first, |q| Some(cost(q))).unwrap();
    assert!(cost(&found) < 0.1 * first, "{found:?} {known:?}");
    assert!((found[0].sin() + (found[0] + found[1]).sin() - 1.2).abs() < 1e-8);
    // Nothing is cheaper than nothing, and nothing is found where nothing can be evaluated.
    assert!(cheaper(&mut rows.end, &known.q, &[0, 1], &unlimited, 0.0, |q| Some(cost(q))).is_none());
    assert!(cheaper(&mut rows.end, &known.q, &[0, 1], &unlimited, first, |_| None).is_none());
    let point = problem(arm, ToolPose::of(tip).with_position([1.0, 1.2, f64::INFINITY]));
    let (mut rows, known) = search(&point, &unlimited);
    assert!(cheaper(&mut rows.end, &known.q, &[0, 1], &unlimited, first, |q| Some(cost(q))).is_none());
}
