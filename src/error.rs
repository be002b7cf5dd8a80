//! What can be wrong with a state.

/// Why an evaluation was refused. The workspace stays usable.
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
    /// An argument with an infinite or undefined entry.
    #[error("{what}[{index}] (joint '{joint}') is not finite; check what produced it")]
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
        "the mass matrix is singular at joint '{joint}': with the joints beyond it free, nothing resists its motion; \
         give the links beyond it a mass or the joint armature, or leave this pose if it is special \
         (a floating joint made of six is singular where its second angle is +-pi/2)"
    )]
    SingularMassMatrix {
        /// The joint whose pivot vanished.
        joint: String,
    },
    /// A model of a user cannot be evaluated.
    #[error("the model cannot be evaluated: {reason}")]
    Model {
        /// The error of the model.
        reason: String,
    },
}

/// `slice` must have `expected` entries.
pub(crate) fn check_length<T>(what: &'static str, slice: &[T], expected: usize) -> Result<(), EvalError> {
    if slice.len() == expected {
        return Ok(());
    }
    Err(EvalError::WrongLength { what, expected, found: slice.len() })
}
