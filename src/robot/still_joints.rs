//! A robot with still joints: displacements of its frames as coordinates.

use super::constraint::ConstraintKind;
use super::free_parts::free_joints;
use super::joint::{Friction, Joint, JointKind, Limits, Mimic, Spring};
use super::link::{LinkInertia, Placement};
use super::model::Robot;
use nalgebra::Vector3;

/// Where a still joint is inserted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Site {
    /// Between the world and all that is attached to it.
    World,
    /// Before the placement of this joint: at the origin of its parent's frame.
    Parent(usize),
    /// After the placement of this joint: at its origin, before it moves.
    Joint(usize),
}

/// A joint to be inserted; it stays at coordinate 0 and rate 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct StillJoint {
    /// Where.
    pub site: Site,
    /// Revolute for a rotation, prismatic for a translation.
    pub kind: JointKind,
    /// Unit axis, in the frame of the site.
    pub axis: Vector3<f64>,
}

/// A robot with still joints, and where the joints are in it.
#[derive(Clone, Debug)]
pub(crate) struct WithStillJoints {
    /// The robot. Its mass matrix may be singular: the links of still joints have no mass.
    pub robot: Robot,
    /// Number of each coordinate of the original robot.
    pub kept: Vec<usize>,
    /// Number of the coordinate of each still joint.
    pub still: Vec<usize>,
}

impl Robot {
    /// The same robot with still joints, those of one site following each other.
    ///
    /// At coordinate 0 and rate 0 of these joints L(q, v) is that of this robot, and its derivatives by their
    /// coordinates are those by the displacements.
    pub(crate) fn with_still_joints(&self, added: &[StillJoint]) -> WithStillJoints {
        let n = self.joints.len() + added.len();
        let mut joints: Vec<Joint> = Vec::with_capacity(n);
        let (mut kept, mut still) = (Vec::with_capacity(self.joints.len()), vec![0; added.len()]);
        let mut insert = |joints: &mut Vec<Joint>, site, mut parent, mut placement| {
            for (k, one) in added.iter().enumerate().filter(|(_, one)| one.site == site) {
                still[k] = joints.len();
                joints.push(one.joint(k, parent, std::mem::take(&mut placement)));
                parent = Some(still[k]);
            }
            (parent, placement)
        };
        let (base, _) = insert(&mut joints, Site::World, None, Placement::identity());
        for (i, joint) in self.joints.iter().enumerate() {
            let parent = joint.parent.map_or(base, |parent| Some(kept[parent]));
            let (parent, _) = insert(&mut joints, Site::Parent(i), parent, Placement::identity());
            let (parent, placement) = insert(&mut joints, Site::Joint(i), parent, joint.placement);
            kept.push(joints.len());
            joints.push(Joint { parent, placement, ..joint.clone() });
        }
        for joint in &mut joints {
            joint.mimic = joint.mimic.map(|mimic| Mimic { joint: kept[mimic.joint], ..mimic });
        }
        let independent: Vec<usize> = (0..n).filter(|&i| joints[i].mimic.is_none()).collect();
        let mut coordinates = vec![0; n];
        independent.iter().enumerate().for_each(|(k, &i)| coordinates[i] = k);
        let armature = self.armature.spread(n, &kept);
        let free = free_joints(&joints);
        let mut robot = Self { joints, independent, free, armature, ..self.clone() };
        for constraint in &mut robot.constraints {
            if let ConstraintKind::Coupling { terms, .. } = &mut constraint.kind {
                terms.iter_mut().for_each(|(joint, _)| *joint = kept[*joint]);
            }
        }
        for frame in &mut robot.frames {
            frame.joint = frame.joint.map(|joint| kept[joint]);
        }
        let kept = self.independent.iter().map(|&i| coordinates[kept[i]]).collect();
        let still = still.into_iter().map(|i| coordinates[i]).collect();
        WithStillJoints { robot, kept, still }
    }
}

impl Robot {
    /// The same robot without springs in this field of gravity (m/s^2): V is linear in gravity.
    pub(crate) fn in_field(&self, gravity: Vector3<f64>) -> Self {
        let mut robot = Self { gravity, ..self.clone() };
        robot.joints.iter_mut().for_each(|joint| joint.spring = Spring::default());
        robot
    }
}

impl StillJoint {
    fn joint(&self, number: usize, parent: Option<usize>, placement: Placement) -> Joint {
        Joint {
            name: format!("displacement {number}"),
            kind: self.kind,
            parent,
            placement,
            axis: self.axis,
            link: String::new(),
            inertia: LinkInertia::massless(),
            spring: Spring::default(),
            friction: Friction::none(),
            limits: Limits::default(),
            mimic: None,
            free: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::JointSpec;

    #[test]
    fn frames_stay_where_they_are_and_move_with_still_joints_joints() {
        let placed = |x: f64| Placement::from_xyz_rpy([x, -0.4, 0.7 - x], [0.4 + x, -1.1, 2.0 * x]);
        let link = LinkInertia::point(1.0, [0.3, 0.2, -0.1]);
        let robot = Robot::builder("branched")
            .joint(JointSpec::revolute("a").placed(placed(0.1)).carrying(link))
            .joint(JointSpec::prismatic("b").on("a").placed(placed(0.4)).armature(0.3).carrying(link))
            .joint(JointSpec::revolute("c").on("a").placed(placed(-0.3)).armature(0.2).carrying(link))
            .build()
            .unwrap();
        let axis = Vector3::new(0.6, 0.0, -0.8);
        let added = [
            StillJoint { site: Site::Joint(2), kind: JointKind::Revolute, axis },
            StillJoint { site: Site::World, kind: JointKind::Prismatic, axis },
            StillJoint { site: Site::Parent(2), kind: JointKind::Prismatic, axis },
        ];
        let WithStillJoints { robot: with, kept, still } = robot.with_still_joints(&added);
        assert_eq!((kept, still), (vec![1, 2, 5], vec![4, 0, 3]));
        assert_eq!(with.armature(), [(2, 2, 0.3), (5, 5, 0.2)]);
        let (before, after) = (robot.poses(&[0.3, -0.2, 1.1]).unwrap(), [0.0, 0.3, -0.2, 0.0, 0.0, 1.1]);
        let stays = with.poses(&after).unwrap();
        let moved = with.poses(&[0.5, 0.3, -0.2, 0.25, 0.0, 1.1]).unwrap();
        for (i, k) in [(0, 1), (1, 2), (2, 5)] {
            assert!((before[i].rotation - stays[k].rotation).amax() < 1e-15);
            assert!((before[i].translation - stays[k].translation).amax() < 1e-15);
        }
        let shift = moved[5].translation - stays[5].translation;
        assert!((shift - axis * 0.5 - stays[1].rotation * axis * 0.25).amax() < 1e-15);
    }
}
