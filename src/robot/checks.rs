//! Physical checks: the impossible is an error, the unlikely a warning.

use super::armature::Armature;
use super::body::Body;
use super::error::RobotError;
use super::joint::{Friction, Joint, JointKind, JointSpec, Limits, Spring};
use super::link::LinkInertia;
use super::positive::{is_regular, positivity};
use super::range::{RANGE, is_moderate};
use super::warning::{Positivity, Warning};

/// Relative rounding that published figures are allowed.
const ROUNDING: f64 = 1e-9;

/// A principal moment of this size times the mass is that of a micrometre: rounding.
const TINY_RADIUS_SQUARED: f64 = 1e-12;

/// The size of a negative principal moment, relative to the largest one, up to which it may be a mistake in
/// the figures of a real link; M shows whether it matters.
const SLIGHTLY: f64 = 0.5;

/// Largest position limit of a revolute joint that passes without a warning (rad): two turns.
const TWO_TURNS: f64 = 4.0 * std::f64::consts::PI;

/// Larger limits (rad) mean that there is none.
const UNLIMITED: f64 = 3600.0;

/// Robots that reach less far (m) are not taken for some that are given in millimetres.
const FAR: f64 = 10.0;

/// Mass over the cube of the length (kg/m^3) below which a robot is lighter than can be: a rod of foam with
/// 30 kg/m^3, a thousand times as long as thick, has 3e-5. Lengths in mm make the ratio 1e9 times smaller;
/// real robots have 1e-2 or more.
const LIGHTEST: f64 = 3e-5;

/// The same for inertias, by the mean radius of gyration: a rod of 1000 kg/m^3. Those in kg mm^2 have a
/// radius that is a thousand times too long.
const LIGHTEST_TO_TURN: f64 = 1e-3;

/// How many times longer than the robot its mean radius of gyration must be.
const TOO_WIDE: f64 = 10.0;

/// A name that can be written in a file or a flag: not blank.
pub(super) fn name(kind: &'static str, name: &str) -> Result<(), RobotError> {
    match name.trim() {
        "" => Err(RobotError::BadName { kind, name: name.into(), rule: "give it a name that is not blank" }),
        _ => Ok(()),
    }
}

/// Mass, centre of mass and inertia of one body.
pub(super) fn inertia(body: &Body, inertia: &LinkInertia) -> Result<(), RobotError> {
    let not_finite = |what| RobotError::NonFiniteInertia { body: body.clone(), what };
    if !inertia.mass.is_finite() {
        return Err(not_finite("the mass"));
    }
    if inertia.com.iter().any(|x| !x.is_finite()) {
        return Err(not_finite("the centre of mass"));
    }
    if inertia.inertia.iter().any(|x| !x.is_finite()) {
        return Err(not_finite("the inertia"));
    }
    if inertia.mass < 0.0 {
        return Err(RobotError::NegativeMass { body: body.clone(), mass: inertia.mass });
    }
    let about_origin = inertia.inertia_about_origin();
    let sizes = [
        ("the mass", inertia.mass),
        ("the largest entry of the inertia", inertia.inertia.amax()),
        ("the largest entry of the inertia about the joint frame", about_origin.amax()),
    ];
    if let Some((what, value)) = sizes.into_iter().find(|(_, size)| *size != 0.0 && !RANGE.contains(size)) {
        return Err(RobotError::OutOfRange { body: body.clone(), what, value });
    }
    let moment = negative_moment(inertia);
    if moment < 0.0 && moment < -SLIGHTLY * inertia.principal_moments()[2] {
        return Err(RobotError::IndefiniteInertia { body: body.clone(), moment });
    }
    Ok(())
}

/// A body whose figures the caller gives: no principal moment is negative by more than rounding.
pub(super) fn rigid(body: &Body, inertia: &LinkInertia) -> Result<(), RobotError> {
    let moment = negative_moment(inertia);
    if moment < 0.0 { Err(RobotError::IndefiniteInertia { body: body.clone(), moment }) } else { Ok(()) }
}

/// The smallest principal moment where it is negative by more than rounding, else 0.
fn negative_moment(inertia: &LinkInertia) -> f64 {
    let [smallest, _, largest] = inertia.principal_moments();
    let rounding = (ROUNDING * largest.abs()).max(TINY_RADIUS_SQUARED * inertia.mass);
    if smallest < -rounding { smallest } else { 0.0 }
}

