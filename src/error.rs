//! Why an evaluation was refused.

/// An argument of the wrong length.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{what} has {found} entries, not {expected}")]
pub struct LengthError {
    /// The argument.
    pub what: &'static str,
    /// The length that it must have.
    pub expected: usize,
    /// The length that it has.
    pub found: usize,
}

impl LengthError {
    /// `Ok` if `found` is `expected`.
    ///
    /// # Errors
    /// The error itself if they differ.
    pub fn check(what: &'static str, expected: usize, found: usize) -> Result<(), Self> {
        if found == expected { Ok(()) } else { Err(Self { what, expected, found }) }
    }
}

use crate::robot::printable;
use std::fmt;

/// Why an evaluation was refused. The workspace remains usable.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum EvalError {
    /// An argument has the wrong length.
    #[error(transparent)]
    WrongLength(#[from] LengthError),
    /// An argument has an entry that is infinite or not a number.
    #[error(
        "{what}[{index}] (joint '{}') is not finite; check the computation that produced it",
        printable(joint)
    )]
    NonFinite {
        /// The argument.
        what: &'static str,
        /// Index of the entry, from 0.
        index: usize,
        /// The joint of the entry.
        joint: String,
    },
    /// A robot with a floating or spherical joint, where this computation takes none.
    #[error(
        "joint '{}' is {kind}, its orientation a quaternion: this computation does not take such joints, or q has \
         no entries for the quaternion; `Hamiltonian`, `ConstrainedHamiltonian` and `Lagrangian` take them, to \
         second order; for all else describe the joint as a chain of joints of one degree of freedom",
        printable(joint)
    )]
    FreeJoint {
        /// The joint.
        joint: String,
        /// `"floating"` or `"spherical"`.
        kind: &'static str,
    },
    /// A robot with a floating or spherical joint and wrenches from outside.
    #[error(
        "joint '{}' is {kind}, its orientation a quaternion: the dynamics of such a robot take no wrenches from \
         outside; add their generalised forces J'W to u, with the Jacobians J of `FreeKinematics`, or describe \
         the joint as a chain of joints of one degree of freedom",
        printable(joint)
    )]
    FreeJointAndWrench {
        /// The joint.
        joint: String,
        /// `"floating"` or `"spherical"`.
        kind: &'static str,
    },
    /// A robot with constraints, where this computation would ignore them.
    #[error(
        "the robot has the constraint '{}', which this computation would ignore: use `ConstrainedHamiltonian`, \
         or `Robot::without_constraints` for the open tree",
        printable(constraint)
    )]
    Constrained {
        /// The first constraint.
        constraint: String,
    },
    /// A quaternion whose length is not 1.
    #[error(
        "the quaternion of joint '{}' has a squared length that differs from 1 by more than {by}; \
         `ConfigurationSpace::normalize` divides it by its length",
        printable(joint)
    )]
    NotUnit {
        /// The joint.
        joint: String,
        /// A power of ten that the difference of its squared length from 1 exceeds.
        by: PowerOfTen,
    },
    /// The mass matrix is singular in working precision.
    #[error(
        "the mass matrix is singular at joint '{}': with the joints beyond it free, nothing resists its motion; \
         give the links beyond it a mass or the joint armature, lock it, correct a negative moment of inertia, or \
         avoid this pose if it is special \
         (a floating joint made of six is singular where its second angle is +-pi/2)",
        printable(joint)
    )]
    SingularMassMatrix {
        /// The joint whose pivot vanished.
        joint: String,
    },
    /// There is no frame of this number.
    #[error(
        "there is no frame {frame}: the robot has frames 0 to {last}; `Robot::frame_index` finds them by name"
    )]
    NoFrame {
        /// The number given.
        frame: usize,
        /// The largest number of a frame.
        last: usize,
    },
    /// There is no wrench of this number.
    #[error("there is no wrench {wrench}: the robot has {count}, counted from 0 in `Robot::wrenches`")]
    NoWrench {
        /// The number given.
        wrench: usize,
        /// How many there are.
        count: usize,
    },
    /// A wrench has a number that is not finite.
    #[error("the moment or force of wrench {wrench} is not finite; check the computation that produced it")]
    BadWrench {
        /// Its number.
        wrench: usize,
    },
    /// The centre of mass of a robot whose links have no mass.
    #[error("no link that moves has a mass, so that there is no centre of mass; give one of them a mass")]
    Massless,
    /// A model of a user cannot be evaluated.
    #[error("the model cannot be evaluated: {reason}")]
    Model {
        /// The error of the model.
        reason: String,
    },
}

impl EvalError {
    /// [`EvalError::FreeJoint`].
    pub(crate) fn free_joint(joint: &str, kind: &'static str) -> Self {
        Self::FreeJoint { joint: joint.to_owned(), kind }
    }
}

/// `10^exponent`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PowerOfTen(pub i32);

impl PowerOfTen {
    /// Its value.
    pub fn value(self) -> f64 {
        10.0_f64.powi(self.0)
    }
}

impl fmt::Display for PowerOfTen {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "1e{}", self.0)
    }
}

/// `slice` must have `expected` entries.
pub(crate) fn check_length<T>(what: &'static str, slice: &[T], expected: usize) -> Result<(), EvalError> {
    Ok(LengthError::check(what, expected, slice.len())?)
}
