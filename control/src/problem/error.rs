//! Errors of a problem.

use crate::problem::continuation_cause::ContinuationCause;
use crate::problem::key::Key;
use crate::problem::rounded::rounded;
use crate::problem::task_error::TaskError;
use crate::problem::torque_speed_error::TorqueSpeedError;
use crate::problem::via_error::ViaError;
use costate::EvalError;
use costate::codegen::CodegenError;
use costate::robot::{printable, printable_number as number};
use std::fmt;

/// Why a problem was refused. Prints as field and reason; [`key`](Self::key) and [`reason`](Self::reason)
/// give each.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum ProblemError {
    /// A list of the wrong length.
    WrongLength {
        /// The field.
        key: Key,
        /// Number of joints.
        expected: usize,
        /// Length found.
        found: usize,
    },
    /// An infinite or undefined entry.
    NotFinite {
        /// The field.
        key: Key,
        /// The joint.
        joint: String,
    },
    /// An undefined limit.
    NotANumber {
        /// The field.
        key: Key,
        /// The joint.
        joint: String,
    },
    /// A joint that the robot does not have.
    UnknownJoint {
        /// The field.
        key: Key,
        /// Name or index that was given.
        joint: String,
        /// Names of joints that resemble it, or of all joints if none does.
        joints: Vec<String>,
        /// Number of joints.
        dof: usize,
    },
    /// A number that must be positive.
    NotPositive {
        /// The field.
        key: Key,
        /// Its value.
        value: f64,
    },
    /// A number that must not be negative.
    Negative {
        /// The field.
        key: Key,
        /// The joint, if the field is a list.
        joint: Option<String>,
        /// Its value.
        value: f64,
    },
    /// A free final time without a cost of time.
    FreeTimeWithoutCost,
    /// A free final time, and the robot rests at its end from the start on: nothing is to be done.
    NoWay,
    /// A control without effect.
    NoGain {
        /// The joint.
        joint: String,
    },
    /// Bounds with nothing between them.
    EmptyBounds {
        /// The joint.
        joint: String,
        /// Lower bound.
        u_min: f64,
        /// Upper bound.
        u_max: f64,
    },
    /// An empty range of positions.
    EmptyRange {
        /// The joint.
        joint: String,
        /// Lower limit.
        q_min: f64,
        /// Upper limit.
        q_max: f64,
    },
    /// A limit with no room for a motion.
    NoRoom {
        /// The field.
        key: Key,
        /// The joint, if the field is a list.
        joint: Option<String>,
        /// The limit.
        value: f64,
    },
    /// Limits with nothing between them, those of the robot included.
    EmptyLimits {
        /// The field.
        key: Key,
        /// The joint.
        joint: String,
        /// Lower limit.
        low: f64,
        /// Upper limit.
        high: f64,
    },
    /// A start or an end outside of the limits.
    OutsideLimits {
        /// The field.
        key: Key,
        /// The joint.
        joint: String,
        /// Position or rate.
        value: f64,
        /// Lower limit.
        low: f64,
        /// Upper limit.
        high: f64,
    },
    /// Positions, rates and accelerations of an end that need more torque or power than there is.
    BeyondLimit {
        /// The accelerations.
        key: Key,
        /// The joint; none for all together.
        joint: Option<String>,
        /// "torque" or "power".
        quantity: &'static str,
        /// What they need (N m, N or W).
        value: f64,
        /// The limit, that of a motor at this rate.
        limit: f64,
    },
    /// Hard limits with a method that does not keep them.
    LimitsNeedDirect,
    /// A part of the [`Task`](crate::Task).
    Task {
        /// The field.
        key: Key,
        /// What is wrong.
        cause: TaskError,
    },
    /// A task with a method that does not take it.
    TaskNeedsDirect {
        /// Its first part.
        key: Key,
    },
    /// A [`Via`](crate::Via).
    Via {
        /// The field.
        key: Key,
        /// What is wrong.
        cause: ViaError,
    },
    /// Vias, or an end that follows the start, with a method that does not take them.
    PhasesNeedDirect {
        /// The first of them.
        key: Key,
    },
    /// Torque-speed limits of motors.
    TorqueSpeed {
        /// The field.
        key: Key,
        /// What is wrong.
        cause: TorqueSpeedError,
    },
    /// A cost of energy with a method that does not take it.
    EnergyNeedsDirect,
    /// A cost of jerks or of rates of torques, or a given acceleration, with a method that does not take it.
    RatesNeedDirect {
        /// The field.
        key: Key,
    },
    /// Jerks, rates of torques, given accelerations, vias or an end that follows the start, which
    /// [`Resolve`](crate::Resolve) does not take.
    NotAgain {
        /// The field.
        key: Key,
    },
    /// A control that costs nothing and is not bounded on both sides.
    UnboundedEffort {
        /// The joint.
        joint: String,
    },
    /// A fixed time, and nothing that costs anything.
    NothingToMinimise,
    /// An option out of range.
    BadOption {
        /// The field of [`SolverOptions`](crate::SolverOptions).
        key: &'static str,
        /// Its value.
        value: f64,
        /// The valid range.
        remedy: &'static str,
    },
    /// A continuation in a parameter that the problem does not have, or to an invalid value.
    Continuation {
        /// Name of the parameter.
        parameter: &'static str,
        /// The value.
        value: f64,
        /// The cause and its remedy.
        cause: ContinuationCause,
    },
}

