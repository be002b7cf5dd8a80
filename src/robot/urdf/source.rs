//! From the text of a URDF to what `urdf-rs` makes of it.
//!
//! The text is first checked element by element, since `urdf-rs` knows no lines and drops what it cannot read.
//! It is then handed over reduced to what dynamics needs, with every omitted limit written out, so that nothing in a
//! mesh, a transmission or a simulator's extension can make a robot fail.

use super::element::{Element, Lines, at};
use super::text::{escaped, roll_pitch_yaw, without_comments};
use crate::robot::error::RobotError;
use crate::robot::warning::Warning;
use roxmltree::{Document, Error, Node, ParsingOptions};
use std::fmt::Write;

/// The joint types that can be loaded.
const TYPES: [&str; 6] = ["revolute", "continuous", "prismatic", "fixed", "floating", "planar"];

/// A URDF without what dynamics has no use for, and where things stand in the file.
pub(super) struct Source {
    pub(super) robot: urdf_rs::Robot,
    /// Line of `<robot>`.
    pub(super) line: usize,
    /// Line of each of the robot's links.
    pub(super) link_lines: Vec<usize>,
    /// Line of each of the robot's joints.
    pub(super) joint_lines: Vec<usize>,
    /// What is odd about the file.
    pub(super) notes: Vec<Warning>,
}

/// Reads a URDF.
pub(super) fn read(text: &str) -> Result<Source, RobotError> {
    let text = with_prefixes_declared(&without_comments(text));
    let lines = Lines::of(&text);
    let document = parse_xml(&text).map_err(|error| not_well_formed(&error, &lines))?;
    let root = document.root_element();
    if root.tag_name().name() != "robot" {
        let message =
            format!("the outermost element is <{}>; a URDF begins with <robot>", root.tag_name().name());
        return Err(at(lines.line(root), RobotError::Malformed { message }));
    }
    let mut reduction = Reduction::new(root, &lines);
    for node in root.children().filter(Node::is_element) {
        let same_namespace = node.tag_name().namespace() == root.tag_name().namespace();
        match node.tag_name().name() {
            "link" if same_namespace => reduction.link(node)?,
            "joint" if same_namespace => reduction.joint(node)?,
            name if node.tag_name().namespace().is_some_and(|uri| uri.contains("xacro")) => {
                reduction.unexpanded(name, lines.line(node));
            }
            _ => {}
        }
    }
    reduction.finish(lines.line(root))
}

fn parse_xml(text: &str) -> Result<Document<'_>, Error> {
    Document::parse_with_options(text, ParsingOptions { allow_dtd: true, ..ParsingOptions::default() })
}

/// The text with namespace prefixes that nobody declared declared in `<robot>`, on the same line.
///
/// Simulators' extensions come with such prefixes; readers of URDF do not mind, XML does.
fn with_prefixes_declared(text: &str) -> String {
    const MOST: usize = 64;
    let mut text = text.to_owned();
    let mut last = String::new();
    for _ in 0..MOST {
        let Err(Error::UnknownNamespace(prefix, _)) = parse_xml(&text) else { break };
        let Some(root) = text.find("<robot").filter(|_| prefix != last) else { break };
        text.insert_str(root + "<robot".len(), &format!(" xmlns:{prefix}=\"undeclared:{prefix}\""));
        last = prefix;
    }
    text
}

fn not_well_formed(error: &Error, lines: &Lines) -> RobotError {
    let (line, message) = match error {
        Error::UnclosedRootNode | Error::UnexpectedEndOfStream => {
            (lines.count(), "the text ends inside an element; complete the file".into())
        }
        error => (error.pos().row as usize, format!("not well-formed XML: {error}; correct it")),
    };
    at(line, RobotError::Malformed { message })
}

/// The reduced document, as far as it is written.
struct Reduction<'a> {
    lines: &'a Lines,
    /// Major and minor version of the format.
    version: (u32, u32),
    text: String,
    link_lines: Vec<usize>,
    joint_lines: Vec<usize>,
    notes: Vec<Warning>,
    is_xacro: bool,
    /// Joints whose `<limit>` lacks effort or velocity.
    unlimited: Vec<String>,
    /// Joints whose lower limit lies above the upper one.
    swapped: Vec<String>,
}

