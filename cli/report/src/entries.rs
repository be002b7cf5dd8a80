//! Entries of q: of robots with floating and spherical joints they are not those of v.

use costate::robot::{FreeKind, FreePart, Joint, JointKind, Placement, Robot};

/// An entry of q.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Entry {
    pub name: String,
    /// The coordinate whose colour it has, and which hides it. A quaternion has one entry more than there are
    /// angles; that one has a number after all coordinates.
    pub number: usize,
    /// Whether it is one of a quaternion, without a unit.
    pub is_quaternion: bool,
}

/// All entries of q: those of a joint `base` are `base_x`, `base_y`, `base_z`, `base_qx` to `base_qw`.
pub(crate) fn entries(robot: &Robot) -> Vec<Entry> {
    let mut entries = Vec::with_capacity(robot.dof() + robot.free_joints().len());
    let mut further = robot.dof();
    for (number, joint) in robot.independent_joints().enumerate() {
        let Some(part) = &joint.free else {
            entries.push(Entry { name: joint.name.clone(), number, is_quaternion: false });
            continue;
        };
        let slides = part.kind.slides();
        let name = |end: &str| format!("{}_{end}", part.joint);
        let end = if part.place < slides {
            ["x", "y", "z"].get(part.place)
        } else {
            ["qx", "qy", "qz"].get(part.place - slides)
        };
        let end = end.copied().unwrap_or_default();
        entries.push(Entry { name: name(end), number, is_quaternion: part.place >= slides });
        if is_last(part) {
            entries.push(Entry { name: name("qw"), number: further, is_quaternion: true });
            further += 1;
        }
    }
    entries
}

/// Whether it is the part of a free joint that moves its link.
pub(crate) fn is_last(part: &FreePart) -> bool {
    part.place + 1 == part.kind.dof()
}

/// Whether a joint, or the one that it is a part of, holds its link at no place.
pub(crate) fn is_floating(joint: &Joint) -> bool {
    joint.free.as_ref().is_some_and(|part| part.kind == FreeKind::Floating)
}

/// The first entry of q of each coordinate that has one: of the angles of a free joint, those of its
/// quaternion, in their order.
pub(crate) fn of_coordinates(robot: &Robot) -> Vec<usize> {
    let entries = entries(robot);
    let of_coordinate = entries.iter().enumerate().filter(|(_, entry)| entry.number < robot.dof());
    of_coordinate.map(|(at, _)| at).collect()
}

/// What moves a joint on the stage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Mover {
    /// Its position is `ratio q_at + offset`.
    Position { at: usize, ratio: f64, offset: f64 },
    /// The quaternion from this entry on.
    Quaternion { at: usize },
    /// Nothing: it is a further angle of a free joint.
    Nothing,
}

/// What moves each joint.
pub(crate) fn movers(robot: &Robot) -> Vec<Mover> {
    let entries = of_coordinates(robot);
    let mut coordinate = vec![0; robot.joints().len()];
    robot.independent_indices().iter().enumerate().for_each(|(number, &joint)| coordinate[joint] = number);
    let mover = |(i, joint): (usize, &Joint)| match (&joint.free, joint.mimic) {
        (Some(part), _) if part.place > part.kind.slides() => Mover::Nothing,
        (Some(part), _) if part.place == part.kind.slides() => {
            Mover::Quaternion { at: entries[coordinate[i]] }
        }
        (_, Some(mimic)) => {
            let at = entries[coordinate[mimic.joint]];
            Mover::Position { at, ratio: mimic.ratio, offset: mimic.offset }
        }
        _ => Mover::Position { at: entries[coordinate[i]], ratio: 1.0, offset: 0.0 },
    };
    robot.joints().iter().enumerate().map(mover).collect()
}

/// The pose of the frame of each joint in the world, as [`Robot::poses`] has it for robots without free
/// joints; quaternions may have any length but 0. `None` where q has the wrong length.
pub(crate) fn poses(robot: &Robot, movers: &[Mover], q: &[f64]) -> Option<Vec<Placement>> {
    if q.len() != robot.dof() + robot.free_joints().len() {
        return None;
    }
    let mut poses: Vec<Placement> = Vec::with_capacity(movers.len());
    for (joint, mover) in robot.joints().iter().zip(movers) {
        let standing = joint.parent.map_or(joint.placement, |parent| poses[parent].then(&joint.placement));
        poses.push(match *mover {
            Mover::Position { at, ratio, offset } => {
                let position = ratio * q[at] + offset;
                match joint.kind {
                    JointKind::Revolute => {
                        let (sin, cos) = (0.5 * position).sin_cos();
                        let axis = joint.axis * sin;
                        standing.then(&turn([axis.x, axis.y, axis.z, cos]))
                    }
                    JointKind::Prismatic => standing
                        .then(&Placement { translation: joint.axis * position, ..Placement::identity() }),
                }
            }
            Mover::Quaternion { at } => standing.then(&turn([q[at], q[at + 1], q[at + 2], q[at + 3]])),
            Mover::Nothing => standing,
        });
    }
    Some(poses)
}

