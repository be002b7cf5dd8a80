//! Constraints in the frames of a tree.

use crate::robot::constraint::{ConstraintFrame, ConstraintKind, ConstraintRow};
use crate::robot::joint_map::{Row, scaled};
use crate::robot::model::Robot;
use crate::robot::tree_frame::TreeFrame;

/// A constraint whose frames are those of a tree.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct TreeConstraint {
    pub name: String,
    pub kind: TreeConstraintKind,
}

/// What it holds.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum TreeConstraintKind {
    /// See [`ConstraintKind::Frames`].
    Frames { frames: [TreeFrame; 2], rows: Vec<ConstraintRow> },
    /// See [`ConstraintKind::Distance`].
    Distance { frames: [TreeFrame; 2], length: f64 },
    /// Coordinates with factors, and what is subtracted: joints that mimic others are resolved.
    Coupling { terms: Vec<(usize, f64)>, constant: f64 },
}

/// The constraints of a robot, from the frames of its tree and the coordinates of its joints.
pub(super) fn constraints(robot: &Robot, frames: &[TreeFrame], rows: &[Row]) -> Vec<TreeConstraint> {
    let seat = |at: &ConstraintFrame| {
        let TreeFrame { joint, placement } = frames[at.frame];
        TreeFrame { joint, placement: placement.then(&at.placement) }
    };
    let kind = |kind: &ConstraintKind| match kind {
        ConstraintKind::Frames { frame, to, rows } => {
            TreeConstraintKind::Frames { frames: [seat(frame), seat(to)], rows: rows.clone() }
        }
        ConstraintKind::Distance { frame, to, length } => {
            TreeConstraintKind::Distance { frames: [seat(frame), seat(to)], length: *length }
        }
        ConstraintKind::Coupling { terms, constant } => {
            let of =
                |&(joint, factor): &(usize, f64)| (rows[joint].coordinate, scaled(rows[joint].ratio, factor));
            let offset: f64 = terms.iter().map(|&(joint, factor)| factor * rows[joint].offset).sum();
            TreeConstraintKind::Coupling {
                terms: terms.iter().map(of).collect(),
                constant: constant - offset,
            }
        }
    };
    let all = robot.constraints().iter();
    all.map(|one| TreeConstraint { name: one.name.clone(), kind: kind(&one.kind) }).collect()
}
