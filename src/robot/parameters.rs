//! The constants of a robot as a list of numbers, and frames that do not depend on them.

use super::frames::AlignedFrames;
use super::joint_frame::JointFrame;
use super::model::Robot;
use nalgebra::Matrix3;

/// The names of ten inertial and three geometric parameters, those of every joint.
const OF_EVERY_JOINT: [&str; 13] =
    ["mass", "h_x", "h_y", "h_z", "J_xx", "J_yy", "J_zz", "J_xy", "J_xz", "J_yz", "x", "y", "z"];

/// A group of consecutive parameters.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Group {
    /// The joint (or pair of joints) that they belong to; empty for gravity.
    pub of: String,
    /// Name and value of each.
    pub entries: Vec<(&'static str, f64)>,
}

/// All parameters of a robot, group by group.
///
/// For each joint its link's mass, first moment and inertia about the origin of the joint frame, and the
/// translation of its placement; its spring, friction and armature if it has them; then pairs of joints that
/// armature couples, then gravity.
pub(crate) fn groups(robot: &Robot) -> Vec<Group> {
    let mut groups = Vec::new();
    let armature = robot.armature();
    for (i, joint) in robot.joints().iter().enumerate() {
        let (link, place) = (&joint.inertia, &joint.placement.translation);
        let (h, j) = (link.com * link.mass, link.inertia_about_origin());
        let values = [
            link.mass,
            h.x,
            h.y,
            h.z,
            j[(0, 0)],
            j[(1, 1)],
            j[(2, 2)],
            j[(0, 1)],
            j[(0, 2)],
            j[(1, 2)],
            place.x,
            place.y,
            place.z,
        ];
        let mut entries: Vec<_> = OF_EVERY_JOINT.into_iter().zip(values).collect();
        if joint.spring.stiffness != 0.0 {
            entries.extend([("stiffness", joint.spring.stiffness), ("rest", joint.spring.rest)]);
        }
        if joint.friction.viscous != 0.0 {
            entries.push(("viscous", joint.friction.viscous));
        }
        if joint.friction.coulomb != 0.0 {
            let friction = &joint.friction;
            entries.extend([("coulomb", friction.coulomb), ("coulomb_velocity", friction.coulomb_velocity)]);
        }
        let own = robot.armature_entry(i, i);
        entries.extend((own != 0.0).then_some(("armature", own)));
        groups.push(Group { of: joint.name.clone(), entries });
    }
    for &(i, j, value) in armature.iter().filter(|(i, j, _)| i != j) {
        let of = format!("{}, {}", robot.joints()[i].name, robot.joints()[j].name);
        groups.push(Group { of, entries: vec![("armature", value)] });
    }
    let g = robot.gravity();
    groups.push(Group {
        of: String::new(),
        entries: vec![("gravity_x", g.x), ("gravity_y", g.y), ("gravity_z", g.z)],
    });
    groups
}

/// Frames that depend on the directions of joints alone.
pub(crate) struct Directions {
    /// The joints: only their kind, parent, rotations and offset are meaningful.
    pub joints: Vec<JointFrame>,
    /// Rotations from the original frames of the joints to the aligned ones.
    pub turns: Vec<Matrix3<f64>>,
    /// Rotations of the translations to the joints.
    pub arms: Vec<Matrix3<f64>>,
    /// Rotation of the world.
    pub world: Matrix3<f64>,
    /// Entries of the armature matrix that are not zero, on and below the diagonal.
    pub armature: Vec<(usize, usize, f64)>,
}

impl From<&Robot> for Directions {
    fn from(robot: &Robot) -> Self {
        let mut aligned = AlignedFrames::rotated_only(robot);
        (0..robot.joints().len()).for_each(|i| aligned.place(i));
        let of_joint = |i| aligned.rotation_and_arm(i);
        Self {
            joints: (0..robot.joints().len()).map(|i| aligned.joint(i, 0.0)).collect(),
            turns: (0..robot.joints().len()).map(|i| of_joint(i)[0]).collect(),
            arms: (0..robot.joints().len()).map(|i| of_joint(i)[1]).collect(),
            world: aligned.world.map(super::link::snap),
            armature: robot.armature().to_vec(),
        }
    }
}
