//! What can be wrong with a state.

use crate::robot::printable;

/// Why an evaluation was refused. The workspace remains usable.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum EvalError {
    /// An argument of the wrong length.
    #[error("{what} has {found} entries, not {expected}")]
    WrongLength {
        /// The argument.
        what: &'static str,
        /// Length it must have.
        expected: usize,
        /// Length it has.
        found: usize,
    },
    /// An argument with an entry that is infinite or not a number.
    #[error("{what}[{index}] (joint '{}') is not finite; check what produced it", printable(joint))]
    NonFinite {
        /// The argument.
        what: &'static str,
        /// Position of the entry, from 0.
        index: usize,
        /// The joint it belongs to.
        joint: String,
    },
    /// The mass matrix has no inverse in working precision.
    #[error(
        "the mass matrix is singular at joint '{}': with the joints beyond it free, nothing resists its motion; \
         give the links beyond it a mass or the joint armature, or avoid this pose if it is special \
         (a floating joint made of six is singular where its second angle is +-pi/2)",
        printable(joint)
    )]
    SingularMassMatrix {
        /// The joint whose pivot vanished.
        joint: String,
    },
}

/// `slice` must have `expected` entries.
pub(crate) fn check_length<T>(what: &'static str, slice: &[T], expected: usize) -> Result<(), EvalError> {
    if slice.len() == expected {
        return Ok(());
    }
    Err(EvalError::WrongLength { what, expected, found: slice.len() })
}
