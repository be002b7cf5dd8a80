//! Entries of q: of robots with floating and spherical joints they are not those of v.

use costate::robot::{FreeKind, FreePart, Joint, Robot};

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

#[cfg(test)]
mod tests {
    use super::{Mover, entries, movers};
    use costate::robot::{JointSpec, LinkInertia, Placement, Robot};

    /// A hinge, a floating body on it, a slide, a link on a ball joint, a last one, and a finger that follows
    /// the slide.
    fn flying() -> Robot {
        let body = |joint: JointSpec| joint.carrying(LinkInertia::point(1.0, [0.1, 0.2, 0.3]));
        let placed = |x: f64| Placement::from_xyz_rpy([x, -0.4, 0.7 - x], [0.4 + x, -1.1, 2.0 * x]);
        Robot::builder("flying")
            .joint(body(JointSpec::revolute("hinge")).placed(placed(0.1)))
            .joint(body(JointSpec::floating("base")).on("hinge").placed(placed(0.2)))
            .joint(body(JointSpec::prismatic("slide")).on("base").axis([0.0, 0.6, 0.8]).placed(placed(0.3)))
            .joint(body(JointSpec::spherical("ball")).on("slide").placed(placed(0.4)))
            .joint(body(JointSpec::revolute("last")).on("ball").placed(placed(0.5)))
            .joint(body(JointSpec::prismatic("finger")).on("base").mimicking("slide", -2.0, 0.4))
            .build()
            .unwrap()
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
    fn joints_move_by_their_entries() {
        let position = |at, ratio, offset| Mover::Position { at, ratio, offset };
        let (slide, fixed) = (|at| position(at, 1.0, 0.0), Mover::Nothing);
        let expected = [
            slide(0),
            slide(1),
            slide(2),
            slide(3),
            Mover::Quaternion { at: 4 },
            fixed,
            fixed,
            slide(8),
            Mover::Quaternion { at: 9 },
            fixed,
            fixed,
            slide(13),
            position(8, -2.0, 0.4),
        ];
        assert_eq!(movers(&flying()), expected);
    }
}
