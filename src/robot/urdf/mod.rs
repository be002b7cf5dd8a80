//! Robots from URDF files.
//!
//! The root link is the base: it does not move, nor does anything fixed to it. Links behind fixed joints are
//! merged into the body that carries them. `continuous` is revolute without position limits; `floating` and
//! `planar` joints become several joints with massless links between them. Joints keep the order of the file,
//! except that parents come before their children. Transmissions and extensions of simulators are not read;
//! visual and collision models are, by [`visuals`] and [`collisions`], and belong to no robot. A joint with
//! `<mimic>` follows another one ([`Mimic`](super::Mimic)); one that mimics a fixed joint is fixed at its
//! offset. Elements and attributes that URDF does not know are ignored with a warning that names the line.
//!
//! Loops of its extensions become [constraints](Robot::constraints) with the name of the element:
//!
//! ```xml
//! <loop name="pivot" type="revolute">
//!   <predecessor link="base"><origin xyz="1.3 0 0" rpy="0 0 0"/></predecessor>
//!   <successor link="rocker"><origin xyz="0.9 0 0" rpy="0 0 0"/></successor>
//!   <axis xyz="0 0 1"/>
//! </loop>
//! <loop_joint name="pivot" type="revolute">
//!   <link1 link="base" xyz="1.3 0 0" rpy="0 0 0"/>
//!   <link2 link="rocker" xyz="0.9 0 0" rpy="0 0 0"/>
//!   <axis xyz="0 0 1"/>
//! </loop_joint>
//! <coupling name="gear">
//!   <predecessor link="wheel"/><successor link="rotor"/><ratio value="6"/>
//! </coupling>
//! <drake:ball_constraint>
//!   <drake:ball_constraint_body_A name="base"/><drake:ball_constraint_p_AP value="1.3 0 0"/>
//!   <drake:ball_constraint_body_B name="rocker"/><drake:ball_constraint_p_BQ value="0.9 0 0"/>
//! </drake:ball_constraint>
//! ```
//!
//! A joint of the type leads from the first link to the second, its frame placed in both. Types are `fixed`
//! (all six rows), `revolute` and `continuous` (x, y, z, turn_x, turn_y of frames whose z is the axis),
//! `prismatic` (x, y and all turns), `planar` (z, turn_x, turn_y) and `spherical` (x, y, z). The axis is in
//! axes of the frame of the joint, (1, 0, 0) where it is omitted. A coupling is `ratio` times the sum of the
//! joints that move the predecessor, minus the sum of those that move the successor, each from where their
//! ways from the root part; the ratio is 1 where it is omitted. Ball constraints are called
//! `ball_constraint_1`, `ball_constraint_2`.
//!
//! A text may have 16 MiB and 500 000 elements and texts between them, an element 256 attributes. A document
//! type (`<!DOCTYPE`) is refused.

mod collision;
mod element;
mod geometry;
mod limits;
mod loop_elements;
mod loops;
mod mimics;
mod origin;
mod parts;
mod plane;
mod quaternion;
mod source;
mod tree;
mod visual;
mod vocabulary;
mod xml;

pub use self::collision::{CollisionModel, collisions};
pub use self::geometry::Geometry;
pub use self::visual::{Visual, visuals};

use self::parts::{JointType, Source, SourceJoint};
use self::plane::plane;
use self::tree::{Attachment, Attachments};
use super::body::Body;
use super::checks;
use super::error::RobotError;
use super::frame::{FrameKind, FrameSpec};
use super::joint::{Friction, JointKind, JointSpec};
use super::link::LinkInertia;
use super::model::Robot;
use super::options::LoadOptions;
use super::printable::{printable, printable_number};
use super::warning::Warning;
use nalgebra::Vector3;
use std::collections::HashMap;

/// Reads the text of a URDF; gravity is (0, 0, -9.81) m/s^2 in the frame of the root link.
///
/// With [`LoadOptions::quaternions`] joint `NAME` of type `floating` is a floating joint. Else it becomes
/// six: prismatic `NAME_x`, `NAME_y`, `NAME_z`, then revolute `NAME_rz`, `NAME_ry`, `NAME_rx`, along and
/// about the axes of the joint frame. One of type `planar` becomes three: prismatic `NAME_x` and `NAME_y` in
/// the plane normal to its axis, then revolute `NAME_rz` about the axis. The first direction in the plane is
/// the x axis of the joint frame projected on it (the y axis where x is within 30 degrees of the joint's
/// axis), the second completes a right-handed frame: axis z gives exactly x and y.
///
/// # Errors
/// [`RobotError::InFile`] with the line of the culprit and an empty path; the error itself where no line is
/// known. [`RobotError::BadLoop`] and [`RobotError::BadConstraint`] are about loops.
pub fn parse(text: &str, options: LoadOptions) -> Result<Robot, RobotError> {
    let mut source = source::read(text)?;
    let xacro = source.xacro.take();
    built(source, options).map_err(|error| error.unexpanded(xacro))
}

