//! Joints as they are shown: a floating or spherical joint is one, not the chain that it is computed as.

use costate::robot::{FreeJoint, Joint, Robot};
use std::ops::Range;

/// A joint.
pub struct Row<'a> {
    /// Its index in [`Robot::joints`], the last one of a chain.
    index: usize,
    /// The joint, the last one of a chain, which moves the link and has the name of all.
    pub moved: &'a Joint,
    /// The same, the first one of a chain.
    pub first: &'a Joint,
    /// If it is a chain.
    free: Option<&'a FreeJoint>,
    /// Its entries of q; none if it mimics another one.
    pub q: Option<Range<usize>>,
    /// Its entries of v.
    pub v: Option<Range<usize>>,
}

/// The mass of all moving links (kg).
pub fn mass(robot: &Robot) -> f64 {
    robot.joints().iter().map(|joint| joint.inertia.mass).sum()
}

/// All joints, in order.
pub fn rows(robot: &Robot) -> Vec<Row<'_>> {
    let joints = robot.joints();
    let mut rows = Vec::with_capacity(joints.len());
    // A quaternion has one entry more than there are angles.
    let mut quaternions = 0;
    for (index, moved) in joints.iter().enumerate() {
        let place = robot.independent_indices().binary_search(&index).ok();
        let Some(part) = &moved.free else {
            let entries = |before: usize| place.map(|place| place + before..place + before + 1);
            let (q, v) = (entries(quaternions), entries(0));
            rows.push(Row { index, moved, first: moved, free: None, q, v });
            continue;
        };
        if let Some(free) = robot.free_joints().iter().find(|free| free.name == moved.name) {
            let FreeJoint { kind, position, coordinate, .. } = free;
            let first = &joints[robot.independent_indices()[*coordinate]];
            let (q, v) = (*position..position + kind.positions(), *coordinate..coordinate + part.kind.dof());
            rows.push(Row { index, moved, first, free: Some(free), q: Some(q), v: Some(v) });
            quaternions += 1;
        }
    }
    rows
}

impl Row<'_> {
    /// `"revolute"`, `"floating"`.
    pub fn kind(&self) -> &'static str {
        self.free.map_or_else(|| self.moved.kind.name(), |free| free.kind.name())
    }

    /// The joint that moves the link it is attached to; none for the world.
    pub fn parent<'a>(&self, robot: &'a Robot) -> Option<&'a str> {
        self.first.parent.map(|parent| robot.joints()[parent].name.as_str())
    }

    /// The axis in the joint frame; a floating or spherical joint has none.
    pub fn axis(&self) -> Option<[f64; 3]> {
        self.free.is_none().then(|| self.moved.axis.into())
    }

    /// The inertia of the rotor (kg m^2, kg).
    pub fn armature(&self, robot: &Robot) -> f64 {
        robot.armature_entry(self.index, self.index)
    }
}
