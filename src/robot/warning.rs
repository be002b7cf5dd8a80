//! What is unusual about the description of a robot.

use super::printable::{joints, printable, printable_number, sentence};
use std::fmt;

/// Something unusual that does not stop the computation.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Warning {
    /// A moving link that has neither mass nor inertia.
    MasslessLink {
        /// The link.
        link: String,
    },
    /// Principal moments that no rigid body has.
    TriangleInequality {
        /// The link.
        link: String,
        /// Principal moments (kg m^2), rising.
        moments: [f64; 3],
    },
    /// A negative principal moment of a link; the mass matrix was positive wherever it was tried.
    NegativeMoment {
        /// The link.
        link: String,
        /// The moment (kg m^2).
        moment: f64,
    },
    /// A joint that moves no mass and has no armature: M is singular in every pose. Kinematics and inverse
    /// dynamics are not concerned; the other derivatives need the joint locked, or with armature or a
    /// payload.
    MovesNothing {
        /// The joint.
        joint: String,
    },
    /// All mass that the last joint moves lies on its axis: M is singular in every pose.
    OnAxis {
        /// The joint.
        joint: String,
    },
    /// An element or attribute that URDF does not know, and that is therefore ignored.
    UnknownName {
        /// The element, such as `<orign>`, or the attribute, such as `xzy`.
        name: String,
        /// Where it is, such as `joint 'elbow'` or `<origin> of joint 'elbow'`.
        owner: String,
        /// Line of the first one, from 1.
        line: usize,
        /// How many more there are in elements of the same kind.
        others: usize,
        /// The known name that it resembles.
        nearest: Option<&'static str>,
    },
    /// More elements and attributes that URDF does not know.
    MoreUnknownNames {
        /// How many.
        count: usize,
        /// Line of the first one, from 1.
        line: usize,
    },
    /// Revolute or prismatic joints of a URDF without `<limit>`; they are unlimited.
    WithoutLimit {
        /// The joints.
        joints: Vec<String>,
        /// Line of the first one, from 1.
        line: usize,
    },
    /// Joints of a URDF whose lower limit lies above the upper one; their positions are unlimited.
    SwappedLimits {
        /// The joints.
        joints: Vec<String>,
        /// Line of the first `<limit>`, from 1.
        line: usize,
    },
    /// Joints of a URDF with a negative limit of effort or velocity, which is taken as no limit.
    NegativeLimit {
        /// The joints.
        joints: Vec<String>,
        /// Line of the first `<limit>`, from 1.
        line: usize,
    },
    /// The root link of a URDF has mass, which is not used since the base is held fixed.
    FixedBase {
        /// The root link.
        link: String,
        /// Its mass (kg).
        mass: f64,
        /// Its line, from 1.
        line: usize,
    },
    /// No position of a joint is within both its limits and those of a joint that mimics it, which are
    /// ignored.
    MimicLimits {
        /// The joint that mimics.
        joint: String,
        /// The independent joint.
        master: String,
    },
    /// A joint is locked outside its limits.
    LockedOutside {
        /// The joint.
        joint: String,
        /// Its position (rad, m).
        value: f64,
        /// Its limits (rad, m).
        limits: [f64; 2],
    },
    /// Limits of revolute joints beyond two turns: they may be degrees.
    LargeLimits {
        /// The joints.
        joints: Vec<String>,
        /// The limit of the first one (rad).
        limit: f64,
    },
    /// Damping and friction in `<dynamics>` of a URDF that were not loaded.
    FrictionIgnored {
        /// The joints.
        joints: Vec<String>,
    },
    /// A joint of several degrees of freedom, replaced by joints of one degree of freedom each.
    Expanded {
        /// The joint.
        joint: String,
        /// `"floating"` or `"planar"`.
        kind: &'static str,
    },
    /// Anything else worth saying about the file.
    Note {
        /// The whole sentence.
        text: String,
    },
}

impl Warning {
    /// Whether it suggests a mistake in the file; strict loading refuses these.
    pub fn is_refused_when_strict(&self) -> bool {
        !matches!(self, Self::FrictionIgnored { .. } | Self::Expanded { .. } | Self::Note { .. })
    }

    /// What is left of it for the joints that a robot has: lists of joints without others; `None` for
    /// nothing.
    pub(super) fn about(self, is_joint: impl Fn(&str) -> bool) -> Option<Self> {
        match self {
            Self::MimicLimits { ref joint, ref master } => {
                (is_joint(joint) && is_joint(master)).then_some(self)
            }
            mut warning => {
                let Some(joints) = warning.joints_mut() else { return Some(warning) };
                joints.retain(|joint| is_joint(joint));
                let some = !joints.is_empty();
                some.then_some(warning)
            }
        }
    }

    /// What is left of it where the limits of a joint are given anew; `None` for nothing.
    pub(super) fn without_limits_of(self, name: &str) -> Option<Self> {
        match self {
            Self::FrictionIgnored { .. } => Some(self),
            Self::MimicLimits { ref master, .. } if master == name => None,
            warning => warning.about(|joint| joint != name),
        }
    }

    /// The joints of a warning about several.
    fn joints_mut(&mut self) -> Option<&mut Vec<String>> {
        match self {
            Self::WithoutLimit { joints, .. }
            | Self::SwappedLimits { joints, .. }
            | Self::NegativeLimit { joints, .. }
            | Self::LargeLimits { joints, .. }
            | Self::FrictionIgnored { joints } => Some(joints),
            _ => None,
        }
    }

    /// The line of the file that it is about, from 1, where one is known.
    pub fn line(&self) -> Option<usize> {
        match self {
            Self::UnknownName { line, .. }
            | Self::MoreUnknownNames { line, .. }
            | Self::WithoutLimit { line, .. }
            | Self::SwappedLimits { line, .. }
            | Self::NegativeLimit { line, .. }
            | Self::FixedBase { line, .. } => Some(*line),
            _ => None,
        }
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::MasslessLink { link } => {
                write!(f, "link '{}' moves but has neither mass nor inertia", printable(link))
            }
            Self::NegativeMoment { link, moment } => write!(
                f,
                "the inertia of link '{}' about its centre of mass has the negative principal moment {} kg m^2; \
                 M is positive where it was tried, and may be singular elsewhere: check the matrix",
                printable(link),
                printable_number(*moment)
            ),
            Self::TriangleInequality { link, moments: [a, b, c] } => write!(
                f,
                "no rigid body has the principal moments of link '{}', ({a:.4e}, {b:.4e}, {c:.4e}) kg m^2: \
                 the largest exceeds the sum of the others",
                printable(link)
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
                write!(f, " is unknown to URDF and was ignored")?;
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
                 for a free base, attach it to a massless root link by a floating joint",
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
            Self::LockedOutside { joint, value, limits: [lower, upper] } => write!(
                f,
                "joint '{}' is locked at {}, outside its limits {} and {}",
                printable(joint),
                printable_number(*value),
                printable_number(*lower),
                printable_number(*upper)
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
                 singular where the second angle is +-pi/2",
                printable(joint)
            ),
            Self::Expanded { joint, kind } => {
                write!(f, "{kind} joint '{}' became two prismatic and one revolute joint", printable(joint))
            }
            Self::Note { text } => sentence(text).fmt(f),
        }
    }
}
