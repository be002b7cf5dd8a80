//! The chain of joints that a floating or spherical joint is, and what it cannot have.

use super::armature::Armature;
use super::error::RobotError;
use super::free::{FreeJoint, FreeKind, FreePart};
use super::joint::{Friction, Joint, JointKind, JointSpec, Limits, Spring};
use super::link::Placement;
use nalgebra::Vector3;

/// The free joints of a list of joints, in its order.
pub(super) fn free_joints(joints: &[Joint]) -> Vec<FreeJoint> {
    let (mut found, mut position, mut coordinate) = (Vec::new(), 0, 0);
    for (i, joint) in joints.iter().enumerate().filter(|(_, joint)| joint.mimic.is_none()) {
        match &joint.free {
            Some(part) if part.place == part.kind.slides() => {
                let slides = part.kind.slides();
                let (name, kind) = (part.joint.clone(), part.kind);
                let (position, coordinate): (usize, usize) = (position - slides, coordinate - slides);
                found.push(FreeJoint { name, kind, position, coordinate, turned: i });
            }
            _ => {}
        }
        coordinate += 1;
        // The last of three angles brings the fourth entry of the quaternion.
        let is_last = joint.free.as_ref().is_some_and(|part| part.place + 1 == part.kind.dof());
        position += if is_last { 2 } else { 1 };
    }
    found
}

impl JointSpec {
    /// A joint that moves without restriction: see [`FreeKind::Floating`].
    ///
    /// The robot has six joints for it, `NAME_x`, `NAME_y`, `NAME_z` along and `NAME_rx`, `NAME_ry`, `NAME`
    /// about the axes, whose order is that of its entries of v, p and u; the last one moves the link.
    pub fn floating(name: impl Into<String>) -> Self {
        Self::free(name.into(), FreeKind::Floating)
    }

    /// A joint that turns without restriction: see [`FreeKind::Spherical`].
    ///
    /// The robot has three joints for it, `NAME_rx`, `NAME_ry` and `NAME`, as for a
    /// [`floating`](Self::floating) one.
    pub fn spherical(name: impl Into<String>) -> Self {
        Self::free(name.into(), FreeKind::Spherical)
    }

    fn free(name: String, kind: FreeKind) -> Self {
        Self { free: Some(FreePart { joint: name.clone(), kind, place: 0 }), ..Self::revolute(name) }
    }

    /// Whether it describes a joint that turns freely, which is to become a chain.
    fn is_whole(&self) -> bool {
        self.free.as_ref().is_some_and(|part| part.joint == self.name && part.place == 0)
    }

    /// Itself, or the chain of a free joint.
    pub(super) fn parts(self) -> Vec<Self> {
        let Some(kind) = self.free.as_ref().filter(|_| self.is_whole()).map(|part| part.kind) else {
            return vec![self];
        };
        let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
        let slides = [("_x", 0), ("_y", 1), ("_z", 2)].map(|(end, axis)| (end, axis, JointKind::Prismatic));
        let turns = [("_rx", 0), ("_ry", 1), ("", 2)].map(|(end, axis)| (end, axis, JointKind::Revolute));
        let chain = slides[..kind.slides()].iter().chain(&turns);
        let mut parts: Vec<Self> = Vec::with_capacity(kind.dof());
        for (place, &(end, axis, of)) in chain.enumerate() {
            let mut part = Self::new(format!("{}{end}", self.name), of).axis(axes[axis].into());
            part.parent = parts.last().map(|before| before.name.clone());
            part.virtual_link = true;
            part.free = Some(FreePart { joint: self.name.clone(), kind, place });
            parts.push(part);
        }
        if let Some(first) = parts.first_mut() {
            (first.parent, first.placement) = (self.parent, self.placement);
        }
        if let Some(last) = parts.last_mut() {
            // What a chain cannot have is refused by `check_part`.
            *last = Self {
                parent: last.parent.take(),
                placement: Placement::identity(),
                axis: last.axis,
                kind: last.kind,
                free: last.free.take(),
                ..self
            };
        }
        parts
    }
}

/// A part of a free joint has no spring, friction, limits or armature, and mimics nothing.
pub(super) fn check_part(spec: &JointSpec) -> Result<(), RobotError> {
    let Some(part) = &spec.free else { return Ok(()) };
    let joint = || part.joint.clone();
    if let Some(mimic) = &spec.mimic {
        let (master, kind) = (mimic.joint.clone(), part.kind.name());
        return Err(RobotError::UnsupportedMimic { joint: joint(), master, several: joint(), kind });
    }
    let refused = |what| Err(RobotError::FreeJoint { joint: joint(), kind: part.kind.name(), what });
    if spec.spring != Spring::default() {
        return refused("have a spring");
    }
    if spec.friction != Friction::none() {
        return refused("have friction");
    }
    if spec.limits != Limits::default() {
        return refused("have limits");
    }
    if spec.armature != 0.0 {
        return refused("have armature");
    }
    Ok(())
}

/// No joint mimics a part of a free joint, and none shares armature with one.
pub(super) fn check_robot(joints: &[Joint], armature: &Armature) -> Result<(), RobotError> {
    for joint in joints {
        let Some(mimic) = joint.mimic else { continue };
        if let Some(part) = &joints[mimic.joint].free {
            let (several, kind) = (part.joint.clone(), part.kind.name());
            let (joint, master) = (joint.name.clone(), part.joint.clone());
            return Err(RobotError::UnsupportedMimic { joint, master, several, kind });
        }
    }
    for &(i, j, _) in armature.entries() {
        if let Some(part) = joints[i].free.as_ref().or(joints[j].free.as_ref()) {
            let (joint, kind) = (part.joint.clone(), part.kind.name());
            return Err(RobotError::FreeJoint { joint, kind, what: "have armature" });
        }
    }
    Ok(())
}
