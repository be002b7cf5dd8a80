//! Errors of a problem in words, and what caused them.

use crate::problem::continuation_cause::ContinuationCause;
use crate::problem::error::ProblemError;
use crate::problem::key::Key;
use crate::problem::rounded::rounded;
use costate::robot::{printable, printable_number as number};
use std::fmt;

impl ProblemError {
    /// The reason and the remedy, without the field.
    pub fn reason(&self) -> String {
        match self {
            Self::WrongLength { expected, found, .. } => {
                let (found, joints) = (count(*found, "entry", "entries"), count(*expected, "joint", "joints"));
                format!("has {found}, the robot has {joints}: give one entry for each joint")
            }
            Self::WrongPositions { expected, found, .. } => format!(
                "has {}, and the robot {expected} positions: give (x, y, z, qx, qy, qz, qw) for each floating joint, \
                 (qx, qy, qz, qw) for each spherical one, and one for every other joint",
                count(*found, "entry", "entries")),
            Self::NotFinite { joint, .. } => {
                format!("the entry of joint '{}' is not finite; give a finite number", printable(joint))
            }
            Self::NotANumber { joint, .. } => {
                format!("the entry of joint '{joint}' is not a number; give one, or inf or -inf for no limit", joint = printable(joint))
            }
            Self::UnknownJoint { joint, joints, dof, .. } => {
                let (joint, last) = (printable(joint), dof.saturating_sub(1));
                let offered = match joints.len() < *dof {
                    true => format!("did you mean {}? Joints can also be given", joints.iter().map(|name| format!("'{}'", printable(name))).collect::<Vec<_>>().join(" or ")),
                    false => format!("the joints are {}, or", listed(joints)),
                };
                format!("there is no joint {joint}; {offered} by index 0 to {last}")
            }
            Self::GivenTwice { joint, .. } => format!("joint '{}' is listed twice; list it once", printable(joint)),
            Self::NotPositive { value, .. } => format!("must be positive and finite, but is {}", number(*value)),
            Self::Negative { key, joint, value } => {
                let entry =
                    joint.as_ref().map_or_else(String::new, |joint| format!("the entry of joint '{joint}' ", joint = printable(joint)));
                match key {
                    // Infinite is no limit.
                    &Key::V_MAX => format!("{entry}must not be negative, but is {}; inf is no limit", number(*value)),
                    _ => format!("{entry}must be neither negative nor infinite, but is {}", number(*value)),
                }
            }
            Self::FreeTimeWithoutCost => {
                "a free final time needs cost.time > 0 or [[cost.tool]] (in Rust also a term of the running cost): \
                 otherwise the slowest motion is the cheapest"
                    .into()
            }
            Self::NoWay => {
                "the robot rests at its end from the start on, so the cheapest motion takes no time; move start.q or \
                 end.q, give time.final, or add [[via]]"
                    .into()
            }
            Self::NoGain { joint } => format!("the gain of joint '{joint}' is zero: its control would have no effect", joint = printable(joint)),
            Self::EmptyBounds { joint, u_min, u_max } if *u_max == f64::NEG_INFINITY || *u_min == f64::INFINITY => {
                let (side, none) = if *u_min == f64::INFINITY { ("lower", "-inf") } else { ("upper", "inf") };
                let found = if *u_min == f64::INFINITY { u_min } else { u_max };
                format!("the {side} bound {} of joint '{joint}' leaves it no control; {none} is no bound", number(*found), joint = printable(joint))
            }
            Self::EmptyBounds { joint, u_min, u_max } => {
                format!("the lower bound {} of joint '{joint}' must be less than bounds.u_max = {}", number(*u_min), number(*u_max), joint = printable(joint))
            }
            Self::EmptyRange { joint, q_min, q_max } => {
                format!("the lower limit {} of joint '{joint}' must be less than penalty.q_max = {}", number(*q_min), number(*q_max), joint = printable(joint))
            }
            Self::NoRoom { key, joint, value } => {
                let whose = joint.as_ref().map_or_else(String::new, |joint| format!(" of joint '{}'", printable(joint)));
                let zero = if *key == Key::LIMIT_TORQUE_MAX { ", or 0 for a joint without a motor" } else { "" };
                format!("the limit {}{whose} must be positive{zero}; inf is no limit", number(*value))
            }
            Self::EmptyLimits { key, joint, low, high } if *key == Key::LIMIT_TORQUE_MAX && *low == *high && *low == 0.0 => format!(
                "the robot file limits the effort of joint '{joint}' to 0, so nothing drives it; give its effort in \
                 robot.limits, or, if it has no motor, an entry 0 here",
                joint = printable(joint)),
            Self::EmptyLimits { joint, low, high, .. } => format!(
                "joint '{joint}' has no room between {} and {}, the limits of the robot included", number(*low), number(*high),
                joint = printable(joint)),
            Self::OutsideLimits { joint, value, low, high, .. } => format!(
                "{} of joint '{joint}' lies outside of its limits, {} and {}; {}move it, widen the limits, or set \
                 limits.from_robot = false if they come from the file of the robot", number(*value), number(*low), number(*high),
                // No angle of a joint is that large.
                if value.abs() >= 10.0 { "angles are in rad; " } else { "" },
                joint = printable(joint)),
            Self::BeyondLimit { joint, quantity, value, limit, .. } => format!(
                "with the positions and rates that are given there {} need a {quantity} of {}, beyond the limit \
                 {}; change the accelerations or leave some of them free, or widen the limit",
                joint.as_ref().map_or_else(
                    || "all joints".into(), |joint| format!("those of joint '{joint}'", joint = printable(joint))),
                rounded(*value), rounded(*limit)),
            Self::End { cause, .. } => cause.to_string(),
            Self::NoMass { joint } => format!(
                "joint '{}' moves neither mass nor inertia, so that no torque determines its motion; give its links \
                 mass and inertia, give it robot.armature, or lock it",
                printable(joint)),
            Self::LimitsNeedDirect => "hard limits are kept by method = \"direct\" only; choose it, or remove [limits]".into(),
            Self::Task { cause, .. } => cause.to_string(),
            Self::FreeJoint { joint, kind } => format!(
                "joint '{}' is {kind}, its orientation a quaternion: method = \"direct\" alone moves such robots, without \
                 feedback and solving again; choose it, or describe the joint as a chain of joints",
                printable(joint)
            ),
            Self::Constrained { constraint } => format!(
                "the robot has the constraint '{}', which this would ignore: method = \"direct\" alone moves robots with \
                 constraints, without feedback and solving again; remove it to move the open tree",
                printable(constraint)
            ),
            Self::Loop { cause } => cause.to_string(),
            Self::Gait { cause, .. } => cause.to_string(),
            Self::Free { cause } => cause.to_string(),
            Self::TaskNeedsDirect { .. } => "tools and obstacles are taken by method = \"direct\" only; choose it, or remove them".into(),
            Self::Via { cause, .. } => cause.to_string(),
            Self::PhasesNeedDirect { .. } => {
                "vias and periodic motions are taken by method = \"direct\" only; choose it, or remove them".into()
            }
            Self::TorqueSpeed { cause, .. } => cause.to_string(),
            Self::EnergyNeedsDirect => "a cost of energy is taken by method = \"direct\" only; choose it, or remove the cost".into(),
            Self::RatesNeedDirect { .. } => "this is taken by method = \"direct\" only; choose it, or remove it".into(),
            Self::UnboundedEffort { joint } => format!(
                "the weight of joint '{joint}' is zero and its control is not bounded on both sides: give it a weight, \
                 finite bounds.u_min and bounds.u_max, or, with method = \"direct\", an entry of limits.torque_max",
                joint = printable(joint)),
            Self::NothingToMinimise => {
                "zero for all joints, and the final time is fixed: nothing is left to minimise; give weights, or free \
                 the time"
                    .into()
            }
            Self::BadOption { value, remedy, .. } => format!("{remedy}, but is {}", number(*value)),
            Self::Continuation { parameter, value, cause } => {
                format!("continuation to {parameter} = {}: {cause}", number(*value))
            }
        }
    }
}

