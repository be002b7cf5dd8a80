//! The counting number and its arithmetic.

use super::{Operations, tally};
use crate::scalar::number::Scalar;
use crate::scalar::real::real_tanh_and_slope;
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

/// A value that counts the operations done with it, see [`count`](super::count).
///
/// It knows whether it is a constant: a number of the model, or a result of constants only. A variable with
/// the value 0 is not a constant, so that counts do not depend on the state. It implements num-dual's traits:
/// dual and hyper-dual numbers over it count the operations of those over `f64`.
#[derive(Clone, Copy, Debug)]
pub struct Count {
    pub(super) value: f64,
    pub(super) constant: bool,
}

impl Count {
    /// A variable: its operations count regardless of its value.
    pub fn variable(value: f64) -> Self {
        Self { value, constant: false }
    }

    /// The value.
    pub fn value(self) -> f64 {
        self.value
    }

    /// Whether it is known without any input.
    pub fn is_constant(self) -> bool {
        self.constant
    }

    pub(super) fn constant(value: f64) -> Self {
        Self { value, constant: true }
    }

    fn is(self, value: f64) -> bool {
        self.constant && self.value == value
    }

    /// Whether the result of a product with it is known beforehand.
    fn is_trivial_factor(self) -> bool {
        self.is(0.0) || self.is(1.0) || self.is(-1.0)
    }

    /// The value of a function of this number alone.
    pub(super) fn function(self, value: f64, kind: impl FnOnce(&mut Operations)) -> Self {
        tally(self.constant, kind);
        Self { value, constant: self.constant }
    }
}

impl Add for Count {
    type Output = Self;
    #[inline(never)]
    fn add(self, other: Self) -> Self {
        let constant = self.constant && other.constant;
        tally(constant || self.is(0.0) || other.is(0.0), |o| o.add += 1);
        Self { value: self.value + other.value, constant }
    }
}

impl Neg for Count {
    type Output = Self;
    fn neg(self) -> Self {
        Self { value: -self.value, ..self }
    }
}

impl Sub for Count {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Count {
    type Output = Self;
    #[inline(never)]
    fn mul(self, other: Self) -> Self {
        let constant = self.constant && other.constant;
        tally(constant || self.is_trivial_factor() || other.is_trivial_factor(), |o| o.mul += 1);
        if self.is(0.0) || other.is(0.0) {
            return Self::constant(0.0);
        }
        Self { value: self.value * other.value, constant }
    }
}

impl Div for Count {
    type Output = Self;
    #[inline(never)]
    fn div(self, other: Self) -> Self {
        let constant = self.constant && other.constant;
        let free = constant || self.is(0.0) || other.is(1.0) || other.is(-1.0);
        if other.constant && !free && super::folds() {
            tally(false, |o| o.mul += 1);
        } else {
            tally(free, |o| o.div += 1);
        }
        if self.is(0.0) {
            return self;
        }
        Self { value: self.value / other.value, constant }
    }
}

impl AddAssign for Count {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl SubAssign for Count {
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl MulAssign for Count {
    fn mul_assign(&mut self, other: Self) {
        *self = *self * other;
    }
}

impl Scalar for Count {
    type Mask = bool;
    type Pack = Self;
    const EPSILON: f64 = f64::EPSILON;
    const ORDER: usize = 0;
    const CHECKED: bool = false;

    fn from_f64(value: f64) -> Self {
        Self::constant(value)
    }
    fn times(self, factor: f64) -> Self {
        self * Self::constant(factor)
    }
    fn plus(self, term: f64) -> Self {
        self + Self::constant(term)
    }
    #[inline(never)]
    fn recip(self) -> Self {
        self.function(1.0 / self.value, |o| o.div += 1)
    }
    fn sqrt(self) -> Self {
        self.function(self.value.sqrt(), |o| o.sqrt += 1)
    }
    #[inline(never)]
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.value.sin_cos();
        (self.function(sin, |o| o.sincos += 1), Self { value: cos, constant: self.constant })
    }
    fn exp(self) -> Self {
        self.function(self.value.exp(), |o| o.exp += 1)
    }
    fn exp_m1(self) -> Self {
        self.function(self.value.exp_m1(), |o| o.exp += 1)
    }
    fn tanh_and_slope(self) -> (Self, Self) {
        real_tanh_and_slope(self)
    }
    #[inline(never)]
    fn less(self, other: Self) -> bool {
        tally(self.constant && other.constant, |o| o.less += 1);
        self.value < other.value
    }
    fn select(mask: bool, if_true: Self, if_false: Self) -> Self {
        let chosen = if mask { if_true } else { if_false };
        Self { constant: if_true.constant && if_false.constant, ..chosen }
    }
    fn all(mask: bool) -> bool {
        mask
    }
}
