//! The elements that close loops, in the extensions of URDF that have them.
//!
//! - `<loop_joint>`: the first parser of Drake, type `continuous`; Isaac Sim, type `spherical`.
//! - `<loop>` and `<coupling>`: URDF+ (Chignoli, Slotine, Wensing and Kim 2024).
//! - `<drake:ball_constraint>`: Drake.

use super::element::Element;
use super::origin::{placed, placement};
use super::parts::{LoopType, SourceHeld, SourceLoop};
use super::vocabulary::Unknown;
use super::xml::Lines;
use crate::robot::error::{LoopProblem, RobotError};
use crate::robot::link::Placement;
use crate::robot::printable::printable;
use nalgebra::Vector3;
use roxmltree::Node;

/// The loops that have been read so far.
#[derive(Default)]
pub(super) struct LoopReader {
    pub(super) loops: Vec<SourceLoop>,
    balls: usize,
}

impl LoopReader {
    /// Reads a `<loop_joint>`, `<loop>` or `<coupling>`.
    pub(super) fn read(
        &mut self,
        node: Node<'_, '_>,
        lines: &Lines,
        unknown: &mut Unknown,
        has_quaternions: bool,
    ) -> Result<(), RobotError> {
        let tag = node.tag_name().name();
        let name = Element::new(node, lines, "").required_text("name")?;
        let owner = format!("{} '{}'", if tag == "coupling" { tag } else { "loop" }, printable(name));
        let element = Element::new(node, lines, &owner);
        unknown.check(node, &owner, lines);
        // The second first: of two <link1> the message is that there is no <link2>.
        let [first, second] =
            if tag == "loop_joint" { ["link1", "link2"] } else { ["predecessor", "successor"] };
        let second = element.required_child(second)?;
        let ends = [element.required_child(first)?, second];
        let [first, second] = &ends;
        let links = [first.required_text("link")?.to_owned(), second.required_text("link")?.to_owned()];
        let held = match tag {
            "coupling" => SourceHeld::Ratio(match element.child("ratio")? {
                Some(ratio) => ratio.required_number("value")?,
                None => 1.0,
            }),
            "loop_joint" => joint(&element, name, [placement(first, false)?, placement(second, false)?])?,
            _ => joint(&element, name, [placed(first, has_quaternions)?, placed(second, has_quaternions)?])?,
        };
        self.loops.push(SourceLoop { name: name.to_owned(), links, held, line: element.line() });
        Ok(())
    }

    /// Reads a `<drake:ball_constraint>`, which has no name: it is called by its number.
    pub(super) fn ball(&mut self, node: Node<'_, '_>, lines: &Lines) -> Result<(), RobotError> {
        self.balls += 1;
        let name = format!("ball_constraint_{}", self.balls);
        let owner = format!("loop '{name}'");
        let element = Element::new(node, lines, &owner);
        let link = |body: &str| {
            let body = element.required_child(&format!("ball_constraint_body_{body}"))?;
            Ok::<_, RobotError>(body.required_text("name")?.to_owned())
        };
        let point = |name: &str| {
            let point = element.required_child(&format!("ball_constraint_p_{name}"))?;
            let xyz = point.numbers::<3>("value")?;
            let xyz =
                xyz.ok_or_else(|| point.refuse("has no value; add value=\"0 0 0\" or another point"))?;
            Ok::<_, RobotError>(Placement::from_xyz_rpy(xyz, [0.0; 3]))
        };
        let held = SourceHeld::Joint {
            kind: LoopType::Spherical,
            axis: Vector3::x(),
            placements: Box::new([point("AP")?, point("BQ")?]),
        };
        let links = [link("A")?, link("B")?];
        self.loops.push(SourceLoop { name, links, held, line: element.line() });
        Ok(())
    }
}

/// Type and axis of the joint that closes a loop.
fn joint(element: &Element<'_>, name: &str, placements: [Placement; 2]) -> Result<SourceHeld, RobotError> {
    let refused = |problem| RobotError::BadLoop { constraint: name.to_owned(), problem };
    let type_name = element.required_text("type")?;
    let Some(kind) = LoopType::from_name(type_name) else {
        let problem = LoopProblem::UnsupportedType { kind: type_name.to_owned() };
        return Err(refused(problem).at(element.line()));
    };
    let mut axis = Vector3::x();
    if let Some(given) = element.child("axis")?.filter(|_| kind.has_axis()) {
        let xyz = given.any_numbers::<3>("xyz")?;
        let xyz = xyz.ok_or_else(|| given.refuse("has no xyz; add xyz=\"0 0 1\" or another direction"))?;
        axis = Vector3::from(xyz);
        let length = axis.norm();
        if !(length.is_finite() && length > 0.0) {
            return Err(refused(LoopProblem::BadAxis).at(given.line()));
        }
    }
    Ok(SourceHeld::Joint { kind, axis, placements: Box::new(placements) })
}
