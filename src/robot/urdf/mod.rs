//! Robots from URDF files.
//!
//! The root link is the base: it does not move, nor does anything fixed to it. Links behind fixed joints are merged
//! into the body that carries them. `continuous` is revolute without position limits; `floating` and `planar` joints
//! become several joints with massless links between them. Joints keep the order of the file as far as parents come
//! before their children. What a URDF says about looks, collisions, transmissions and simulators is not read.

mod element;
mod source;
mod text;
mod tree;

use self::element::at;
use self::source::Source;
use self::tree::{Seat, Seats};
use super::error::RobotError;
use super::joint::{Friction, JointKind, JointSpec, Limits};
use super::link::LinkInertia;
use super::warning::Warning;
use super::{LoadOptions, Robot, checks};
use nalgebra::{Matrix3, Vector3};
use std::collections::HashMap;
use urdf_rs::JointType;

/// Reads the text of a URDF; gravity is (0, 0, -9.81) m/s^2 in the frame of the root link.
///
/// Joint `NAME` of type `floating` becomes six: prismatic `NAME_x`, `NAME_y`, `NAME_z`, then revolute `NAME_rz`,
/// `NAME_ry`, `NAME_rx`, along and about the axes of the joint frame. One of type `planar` becomes three: prismatic
/// `NAME_x` and `NAME_y` in the plane normal to its axis, then revolute `NAME_rz` about the axis. The first direction
/// in the plane is the x axis of the joint frame projected on it (the y axis where x is within 30 degrees of the
/// joint's axis), the second completes a right-handed frame: axis z gives exactly x and y.
///
/// # Errors
/// [`RobotError::InFile`] with the line of the culprit and an empty path; the bare error where no line is to blame.
pub fn parse(text: &str, options: LoadOptions) -> Result<Robot, RobotError> {
    let source = source::read(text)?;
    let seats = tree::seats(&source)?;
    let mut warnings = source.notes.clone();
    let bodies = bodies(&source, &seats.links, &mut warnings)?;
    let name = Some(source.robot.name.as_str()).filter(|name| !name.trim().is_empty()).unwrap_or("robot");
    let mut lines = HashMap::new();
    let mut builder = Robot::builder(name).options(options);
    for (spec, line) in joints(&source, &seats, bodies, options, &mut warnings) {
        lines.insert(spec.name.clone(), line);
        builder = builder.joint(spec);
    }
    for warning in warnings {
        builder.warn(warning);
    }
    builder.build().map_err(|error| {
        let has_mass = source.robot.links.iter().any(|link| !inertia(&link.inertial).is_massless());
        let error = match error {
            RobotError::MovesNothing { joint } if !has_mass => RobotError::KinematicsOnly { joint },
            error => error,
        };
        match error.culprit().and_then(|joint| lines.get(joint)) {
            Some(&line) => at(line, error),
            None if matches!(error, RobotError::NoJoints { .. }) => at(source.line, error),
            None => error,
        }
    })
}

/// The inertia that each joint of the file carries, in its frame: of its own link and of all that is fixed to it.
///
/// A link that no rigid body can be is named here if it disappears in a larger body, by the builder if not.
fn bodies(
    source: &Source,
    seats: &[Seat],
    warnings: &mut Vec<Warning>,
) -> Result<Vec<LinkInertia>, RobotError> {
    let mut bodies = vec![LinkInertia::massless(); source.robot.joints.len()];
    let mut parts = vec![Vec::new(); bodies.len()];
    for ((link, seat), &line) in source.robot.links.iter().zip(seats).zip(&source.link_lines) {
        let inertia = inertia(&link.inertial);
        match (checks::inertia(&link.name, &inertia), seat.carrier) {
            (Ok(()), None) | (Err(RobotError::IndefiniteInertia { .. }), None) => {}
            (Ok(()), Some(_)) if inertia.is_massless() => {}
            (Ok(()), Some(joint)) => {
                let part = inertia.placed(&seat.placement);
                bodies[joint] = if parts[joint].is_empty() { part } else { bodies[joint].merged(&part) };
                parts[joint].push((&link.name, inertia));
            }
            (Err(error), _) => return Err(at(line, error)),
        }
    }
    for (link, inertia) in parts.iter().filter(|parts| parts.len() > 1).flatten() {
        warnings.extend(checks::triangle_inequality(link, inertia));
    }
    Ok(bodies)
}

