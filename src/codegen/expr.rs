//! A scalar that records what the pipeline does with it.

use super::arena::Arena;
use super::error::CodegenError;
use super::node::{Id, Node};
use super::recording::RECORDING;
use super::value::{Signed, Truth, Value};
use crate::scalar::{Scalar, real_tanh_and_slope};
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

/// A recorded number: a constant, or plus or minus a node of the recording that runs on this thread.
///
/// What is known beforehand is folded: anything between constants, products with 0, 1 and -1, sums with 0, `x - x`, double
/// changes of sign, constant factors of constant multiples. Equal operations are recorded once, whatever the order and the
/// signs of their operands. As in all generated code, `0 x` is then 0 even where x is not a number.
///
/// Sums are taken for those of real numbers: `(x + c) + d` becomes `x + (c + d)`, `a + (b - a)` becomes b and
/// `a x + (b - a) x` becomes `b x`. Formulas that live on rounding (compensated sums, reductions by a large constant) lose their
/// meaning; give them as inputs what they compute.
///
/// An expression belongs to its recording. Used outside, it turns into one that no recording accepts:
/// [`Program::record`](super::Program::record) fails with [`CodegenError::Foreign`] where one such occurs.
#[derive(Clone, Copy, Debug)]
pub struct Expr(pub(super) Content<Signed, f64>);

/// A recorded comparison.
#[derive(Clone, Copy, Debug)]
pub struct ExprMask(pub(super) Content<Id, bool>);

/// What an expression is.
#[derive(Clone, Copy, Debug)]
pub(super) enum Content<N, C> {
    Constant(C),
    Node {
        node: N,
        recording: u32,
    },
    /// Made of an expression of another recording.
    Foreign,
}

impl Expr {
    const FOREIGN: Self = Self(Content::Foreign);

    pub(super) fn from_value(value: Value, recording: u32) -> Self {
        Self(match value {
            Value::Constant(value) => Content::Constant(value),
            Value::Of(node) => Content::Node { node, recording },
        })
    }

    /// A constant that stands for itself.
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

    fn unary(self, apply: impl FnOnce(&mut Arena, Value) -> Value) -> Self {
        RECORDING.with_borrow_mut(|recording| match recording.value(self) {
            Some(value) => Self::from_value(apply(&mut recording.arena, value), recording.number),
            None => Self::FOREIGN,
        })
    }

    fn binary(self, other: Self, apply: impl FnOnce(&mut Arena, Value, Value) -> Value) -> Self {
        RECORDING.with_borrow_mut(|recording| match (recording.value(self), recording.value(other)) {
            (Some(a), Some(b)) => Self::from_value(apply(&mut recording.arena, a, b), recording.number),
            _ => Self::FOREIGN,
        })
    }
}

impl Add for Expr {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        self.binary(other, Arena::add)
    }
}

impl Sub for Expr {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self.binary(other, |arena, a, b| arena.add(a, -b))
    }
}

impl Mul for Expr {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        self.binary(other, Arena::mul)
    }
}

impl Div for Expr {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        self.binary(other, Arena::div)
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

impl AddAssign for Expr {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl SubAssign for Expr {
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl MulAssign for Expr {
    fn mul_assign(&mut self, other: Self) {
        *self = *self * other;
    }
}

impl Scalar for Expr {
    type Mask = ExprMask;
    type Pack = Self;
    const EPSILON: f64 = f64::EPSILON;
    const ORDER: usize = 0;
    const CHECKED: bool = false;

    fn from_f64(value: f64) -> Self {
        RECORDING.with_borrow_mut(|recording| {
            let known = recording.labels.as_ref().map(|labels| labels.expr(value));
            match known {
                None => Self(Content::Constant(value)),
                Some(Some(expr)) => expr,
                Some(None) => {
                    recording.arena.fail(CodegenError::Constant);
                    Self(Content::Constant(value))
                }
            }
        })
    }
    fn times(self, factor: f64) -> Self {
        self * Self::from_f64(factor)
    }
    fn plus(self, term: f64) -> Self {
        self + Self::from_f64(term)
    }
    fn recip(self) -> Self {
        Self::one() / self
    }
    fn sqrt(self) -> Self {
        self.unary(|arena, a| arena.function(a, Node::Sqrt, f64::sqrt))
    }
    fn sin_cos(self) -> (Self, Self) {
        let sin = self.unary(|arena, a| arena.sin_cos(a).0);
        (sin, self.unary(|arena, a| arena.sin_cos(a).1))
    }
    fn exp(self) -> Self {
        self.unary(|arena, a| arena.function(a, Node::Exp, f64::exp))
    }
    fn exp_m1(self) -> Self {
        self.unary(|arena, a| arena.function(a, Node::ExpM1, f64::exp_m1))
    }
    fn tanh_and_slope(self) -> (Self, Self) {
        real_tanh_and_slope(self)
    }
    fn less(self, other: Self) -> ExprMask {
        let content = RECORDING.with_borrow_mut(|recording| {
            let (Some(a), Some(b)) = (recording.value(self), recording.value(other)) else {
                return Content::Foreign;
            };
            match recording.arena.less(a, b) {
                Truth::Constant(value) => Content::Constant(value),
                Truth::Of(node) => Content::Node { node, recording: recording.number },
            }
        });
        ExprMask(content)
    }
    fn select(mask: ExprMask, if_true: Self, if_false: Self) -> Self {
        let mask = RECORDING.with_borrow_mut(|recording| recording.truth(mask));
        match mask {
            Some(mask) => if_true.binary(if_false, |arena, a, b| arena.select(mask, a, b)),
            None => Self::FOREIGN,
        }
    }

    /// A recorded comparison has no outcome: asked for one, the recording fails with [`CodegenError::Branch`].
    fn all(mask: ExprMask) -> bool {
        match mask.0 {
            Content::Constant(value) => value,
            _ => {
                RECORDING.with_borrow_mut(|recording| recording.arena.fail(CodegenError::Branch));
                true
            }
        }
    }
}
