//! Frames that are fixed to links.

use super::error::RobotError;
use super::link::Placement;
use super::nearest::resembling;
use std::collections::HashMap;

/// What a frame belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum FrameKind {
    /// The world.
    World,
    /// A joint: the joint frame, which moves with the link. Joints that a reader merged count too.
    Joint,
    /// A link of the description, merged or not.
    Link,
    /// A frame that was added to the description, such as the tip of a tool.
    Added,
}

/// A frame that is fixed to the link of a joint, or to the world.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Frame {
    /// Its name, unique among the frames of its kind.
    pub name: String,
    /// What it belongs to.
    pub kind: FrameKind,
    /// Index of the joint that moves it; `None` if it is fixed to the world.
    pub joint: Option<usize>,
    /// The frame in the frame of that joint, as in [`Robot::joints`](super::Robot::joints), or in the world.
    pub placement: Placement,
}

/// Description of a frame, for [`RobotBuilder::frame`](super::RobotBuilder::frame) and
/// [`Robot::with_frame`](super::Robot::with_frame).
///
/// Starts at the origin of the world, along its axes.
#[derive(Clone, Debug, PartialEq)]
#[must_use = "a description does nothing until it is given to a builder or robot"]
pub struct FrameSpec {
    pub(super) name: String,
    pub(super) kind: FrameKind,
    pub(super) base: Base,
    pub(super) placement: Placement,
}

/// What a new frame is placed in.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Base {
    World,
    /// A frame by its name.
    Frame(String),
    /// The frame of a joint, whatever else has its name.
    Joint(String),
}

impl FrameSpec {
    /// A frame of this name.
    pub fn new(name: impl Into<String>) -> Self {
        let placement = Placement::identity();
        Self { name: name.into(), kind: FrameKind::Added, base: Base::World, placement }
    }

    /// The frame of a link, or of a joint that a reader merged: placed in the frame of a joint, or in the
    /// world.
    pub(super) fn described(name: &str, kind: FrameKind, joint: Option<&str>, placement: Placement) -> Self {
        let base = joint.map_or(Base::World, |joint| Base::Joint(joint.to_owned()));
        Self { name: name.to_owned(), kind, base, placement }
    }

    /// Fixes it to another frame: of a link, of a joint, or one added before.
    pub fn on(mut self, frame: impl Into<String>) -> Self {
        self.base = Base::Frame(frame.into());
        self
    }

    /// Its placement in that frame.
    pub fn placed(mut self, placement: Placement) -> Self {
        self.placement = placement;
        self
    }
}

/// Frames while they are collected, with their positions by name.
pub(super) struct FrameList {
    frames: Vec<Frame>,
    index: HashMap<String, Vec<usize>>,
}

impl FrameList {
    /// The frames of the world and of the joints.
    pub(super) fn of_joints<'a>(names: impl Iterator<Item = &'a str>) -> Self {
        let placement = Placement::identity();
        let world = Frame { name: "world".into(), kind: FrameKind::World, joint: None, placement };
        let joints = names.enumerate().map(|(i, name)| Frame {
            name: name.to_owned(),
            kind: FrameKind::Joint,
            joint: Some(i),
            placement,
        });
        Self::from(std::iter::once(world).chain(joints).collect::<Vec<_>>())
    }

    /// Adds a frame, whose base must be there already.
    pub(super) fn add(&mut self, spec: FrameSpec) -> Result<(), RobotError> {
        let FrameSpec { name, kind, base, placement } = spec;
        if !placement.is_rigid() {
            return Err(RobotError::BadFramePlacement { frame: name });
        }
        // One name of a description may be that of a link and of a joint; added frames have names of their
        // own.
        let is_taken = |other: &Frame| other.kind == kind || kind == FrameKind::Added;
        if self.named(&name).any(is_taken) {
            let kind = if kind == FrameKind::Link { "link" } else { "frame" };
            return Err(RobotError::DuplicateName { kind, name });
        }
        let base = match &base {
            Base::World => &self.frames[0],
            Base::Frame(base) => preferred(self.named(base)).ok_or_else(|| unknown(&self.frames, base))?,
            Base::Joint(base) => self
                .named(base)
                .find(|frame| frame.kind == FrameKind::Joint)
                .ok_or_else(|| unknown(&self.frames, base))?,
        };
        let (joint, placement) = (base.joint, base.placement.then(&placement.orthonormalised()));
        self.index.entry(name.clone()).or_default().push(self.frames.len());
        self.frames.push(Frame { name, kind, joint, placement });
        Ok(())
    }

    /// The frame of this name.
    pub(super) fn find<'a>(frames: &'a [Frame], name: &str) -> Result<&'a Frame, RobotError> {
        let named = frames.iter().filter(|frame| frame.name == name);
        preferred(named).ok_or_else(|| unknown(frames, name))
    }

    fn named(&self, name: &str) -> impl Iterator<Item = &Frame> {
        self.index.get(name).into_iter().flatten().map(|&k| &self.frames[k])
    }

    pub(super) fn into_frames(self) -> Vec<Frame> {
        self.frames
    }
}