impl<'a> Reduction<'a> {
    fn new(root: Node<'a, 'a>, lines: &'a Lines) -> Self {
        let number = |text: &str| text.parse::<u32>().ok();
        let version = root.attribute("version").and_then(|text| text.trim().split_once('.'));
        let version =
            version.and_then(|(major, minor)| Some((number(major)?, number(minor)?))).unwrap_or((1, 0));
        // No version: what later ones changed, quaternions and omitted limits, is written out.
        let text = format!("<robot name=\"{}\">\n", escaped(root.attribute("name").unwrap_or_default()));
        let (link_lines, joint_lines, notes, unlimited, swapped) = Default::default();
        Self { lines, version, text, link_lines, joint_lines, notes, is_xacro: false, unlimited, swapped }
    }

    fn finish(mut self, line: usize) -> Result<Source, RobotError> {
        for (joints, what) in [
            (self.unlimited.join(", "), "without effort or velocity is taken as unlimited"),
            (self.swapped.join(", "), "with lower above upper is taken as no limit of position"),
        ] {
            if !joints.is_empty() {
                self.notes.push(Warning::Note { text: format!("<limit> {what}: joints {joints}") });
            }
        }
        let Self { text, link_lines, joint_lines, notes, .. } = self;
        let malformed = |message| at(line, RobotError::Malformed { message });
        let robot = urdf_rs::read_from_string(&(text + "</robot>"))
            .map_err(|error| malformed(format!("cannot be read as URDF: {error}")))?;
        if (robot.links.len(), robot.joints.len()) != (link_lines.len(), joint_lines.len()) {
            return Err(malformed(
                "cannot be read as URDF: links or joints are lost; check their names".into(),
            ));
        }
        Ok(Source { robot, line, link_lines, joint_lines, notes })
    }

    fn write(&mut self, element: std::fmt::Arguments<'_>) {
        // Writing to a string cannot fail.
        let _ = self.text.write_fmt(element);
    }

    fn note(&mut self, text: String) {
        self.notes.push(Warning::Note { text });
    }

    fn unexpanded(&mut self, name: &str, line: usize) {
        if !std::mem::replace(&mut self.is_xacro, true) {
            self.note(format!(
                "the file holds xacro elements (the first is '{name}' in line {line}), which are left out; \
                 expand it first (xacro robot.xacro > robot.urdf)"
            ));
        }
    }

    fn link(&mut self, node: Node<'a, 'a>) -> Result<(), RobotError> {
        let name = Element::new(node, self.lines, "").required_text("name")?;
        let owner = format!("link '{name}'");
        let link = Element::new(node, self.lines, &owner);
        self.link_lines.push(link.line());
        self.write(format_args!("<link name=\"{}\">", escaped(name)));
        if let Some(inertial) = link.child("inertial")? {
            self.text += "<inertial>";
            self.origin(&inertial)?;
            let mass = inertial.required_child("mass")?.required_number("value")?;
            self.write(format_args!("<mass value=\"{mass:?}\"/><inertia"));
            let inertia = inertial.required_child("inertia")?;
            for entry in ["ixx", "ixy", "ixz", "iyy", "iyz", "izz"] {
                let value = inertia.required_number(entry)?;
                self.write(format_args!(" {entry}=\"{value:?}\""));
            }
            self.text += "/></inertial>";
        }
        self.text += "</link>\n";
        Ok(())
    }

    fn joint(&mut self, node: Node<'a, 'a>) -> Result<(), RobotError> {
        let name = Element::new(node, self.lines, "").required_text("name")?;
        let owner = format!("joint '{name}'");
        let joint = Element::new(node, self.lines, &owner);
        let kind = joint.required_text("type")?;
        if !TYPES.contains(&kind) {
            let (joint_name, kind) = (name.to_owned(), kind.to_owned());
            return Err(at(joint.line(), RobotError::UnsupportedJoint { joint: joint_name, kind }));
        }
        let parent = joint.required_child("parent")?.required_text("link")?;
        let child = joint.required_child("child")?.required_text("link")?;
        self.joint_lines.push(joint.line());
        self.write(format_args!("<joint name=\"{}\" type=\"{kind}\">", escaped(name)));
        self.write(format_args!(
            "<parent link=\"{}\"/><child link=\"{}\"/>",
            escaped(parent),
            escaped(child)
        ));
        self.origin(&joint)?;
        if kind != "fixed" {
            self.motion(&joint, name, kind)?;
        }
        self.text += "</joint>\n";
        Ok(())
    }

