//! The operations of a recorded number.
//!
//! An operation on a foreign expression is foreign at once: a recording that was stopped at its limit runs to
//! the end of the recorded function, and should do so without work.

use super::arena::Arena;
use super::expr::{Content, Expr, ExprMask};
use super::node::Node;
use super::recording::with;
use super::value::Value;
use crate::codegen::error::CodegenError;
use crate::scalar::{Scalar, real_tanh_and_slope};
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Sub, SubAssign};

impl Expr {
    fn unary(self, apply: impl FnOnce(&mut Arena, Value) -> Value) -> Self {
        if self.is_foreign() {
            return Self::FOREIGN;
        }
        with(|recording| match recording.value(self) {
            Some(value) => recording.expr(|arena| apply(arena, value)),
            None => Self::FOREIGN,
        })
    }

    fn binary(self, other: Self, apply: impl FnOnce(&mut Arena, Value, Value) -> Value) -> Self {
        if self.is_foreign() || other.is_foreign() {
            return Self::FOREIGN;
        }
        with(|recording| match (recording.value(self), recording.value(other)) {
            (Some(a), Some(b)) => recording.expr(|arena| apply(arena, a, b)),
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
    const FOLDED: bool = true;
    const INLINED: bool = false;

    fn from_f64(value: f64) -> Self {
        with(|recording| recording.constant(value))
    }
    fn times(self, factor: f64) -> Self {
        if self.is_foreign() { self } else { self * Self::from_f64(factor) }
    }
    fn plus(self, term: f64) -> Self {
        if self.is_foreign() { self } else { self + Self::from_f64(term) }
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
        with(|recording| recording.less(self, other))
    }
    fn select(mask: ExprMask, if_true: Self, if_false: Self) -> Self {
        match with(|recording| recording.truth(mask)) {
            Some(mask) => if_true.binary(if_false, |arena, a, b| arena.select(mask, a, b)),
            None => Self::FOREIGN,
        }
    }

    /// A recorded comparison has no outcome: a recording that needs one fails with [`CodegenError::Branch`].
    fn all(mask: ExprMask) -> bool {
        match mask.0 {
            Content::Constant(value) => value,
            _ => {
                with(|recording| recording.fail(CodegenError::Branch));
                true
            }
        }
    }
}