/// An `<inertial>` in the frame of its link.
fn inertia(inertial: &urdf_rs::Inertial) -> LinkInertia {
    let urdf_rs::Inertia { ixx, ixy, ixz, iyy, iyz, izz } = inertial.inertia;
    let matrix = Matrix3::new(ixx, ixy, ixz, ixy, iyy, iyz, ixz, iyz, izz);
    LinkInertia::about_com(inertial.mass.value, [0.0; 3], matrix).placed(&tree::placed(&inertial.origin))
}

/// The joints of the robot in the order of the file, each with the line of the joint that it comes from.
fn joints(
    source: &Source,
    seats: &Seats,
    bodies: Vec<LinkInertia>,
    options: LoadOptions,
    warnings: &mut Vec<Warning>,
) -> Vec<(JointSpec, usize)> {
    let expanded: Vec<Vec<JointSpec>> = source.robot.joints.iter().map(expanded).collect();
    let moving_link: Vec<Option<String>> =
        expanded.iter().map(|specs| specs.last().map(|spec| spec.name.clone())).collect();
    let (mut all, mut ignored) = (Vec::with_capacity(expanded.len()), Vec::new());
    for (index, mut specs) in expanded.into_iter().enumerate() {
        let (joint, seat) = (&source.robot.joints[index], &seats.joints[index]);
        if let [only] = &mut specs[..] {
            only.limits = limits(&joint.limit);
        }
        if let Some(first) = specs.first_mut() {
            first.parent = seat.carrier.and_then(|carrier| moving_link[carrier].clone());
            first.placement = seat.placement;
        }
        if let Some(last) = specs.last_mut() {
            last.virtual_link = false;
            last.link = Some(joint.child.link.clone());
            last.inertia = bodies[index];
        }
        friction(joint, &mut specs, options, &mut ignored, warnings);
        if let JointType::Floating | JointType::Planar = joint.joint_type {
            let kind = if joint.joint_type == JointType::Planar { "planar" } else { "floating" };
            warnings.push(Warning::Expanded { joint: joint.name.clone(), kind });
        }
        all.extend(specs.into_iter().map(|spec| (spec, source.joint_lines[index])));
    }
    if !ignored.is_empty() {
        warnings.push(Warning::FrictionIgnored { joints: ignored });
    }
    all
}

/// The joints of one degree of freedom that a joint becomes, each standing on the one before; none for a fixed one.
fn expanded(joint: &urdf_rs::Joint) -> Vec<JointSpec> {
    use JointKind::{Prismatic, Revolute};
    let axis = Vector3::from(*joint.axis.xyz);
    let [x, y, z] = [Vector3::x(), Vector3::y(), Vector3::z()];
    let parts: &[(&str, JointKind, Vector3<f64>)] = match joint.joint_type {
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
        JointType::Fixed | JointType::Spherical => &[],
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

/// Two directions that with `normal` (of length 1) form a right-handed frame: x, y for z.
fn plane(normal: &Vector3<f64>) -> [Vector3<f64>; 2] {
    let within = |direction: Vector3<f64>| direction - normal * normal.dot(&direction);
    let x = within(Vector3::x());
    let first = if x.norm() >= 0.5 { x } else { within(Vector3::y()) };
    let first = first / first.norm();
    [first, normal.cross(&first)]
}

fn limits(limit: &urdf_rs::JointLimit) -> Limits {
    Limits { lower: limit.lower, upper: limit.upper, velocity: limit.velocity, effort: limit.effort }
}

/// Loads `<dynamics>` if that is asked for, and says so if it is left out.
fn friction(
    joint: &urdf_rs::Joint,
    specs: &mut [JointSpec],
    options: LoadOptions,
    ignored: &mut Vec<String>,
    warnings: &mut Vec<Warning>,
) {
    let Some(urdf_rs::Dynamics { damping, friction }) = joint.dynamics else { return };
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
                "<dynamics> of joint '{name}' is left out: one number does not fit several degrees of freedom"
            ),
        }),
    }
}