/// Whether the principal moments could be those of a rigid body; the warning if not, before M is tried.
pub(super) fn principal_moments(body: &Body, inertia: &LinkInertia) -> Option<Warning> {
    let moments @ [a, b, c] = inertia.principal_moments();
    let moment = negative_moment(inertia);
    if moment < 0.0 {
        let positive = Positivity::Untried;
        return Some(Warning::NegativeMoment { body: body.clone(), moment, positive });
    }
    let rounding = (ROUNDING * c).max(TINY_RADIUS_SQUARED * inertia.mass);
    (a + b < c - rounding).then(|| Warning::TriangleInequality { body: body.clone(), moments })
}

/// Gravity (m/s^2).
pub(super) fn gravity(gravity: &[f64; 3]) -> Result<(), RobotError> {
    if gravity.iter().all(|&g| is_moderate(g)) { Ok(()) } else { Err(RobotError::BadGravity) }
}

/// What one joint shows by itself.
pub(super) fn joint(spec: &JointSpec) -> Result<(), RobotError> {
    let name = || spec.name.clone();
    let length = spec.axis.norm();
    if !(length.is_finite() && length > 0.0) {
        return Err(RobotError::BadAxis { joint: name() });
    }
    if !spec.placement.is_rigid() {
        return Err(RobotError::BadPlacement { joint: name() });
    }
    inertia(&Body::link(spec.link_name()), &spec.inertia)?;
    figures(&spec.name, spec.armature, &spec.spring, &spec.friction, &spec.limits)
}

/// Armature, spring, friction and limits of one joint.
pub(super) fn figures(
    name: &str,
    armature: f64,
    spring: &Spring,
    friction: &Friction,
    limits: &Limits,
) -> Result<(), RobotError> {
    let in_range = |value: f64| value == 0.0 || RANGE.contains(&value);
    let not_negative = |what, value: f64| {
        (what, value, (0.0..=*RANGE.end()).contains(&value), "it must lie between 0 and 1e75")
    };
    let moderate = |what, value: f64| (what, value, is_moderate(value), "its size must be 1e75 at most");
    let number = |what, value: f64| (what, value, !value.is_nan(), "give a number");
    let transition = friction.coulomb_velocity;
    let checks = [
        ("the armature", armature, in_range(armature), "it must be 0, or lie between 1e-75 and 1e75"),
        not_negative("the viscous friction", friction.viscous),
        not_negative("the Coulomb friction", friction.coulomb),
        (
            "the Coulomb transition velocity",
            transition,
            RANGE.contains(&transition),
            "it must lie between 1e-75 and 1e75",
        ),
        moderate("the spring stiffness", spring.stiffness),
        moderate("the rest position of the spring", spring.rest),
        number("the lower limit", limits.lower),
        number("the upper limit", limits.upper),
        number("the velocity limit", limits.velocity),
        number("the effort limit", limits.effort),
        ("the lower limit", limits.lower, limits.lower <= limits.upper, "it must not exceed the upper limit"),
        ("the lower limit", limits.lower, limits.lower < f64::INFINITY, "it must be below infinity"),
        (
            "the upper limit",
            limits.upper,
            limits.upper > f64::NEG_INFINITY,
            "it must be above minus infinity",
        ),
        ("the velocity limit", limits.velocity, limits.velocity >= 0.0, "it must not be negative"),
        ("the effort limit", limits.effort, limits.effort >= 0.0, "it must not be negative"),
    ];
    match checks.into_iter().find(|(_, _, ok, _)| !ok) {
        Some((what, value, _, rule)) => Err(RobotError::BadValue { joint: name.into(), what, value, rule }),
        None => Ok(()),
    }
}

/// One warning about limits that look like degrees.
fn large_limits(joints: &[Joint]) -> Option<Warning> {
    let large = |joint: &Joint| {
        let limits = [joint.limits.lower, joint.limits.upper];
        let mut large = limits.into_iter().filter(|limit| (TWO_TURNS..=UNLIMITED).contains(&limit.abs()));
        large.next().filter(|_| joint.kind == JointKind::Revolute).map(|limit| (joint.name.clone(), limit))
    };
    let (joints, limits): (Vec<String>, Vec<f64>) = joints.iter().filter_map(large).unzip();
    limits.first().map(|&limit| Warning::LargeLimits { joints, limit })
}