    /// What only a joint that moves has.
    fn motion(&mut self, joint: &Element<'_>, name: &str, kind: &str) -> Result<(), RobotError> {
        if let Some(mimic) = joint.child("mimic")? {
            let (joint, master) = (name.to_owned(), mimic.required_text("joint")?.to_owned());
            return Err(at(mimic.line(), RobotError::Mimic { joint, master }));
        }
        if let Some(axis) = joint.child("axis")?.filter(|_| kind != "floating") {
            let [x, y, z] = axis
                .any_numbers::<3>("xyz")?
                .ok_or_else(|| axis.refuse("has no xyz; add xyz=\"0 0 1\" or another direction"))?;
            let length = (x * x + y * y + z * z).sqrt();
            if !(length.is_finite() && length > 0.0) {
                return Err(at(axis.line(), RobotError::BadAxis { joint: name.to_owned() }));
            }
            self.write(format_args!("<axis xyz=\"{x:?} {y:?} {z:?}\"/>"));
        }
        if let Some(dynamics) = joint.child("dynamics")? {
            let damping = dynamics.number("damping")?.unwrap_or(0.0);
            let friction = dynamics.number("friction")?.unwrap_or(0.0);
            self.write(format_args!("<dynamics damping=\"{damping:?}\" friction=\"{friction:?}\"/>"));
        }
        if !["floating", "planar"].contains(&kind) {
            self.limit(joint, name, kind == "continuous")?;
        }
        Ok(())
    }

    /// All limits of a joint: an omitted one is infinite, but an omitted position is 0 before version 1.2.
    fn limit(&mut self, joint: &Element<'_>, name: &str, is_continuous: bool) -> Result<(), RobotError> {
        const NONE: f64 = f64::INFINITY;
        let [mut lower, mut upper, mut effort, mut velocity] = [-NONE, NONE, NONE, NONE];
        if let Some(limit) = joint.child("limit")? {
            let given = [limit.number("effort")?, limit.number("velocity")?];
            [effort, velocity] = given.map(|limit| limit.unwrap_or(NONE));
            let positions = match is_continuous {
                true => [Some(lower), Some(upper)],
                false => [limit.number("lower")?, limit.number("upper")?],
            };
            let is_old = self.version < (1, 2);
            let omitted = if is_old { [0.0; 2] } else { [-NONE, NONE] };
            [lower, upper] = [0, 1].map(|side| positions[side].unwrap_or(omitted[side]));
            if is_old && given.contains(&None) {
                self.unlimited.push(name.to_owned());
            }
            if lower > upper {
                self.swapped.push(name.to_owned());
                [lower, upper] = [-NONE, NONE];
            }
            if is_old && positions == [None, None] {
                self.note(format!(
                    "<limit> of joint '{name}' has neither lower nor upper, which by the format means 0: \
                     add them, or make the joint continuous"
                ));
            }
        }
        self.write(format_args!(
            "<limit lower=\"{lower:?}\" upper=\"{upper:?}\" effort=\"{effort:?}\" velocity=\"{velocity:?}\"/>"
        ));
        Ok(())
    }

    /// The `<origin>` of a joint or of an `<inertial>`.
    fn origin(&mut self, of: &Element<'_>) -> Result<(), RobotError> {
        let Some(origin) = of.child("origin")? else { return Ok(()) };
        let [x, y, z] = origin.numbers::<3>("xyz")?.unwrap_or_default();
        self.write(format_args!("<origin xyz=\"{x:?} {y:?} {z:?}\""));
        let angles = origin.numbers::<3>("rpy")?;
        if let Some([roll, pitch, yaw]) = angles {
            self.write(format_args!(" rpy=\"{roll:?} {pitch:?} {yaw:?}\""));
        }
        match origin.attribute("quat_xyzw") {
            Some(_) if self.version < (1, 1) => self.note(format!(
                "quat_xyzw of {} is ignored, as by the format before version 1.1; \
                 write <robot version=\"1.1\"> if it is meant",
                origin.description()
            )),
            Some(_) if angles.is_some() => {
                return Err(origin.refuse("has both rpy and quat_xyzw; keep one of them"));
            }
            Some(_) => {
                let [x, y, z, w] = origin.numbers::<4>("quat_xyzw")?.unwrap_or([0.0, 0.0, 0.0, 1.0]);
                let norm = (x * x + y * y + z * z + w * w).sqrt();
                if !(norm.is_finite() && norm > 0.0) {
                    return Err(origin.refuse("has a quat_xyzw of length zero; give a unit quaternion"));
                }
                let [roll, pitch, yaw] = roll_pitch_yaw([x, y, z, w].map(|part| part / norm));
                self.write(format_args!(" rpy=\"{roll:?} {pitch:?} {yaw:?}\""));
            }
            None => {}
        }
        self.text += "/>";
        Ok(())
    }
}
