//! What is wrong with a new start, end or goal.

use crate::problem::TaskError;
use costate::EvalError;

/// Why a new start, end or goal was refused, or what is asked of a motion.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ResolveError {
    /// There is no motion yet.
    #[error("nothing is solved yet; call solve first")]
    NotSolved,
    /// A time that is no number.
    #[error("the time of the motion is NaN; give seconds since its start")]
    NotATime,
    /// The dynamics cannot be evaluated there.
    #[error(transparent)]
    Evaluation(#[from] EvalError),
    /// Not one number for each joint, or each coordinate.
    #[error("{what}: {found} entries, not {expected}")]
    WrongLength {
        /// What it is.
        what: &'static str,
        /// Entries that are needed.
        expected: usize,
        /// Entries that were given.
        found: usize,
    },
    /// A number that is not finite.
    #[error("{what}: entry {entry} is not finite")]
    NotFinite {
        /// What it is.
        what: &'static str,
        /// The entry, from 0.
        entry: usize,
    },
    /// A position or rate beyond its limits.
    #[error("{what} of joint '{joint}' is {value}, beyond its limits {low} and {high}")]
    Outside {
        /// What it is.
        what: &'static str,
        /// The name of the joint.
        joint: String,
        /// The value (rad, rad/s, m, m/s).
        value: f64,
        /// Its least value.
        low: f64,
        /// Its largest value.
        high: f64,
    },
    /// An obstacle or a reference that the problem does not have.
    #[error("{table}: there is no entry {entry}, counted from 0; the number of entries is fixed")]
    NoEntry {
        /// The table of the problem.
        table: &'static str,
        /// The number that was given, from 0.
        entry: usize,
    },
    /// An obstacle or a reference that does not fit.
    #[error("{table}, entry {entry}: {cause}")]
    Task {
        /// The table of the problem.
        table: &'static str,
        /// The number that was given, from 0.
        entry: usize,
        /// What is wrong with it.
        cause: TaskError,
    },
    /// A tool that the problem does not have, or one without an orientation.
    #[error("{table}: there is no entry {entry} with an orientation, counted from 0; poses keep their kind")]
    NoOrientation {
        /// The table of the problem.
        table: &'static str,
        /// The number that was given, from 0.
        entry: usize,
    },
    /// A value that a limit cannot have.
    #[error("{kind} of joint '{joint}': {value} {remedy}")]
    BadLimit {
        /// What is limited.
        kind: &'static str,
        /// The name of the joint.
        joint: String,
        /// The value (rad, rad/s, rad/s^2, N m, W; m, N).
        value: f64,
        /// What it has to be.
        remedy: &'static str,
    },
    /// What a motion depends on and is no limit of joints: a payload, numbers of tools, obstacles and motors.
    #[error(
        "only limits of joints change; prepare the problem anew with another payload, tool, obstacle or motor"
    )]
    NotALimit,
    /// An entry that the problem does not have, or without one number that limits it.
    #[error("{table}: there is no entry {entry}, counted from 0, with one number that a motion depends on")]
    NoNumber {
        /// The table of the problem.
        table: &'static str,
        /// The number that was given, from 0.
        entry: usize,
    },
    /// The end of a periodic motion, which follows its start.
    #[error("the end of a periodic motion follows its start; set the start")]
    Periodic,
    /// Accelerations that the problem leaves free.
    #[error("{what}: it is free in the problem; give BoundaryState::a there")]
    FreeAcceleration {
        /// What it is.
        what: &'static str,
    },
    /// A limit that a joint does not have, or a torque limit that falls with the speed.
    #[error(
        "{kind} of joint '{joint}': there is no such limit, or it is a torque limit that falls with the speed"
    )]
    NoLimit {
        /// What is limited.
        kind: &'static str,
        /// The name of the joint, or its index from 0 if the robot has no such joint.
        joint: String,
    },
    /// A payload that the robot does not take.
    #[error("the payload: {0}")]
    Payload(String),
    /// A payload without mass, whose derivative by its mass is that of no body.
    #[error("the payload has no mass; give one, whose centre and shape the derivative belongs to")]
    NoMass,
    /// A tool that the problem does not have, or one without a position.
    #[error("{table}: there is no entry {entry} with a position, counted from 0; poses keep their kind")]
    NoTool {
        /// The table of the problem.
        table: &'static str,
        /// The number that was given, from 0.
        entry: usize,
    },
}
