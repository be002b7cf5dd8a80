//! A recorded number and a recorded truth value.

use super::node::Id;
use super::value::{Signed, Value};
use std::ops::Neg;

/// A recorded number: a constant, or plus or minus a node of the recording that runs on this thread.
///
/// Whatever is known while recording is folded: operations between constants, products with 0, 1 and -1, sums
/// with 0, `x - x`, double negations, constant multiples of constant multiples. Equal operations are recorded
/// once, whatever the order and the signs of their operands. As in all generated code, `0 x` is then 0 even
/// where x is not a number.
///
/// Sums are treated as sums of real numbers: `(x + c) + d` becomes `x + (c + d)`, `a + (b - a)` becomes b and
/// `a x + (b - a) x` becomes `b x`. Formulas that rely on rounding (compensated sums, reductions by a large
/// constant) lose their meaning; compute such values outside and pass them as inputs.
///
/// An expression belongs to its recording. Used outside of it, it becomes one that no recording accepts:
/// [`Program::record`](crate::codegen::Program::record) fails with
/// [`CodegenError::Foreign`](crate::codegen::CodegenError::Foreign) where such an expression is part of a
/// result.
#[derive(Clone, Copy, Debug)]
pub struct Expr(pub(super) Content<Signed, f64>);

/// A recorded comparison.
#[derive(Clone, Copy, Debug)]
pub struct ExprMask(pub(super) Content<Id, bool>);

/// The content of an expression.
#[derive(Clone, Copy, Debug)]
pub(super) enum Content<N, C> {
    Constant(C),
    Node {
        node: N,
        recording: u32,
    },
    /// Made from an expression of another recording, or after the recording was stopped.
    Foreign,
}

impl Expr {
    pub(super) const FOREIGN: Self = Self(Content::Foreign);

    pub(super) fn from_value(value: Value, recording: u32) -> Self {
        Self(match value {
            Value::Constant(value) => Content::Constant(value),
            Value::Of(node) => Content::Node { node, recording },
        })
    }

    /// A constant that no label replaces.
    pub(super) fn fixed(value: f64) -> Self {
        Self(Content::Constant(value))
    }

    /// Its value, if it is a constant.
    pub fn constant(self) -> Option<f64> {
        match self.0 {
            Content::Constant(value) => Some(value),
            _ => None,
        }
    }

    /// Whether no recording accepts it.
    #[inline]
    pub(super) fn is_foreign(self) -> bool {
        matches!(self.0, Content::Foreign)
    }
}

impl Neg for Expr {
    type Output = Self;
    fn neg(self) -> Self {
        match self.0 {
            Content::Constant(value) => Self(Content::Constant(0.0 - value)),
            Content::Node { node: Signed { id, negative }, recording } => {
                Self(Content::Node { node: Signed { id, negative: !negative }, recording })
            }
            Content::Foreign => self,
        }
    }
}
