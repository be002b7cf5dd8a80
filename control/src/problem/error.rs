//! Errors of a problem.

use crate::problem::continuation_cause::ContinuationCause;
use crate::problem::end_error::EndError;
use crate::problem::free_error::FreeMotionError;
use crate::problem::gait_error::GaitError;
use crate::problem::key::Key;
use crate::problem::loop_error::LoopError;
use crate::problem::task_error::TaskError;
use crate::problem::torque_speed_error::TorqueSpeedError;
use crate::problem::via_error::ViaError;

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
    /// Positions of a robot with floating or spherical joints that are too few or too many.
    WrongPositions {
        /// The field.
        key: Key,
        /// Number of positions, quaternions included.
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
    /// A joint that is listed twice.
    GivenTwice {
        /// The field.
        key: Key,
        /// The joint.
        joint: String,
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
    /// An end, or a via, that no motion has, or that no optimal motion has.
    End {
        /// The field.
        key: Key,
        /// What is wrong.
        cause: EndError,
    },
    /// A joint that moves neither mass nor inertia.
    NoMass {
        /// The joint.
        joint: String,
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
    /// A robot with a floating or spherical joint, whose orientation is a quaternion, where none is taken.
    FreeJoint {
        /// The joint.
        joint: String,
        /// `"floating"` or `"spherical"`.
        kind: &'static str,
    },
    /// A motion of a robot with floating or spherical joints that is refused.
    Free {
        /// The cause and its remedy.
        cause: FreeMotionError,
    },
    /// A robot with constraints where only open trees are taken.
    Constrained {
        /// The first constraint.
        constraint: String,
    },
    /// A motion of a robot with constraints that is refused.
    Loop {
        /// The cause and its remedy.
        cause: LoopError,
    },
    /// A [`Gait`](crate::Gait).
    Gait {
        /// The field.
        key: Key,
        /// The cause and its remedy.
        cause: Box<GaitError>,
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
    /// The field at fault; `None` for a continuation and for a joint of the robot.
    pub fn key(&self) -> Option<Key> {
        Some(match *self {
            Self::WrongLength { key, .. }
            | Self::WrongPositions { key, .. }
            | Self::NotFinite { key, .. }
            | Self::NotANumber { key, .. }
            | Self::UnknownJoint { key, .. }
            | Self::GivenTwice { key, .. }
            | Self::NotPositive { key, .. }
            | Self::Negative { key, .. }
            | Self::NoRoom { key, .. }
            | Self::EmptyLimits { key, .. }
            | Self::OutsideLimits { key, .. }
            | Self::BeyondLimit { key, .. }
            | Self::End { key, .. }
            | Self::Task { key, .. }
            | Self::Via { key, .. }
            | Self::Gait { key, .. }
            | Self::PhasesNeedDirect { key }
            | Self::TorqueSpeed { key, .. }
            | Self::RatesNeedDirect { key }
            | Self::TaskNeedsDirect { key } => key,
            Self::Loop { ref cause } => cause.key(),
            Self::Free { ref cause } => cause.key(),
            Self::NoMass { .. } => Key::ROBOT,
            Self::LimitsNeedDirect => Key::solver("method"),
            Self::EnergyNeedsDirect => Key::ENERGY,
            Self::FreeTimeWithoutCost | Self::NoWay => Key::FREE_TIME,
            Self::NoGain { .. } => Key::GAIN,
            Self::EmptyBounds { u_max: f64::NEG_INFINITY, .. } => Key::U_MAX,
            Self::EmptyBounds { .. } => Key::U_MIN,
            Self::EmptyRange { .. } => Key::Q_MIN,
            Self::UnboundedEffort { .. } | Self::NothingToMinimise => Key::EFFORT,
            Self::BadOption { key, .. } => Key::solver(key),
            Self::FreeJoint { .. } | Self::Constrained { .. } | Self::Continuation { .. } => return None,
        })
    }
}

impl From<FreeMotionError> for ProblemError {
    fn from(cause: FreeMotionError) -> Self {
        Self::Free { cause }
    }
}
