//! What can be wrong with a problem.

use costate::EvalError;
use costate::codegen::CodegenError;

/// Why a problem was refused; names the key of the problem file and the joint.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ProblemError {
    /// A list of the wrong length.
    #[error("{key} has {found} entries, the robot has {expected} joints: give one for each")]
    WrongLength {
        /// The key.
        key: &'static str,
        /// Number of joints.
        expected: usize,
        /// Length found.
        found: usize,
    },
    /// An entry that is infinite or undefined.
    #[error("{key}: the entry of joint '{joint}' is not finite")]
    NotFinite {
        /// The key.
        key: &'static str,
        /// The joint.
        joint: String,
    },
    /// A limit that is undefined.
    #[error("{key}: the entry of joint '{joint}' is not a number; give one, or inf or -inf for no limit")]
    NotANumber {
        /// The key.
        key: &'static str,
        /// The joint.
        joint: String,
    },
    /// A joint that the robot does not have.
    #[error("{key} names joint {joint}, but the joints are numbered from 0 to {last}", last = n - 1)]
    UnknownJoint {
        /// The key.
        key: &'static str,
        /// The number given.
        joint: usize,
        /// Number of joints.
        n: usize,
    },
    /// A number that must be positive.
    #[error("{key} = {value} must be positive and finite")]
    NotPositive {
        /// The key.
        key: &'static str,
        /// Its value.
        value: f64,
    },
    /// A number that must not be negative.
    #[error("{key}{of} = {value} must not be negative, nor infinite", of = of_joint(.joint))]
    Negative {
        /// The key.
        key: &'static str,
        /// The joint, where it is a list.
        joint: Option<String>,
        /// Its value.
        value: f64,
    },
    /// A free final time that costs nothing.
    #[error("time.free needs cost.time > 0: without a price of time the best motion takes for ever")]
    FreeTimeWithoutCost,
    /// A control that does nothing.
    #[error("actuation.gain of joint '{joint}' is zero: its control would do nothing")]
    NoGain {
        /// The joint.
        joint: String,
    },
    /// Bounds that leave nothing between them.
    #[error("bounds.u_min = {u_min} of joint '{joint}' must be less than bounds.u_max = {u_max}")]
    EmptyBounds {
        /// The joint.
        joint: String,
        /// Lower bound.
        u_min: f64,
        /// Upper bound.
        u_max: f64,
    },
    /// A range of positions that leaves nothing.
    #[error("penalty.q_min = {q_min} of joint '{joint}' must be less than penalty.q_max = {q_max}")]
    EmptyRange {
        /// The joint.
        joint: String,
        /// Lower limit.
        q_min: f64,
        /// Upper limit.
        q_max: f64,
    },
    /// A control that costs nothing and is not bounded on both sides.
    #[error(
        "cost.effort of joint '{joint}' is zero and it is not bounded on both sides: give it a weight, or finite \
         bounds.u_min and bounds.u_max"
    )]
    UnboundedEffort {
        /// The joint.
        joint: String,
    },
    /// A fixed time and no effort.
    #[error(
        "cost.effort is zero for all joints and time.final is fixed: nothing is left to minimise; give efforts, or free the time"
    )]
    NothingToMinimise,
    /// An option out of range.
    #[error("solver.{key} = {value}: {remedy}")]
    BadOption {
        /// The key.
        key: &'static str,
        /// Its value.
        value: f64,
        /// What it must be.
        remedy: &'static str,
    },
    /// A continuation in a parameter that the problem does not have, or to a value that it must not have.
    #[error("continuation to {parameter} = {value}: {reason}")]
    Continuation {
        /// Name of the parameter.
        parameter: &'static str,
        /// The value.
        value: f64,
        /// What is wrong with it, and what to do.
        reason: String,
    },
    /// A saved solution of another robot.
    #[error("start_from.file holds a motion of {found} joints, the robot has {expected}")]
    OtherRobot {
        /// Number of joints.
        expected: usize,
        /// Number of joints in the file.
        found: usize,
    },
}

/// Why the equations of a problem were not recorded, or not taken from generated code.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SourceError {
    /// The problem cannot be posed.
    #[error(transparent)]
    Problem(#[from] ProblemError),
    /// The equations cannot be recorded.
    #[error(transparent)]
    Codegen(#[from] CodegenError),
    /// The robot cannot stand at the start or the end.
    #[error(transparent)]
    Eval(#[from] EvalError),
}

fn of_joint(joint: &Option<String>) -> String {
    joint.as_ref().map_or_else(String::new, |joint| format!(" of joint '{joint}'"))
}
