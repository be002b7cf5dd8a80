//! From the loops of a URDF to the constraints that close them.

use super::parts::{JointType, LoopType, Source, SourceHeld, SourceJoint, SourceLoop};
use super::plane::plane;
use crate::robot::constraint::{ConstraintRow, ConstraintSpec};
use crate::robot::error::{LoopProblem, RobotError};
use crate::robot::link::Placement;
use crate::robot::model::Robot;
use crate::robot::nearest::resembling;
use crate::robot::printable::{list, printable};
use crate::robot::warning::Warning;
use nalgebra::{Matrix3, Vector3};
use std::collections::{HashMap, HashSet};

/// Most joints on the ways of all couplings together from their links to the root: a short text could ask for
/// gigabytes of factors.
const MOST_STEPS: usize = 1_000_000;

/// The constraints that close the loops, in the order of the file, of links that form a tree.
pub(super) fn specs(source: &Source, warnings: &mut Vec<Warning>) -> Result<Vec<ConstraintSpec>, RobotError> {
    let mut ways = Ways::of(source);
    let mut specs = Vec::with_capacity(source.loops.len());
    for one in &source.loops {
        specs.push(spec(one, source, &mut ways, warnings).map_err(|error| error.at(one.line))?);
    }
    Ok(specs)
}

/// The robot of the tree with its loops closed.
pub(super) fn close(tree: Robot, source: &Source, specs: Vec<ConstraintSpec>) -> Result<Robot, RobotError> {
    if specs.is_empty() {
        return Ok(tree);
    }
    tree.with_constraints(specs.into_iter()).map_err(|(k, error)| error.at(source.loops[k].line))
}

/// The constraint that a loop is. The joint that closes it leads from the first link to the second.
fn spec(
    one: &SourceLoop,
    source: &Source,
    ways: &mut Ways<'_>,
    warnings: &mut Vec<Warning>,
) -> Result<ConstraintSpec, RobotError> {
    let refused = |problem| RobotError::BadLoop { constraint: one.name.clone(), problem };
    for link in &one.links {
        if !ways.links.contains(link.as_str()) {
            let nearest = resembling(link, source.links.iter().map(|link| link.name.as_str()));
            return Err(refused(LoopProblem::UnknownLink { link: link.clone(), nearest }));
        }
    }
    let [first, second] = &one.links;
    match &one.held {
        SourceHeld::Joint { kind, axis, placements } => {
            let [to, frame] = &**placements;
            let along = if kind.has_axis() { onto_z(axis) } else { Placement::identity() };
            let spec = ConstraintSpec::rows(&one.name, second, first, rows(*kind));
            Ok(spec.placed(frame.then(&along)).to_placed(to.then(&along)))
        }
        SourceHeld::Ratio(ratio) => {
            if *ratio == 0.0 {
                return Err(refused(LoopProblem::NoRatio));
            }
            let [before, after] = ways.sides([first, second], refused)?;
            if before.is_empty() || after.is_empty() {
                warnings.push(one_sided(one, [&before[..], &after].concat()));
            }
            let terms = before.into_iter().map(|joint| (joint, *ratio));
            let terms: Vec<_> = terms.chain(after.into_iter().map(|joint| (joint, -1.0))).collect();
            Ok(ConstraintSpec::coupling(&one.name, &terms, 0.0))
        }
    }
}

/// What a joint of this type does not let move; its axis is z.
fn rows(kind: LoopType) -> &'static [ConstraintRow] {
    use ConstraintRow::{TurnX, TurnY, TurnZ, X, Y, Z};
    match kind {
        LoopType::Fixed => &ConstraintRow::ALL,
        LoopType::Spherical => &[X, Y, Z],
        LoopType::Revolute => &[X, Y, Z, TurnX, TurnY],
        LoopType::Prismatic => &[X, Y, TurnX, TurnY, TurnZ],
        LoopType::Planar => &[Z, TurnX, TurnY],
    }
}

/// Axes whose z is this direction.
fn onto_z(axis: &Vector3<f64>) -> Placement {
    let z = axis / axis.norm();
    let [x, y] = plane(&z);
    Placement { rotation: Matrix3::from_columns(&[x, y, z]), translation: Vector3::zeros() }
}

/// The ways from links to the root.
struct Ways<'a> {
    source: &'a Source,
    links: HashSet<&'a str>,
    /// The joint that moves each link.
    mover: HashMap<&'a str, usize>,
    /// Joints that couplings passed so far.
    steps: usize,
}

impl<'a> Ways<'a> {
    fn of(source: &'a Source) -> Self {
        Self {
            source,
            links: source.links.iter().map(|link| link.name.as_str()).collect(),
            mover: source.joints.iter().enumerate().map(|(i, joint)| (joint.child.as_str(), i)).collect(),
            steps: 0,
        }
    }

    /// The joints from the root to a link.
    fn way(&mut self, link: &str) -> Result<Vec<usize>, RobotError> {
        let (mut way, mut link) = (Vec::new(), link);
        while let Some(&joint) = self.mover.get(link) {
            self.steps += 1;
            if self.steps > MOST_STEPS {
                let message = format!("the couplings go along more than {MOST_STEPS} joints; remove some");
                return Err(RobotError::malformed(message));
            }
            way.push(joint);
            link = &self.source.joints[joint].parent;
        }
        way.reverse();
        Ok(way)
    }

    /// The joints that move the first link, and those that move the second, from where their ways part.
    fn sides(
        &mut self,
        [first, second]: [&str; 2],
        refused: impl Fn(LoopProblem) -> RobotError,
    ) -> Result<[Vec<&'a str>; 2], RobotError> {
        let ways = [self.way(first)?, self.way(second)?];
        let shared = ways[0].iter().zip(&ways[1]).take_while(|(a, b)| a == b).count();
        let mut sides = [Vec::new(), Vec::new()];
        for (way, side) in ways.iter().zip(&mut sides) {
            for &joint in &way[shared..] {
                let SourceJoint { name, kind, .. } = &self.source.joints[joint];
                if let Some(kind) = kind.with_several_freedoms() {
                    return Err(refused(LoopProblem::SeveralFreedoms { joint: name.clone(), kind }));
                }
                if *kind != JointType::Fixed {
                    side.push(name.as_str());
                }
            }
        }
        if sides.iter().all(Vec::is_empty) { Err(refused(LoopProblem::Still)) } else { Ok(sides) }
    }
}

/// What a coupling is that moves one of its links alone.
fn one_sided(one: &SourceLoop, joints: Vec<&str>) -> Warning {
    let held = match &joints[..] {
        [only] => format!("joint '{}'", printable(only)),
        all => format!("the sum of joints '{}'", list(all, "', '")),
    };
    Warning::Note {
        text: format!(
            "coupling '{}' (line {}) has joints on one side only: it holds {held} still, and its ratio has no \
             effect; name links on two branches",
            printable(&one.name),
            one.line
        ),
    }
}