impl ProblemError {
    /// The field at fault; `None` for a continuation.
    pub fn key(&self) -> Option<Key> {
        Some(match *self {
            Self::WrongLength { key, .. }
            | Self::NotFinite { key, .. }
            | Self::NotANumber { key, .. }
            | Self::UnknownJoint { key, .. }
            | Self::NotPositive { key, .. }
            | Self::Negative { key, .. }
            | Self::NoRoom { key, .. }
            | Self::EmptyLimits { key, .. }
            | Self::OutsideLimits { key, .. }
            | Self::BeyondLimit { key, .. }
            | Self::Task { key, .. }
            | Self::Via { key, .. }
            | Self::PhasesNeedDirect { key }
            | Self::TorqueSpeed { key, .. }
            | Self::RatesNeedDirect { key }
            | Self::NotAgain { key }
            | Self::TaskNeedsDirect { key } => key,
            Self::LimitsNeedDirect => Key::solver("method"),
            Self::EnergyNeedsDirect => Key::ENERGY,
            Self::FreeTimeWithoutCost | Self::NoWay => Key::FREE_TIME,
            Self::NoGain { .. } => Key::GAIN,
            Self::EmptyBounds { .. } => Key::U_MIN,
            Self::EmptyRange { .. } => Key::Q_MIN,
            Self::UnboundedEffort { .. } | Self::NothingToMinimise => Key::EFFORT,
            Self::BadOption { key, .. } => Key::solver(key),
            Self::Continuation { .. } => return None,
        })
    }

    /// The reason and the remedy, without the field.
    pub fn reason(&self) -> String {
        match self {
            Self::WrongLength { expected, found, .. } => {
                let (found, joints) = (count(*found, "entry", "entries"), count(*expected, "joint", "joints"));
                format!("has {found}, the robot has {joints}: give one entry for each joint")
            }
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
            Self::NotPositive { value, .. } => format!("must be positive and finite, but is {}", number(*value)),
            Self::Negative { joint, value, .. } => {
                let entry =
                    joint.as_ref().map_or_else(String::new, |joint| format!("the entry of joint '{joint}' ", joint = printable(joint)));
                format!("{entry}must be neither negative nor infinite, but is {}", number(*value))
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
                "{} of joint '{joint}' lies outside of its limits, {} and {}; move it, widen the limits, or set \
                 limits.from_robot = false if they are those of the robot", number(*value), number(*low), number(*high),
                joint = printable(joint)),
            Self::BeyondLimit { joint, quantity, value, limit, .. } => format!(
                "with the positions and rates that are given there {} need a {quantity} of {}, beyond the limit \
                 {}; change the accelerations or leave some of them free, or widen the limit",
                joint.as_ref().map_or_else(
                    || "all joints".into(), |joint| format!("those of joint '{joint}'", joint = printable(joint))),
                rounded(*value), rounded(*limit)),
            Self::LimitsNeedDirect => "hard limits are kept by method = \"direct\" only; choose it, or remove [limits]".into(),
            Self::Task { cause, .. } => cause.to_string(),
            Self::TaskNeedsDirect { .. } => "tools and obstacles are taken by method = \"direct\" only; choose it, or remove them".into(),
            Self::Via { cause, .. } => cause.to_string(),
            Self::PhasesNeedDirect { .. } => {
                "vias and periodic motions are taken by method = \"direct\" only; choose it, or remove them".into()
            }
            Self::TorqueSpeed { cause, .. } => cause.to_string(),
            Self::EnergyNeedsDirect => "a cost of energy is taken by method = \"direct\" only; choose it, or remove the cost".into(),
            Self::RatesNeedDirect { .. } => "this is taken by method = \"direct\" only; choose it, or remove it".into(),
            Self::NotAgain { .. } => "Resolve does not take this; solve the problem with Solver, or remove it".into(),
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
            Self::Task { cause, .. } => Some(cause),
            Self::Via { cause, .. } => Some(cause),
            Self::TorqueSpeed { cause, .. } => Some(cause),
            _ => None,
        }
    }
}

/// The first names of joints, and how many more there are.
pub(crate) fn listed(joints: &[String]) -> String {
    const MOST: usize = 12;
    let shown: Vec<_> = joints.iter().take(MOST).map(|joint| printable(joint).to_string()).collect();
    let more = joints.len().saturating_sub(MOST);
    shown.join(", ") + &if more > 0 { format!(" and {more} more") } else { String::new() }
}

/// "1 joint", "2 joints".
fn count(amount: usize, one: &str, more: &str) -> String {
    format!("{amount} {}", if amount == 1 { one } else { more })
}

/// Why the equations of a problem were not recorded, or not replaced by generated code.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SourceError {
    /// The problem is not valid.
    #[error(transparent)]
    Problem(#[from] ProblemError),
    /// The equations cannot be recorded.
    #[error(transparent)]
    Codegen(#[from] CodegenError),
    /// The dynamics cannot be evaluated at the start or the end.
    #[error(transparent)]
    Eval(#[from] EvalError),
}
