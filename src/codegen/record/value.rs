//! Numbers and truth values while recording: constants, or nodes with a sign.

use super::node::Id;

/// Plus or minus a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::codegen) struct Signed {
    pub id: Id,
    pub negative: bool,
}

/// A number while recording.
#[derive(Clone, Copy, Debug)]
pub(in crate::codegen) enum Value {
    Constant(f64),
    Of(Signed),
}

/// A truth value while recording.
#[derive(Clone, Copy, Debug)]
pub(in crate::codegen) enum Truth {
    Constant(bool),
    Of(Id),
}

impl Value {
    pub fn negated_if(self, negative: bool) -> Self {
        if negative { -self } else { self }
    }

    pub fn is(self, constant: f64) -> bool {
        matches!(self, Self::Constant(value) if value == constant)
    }
}

impl std::ops::Neg for Value {
    type Output = Self;
    fn neg(self) -> Self {
        match self {
            // Never -0.
            Self::Constant(value) => Self::Constant(0.0 - value),
            Self::Of(Signed { id, negative }) => Self::Of(Signed { id, negative: !negative }),
        }
    }
}
