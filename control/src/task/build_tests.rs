use super::*;
use crate::problem::obstacles::{BodyPairs, Collision, LinkCapsule, Obstacle, Shape};
use crate::problem::tools::{Keep, Kept, Tool, ToolCost};
use crate::problem::{BoundaryState, Task};
use crate::task::functions::PathFunction;
use crate::task::row::Row;
use costate::kinematics::{Kinematics, ReferenceFrame};
use costate::robot::Robot;
use nalgebra::{Matrix3, Rotation3, Vector3};

const Q: [f64; 6] = [0.3, -1.2, 0.8, 0.1, 0.5, 0.2];
const V: [f64; 6] = [0.1, -0.2, 0.3, 0.4, -0.5, 0.6];

fn arm() -> Robot {
    Robot::from_file("../robots/ur5.urdf").unwrap()
}

fn rows(robot: Robot, task: Task) -> TaskRows {
    let n = robot.dof();
    TaskRows::new(&Problem::rest_to_rest(robot, &vec![0.0; n], &vec![0.0; n], 1.0).with_task(task)).unwrap()
}

fn violations(functions: &mut TaskFunctions, q: &[f64], v: &[f64]) -> Vec<f64> {
    let mut g = vec![f64::NAN; functions.rows()];
    functions.values(q, v, &mut g).unwrap();
    functions.bounds().iter().zip(g).map(|(row, g)| row.excess(g)).collect()
}

/// Each kind holds with a tolerance just above what the tool deviates by, and fails with one just below.
#[test]
fn tolerances_of_what_is_kept_are_distances_angles_and_speeds() {
    let arm = arm();
    let tool = Tool::new("tool0").with_offset([0.02, -0.05, 0.1]);
    let mut kinematics = Kinematics::<f64>::new(&arm);
    kinematics.set_state(&Q, &V).unwrap();
    let frame = arm.frame_index("tool0").unwrap();
    let (pose, twist) =
        (kinematics.pose(frame).unwrap(), kinematics.twist(frame, ReferenceFrame::LocalWorldAligned));
    let [a, b, c] = pose.rotation;
    let rotation = Matrix3::new(a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2]);
    let turn = Rotation3::from_matrix_unchecked(rotation);
    let arm_to_point = rotation * Vector3::from(tool.offset);
    let x = Vector3::from(pose.position) + arm_to_point;
    let twist = twist.unwrap();
    let turning = Vector3::from(twist.angular.to_array());
    let speed = (Vector3::from(twist.linear.to_array()) + turning.cross(&arm_to_point)).norm();
    let across = Vector3::new(0.6, 0.0, 0.8);
    let vertical = Rotation3::from_scaled_axis(Vector3::z() * 0.2) * turn * Vector3::x();
    // The angle of a turn about z, seen between the axes themselves.
    let angle = vertical.dot(&(turn * Vector3::x())).acos();
    let kinds = |off: f64| {
        let tilted = Rotation3::from_scaled_axis(across * 0.2) * turn;
        let through: [f64; 3] = (x + across * 0.03 + Vector3::y() * 0.5).into();
        [
            Kept::Plane { through, normal: [-1.2, 0.0, -1.6], distance: 0.03 * off },
            Kept::Line { through, along: [0.0, 2.0, 0.0], distance: 0.03 * off },
            Kept::Axis { axis: [3.0, 0.0, 0.0], along: (vertical * 5.0).into(), angle: angle * off },
            Kept::Orientation { rotation: tilted, angle: 0.2 * off },
            Kept::Speed { max: speed * off },
            Kept::Box {
                min: [f64::NEG_INFINITY; 3],
                max: [f64::INFINITY, f64::INFINITY, x.z + 0.1 * (off - 1.0)],
            },
        ]
    };
    let sizes = [0.03, 0.03, angle, 0.2, speed, 0.1];
    for ((inside, outside), size) in kinds(1.0001).into_iter().zip(kinds(0.9999)).zip(sizes) {
        let name = format!("{inside:?}");
        let kept = |kept: Kept| {
            let mut found = rows(arm.clone(), Task::default().with_keep(Keep::new(tool.clone(), kept))).along;
            violations(&mut found, &Q, &V)
        };
        assert_eq!(kept(inside), [0.0], "{name}");
        let by = kept(outside)[0];
        assert!((by - 1e-4 * size).abs() < 1e-10, "{name}: {by} for {size}");
    }
}

