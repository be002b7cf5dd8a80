//! Frames that are fixed to links.

use super::link::Placement;

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
