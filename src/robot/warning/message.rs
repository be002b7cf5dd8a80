//! What warnings say.

use super::{Positivity, Warning};
use crate::robot::printable::{joints, printable, printable_number, sentence};
use std::fmt;

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::MasslessLink { link } => {
                write!(f, "link '{}' moves but has neither mass nor inertia", printable(link))
            }
            Self::NegativeMoment { body, moment, positive } => write!(
                f,
                "the inertia of {body} about its centre of mass has the negative principal moment {} kg m^2; {}",
                printable_number(*moment),
                match positive {
                    Positivity::WhereTried =>
                        "M is positive where it was tried, and may be singular elsewhere: check the matrix",
                    Positivity::Violated =>
                        "M is not positive everywhere, and forward dynamics fails there: check signs and \
                         reference point of the matrix, give the joint armature or lock it",
                    Positivity::Untried => "M may not be positive: check the matrix",
                }
            ),
            Self::KinematicsOnly { joint } => write!(
                f,
                "joint '{}' moves no mass, nor does any other joint: there is kinematics only; for dynamics, give \
                 the links mass and inertia (<inertial> in a URDF)",
                printable(joint)
            ),
            Self::TriangleInequality { body, moments: [a, b, c] } => write!(
                f,
                "no rigid body has the principal moments of {body}, ({a:.4e}, {b:.4e}, {c:.4e}) kg m^2: \
                 the largest exceeds the sum of the others"
            ),
            Self::MovesNothing { joint } => write!(
                f,
                "joint '{}' moves no mass at all, so the mass matrix is singular in every pose: give its links a \
                 mass, give it armature (rotor inertia), lock it, or make it fixed",
                printable(joint)
            ),
            Self::OnAxis { joint } => write!(
                f,
                "all mass that joint '{}' moves lies on its axis, so the mass matrix is singular in every pose: \
                 give its link an inertia or give it armature",
                printable(joint)
            ),
            Self::UnknownName { name, owner, line, others, nearest } => {
                write!(f, "{} in {} (line {line}", sentence(name), sentence(owner))?;
                match others {
                    0 => write!(f, ")")?,
                    _ => write!(f, ", and {others} more)")?,
                }
                let is = if name.contains(", ") {
                    "are unknown to URDF and were"
                } else {
                    "is unknown to URDF and was"
                };
                write!(f, " {is} ignored")?;
                match nearest {
                    Some(known) if name.starts_with('<') => write!(f, "; did you mean <{known}>?"),
                    Some(known) => write!(f, "; did you mean {known}?"),
                    None => Ok(()),
                }
            }
            Self::MoreUnknownNames { count, line } => {
                write!(f, "{count} more elements or attributes are unknown to URDF (first in line {line})")
            }
            Self::WithoutLimit { joints: names, line } => write!(
                f,
                "no <limit> (first in line {line}), taken as unlimited: {}; add it, or make a revolute joint \
                 continuous",
                joints(names)
            ),
            Self::SwappedLimits { joints: names, line } => write!(
                f,
                "<limit> with lower above upper (first in line {line}), taken as no limit of position: {}; \
                 swap the two",
                joints(names)
            ),
            Self::NegativeLimit { joints: names, line } => write!(
                f,
                "<limit> with a negative effort or velocity (first in line {line}), taken as unlimited: {}; \
                 give a positive number",
                joints(names)
            ),
            Self::FixedBase { link, mass, line } => write!(
                f,
                "the root link '{}' (line {line}) has a mass of {} kg, which is not used: the base is held fixed; \
                 for a free base request it by --floating-base (LoadOptions::floating_base), or attach it to a \
                 massless root link by a floating joint",
                printable(link),
                printable_number(*mass)
            ),
            Self::MimicLimits { joint, master } => write!(
                f,
                "no position of joint '{}' is within its limits and those of '{}', which mimics it; the latter \
                 are not used: correct one of them",
                printable(master),
                printable(joint)
            ),
            Self::IdleWrench { frame } => write!(
                f,
                "no joint moves frame '{}', and a wrench there has no effect: name a frame beyond a joint",
                printable(frame)
            ),
            Self::EmptyPayload { frame } => write!(
                f,
                "the payload of frame '{}' has neither mass nor inertia, and no effect: give it a mass",
                printable(frame)
            ),
            Self::LockedOutside { joint, value, limits: [lower, upper] } => write!(
                f,
                "joint '{}' is locked at {}, outside its limits {} and {}",
                printable(joint),
                printable_number(*value),
                printable_number(*lower),
                printable_number(*upper)
            ),
            Self::Millimetres { inertias: false, mass, length, link } => write!(
                f,
                "link '{}' reaches {} m from the first joint, with a moving mass of {} kg: as a rod a thousand times \
                 as long as thick, the robot would be lighter than foam; lengths are in m, are these in mm?",
                printable(link),
                printable_number(rounded(*length)),
                printable_number(rounded(*mass))
            ),
            Self::Millimetres { inertias: true, mass, length, link } => write!(
                f,
                "the inertias are those of a body with a radius of gyration of {} m, that of link '{}' the largest, \
                 with a moving mass of {} kg and much shorter links; inertias are in kg m^2, are these in kg mm^2?",
                printable_number(rounded(*length)),
                printable(link),
                printable_number(rounded(*mass))
            ),
            Self::LargeLimits { joints: names, limit } => write!(
                f,
                "position limits beyond two turns (the first is {} rad): {}; are they degrees? Limits are in rad",
                printable_number(*limit),
                joints(names)
            ),
            Self::FrictionIgnored { joints: names } => write!(
                f,
                "<dynamics> was not loaded, request it by --friction (LoadOptions::friction): {}",
                joints(names)
            ),
            Self::Expanded { joint, kind: "floating" } => write!(
                f,
                "floating joint '{}' became three prismatic (x, y, z) and three revolute joints (z, y, x), \
                 singular where the second angle is +-pi/2; for its quaternion, which is nowhere singular, request it \
                 by --quaternions (LoadOptions::quaternions)",
                printable(joint)
            ),
            Self::Expanded { joint, kind } => {
                write!(f, "{kind} joint '{}' became two prismatic and one revolute joint", printable(joint))
            }
            Self::Note { text } => sentence(text).fmt(f),
        }
    }
}

/// Three digits.
fn rounded(value: f64) -> f64 {
    format!("{value:.2e}").parse().unwrap_or(value)
}
