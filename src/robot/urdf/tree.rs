//! Which joint moves which link: the tree behind a URDF, and where everything sits in it.

use super::element::at;
use super::source::Source;
use crate::robot::error::RobotError;
use crate::robot::link::Placement;
use std::collections::{HashMap, HashSet};
use urdf_rs::{JointType, Pose};

/// Where a frame sits once fixed joints are gone.
#[derive(Clone, Copy)]
pub(super) struct Seat {
    /// The nearest joint above that moves; none on the base.
    pub(super) carrier: Option<usize>,
    /// The frame in the frame of that joint, or of the root link.
    pub(super) placement: Placement,
}

/// The seats of all links and of all joint frames at q = 0.
pub(super) struct Seats {
    pub(super) links: Vec<Seat>,
    pub(super) joints: Vec<Seat>,
}

/// Checks that links and joints form one tree, and seats them from its root outwards.
pub(super) fn seats(source: &Source) -> Result<Seats, RobotError> {
    let Graph { ends, mover } = Graph::of(source)?;
    let mut standing_on = vec![Vec::new(); mover.len()];
    for (joint, &[parent, _]) in ends.iter().enumerate() {
        standing_on[parent].push(joint);
    }
    let base = Seat { carrier: None, placement: Placement::identity() };
    let mut seats = Seats { links: vec![base; mover.len()], joints: vec![base; ends.len()] };
    let roots: Vec<usize> = (0..mover.len()).filter(|&link| mover[link].is_none()).collect();
    let mut reached = vec![false; mover.len()];
    let mut next = roots.clone();
    while let Some(link) = next.pop() {
        reached[link] = true;
        for &joint in &standing_on[link] {
            let Seat { carrier, placement } = seats.links[link];
            let frame =
                Seat { carrier, placement: placement.then(&placed(&source.robot.joints[joint].origin)) };
            let child = ends[joint][1];
            seats.joints[joint] = frame;
            seats.links[child] = match source.robot.joints[joint].joint_type {
                JointType::Fixed => frame,
                _ => Seat { carrier: Some(joint), placement: Placement::identity() },
            };
            next.push(child);
        }
    }
    if let Some(lost) = reached.iter().position(|reached| !reached) {
        return Err(circle(source, &ends, &mover, lost));
    }
    match roots[..] {
        [first, second, ..] => {
            let name = |link: usize| source.robot.links[link].name.clone();
            let error = RobotError::SeveralRoots { first: name(first), second: name(second) };
            Err(at(source.link_lines[second], error))
        }
        _ => Ok(seats),
    }
}

/// The placement that an `<origin>` gives.
pub(super) fn placed(origin: &Pose) -> Placement {
    Placement::from_xyz_rpy(*origin.xyz, *origin.rpy)
}

/// Links and joints by number instead of by name.
struct Graph {
    /// Parent and child link of each joint.
    ends: Vec<[usize; 2]>,
    /// The joint that moves each link.
    mover: Vec<Option<usize>>,
}

impl Graph {
    fn of(source: &Source) -> Result<Self, RobotError> {
        let (links, joints) = (&source.robot.links, &source.robot.joints);
        let duplicate = |kind, name: &str| RobotError::DuplicateName { kind, name: name.to_owned() };
        let mut index = HashMap::with_capacity(links.len());
        for (i, link) in links.iter().enumerate() {
            if index.insert(link.name.as_str(), i).is_some() {
                return Err(at(source.link_lines[i], duplicate("link", &link.name)));
            }
        }
        let mut names = HashSet::with_capacity(joints.len());
        let mut ends = Vec::with_capacity(joints.len());
        let mut mover: Vec<Option<usize>> = vec![None; links.len()];
        for (i, joint) in joints.iter().enumerate() {
            let refused = |error| Err(at(source.joint_lines[i], error));
            let name = || joint.name.clone();
            if !names.insert(joint.name.as_str()) {
                return refused(duplicate("joint", &joint.name));
            }
            let Some(&parent) = index.get(joint.parent.link.as_str()) else {
                let parent = joint.parent.link.clone();
                return refused(RobotError::UnknownParent { joint: name(), parent, kind: "link" });
            };
            let Some(&child) = index.get(joint.child.link.as_str()) else {
                return refused(RobotError::UnknownChild { joint: name(), child: joint.child.link.clone() });
            };
            if parent == child {
                return refused(RobotError::Cycle { joints: vec![name()] });
            }
            if let Some(first) = mover[child].replace(i) {
                let (link, first) = (joint.child.link.clone(), joints[first].name.clone());
                return refused(RobotError::TwoParents { link, first, second: name() });
            }
            ends.push([parent, child]);
        }
        Ok(Self { ends, mover })
    }
}

/// Names the circle of joints above a link that no root reaches.
fn circle(source: &Source, ends: &[[usize; 2]], mover: &[Option<usize>], lost: usize) -> RobotError {
    let mut walk: Vec<usize> = Vec::new();
    let mut step = vec![None; ends.len()];
    let mut above = mover[lost];
    while let Some(joint) = above {
        if let Some(start) = step[joint] {
            walk.drain(..start);
            break;
        }
        step[joint] = Some(walk.len());
        walk.push(joint);
        above = mover[ends[joint][0]];
    }
    let line = walk.first().map_or(source.line, |&joint| source.joint_lines[joint]);
    at(
        line,
        RobotError::Cycle { joints: walk.iter().map(|&j| source.robot.joints[j].name.clone()).collect() },
    )
}