/// The rotation of a quaternion (x, y, z, w).
fn turn([x, y, z, w]: [f64; 4]) -> Placement {
    let s = 2.0 / (x * x + y * y + z * z + w * w);
    let columns = [
        [1.0 - s * (y * y + z * z), s * (x * y + z * w), s * (x * z - y * w)],
        [s * (x * y - z * w), 1.0 - s * (x * x + z * z), s * (y * z + x * w)],
        [s * (x * z + y * w), s * (y * z - x * w), 1.0 - s * (x * x + y * y)],
    ];
    let mut turned = Placement::identity();
    turned.rotation.iter_mut().zip(columns.as_flattened()).for_each(|(entry, value)| *entry = *value);
    turned
}

#[cfg(test)]
mod tests {
    use super::{Mover, entries, movers, poses};
    use costate::configuration::FreeKinematics;
    use costate::robot::{JointSpec, LinkInertia, Placement, Robot};

    /// A hinge, a floating body on it, a slide, and a link on a ball joint, which mimics nothing.
    fn flying() -> Robot {
        let body = |joint: JointSpec| joint.carrying(LinkInertia::point(1.0, [0.1, 0.2, 0.3]));
        let placed = |x: f64| Placement::from_xyz_rpy([x, -0.4, 0.7 - x], [0.4 + x, -1.1, 2.0 * x]);
        Robot::builder("flying")
            .joint(body(JointSpec::revolute("hinge")).placed(placed(0.1)))
            .joint(body(JointSpec::floating("base")).on("hinge").placed(placed(0.2)))
            .joint(body(JointSpec::prismatic("slide")).on("base").axis([0.0, 0.6, 0.8]).placed(placed(0.3)))
            .joint(body(JointSpec::spherical("ball")).on("slide").placed(placed(0.4)))
            .joint(body(JointSpec::revolute("last")).on("ball").placed(placed(0.5)))
            .build()
            .unwrap()
    }

    #[test]
    fn poses_are_those_of_kinematics() {
        let robot = flying();
        let mut q: Vec<f64> = (0..14).map(|k| (1.3 * f64::from(k) + 0.4).sin()).collect();
        for free in robot.free_joints() {
            let quaternion = &mut q[free.quaternion()..free.quaternion() + 4];
            let length = quaternion.iter().map(|x| x * x).sum::<f64>().sqrt();
            quaternion.iter_mut().for_each(|x| *x /= length);
        }
        let mut kinematics = FreeKinematics::<f64>::new(&robot);
        kinematics.set_position(&q).unwrap();
        let movers = movers(&robot);
        let found = poses(&robot, &movers, &q).unwrap();
        // Inside a free joint frames are where its chart has them: what it carries counts.
        let carried = |i: &usize| robot.joints()[*i].free.as_ref().is_none_or(super::is_last);
        for i in (0..robot.joints().len()).filter(carried) {
            let frame = robot.frames().iter().position(|frame| frame.name == robot.joints()[i].name).unwrap();
            let expected = kinematics.pose(frame).unwrap();
            for row in 0..3 {
                assert!((found[i].translation[row] - expected.position[row]).abs() < 1e-14, "{i}");
                for column in 0..3 {
                    let (a, b) = (found[i].rotation[(row, column)], expected.rotation[row][column]);
                    assert!((a - b).abs() < 1e-14, "{i}: {a} {b}");
                }
            }
        }
        // A quaternion that is as good but longer.
        let longer: Vec<f64> =
            q.iter().enumerate().map(|(k, x)| if (4..8).contains(&k) { -2.0 * x } else { *x }).collect();
        let longer = poses(&robot, &movers, &longer).unwrap();
        assert!((longer[11].translation - found[11].translation).norm() < 1e-14);
        assert!(poses(&robot, &movers, &q[1..]).is_none());
    }

    #[test]
    fn entries_have_the_names_and_numbers_of_their_coordinates() {
        let found = entries(&flying());
        let names: Vec<&str> = found.iter().map(|entry| &*entry.name).collect();
        let expected = [
            "hinge", "base_x", "base_y", "base_z", "base_qx", "base_qy", "base_qz", "base_qw", "slide",
            "ball_qx", "ball_qy", "ball_qz", "ball_qw", "last",
        ];
        assert_eq!(names, expected);
        let numbers: Vec<usize> = found.iter().map(|entry| entry.number).collect();
        assert_eq!(numbers, [0, 1, 2, 3, 4, 5, 6, 12, 7, 8, 9, 10, 13, 11]);
        let without: Vec<usize> = (0..14).filter(|&k| found[k].is_quaternion).collect();
        assert_eq!(without, [4, 5, 6, 7, 9, 10, 11, 12]);
    }

    #[test]
    fn other_robots_have_the_poses_of_the_library() {
        let joint = |name: &str| JointSpec::revolute(name).carrying(LinkInertia::point(1.0, [0.0, 0.0, 0.3]));
        let placed = Placement::from_xyz_rpy([0.3, 0.1, 0.0], [0.2, 0.0, 0.5]);
        let robot = Robot::builder("coupled")
            .joint(joint("a"))
            .joint(joint("b").on("a").placed(placed).mimicking("a", -2.0, 0.4))
            .joint(joint("c").on("b").placed(placed))
            .build()
            .unwrap();
        let q = [0.7, -0.3];
        let movers = movers(&robot);
        assert_eq!(movers[1], Mover::Position { at: 0, ratio: -2.0, offset: 0.4 });
        for (found, expected) in poses(&robot, &movers, &q).unwrap().iter().zip(&robot.poses(&q).unwrap()) {
            assert!((found.translation - expected.translation).norm() < 1e-14);
            assert!((found.rotation - expected.rotation).norm() < 1e-14);
        }
    }
}