impl fmt::Display for ProblemError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(key) = self.key() {
            match self {
                // A task has lists: their entries are counted from 0, as in Rust.
                Self::Task { .. } if key.table() != "via" => {
                    write!(f, "task: {}[{}].{}: ", key.table(), key.number(), key.name())?;
                }
                _ if key.table() == "via" => write!(f, "vias[{}].{}: ", key.number(), key.name())?,
                _ => write!(f, "{}: ", key.field())?,
            }
        }
        f.write_str(&self.reason())
    }
}

impl std::error::Error for ProblemError {
    /// The error of the robot that a continuation leads to.
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Continuation { cause: ContinuationCause::Robot(error), .. } => Some(&**error),
            Self::End { cause, .. } => Some(cause),
            Self::Loop { cause } => Some(cause),
            Self::Gait { cause, .. } => Some(&**cause),
            Self::Free { cause } => Some(cause),
            Self::Task { cause, .. } => Some(cause),
            Self::Via { cause, .. } => Some(cause),
            Self::TorqueSpeed { cause, .. } => Some(cause),
            _ => None,
        }
    }
}

/// The first names of joints, and how many more there are.
fn listed(joints: &[String]) -> String {
    const MOST: usize = 12;
    let shown: Vec<_> = joints.iter().take(MOST).map(|joint| printable(joint).to_string()).collect();
    let more = joints.len().saturating_sub(MOST);
    shown.join(", ") + &if more > 0 { format!(" and {more} more") } else { String::new() }
}

/// "1 joint", "2 joints".
fn count(amount: usize, one: &str, more: &str) -> String {
    format!("{amount} {}", if amount == 1 { one } else { more })
}