/// Without a tolerance all of these are equations, and hold at the pose that they are made from.
#[test]
fn equations_hold_where_they_are_made() {
    let arm = arm();
    let mut kinematics = Kinematics::<f64>::new(&arm);
    kinematics.set_position(&Q).unwrap();
    let pose = kinematics.pose(arm.frame_index("tool0").unwrap()).unwrap();
    let rotation = crate::problem::tools::rotation(pose.rotation).unwrap();
    let (x, through) = (Vector3::from(pose.position), pose.position);
    let along: [f64; 3] = (rotation * Vector3::z()).into();
    let keep = |kept: Kept| Keep::new("tool0", kept);
    let there = ToolPose::of("tool0").with_position(pose.position).with_rotation(rotation);
    let task = Task::default()
        .with_keep(keep(Kept::Plane { through, normal: [0.0, 1.0, 1.0], distance: 0.0 }))
        .with_keep(keep(Kept::Line { through: (x + Vector3::from(along)).into(), along, distance: 0.0 }))
        .with_keep(keep(Kept::Axis { axis: [0.0, 0.0, 1.0], along, angle: 0.0 }))
        .with_keep(keep(Kept::Orientation { rotation, angle: 0.0 }))
        .with_end_tool(there.clone())
        .with_end_tool(ToolPose::of("wrist_1_link").with_position([f64::INFINITY, 0.0, f64::INFINITY]))
        .with_start_tool(ToolPose::of("tool0").with_axis([0.0, 0.0, 1.0], along))
        .with_tool_cost(ToolCost::new(there, 3.0, 5.0));
    let mut rows = rows(arm, task);
    assert_eq!([&rows.start, &rows.along, &rows.end, &rows.costs].map(PathFunction::rows), [2, 8, 7, 6]);
    assert_eq!(rows.weights, [3.0, 3.0, 3.0, 5.0, 5.0, 5.0]);
    for functions in [&mut rows.start, &mut rows.along, &mut rows.costs] {
        assert!(functions.bounds().iter().all(Row::is_equation));
        let off = violations(functions, &Q, &V).into_iter().fold(0.0, f64::max);
        assert!(off < 1e-14, "{off}");
    }
    let off = violations(&mut rows.end, &Q, &V);
    assert!(off[..6].iter().all(|off| *off < 1e-14) && off[6] > 0.01);
    assert_eq!(rows.end.bounds()[6].name, "y of the tool 'wrist_1_link'");
}

/// A point at the tip of the two-link arm outside of a disc.
#[test]
fn the_clearance_of_a_point_from_a_disc_is_exact_at_contact() {
    let arm = Robot::from_file("../robots/two_link.toml").unwrap();
    let disc = Obstacle::new("disc", Shape::Sphere { centre: [0.34, 0.59, 0.0], radius: 0.25 });
    let tip = LinkCapsule::sphere("elbow", 0.0).with_from([1.0, 0.0, 0.0]);
    let task = Task::default().with_obstacle(disc).with_collision(Collision::of(vec![tip]));
    let mut along = rows(arm, task).along;
    // The tip at the distance 0.25 from the centre, above it: q by the law of cosines.
    for (y, sign) in [(0.84_f64 + 1e-9, 1.0), (0.84 - 1e-9, -1.0)] {
        let distance = 0.34_f64.hypot(y);
        let bend = (0.5 * distance).acos();
        let q = [y.atan2(0.34) - bend, 2.0 * bend];
        let mut g = [f64::NAN];
        along.values(&q, &[0.0; 2], &mut g).unwrap();
        assert!((g[0] - sign * 1e-9).abs() < 1e-14, "{}", g[0]);
    }
    assert_eq!(along.bounds()[0].name, "clearance of 'elbow' from 'disc'");
}

/// Capsules along links, and pairs that are no neighbours.
#[test]
fn capsules_are_laid_along_links() {
    let arm = arm();
    let floor =
        Obstacle::new("floor", Shape::HalfSpace { through: [0.0, 0.0, -0.2], normal: [0.0, 0.0, 1.0] });
    let collision =
        Collision::along_links(0.05).with_pairs(BodyPairs::All).with_exception("floor", "forearm_link");
    let rows = rows(arm, Task::default().with_obstacle(floor).with_collision(collision));
    let names =
        rows.along.bounds().iter().map(|row| row.name.replace("clearance of ", "").replace("_link", ""));
    // The joints of the shoulder meet in one point, so it has no body; the last link has no length. Both ends
    // of a capsule stay above the floor.
    let expected = [
        "'upper_arm' from 'floor'",
        "'upper_arm' from 'floor'",
        "'wrist_1' from 'floor'",
        "'wrist_1' from 'floor'",
        "'wrist_2' from 'floor'",
        "'wrist_2' from 'floor'",
        "'wrist_3' from 'floor'",
        "'upper_arm' from 'wrist_1'",
        "'upper_arm' from 'wrist_2'",
        "'upper_arm' from 'wrist_3'",
        "'forearm' from 'wrist_2'",
        "'forearm' from 'wrist_3'",
        "'wrist_1' from 'wrist_3'",
    ];
    assert_eq!(names.collect::<Vec<_>>(), expected);
}

/// Two offsets in one frame are two points.
#[test]
fn offsets_of_several_tools_on_one_frame_are_frames_of_their_own() {
    let arm = arm();
    let at = |offset: [f64; 3]| {
        ToolPose::of(Tool::new("tool0").with_offset(offset)).with_position([0.1, 0.2, 0.3])
    };
    let task = Task::default().with_end_tool(at([0.0, 0.0, 0.1])).with_end_tool(at([0.0, 0.0, -0.1]));
    let free: Vec<usize> = (0..6).collect();
    let mut problem = Problem::rest_to_rest(arm, &Q, &Q, 1.0).with_task(task);
    problem.end = BoundaryState::fixed(&Q, &[0.0; 6]).with_q_free(&free);
    let mut end = TaskRows::new(&problem).unwrap().end;
    let mut g = [f64::NAN; 6];
    end.values(&Q, &[0.0; 6], &mut g).unwrap();
    let apart = (Vector3::new(g[0], g[1], g[2]) - Vector3::new(g[3], g[4], g[5])).norm();
    assert!((apart - 0.2).abs() < 1e-15, "{apart}");
}
