//! From the text of a URDF to its links and joints.

use super::element::Element;
use super::limits::LimitReader;
use super::loop_elements::LoopReader;
use super::origin::{placement, version};
use super::parts::{JointType, Link, Source, SourceJoint, SourceMimic};
use super::vocabulary::Unknown;
use super::xml::{self, Lines};
use crate::robot::error::RobotError;
use crate::robot::joint::{Limits, MimicSpec};
use crate::robot::link::{LinkInertia, Placement};
use crate::robot::printable::printable;
use crate::robot::warning::Warning;
use nalgebra::{Matrix3, Vector3};
use roxmltree::Node;

/// Reads a URDF.
pub(super) fn read(text: &str) -> Result<Source, RobotError> {
    let text = xml::prepared(text)?;
    let lines = Lines::of(&text);
    let document = xml::parse(&text, &lines)?;
    let root = document.root_element();
    if root.tag_name().name() != "robot" {
        let tag = printable(root.tag_name().name());
        let message = format!("the outermost element is <{tag}>; a URDF begins with <robot>");
        return Err(RobotError::malformed(message).at(lines.line(root)));
    }
    let is_xacro = |node: &Node<'_, '_>| {
        let namespace = node.tag_name().namespace();
        namespace != root.tag_name().namespace() && namespace.is_some_and(|uri| uri.contains("xacro"))
    };
    let xacro = root.descendants().find(is_xacro);
    let xacro = xacro.map(|node| (node.tag_name().name().to_owned(), lines.line(node)));
    elements(root, &lines, xacro.clone()).map_err(|error| error.unexpanded(xacro))
}

/// Reads the elements of a robot.
fn elements(root: Node<'_, '_>, lines: &Lines, xacro: Option<(String, usize)>) -> Result<Source, RobotError> {
    let mut reader = Reader::new(root, lines);
    reader.unknown.check(root, "<robot>", lines);
    for node in root.children().filter(Node::is_element) {
        let same_namespace = node.tag_name().namespace() == root.tag_name().namespace();
        match node.tag_name().name() {
            "link" if same_namespace => reader.link(node)?,
            "joint" if same_namespace => reader.joint(node)?,
            "material" if same_namespace => reader.unknown.check(node, "<material>", lines),
            "loop_joint" | "loop" | "coupling" if same_namespace => reader.closing(node)?,
            "ball_constraint" if is_of_drake(node) => reader.loops.ball(node, lines)?,
            "ball_constraint" => reader.other_ball(node),
            "gazebo" if same_namespace => reader.gazebo(node),
            _ => {}
        }
    }
    Ok(reader.finish(root, xacro))
}

/// By its namespace, or by the prefix alone, as Drake reads it.
fn is_of_drake(node: Node<'_, '_>) -> bool {
    let namespace = node.tag_name().namespace();
    namespace.is_some_and(|uri| uri.contains("drake") || node.lookup_prefix(uri) == Some("drake"))
}

/// What has been read so far.
struct Reader<'a> {
    lines: &'a Lines,
    /// Major and minor version of the format.
    version: (u32, u32),
    links: Vec<Link>,
    joints: Vec<SourceJoint>,
    loops: LoopReader,
    limits: LimitReader,
    unknown: Unknown,
    notes: Vec<Warning>,
}

impl<'a> Reader<'a> {
    fn new(root: Node<'a, 'a>, lines: &'a Lines) -> Self {
        let version = version(root);
        Self {
            lines,
            version,
            links: Vec::new(),
            joints: Vec::new(),
            loops: LoopReader::default(),
            limits: LimitReader::new(version),
            unknown: Unknown::default(),
            notes: Vec::new(),
        }
    }

    fn finish(mut self, root: Node<'_, '_>, xacro: Option<(String, usize)>) -> Source {
        if let Some((element, line)) = &xacro {
            self.note(format!(
                "the file holds xacro elements (the first is '{}' in line {line}), which were ignored; \
                 expand it first (xacro robot.xacro > robot.urdf)",
                printable(element)
            ));
        }
        let name = root.attribute("name").filter(|name| !name.trim().is_empty()).unwrap_or("robot");
        let warnings = self.unknown.warnings().chain(self.notes).chain(self.limits.warnings());
        Source {
            name: name.to_owned(),
            line: self.lines.line(root),
            links: self.links,
            joints: self.joints,
            loops: self.loops.loops,
            warnings: warnings.collect(),
            xacro,
        }
    }

    fn note(&mut self, text: String) {
        self.notes.push(Warning::Note { text });
    }

    fn closing(&mut self, node: Node<'_, '_>) -> Result<(), RobotError> {
        let has_quaternions = self.has_quaternions();
        self.loops.read(node, self.lines, &mut self.unknown, has_quaternions)
    }

    /// An element that has the name of Drake's, but not its prefix.
    fn other_ball(&mut self, node: Node<'_, '_>) {
        self.note(format!(
            "<ball_constraint> (line {}) was not read: it lacks the prefix of Drake; if it closes a loop, write \
             <drake:ball_constraint>",
            self.lines.line(node)
        ));
    }

