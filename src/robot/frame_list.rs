//! Frames by their names.

use super::checks;
use super::error::RobotError;
use super::frame::{Base, Frame, FrameKind, FrameSpec};
use super::joint::Joint;
use super::link::Placement;
use super::nearest::resembling;
use std::collections::HashMap;

/// Frames while they are collected, with their positions by name.
pub(super) struct FrameList {
    frames: Vec<Frame>,
    index: HashMap<String, Vec<usize>>,
}

impl FrameList {
    /// The frames of the world and of the joints; of a floating or spherical joint that of its last part,
    /// which moves the link. The chain inside of it moves with the chart of its positions, not as a body.
    pub(super) fn of_joints(joints: &[Joint]) -> Self {
        let placement = Placement::identity();
        let world = Frame { name: "world".into(), kind: FrameKind::World, joint: None, placement };
        let joints = joints.iter().enumerate().filter(|(_, joint)| !joint.is_inner()).map(|(i, joint)| {
            Frame { name: joint.name.clone(), kind: FrameKind::Joint, joint: Some(i), placement }
        });
        Self::from(std::iter::once(world).chain(joints).collect::<Vec<_>>())
    }

    /// Adds a frame, whose base must be there already.
    pub(super) fn add(&mut self, spec: FrameSpec) -> Result<(), RobotError> {
        let FrameSpec { name, kind, base, placement } = spec;
        checks::name(if kind == FrameKind::Link { "link" } else { "frame" }, &name)?;
        if !placement.is_rigid() {
            return Err(RobotError::BadFramePlacement { frame: name });
        }
        if kind == FrameKind::Added && PREFIXES.iter().any(|(prefix, _)| name.starts_with(prefix)) {
            let rule = "what begins with 'joint:' or 'link:' means the frame of a joint or a link: give it \
                        another name";
            return Err(RobotError::BadName { kind: "frame", name, rule });
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
            Base::Frame(base) => {
                named(|name| self.named(name), base).ok_or_else(|| unknown(&self.frames, base))?
            }
            Base::Joint(base) => {
                of_kind(self.named(base), FrameKind::Joint).ok_or_else(|| unknown(&self.frames, base))?
            }
        };
        let (joint, placement) = (base.joint, base.placement.then(&placement.orthonormalised()));
        self.index.entry(name.clone()).or_default().push(self.frames.len());
        self.frames.push(Frame { name, kind, joint, placement });
        Ok(())
    }

    /// The frame of this name.
    pub(super) fn find<'a>(frames: &'a [Frame], name: &str) -> Result<&'a Frame, RobotError> {
        let with_name = |name: &str| {
            let name = name.to_owned();
            frames.iter().filter(move |frame| frame.name == name)
        };
        named(with_name, name).ok_or_else(|| unknown(frames, name))
    }

    /// The position of the frame of this name.
    pub(super) fn position(&self, name: &str) -> Result<usize, RobotError> {
        let found = named(|name| self.named(name), name).ok_or_else(|| unknown(&self.frames, name))?;
        let mut alike = self.index.get(&found.name).into_iter().flatten().copied();
        Ok(alike.find(|&k| std::ptr::eq(&self.frames[k], found)).unwrap_or_default())
    }

    fn named<'a>(&'a self, name: &str) -> impl Iterator<Item = &'a Frame> + use<'a> {
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

/// What stands before a name to say what it belongs to, as in `joint:elbow`.
const PREFIXES: [(&str, FrameKind); 2] = [("joint:", FrameKind::Joint), ("link:", FrameKind::Link)];

/// The frame that a name means, see `Robot::frame`: of the frames with this name, else of those with what
/// follows a prefix.
fn named<'a, I: Iterator<Item = &'a Frame>>(with_name: impl Fn(&str) -> I, name: &str) -> Option<&'a Frame> {
    preferred(with_name(name)).or_else(|| {
        let mut meant =
            PREFIXES.iter().filter_map(|&(prefix, kind)| Some((name.strip_prefix(prefix)?, kind)));
        meant.find_map(|(bare, kind)| of_kind(with_name(bare), kind))
    })
}