/// Lengths or inertias that are probably those of millimetres.
fn millimetres(joints: &[Joint]) -> Option<Warning> {
    let mass: f64 = joints.iter().map(|joint| joint.inertia.mass).sum();
    let (mut length, mut farthest) = (0.0, "");
    let mut reaches: Vec<f64> = Vec::with_capacity(joints.len());
    for joint in joints {
        // Where the robot stands says nothing about its size.
        let reach = joint.parent.map_or(0.0, |parent| reaches[parent] + joint.placement.translation.norm());
        reaches.push(reach);
        let own = reach + joint.inertia.com.norm();
        if own > length {
            (length, farthest) = (own, &joint.link);
        }
    }
    let too_light = |length: f64, least: f64| mass > 0.0 && mass < least * length.powi(3);
    let warning = |inertias, length, link: &str| {
        Some(Warning::Millimetres { inertias, mass, length, link: link.to_owned() })
    };
    if length > FAR && too_light(length, LIGHTEST) {
        return warning(false, length, farthest);
    }
    let largest = |joint: &Joint| joint.inertia.inertia.diagonal().amax();
    let gyration = (joints.iter().map(largest).sum::<f64>() / mass).sqrt();
    let widest = joints.iter().max_by(|a, b| largest(a).total_cmp(&largest(b)))?;
    let is_wide = length > 0.0 && gyration > TOO_WIDE * length && too_light(gyration, LIGHTEST_TO_TURN);
    if is_wide { warning(true, gyration, &widest.link) } else { None }
}

/// Whether a joint moves a link that has mass or inertia.
fn moves_mass(joints: &[Joint]) -> Vec<bool> {
    let mut moves_mass: Vec<bool> = joints.iter().map(|joint| !joint.inertia.is_massless()).collect();
    for i in (0..joints.len()).rev() {
        if let Some(parent) = joints[i].parent {
            moves_mass[parent] |= moves_mass[i];
        }
    }
    moves_mass
}

/// Removes the warnings about links without mass whose joints move other links that have some, if M is
/// regular: such links are those between joints at one place, of a free base or a ball joint.
pub(super) fn pass_links_between(joints: &[Joint], armature: &Armature, warnings: &mut Vec<Warning>) {
    let moves_mass = moves_mass(joints);
    let is_between = |warning: &Warning| match warning {
        Warning::MasslessLink { link } => {
            joints.iter().zip(&moves_mass).any(|(joint, moves)| *moves && joint.link == *link)
        }
        _ => false,
    };
    if warnings.iter().any(is_between) && is_regular(joints, armature) {
        warnings.retain(|warning| !is_between(warning));
    }
}

/// What needs the whole tree: joints that move nothing, impossible inertias. Kinematics and inverse dynamics
/// are not concerned, and edits may mend it: these are warnings, and what inverts M fails.
pub(super) fn robot(joints: &[Joint], armature: &Armature, warnings: &mut Vec<Warning>) {
    let n = joints.len();
    let moves_mass = moves_mass(joints);
    let mut is_last = vec![true; n];
    warnings.extend(large_limits(joints));
    warnings.extend(millimetres(joints));
    joints.iter().filter_map(|joint| joint.parent).for_each(|parent| is_last[parent] = false);
    // Of independent joints: whether they, or joints that mimic them, move something; whether any mimics
    // them.
    let mut has_inertia: Vec<bool> = (0..n).map(|i| moves_mass[i] || armature.entry(i, i) != 0.0).collect();
    let mut is_mimicked = vec![false; n];
    for (i, mimic) in joints.iter().enumerate().filter_map(|(i, joint)| Some((i, joint.mimic?))) {
        has_inertia[mimic.joint] |= has_inertia[i];
        (is_mimicked[mimic.joint], is_mimicked[i]) = (true, true);
    }
    if let Some(first) = joints.first().filter(|_| !has_inertia.contains(&true)) {
        warnings.push(Warning::KinematicsOnly { joint: first.name.clone() });
        return;
    }
    for (i, joint) in joints.iter().enumerate() {
        let link = &joint.inertia;
        if joint.mimic.is_none() && !has_inertia[i] {
            warnings.push(Warning::MovesNothing { joint: joint.name.clone() });
            continue;
        }
        warnings.extend(principal_moments(&Body::link(&joint.link), link));
        let about_axis = joint.axis.dot(&(link.inertia_about_origin() * joint.axis));
        if is_last[i]
            && !is_mimicked[i]
            && joint.kind == JointKind::Revolute
            && armature.entry(i, i) == 0.0
            && about_axis.abs() <= 1e-14 * link.inertia_about_origin().amax()
        {
            warnings.push(Warning::OnAxis { joint: joint.name.clone() });
        }
    }
}

/// Says of M in all warnings about negative moments whether it is positive.
pub(super) fn try_mass_matrix(joints: &[Joint], armature: &Armature, warnings: &mut [Warning]) {
    let mut negative = warnings.iter_mut().filter_map(Warning::positivity_mut).peekable();
    if negative.peek().is_some() {
        let found = positivity(joints, armature);
        negative.for_each(|positive| *positive = found);
    }
}
