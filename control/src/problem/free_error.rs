//! What is wrong with a motion of a robot with floating or spherical joints.

use super::key::Key;
use super::rounded::rounded;
use costate::EvalError;
use costate::robot::{printable, printable_number as number};
use std::fmt;

/// Why the motion of a robot with floating or spherical joints was refused.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum FreeMotionError {
    /// A quaternion whose length is not 1.
    NotUnit {
        /// `start.q` or `end.q`.
        key: Key,
        /// The joint.
        joint: String,
        /// Index of the first entry of the quaternion in q.
        entry: usize,
        /// Its length.
        length: f64,
    },
    /// Something that such motions do not take.
    NotTaken {
        /// What it is.
        key: Key,
        /// The first floating or spherical joint of the robot.
        joint: String,
    },
    /// A gait, which robots with such joints do not take.
    Gait {
        /// The first floating or spherical joint of the robot.
        joint: String,
    },
    /// A constraint, which motions of robots with such joints do not keep.
    Constraint {
        /// The first constraint of the robot.
        constraint: String,
        /// The first floating or spherical joint of the robot.
        joint: String,
    },
    /// A wrench from outside, which robots with such joints do not take.
    Wrench {
        /// The first floating or spherical joint of the robot.
        joint: String,
    },
    /// Nothing drives the robot.
    NoMotor {
        /// The first floating or spherical joint of the robot.
        joint: String,
    },
    /// A limit of positions of a floating or spherical joint.
    PositionLimit {
        /// `limits.q_min` or `limits.q_max`.
        key: Key,
        /// The coordinate.
        joint: String,
    },
    /// The robot limits a rate, and its limits are kept.
    RobotRate {
        /// The joint whose rate is limited.
        joint: String,
    },
    /// Two of three angles of an orientation are free at the end.
    TwoAxes {
        /// The joint.
        joint: String,
    },
    /// Rates at the end that positions which are free would have to tell.
    RatesNeedPositions {
        /// A coordinate whose position is free.
        joint: String,
    },
    /// Rates at the end with another momentum than that which nothing changes.
    Momentum {
        /// The joint that carries the whole robot.
        joint: String,
        /// By how much an entry of its momentum differs (kg m/s, kg m^2/s).
        miss: f64,
    },
    /// More rates are given at the end than are left to choose.
    TooManyRates {
        /// The joint that carries the whole robot.
        joint: String,
        /// How many are given.
        given: usize,
        /// How many may be.
        most: usize,
    },
    /// A position at the end that the centre of mass does not come to.
    CentreOfMass {
        /// The joint that carries the whole robot.
        joint: String,
        /// Where its frame is there, with the other positions as they are given (m).
        position: [f64; 3],
    },
    /// A free time, and positions or rates at the end that a centre of mass which moves by itself would have
    /// to have then.
    Falls {
        /// The joint that carries the whole robot.
        joint: String,
    },
    /// A state that cannot be evaluated.
    Evaluation {
        /// `start.q` or `end.q`.
        key: Key,
        /// Why.
        cause: EvalError,
    },
}

impl FreeMotionError {
    /// The field at fault.
    pub fn key(&self) -> Key {
        match *self {
            Self::NotUnit { key, .. }
            | Self::NotTaken { key, .. }
            | Self::PositionLimit { key, .. }
            | Self::Evaluation { key, .. } => key,
            Self::Gait { .. } => Key::GAIT_STANCE,
            Self::Wrench { .. } | Self::Constraint { .. } => Key::ROBOT,
            Self::NoMotor { .. } => Key::LIMIT_TORQUE_MAX,
            Self::RobotRate { .. } => Key::LIMIT_V_MAX,
            Self::TwoAxes { .. } => Key::END_Q_FREE,
            Self::RatesNeedPositions { .. } | Self::Momentum { .. } | Self::TooManyRates { .. } => Key::END_V,
            Self::CentreOfMass { .. } => Key::END_Q,
            Self::Falls { .. } => Key::FREE_TIME,
        }
    }
}