impl From<Vec<Frame>> for FrameList {
    /// Of frames that begin with that of the world.
    fn from(frames: Vec<Frame>) -> Self {
        let mut index: HashMap<String, Vec<usize>> = HashMap::with_capacity(frames.len());
        for (k, frame) in frames.iter().enumerate() {
            index.entry(frame.name.clone()).or_default().push(k);
        }
        Self { frames, index }
    }
}

/// Of several frames with one name: see `Robot::frame`.
fn preferred<'a>(named: impl Iterator<Item = &'a Frame>) -> Option<&'a Frame> {
    named.min_by_key(|frame| match frame.kind {
        FrameKind::Added => 0,
        FrameKind::Link => 1,
        FrameKind::Joint => 2,
        FrameKind::World => 3,
    })
}

fn unknown(frames: &[Frame], name: &str) -> RobotError {
    let nearest = resembling(name, frames.iter().map(|frame| frame.name.as_str()));
    RobotError::UnknownFrame { frame: name.to_owned(), nearest }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::{JointSpec, LinkInertia, Robot};
    use nalgebra::Vector3;

    fn arm() -> Robot {
        let body = LinkInertia::point(1.0, [0.1, 0.0, 0.0]);
        let placed = |x| Placement::from_xyz_rpy([x, 0.0, 0.0], [0.0, 0.3, 0.0]);
        let tool = FrameSpec::new("tool").on("hand").placed(placed(0.2));
        Robot::builder("arm")
            .joint(JointSpec::revolute("shoulder").carrying(body))
            .joint(JointSpec::revolute("elbow").on("shoulder").link("hand").carrying(body))
            .frame(tool)
            .build()
            .unwrap()
    }

    #[test]
    fn frames_are_placed_in_frames() {
        let arm = arm();
        let far = FrameSpec::new("far").on("tool").placed(Placement::from_xyz_rpy([1.0, 0.0, 0.0], [0.0; 3]));
        let arm = arm.with_frame(far).unwrap();
        let (tool, far) = (arm.frame("tool").unwrap(), arm.frame("far").unwrap());
        assert_eq!((tool.joint, far.joint, far.kind), (Some(1), Some(1), FrameKind::Added));
        let expected = Vector3::new(0.2 + 0.3_f64.cos(), 0.0, -(0.3_f64.sin()));
        assert!((far.placement.translation - expected).amax() < 1e-15);
        assert_eq!(arm.frame("hand").unwrap().kind, FrameKind::Link);
        assert_eq!(arm.frame("elbow").unwrap().kind, FrameKind::Joint);
        assert_eq!(arm.frame("world").unwrap().joint, None);
    }

    #[test]
    fn wrong_frames_are_named() {
        let arm = arm();
        let says = |frame: FrameSpec, words: &str| {
            let error = arm.with_frame(frame).unwrap_err().to_string();
            assert!(error.contains(words), "{error}");
        };
        says(FrameSpec::new("a").on("elbwo"), "'elbow'");
        says(FrameSpec::new("tool"), "two frames are called 'tool'");
        let bad = Placement { translation: Vector3::new(f64::NAN, 0.0, 0.0), ..Placement::identity() };
        says(FrameSpec::new("b").placed(bad), "frame 'b'");
    }
}
