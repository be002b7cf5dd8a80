use super::*;
use crate::problem::{Obstacle, Problem, Shape, Task};
use crate::task::build::TaskRows;
use crate::task::functions::PathFunction;
use costate::robot::{FrameSpec, JointSpec, LinkInertia, Placement};
use costate_test_support::robots::file;
use nalgebra::Matrix3;

const RADIUS: f64 = 0.05;

fn laid(robot: &Robot) -> Vec<(String, Vector3<f64>)> {
    let found = links(robot, &Collision::along_links(RADIUS)).unwrap();
    let body = |link: Link| {
        let Body { carried, from, to, radius } = link.body;
        assert!(carried.is_some() && from == Vector3::zeros() && radius == RADIUS, "{}", link.name);
        (link.name, to.unwrap_or_default())
    };
    found.into_iter().map(body).collect()
}

/// The lengths between the joints of a UR5, by its Denavit-Hartenberg table: a_2, then a_3 and d_4 together,
/// d_5, d_6. The joints of the shoulder meet in one point; the frame of the tool is that of the last joint.
#[test]
fn capsules_along_links_are_as_long_as_their_links() {
    let expected = [
        ("upper_arm_link", 0.425),
        ("forearm_link", 0.39225_f64.hypot(0.10915)),
        ("wrist_1_link", 0.09465),
        ("wrist_2_link", 0.0823),
        ("wrist_3_link", 0.0),
    ];
    let found = laid(&file("ur5.urdf"));
    assert_eq!(found.len(), expected.len(), "{found:?}");
    for ((name, to), (link, length)) in found.iter().zip(expected) {
        assert!(name == link && (to.norm() - length).abs() < 1e-15, "{name}: {}", to.norm());
    }
}

/// From a joint to each joint that its link carries; from a last joint to the farthest frame.
#[test]
fn capsules_go_to_all_joints_and_to_the_farthest_frame() {
    let body = LinkInertia::about_com(1.0, [0.1, 0.0, 0.0], Matrix3::identity());
    let at = |xyz| Placement::from_xyz_rpy(xyz, [0.0; 3]);
    let joint = |name: &str, xyz| JointSpec::revolute(name).placed(at(xyz)).link(name).carrying(body);
    let robot = Robot::builder("tree")
        .joint(joint("trunk", [0.0, 0.0, 2.0]))
        .joint(joint("left", [0.0, 1.0, 0.0]).on("trunk"))
        .joint(joint("right", [0.0, -1.0, 0.5]).on("trunk"))
        .frame(FrameSpec::new("near").on("left").placed(at([0.1, 0.0, 0.0])))
        .frame(FrameSpec::new("far").on("left").placed(at([0.0, 0.0, -0.7])))
        .build()
        .unwrap();
    let expected = [
        ("trunk", [0.0, 1.0, 0.0]),
        ("trunk 2", [0.0, -1.0, 0.5]),
        ("left", [0.0, 0.0, -0.7]),
        ("right", [0.0; 3]),
    ];
    assert_eq!(laid(&robot), expected.map(|(name, to)| (name.to_owned(), Vector3::from(to))));
}

/// Balls that touch the stretched arm beside its links and beyond its tip, also where a link is longer.
#[test]
fn capsules_along_links_touch_where_their_radius_ends() {
    let ball = 0.2;
    for longer in [0.0, 0.3] {
        let arm = file("two_link.toml");
        let tip = Placement::from_xyz_rpy([1.0 + longer, 0.0, 0.0], [0.0; 3]);
        let arm = arm.with_frame(FrameSpec::new("tip").on("elbow").placed(tip)).unwrap();
        let touching =
            [[0.4, ball + RADIUS, 0.0], [1.6, 0.0, -ball - RADIUS], [2.0 + longer + ball + RADIUS, 0.0, 0.0]];
        for (k, centre) in touching.into_iter().enumerate() {
            for (off, sign) in [(1.0 + 1e-9, 1.0), (1.0 - 1e-9, -1.0)] {
                let shape = Shape::Sphere { centre, radius: ball * off };
                let task = Task::default()
                    .with_obstacle(Obstacle::new("ball", shape))
                    .with_collision(Collision::along_links(RADIUS));
                let problem = Problem::rest_to_rest(arm.clone(), &[0.0; 2], &[0.0; 2], 1.0).with_task(task);
                let mut along = TaskRows::new(&problem).unwrap().along;
                let mut clearances = vec![f64::NAN; along.rows()];
                along.values(&[0.0; 2], &[0.0; 2], &mut clearances).unwrap();
                let least = clearances.iter().copied().fold(f64::INFINITY, f64::min);
                // A larger ball is beyond the surface by what its radius is larger.
                let beyond = -sign * ball * 1e-9;
                assert!((least - beyond).abs() < 1e-13, "ball {k}: {least}, not {beyond}");
            }
        }
    }
}