    /// Joints of SDF inside `<gazebo>`, which are not read, close loops in Gazebo.
    fn gazebo(&mut self, node: Node<'_, '_>) {
        let mut joints = node.children().filter(|child| child.tag_name().name() == "joint");
        if let Some(joint) = joints.next().filter(|_| !node.has_attribute("reference")) {
            self.note(format!(
                "joint '{}' inside <gazebo> (line {}) was not read: it belongs to Gazebo alone; if it closes a \
                 loop, describe it by <loop> too",
                printable(joint.attribute("name").unwrap_or_default()),
                self.lines.line(joint)
            ));
        }
    }

    fn has_quaternions(&self) -> bool {
        self.version >= (1, 1)
    }

    fn link(&mut self, node: Node<'a, 'a>) -> Result<(), RobotError> {
        let name = Element::new(node, self.lines, "").required_text("name")?;
        let owner = format!("link '{}'", printable(name));
        let link = Element::new(node, self.lines, &owner);
        self.unknown.check(node, &owner, self.lines);
        let inertia = match link.child("inertial")? {
            Some(inertial) => self.inertia(&inertial)?,
            None => LinkInertia::massless(),
        };
        self.links.push(Link { name: name.to_owned(), inertia, line: link.line() });
        Ok(())
    }

    /// An `<inertial>` in the frame of its link.
    fn inertia(&mut self, inertial: &Element<'_>) -> Result<LinkInertia, RobotError> {
        let placement = self.origin(inertial)?;
        let mass = inertial.required_child("mass")?.required_number("value")?;
        let matrix = inertial.required_child("inertia")?;
        let entry = |name| matrix.required_number(name);
        let [ixx, ixy, ixz] = [entry("ixx")?, entry("ixy")?, entry("ixz")?];
        let [iyy, iyz, izz] = [entry("iyy")?, entry("iyz")?, entry("izz")?];
        let matrix = Matrix3::new(ixx, ixy, ixz, ixy, iyy, iyz, ixz, iyz, izz);
        Ok(LinkInertia::about_com(mass, [0.0; 3], matrix).placed(&placement))
    }

    fn joint(&mut self, node: Node<'a, 'a>) -> Result<(), RobotError> {
        let name = Element::new(node, self.lines, "").required_text("name")?;
        let owner = format!("joint '{}'", printable(name));
        let joint = Element::new(node, self.lines, &owner);
        self.unknown.check(node, &owner, self.lines);
        let kind_name = joint.required_text("type")?;
        let Some(kind) = JointType::from_name(kind_name) else {
            let (joint_name, kind) = (name.to_owned(), kind_name.to_owned());
            return Err(RobotError::UnsupportedJoint { joint: joint_name, kind }.at(joint.line()));
        };
        let parent = joint.required_child("parent")?.required_text("link")?;
        let child = joint.required_child("child")?.required_text("link")?;
        let placement = self.origin(&joint)?;
        let mut read = SourceJoint {
            name: name.to_owned(),
            kind,
            parent: parent.to_owned(),
            child: child.to_owned(),
            placement,
            axis: Vector3::x(),
            limits: Limits::default(),
            dynamics: None,
            mimic: None,
            fixed_at: 0.0,
            line: joint.line(),
        };
        if kind != JointType::Fixed {
            self.motion(&joint, &mut read)?;
        }
        self.joints.push(read);
        Ok(())
    }

    /// What only a joint that moves has.
    fn motion(&mut self, joint: &Element<'_>, read: &mut SourceJoint) -> Result<(), RobotError> {
        if let Some(mimic) = joint.child("mimic")? {
            let (ratio, offset) = (mimic.number("multiplier")?, mimic.number("offset")?);
            let joint = mimic.required_text("joint")?.to_owned();
            let spec = MimicSpec { joint, ratio: ratio.unwrap_or(1.0), offset: offset.unwrap_or(0.0) };
            read.mimic = Some(SourceMimic { spec, line: mimic.line() });
        }
        if let Some(axis) = joint.child("axis")?.filter(|_| read.kind != JointType::Floating) {
            let xyz = axis
                .any_numbers::<3>("xyz")?
                .ok_or_else(|| axis.refuse("has no xyz; add xyz=\"0 0 1\" or another direction"))?;
            read.axis = Vector3::from(xyz);
            let length = read.axis.norm();
            if !(length.is_finite() && length > 0.0) {
                return Err(RobotError::BadAxis { joint: read.name.clone() }.at(axis.line()));
            }
        }
        if let Some(dynamics) = joint.child("dynamics")? {
            let [damping, friction] = [dynamics.number("damping")?, dynamics.number("friction")?];
            read.dynamics = Some([damping.unwrap_or(0.0), friction.unwrap_or(0.0)]);
        }
        if !matches!(read.kind, JointType::Floating | JointType::Planar) {
            read.limits = self.limits.read(joint, &read.name, read.kind == JointType::Continuous)?;
        }
        Ok(())
    }

    /// The placement by the `<origin>` of a joint or of an `<inertial>`.
    fn origin(&mut self, of: &Element<'_>) -> Result<Placement, RobotError> {
        let Some(origin) = of.child("origin")? else { return Ok(Placement::identity()) };
        let has_quaternions = self.has_quaternions();
        if !has_quaternions && origin.attribute("quat_xyzw").is_some() {
            self.note(format!(
                "quat_xyzw of {} (line {}) was ignored, as by the format before version 1.1; \
                 write <robot version=\"1.1\"> if it is meant",
                origin.description(),
                origin.line()
            ));
        }
        placement(&origin, has_quaternions)
    }
}