impl fmt::Display for FreeMotionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotUnit { joint, entry, length, .. } => write!(
                f,
                "the quaternion (x, y, z, w) of joint '{}', q[{entry}] to q[{}], has length {}; {}",
                printable(joint),
                entry + 3,
                number(*length),
                if *length > 0.0 { "divide it by that" } else { "it has no direction: give another one" }
            ),
            Self::NotTaken { joint, .. } => write!(
                f,
                "joint '{}' turns freely, its orientation a quaternion, and motions of robots with such joints do \
                 not take this; remove it",
                printable(joint)
            ),
            Self::Gait { joint } => write!(
                f,
                "joint '{}' turns freely, its orientation a quaternion, and gaits do not take such joints; give the \
                 base as prismatic and revolute joints: in a TOML file one by one, of a URDF as a joint of type \
                 floating without robot.quaternions, --quaternions, robot.floating_base and --floating-base",
                printable(joint)
            ),
            Self::Constraint { constraint, joint } => write!(
                f,
                "joint '{}' turns freely, its orientation a quaternion, and motions of robots with such joints do not \
                 keep constraints, the first of which is '{}'; remove the constraints, or give the joint as prismatic \
                 and revolute ones",
                printable(joint),
                printable(constraint)
            ),
            Self::Wrench { joint } => write!(
                f,
                "joint '{}' turns freely, and robots with such joints take no wrench; remove it",
                printable(joint)
            ),
            Self::NoMotor { joint } => write!(
                f,
                "nothing drives the robot: joint '{}' has no actuator unless a force or torque of it is given here, and \
                 all others are 0; give the limit of one, or inf",
                printable(joint)
            ),
            Self::PositionLimit { joint, .. } => write!(
                f,
                "positions of floating and spherical joints are not limited; give inf or -inf for '{}'",
                printable(joint)
            ),
            Self::RobotRate { joint } => write!(
                f,
                "the robot limits the rate of joint '{}', and motions of robots with floating or spherical joints \
                 keep limits of positions and torques alone; set limits.from_robot = false and give q_min, q_max \
                 and torque_max",
                printable(joint)
            ),
            Self::TwoAxes { joint } => write!(
                f,
                "two angles of joint '{}' are free; free one, the turn about an axis of its frame at the end, or all \
                 three",
                printable(joint)
            ),
            Self::RatesNeedPositions { joint } => write!(
                f,
                "with the position of '{}' free all rates must be zero, or all free; give the positions, or list all \
                 joints in end.v_free",
                printable(joint)
            ),
            Self::Momentum { joint, miss } => write!(
                f,
                "nothing drives joint '{}', so the momentum of what it carries is known; these rates differ from it by \
                 {} (kg m/s, kg m^2/s). Change them, or free the rates of this joint in end.v_free",
                printable(joint),
                rounded(*miss)
            ),
            Self::TooManyRates { joint, given, most } => write!(
                f,
                "nothing drives joint '{}', so its momentum is known and {most} rates are left to choose, but {given} \
                 are given; give all, or free its own in end.v_free",
                printable(joint)
            ),
            Self::CentreOfMass { joint, position: [x, y, z] } => write!(
                f,
                "nothing drives joint '{joint}', so the centre of mass moves by itself; with the other positions as they \
                 are given its frame ends at ({}, {}, {}) m. Give that, or free '{joint}_x', '{joint}_y' and \
                 '{joint}_z' in end.q_free",
                number(*x),
                number(*y),
                number(*z),
                joint = printable(joint)
            ),
            Self::Falls { joint } => write!(
                f,
                "nothing drives joint '{}', so its centre of mass moves by itself, and what is given at the end would \
                 tell when; give time.final, or free the position and all rates of this joint",
                printable(joint)
            ),
            Self::Evaluation { cause, .. } => cause.fmt(f),
        }
    }
}

impl std::error::Error for FreeMotionError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Evaluation { cause, .. } => Some(cause),
            _ => None,
        }
    }
}
