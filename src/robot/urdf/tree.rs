//! Which joint moves which link: the tree of a URDF, and where each frame lies in it.

use super::parts::{JointType, Link, Source, UNIVERSE};
use crate::robot::error::RobotError;
use crate::robot::link::Placement;
use std::collections::{HashMap, HashSet};

/// Where a frame lies once fixed joints are merged.
#[derive(Clone, Copy)]
pub(super) struct Attachment {
    /// The nearest joint above that moves; none on the base.
    pub(super) carrier: Option<usize>,
    /// The frame in the frame of that joint, or of the root link.
    pub(super) placement: Placement,
}

/// The attachments of all links and of all joint frames at q = 0.
pub(super) struct Attachments {
    pub(super) links: Vec<Attachment>,
    pub(super) joints: Vec<Attachment>,
    /// The link without a parent.
    pub(super) root: Option<usize>,
}

/// Checks that links and joints form one tree, and places them from its root outwards.
pub(super) fn attachments(source: &Source) -> Result<Attachments, RobotError> {
    let Graph { ends, mover } = Graph::of(source)?;
    let mut children = vec![Vec::new(); mover.len()];
    for (joint, &[parent, _]) in ends.iter().enumerate() {
        children[parent].push(joint);
    }
    let base = Attachment { carrier: None, placement: Placement::identity() };
    let roots: Vec<usize> = (0..mover.len()).filter(|&link| mover[link].is_none()).collect();
    let mut found = Attachments {
        links: vec![base; mover.len()],
        joints: vec![base; ends.len()],
        root: roots.first().copied(),
    };
    let mut reached = vec![false; mover.len()];
    let mut next = roots.clone();
    while let Some(link) = next.pop() {
        reached[link] = true;
        for &joint in &children[link] {
            let Attachment { carrier, placement } = found.links[link];
            let frame = Attachment { carrier, placement: placement.then(&source.joints[joint].placement) };
            let child = ends[joint][1];
            found.joints[joint] = frame;
            found.links[child] = match source.joints[joint].kind {
                JointType::Fixed => frame,
                _ => Attachment { carrier: Some(joint), placement: Placement::identity() },
            };
            next.push(child);
        }
    }
    if let Some(lost) = reached.iter().position(|reached| !reached) {
        return Err(cycle(source, &ends, &mover, lost));
    }
    match roots[..] {
        [first, second, ..] => {
            let name = |link: usize| source.links[link].name.clone();
            let error = RobotError::SeveralRoots { first: name(first), second: name(second) };
            Err(error.at(source.links[second].line))
        }
        _ => Ok(()),
    }?;
    // A base that was put on a floating joint may keep its name.
    let floats = |joint: usize| source.joints[joint].parent == UNIVERSE;
    let moves = |(link, at): &(&Link, &Attachment)| {
        link.name == "world" && at.carrier.is_some_and(|joint| !floats(joint))
    };
    match source.links.iter().zip(&found.links).find(moves) {
        None => Ok(found),
        Some((link, _)) => {
            let rule = "that is the ground, which constraints and frames refer to, and this link moves: give \
                        it another name";
            Err(RobotError::BadName { kind: "link", name: link.name.clone(), rule }.at(link.line))
        }
    }
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
        let (links, joints) = (&source.links, &source.joints);
        let duplicate = |kind, name: &str| RobotError::DuplicateName { kind, name: name.to_owned() };
        let mut index = HashMap::with_capacity(links.len());
        for (i, link) in links.iter().enumerate() {
            if index.insert(link.name.as_str(), i).is_some() {
                return Err(duplicate("link", &link.name).at(link.line));
            }
        }
        let mut names = HashSet::with_capacity(joints.len());
        let mut ends = Vec::with_capacity(joints.len());
        let mut mover: Vec<Option<usize>> = vec![None; links.len()];
        for (i, joint) in joints.iter().enumerate() {
            let refused = |error: RobotError| Err(error.at(joint.line));
            let name = || joint.name.clone();
            if !names.insert(joint.name.as_str()) {
                return refused(duplicate("joint", &joint.name));
            }
            let Some(&parent) = index.get(joint.parent.as_str()) else {
                let parent = joint.parent.clone();
                return refused(RobotError::UnknownParent { joint: name(), parent, kind: "link" });
            };
            let Some(&child) = index.get(joint.child.as_str()) else {
                return refused(RobotError::UnknownChild { joint: name(), child: joint.child.clone() });
            };
            if parent == child {
                return refused(RobotError::Cycle { joints: vec![name()] });
            }
            if let Some(first) = mover[child].replace(i) {
                let (link, first) = (joint.child.clone(), joints[first].name.clone());
                return refused(RobotError::TwoParents { link, first, second: name() });
            }
            ends.push([parent, child]);
        }
        Ok(Self { ends, mover })
    }
}

/// Names the loop of joints above a link that no root reaches.
fn cycle(source: &Source, ends: &[[usize; 2]], mover: &[Option<usize>], lost: usize) -> RobotError {
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
    let line = walk.first().map_or(source.line, |&joint| source.joints[joint].line);
    RobotError::Cycle { joints: walk.iter().map(|&joint| source.joints[joint].name.clone()).collect() }
        .at(line)
}