fn built(mut source: Source, options: LoadOptions) -> Result<Robot, RobotError> {
    let mut warnings = std::mem::take(&mut source.warnings);
    if options.floating_base {
        source.set_afloat();
    }
    mimics::settle(&mut source, &mut warnings)?;
    let attached = tree::attachments(&source)?;
    let bodies = bodies(&source, &attached.links, &mut warnings)?;
    if let Some(root) = attached.root.map(|root| &source.links[root]).filter(|root| root.inertia.mass > 0.0) {
        let (link, mass, line) = (root.name.clone(), root.inertia.mass, root.line);
        let moving =
            source.joints.iter().zip(&attached.joints).filter(|(joint, _)| joint.kind != JointType::Fixed);
        let branches = moving.filter(|(_, attachment)| attachment.carrier.is_none()).count();
        warnings.push(if branches > 1 {
            Warning::FixedBase { link, mass, line }
        } else {
            // The base of an arm: without consequences.
            let (link, mass) = (printable(&link), printable_number(mass));
            let text = format!(
                "the base is held fixed, and the mass of the root link '{link}' (line {line}), {mass} kg, is not used"
            );
            Warning::Note { text }
        });
    }
    let mut lines = HashMap::new();
    let mut builder = Robot::builder(&source.name).options(options);
    for frame in frames(&source, &attached, options) {
        builder = builder.frame(frame);
    }
    for (spec, line) in joints(&source, &attached, bodies, options, &mut warnings) {
        lines.insert(spec.name.clone(), line);
        builder = builder.joint(spec);
    }
    let loops = loops::specs(&source, &mut warnings)?;
    for warning in warnings {
        builder.warn(warning);
    }
    let tree = builder.build().map_err(|error| {
        let line = match &error {
            RobotError::NoJoints { .. } => Some(source.line),
            RobotError::Strict { warnings } => warnings.iter().find_map(Warning::line),
            error => error.culprit().and_then(|name| {
                let link = || source.links.iter().find(|link| link.name == name).map(|link| link.line);
                lines.get(name).copied().or_else(link)
            }),
        };
        if line.is_some() { error.at(line) } else { error }
    })?;
    loops::close(tree, &source, loops)
}

/// The inertia that each joint of the file carries, in its frame: of its own link and of all that is fixed to
/// it.
///
/// A link that no rigid body can be is named here if it is merged into a larger body, by the builder if not.
fn bodies(
    source: &Source,
    attached: &[Attachment],
    warnings: &mut Vec<Warning>,
) -> Result<Vec<LinkInertia>, RobotError> {
    let mut bodies = vec![LinkInertia::massless(); source.joints.len()];
    let mut parts = vec![Vec::new(); bodies.len()];
    for (link, attachment) in source.links.iter().zip(attached) {
        let inertia = link.inertia;
        match (checks::inertia(&Body::link(&link.name), &inertia), attachment.carrier) {
            (Ok(()), None) | (Err(RobotError::IndefiniteInertia { .. }), None) => {}
            (Ok(()), Some(_)) if inertia.is_massless() => {}
            (Ok(()), Some(joint)) => {
                let part = inertia.placed(&attachment.placement);
                bodies[joint] = if parts[joint].is_empty() { part } else { bodies[joint].merged(&part) };
                parts[joint].push((&link.name, inertia));
            }
            (Err(error), _) => return Err(error.at(link.line)),
        }
    }
    for (link, inertia) in parts.iter().filter(|parts| parts.len() > 1).flatten() {
        warnings.extend(checks::principal_moments(&Body::link(link), inertia));
    }
    Ok(bodies)
}

/// The frames of all links, and of the joints that are merged.
fn frames(source: &Source, attached: &Attachments, options: LoadOptions) -> Vec<FrameSpec> {
    let mover = |attachment: &Attachment| {
        // Of several joints that one becomes, the last moves the link.
        attachment
            .carrier
            .and_then(|carrier| expanded(&source.joints[carrier], options).pop())
            .map(|last| last.name)
    };
    let frame = |name: &str, kind, attachment: &Attachment| {
        FrameSpec::described(name, kind, mover(attachment).as_deref(), attachment.placement)
    };
    let links = source.links.iter().zip(&attached.links);
    let links = links.map(|(link, attachment)| frame(&link.name, FrameKind::Link, attachment));
    let merged =
        source.joints.iter().zip(&attached.joints).filter(|(joint, _)| joint.kind == JointType::Fixed);
    let merged = merged.map(|(joint, attachment)| frame(&joint.name, FrameKind::Joint, attachment));
    links.chain(merged).collect()
}