fn of_kind<'a>(mut frames: impl Iterator<Item = &'a Frame>, kind: FrameKind) -> Option<&'a Frame> {
    frames.find(|frame| frame.kind == kind)
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
    let prefixed = PREFIXES.iter().find(|(prefix, _)| name.starts_with(prefix));
    let nearest = match prefixed {
        None => resembling(name, frames.iter().map(|frame| frame.name.as_str())),
        Some((prefix, kind)) => {
            let of_kind = frames.iter().filter(|frame| frame.kind == *kind);
            let found = resembling(&name[prefix.len()..], of_kind.map(|frame| frame.name.as_str()));
            found.into_iter().map(|name| format!("{prefix}{name}")).collect()
        }
    };
    RobotError::UnknownFrame { frame: name.to_owned(), nearest }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::{JointSpec, LinkInertia, Robot};
    use nalgebra::Vector3;

    /// Joint 'a' moves link 'b', joint 'b' moves link 'c'.
    fn robot() -> Robot {
        let body = LinkInertia::point(1.0, [0.1, 0.0, 0.0]);
        Robot::builder("arm")
            .joint(JointSpec::revolute("a").link("b").carrying(body))
            .joint(JointSpec::revolute("b").on("a").link("c").carrying(body))
            .build()
            .unwrap()
    }

    #[test]
    fn prefixes_tell_joints_from_links() {
        let robot = robot();
        let found = |name| robot.frame(name).map(|frame| (frame.kind, frame.joint)).unwrap();
        assert_eq!(found("b"), (FrameKind::Link, Some(0)));
        assert_eq!(found("link:b"), (FrameKind::Link, Some(0)));
        assert_eq!(found("joint:b"), (FrameKind::Joint, Some(1)));
        let place = Placement::from_xyz_rpy([0.0, 0.5, 0.0], [0.0; 3]);
        let tip = robot.with_frame(FrameSpec::new("tip").on("joint:b").placed(place)).unwrap();
        let tip = tip.frame("tip").unwrap();
        assert_eq!((tip.joint, tip.placement.translation), (Some(1), Vector3::new(0.0, 0.5, 0.0)));
    }

    #[test]
    fn blank_names_are_refused() {
        for blank in ["", " ", "\t\n"] {
            let refused = |error| matches!(error, RobotError::BadName { ref name, .. } if name == blank);
            assert!(refused(robot().with_frame(FrameSpec::new(blank)).unwrap_err()), "{blank:?}");
            let body = LinkInertia::point(1.0, [0.1, 0.0, 0.0]);
            let joint = |name: &str| JointSpec::revolute(name).carrying(body);
            let build = |joint| Robot::builder("arm").joint(joint).build().unwrap_err();
            assert!(refused(build(joint(blank))) && refused(build(joint("a").link(blank))), "{blank:?}");
        }
    }

    #[test]
    fn a_whole_name_comes_before_a_prefix() {
        let body = LinkInertia::point(1.0, [0.1, 0.0, 0.0]);
        let odd = JointSpec::revolute("b").on("a").link("joint:a").carrying(body);
        let first = JointSpec::revolute("a").carrying(body);
        let robot = Robot::builder("arm").joint(first).joint(odd).build().unwrap();
        assert_eq!(robot.frame("joint:a").unwrap().kind, FrameKind::Link);
    }

    #[test]
    fn an_added_frame_does_not_take_the_name_of_another_one() {
        for name in ["joint:b", "link:b", "joint:"] {
            let error = robot().with_frame(FrameSpec::new(name).on("a")).unwrap_err();
            assert!(matches!(error, RobotError::BadName { kind: "frame", .. }), "{error}");
        }
        assert!(robot().with_frame(FrameSpec::new("jointed:b").on("a")).is_ok());
    }

    #[test]
    fn what_resembles_a_name_with_a_prefix_is_of_its_kind() {
        let body = LinkInertia::point(1.0, [0.1, 0.0, 0.0]);
        let elbow = JointSpec::revolute("elbow").link("elbows").carrying(body);
        let robot = Robot::builder("arm").joint(elbow).build().unwrap();
        let nearest = |name| match robot.frame(name) {
            Err(RobotError::UnknownFrame { nearest, .. }) => nearest,
            other => panic!("{other:?}"),
        };
        assert_eq!(nearest("joint:elbwo"), ["joint:elbow"]);
        assert_eq!(nearest("link:elbow"), ["link:elbows"]);
        assert_eq!(nearest("joint:wrist"), [""; 0]);
    }
}