/// The joints of the robot in the order of the file, each with the line of the joint that it comes from.
fn joints(
    source: &Source,
    attached: &Attachments,
    bodies: Vec<LinkInertia>,
    options: LoadOptions,
    warnings: &mut Vec<Warning>,
) -> Vec<(JointSpec, usize)> {
    let expanded: Vec<Vec<JointSpec>> = source.joints.iter().map(|joint| expanded(joint, options)).collect();
    let moving_link: Vec<Option<String>> =
        expanded.iter().map(|specs| specs.last().map(|spec| spec.name.clone())).collect();
    let (mut all, mut ignored) = (Vec::with_capacity(expanded.len()), Vec::new());
    for (index, mut specs) in expanded.into_iter().enumerate() {
        let (joint, attachment) = (&source.joints[index], &attached.joints[index]);
        if let [only] = &mut specs[..] {
            only.limits = joint.limits;
            only.mimic = joint.mimic.as_ref().map(|mimic| mimic.spec.clone());
        }
        if let Some(first) = specs.first_mut() {
            first.parent = attachment.carrier.and_then(|carrier| moving_link[carrier].clone());
            first.placement = attachment.placement;
        }
        if let Some(last) = specs.last_mut() {
            last.virtual_link = false;
            last.link = Some(joint.child.clone());
            last.inertia = bodies[index];
        }
        friction(joint, &mut specs, options, &mut ignored, warnings);
        let is_whole = specs.iter().any(|spec| spec.free.is_some());
        if let Some(kind) = joint.kind.with_several_freedoms().filter(|_| !is_whole) {
            warnings.push(Warning::Expanded { joint: joint.name.clone(), kind });
        }
        all.extend(specs.into_iter().map(|spec| (spec, joint.line)));
    }
    if !ignored.is_empty() {
        warnings.push(Warning::FrictionIgnored { joints: ignored });
    }
    all
}

/// The joints of one degree of freedom that a joint becomes, each attached to the one before; none for a
/// fixed one.
fn expanded(joint: &SourceJoint, options: LoadOptions) -> Vec<JointSpec> {
    if joint.kind == JointType::Floating && (options.quaternions || options.floating_base) {
        return JointSpec::floating(&joint.name).parts();
    }
    use JointKind::{Prismatic, Revolute};
    let axis = joint.axis;
    let [x, y, z] = [Vector3::x(), Vector3::y(), Vector3::z()];
    let parts: &[(&str, JointKind, Vector3<f64>)] = match joint.kind {
        JointType::Revolute | JointType::Continuous => &[("", Revolute, axis)],
        JointType::Prismatic => &[("", Prismatic, axis)],
        JointType::Floating => &[
            ("_x", Prismatic, x),
            ("_y", Prismatic, y),
            ("_z", Prismatic, z),
            ("_rz", Revolute, z),
            ("_ry", Revolute, y),
            ("_rx", Revolute, x),
        ],
        JointType::Planar => {
            let normal = axis / axis.norm();
            let [first, second] = plane(&normal);
            &[("_x", Prismatic, first), ("_y", Prismatic, second), ("_rz", Revolute, normal)]
        }
        JointType::Fixed => &[],
    };
    let mut specs: Vec<JointSpec> = Vec::with_capacity(parts.len());
    for &(suffix, kind, axis) in parts {
        let mut spec = JointSpec::new(format!("{}{suffix}", joint.name), kind).axis(axis.into());
        spec.parent = specs.last().map(|before| before.name.clone());
        spec.virtual_link = true;
        specs.push(spec);
    }
    specs
}

/// Loads `<dynamics>` if the options request it; else warns about it.
fn friction(
    joint: &SourceJoint,
    specs: &mut [JointSpec],
    options: LoadOptions,
    ignored: &mut Vec<String>,
    warnings: &mut Vec<Warning>,
) {
    let Some([damping, friction]) = joint.dynamics else { return };
    if damping == 0.0 && friction == 0.0 {
        return;
    }
    let name = joint.name.clone();
    match specs {
        [only] if options.friction => {
            let coulomb_velocity = Friction::DEFAULT_COULOMB_VELOCITY;
            only.friction = Friction { viscous: damping, coulomb: friction, coulomb_velocity };
        }
        [_] => ignored.push(name),
        _ => warnings.push(Warning::Note {
            text: format!(
                "<dynamics> of joint '{}' was not loaded: one number does not fit several degrees of freedom",
                printable(&name)
            ),
        }),
    }
}
