//! A scalar that counts what the pipeline does with it.

use super::{Scalar, real_tanh_and_slope};
use std::cell::Cell;
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

/// Arithmetic operations, by kind. Changes of sign and copies are free.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Operations {
    /// Multiplications.
    pub mul: u64,
    /// Additions and subtractions.
    pub add: u64,
    /// Divisions and reciprocals.
    pub div: u64,
    /// Square roots.
    pub sqrt: u64,
    /// Pairs of sine and cosine.
    pub sincos: u64,
    /// Exponential functions.
    pub exp: u64,
    /// Comparisons.
    pub less: u64,
}

const NONE: Operations = Operations { mul: 0, add: 0, div: 0, sqrt: 0, sincos: 0, exp: 0, less: 0 };

thread_local! {
    static OPERATIONS: Cell<Operations> = const { Cell::new(NONE) };
}

/// Counts the operations that `work` does with [`Count`] numbers on this thread.
///
/// ```
/// use costate::scalar::{Count, Scalar, count};
/// let x = Count::variable(3.0);
/// let (_, operations) = count(|| x * x + Count::one() * x + Count::zero());
/// assert_eq!((operations.mul, operations.add), (1, 1)); // 1 x and + 0 are folded
/// ```
pub fn count<R>(work: impl FnOnce() -> R) -> (R, Operations) {
    let outer = OPERATIONS.replace(NONE);
    let result = work();
    (result, OPERATIONS.replace(outer))
}

fn tally(update: impl FnOnce(&mut Operations)) {
    let mut operations = OPERATIONS.get();
    update(&mut operations);
    OPERATIONS.set(operations);
}

/// A value that counts the operations done with it, see [`count`].
///
/// Constants are folded the way generated code would fold them: products with exactly 0, 1 or -1, sums with
/// exactly 0 and operations between two constants cost nothing. A value that happens to be 0 is not a constant.
#[derive(Clone, Copy, Debug)]
pub struct Count {
    value: f64,
    constant: bool,
}

impl Count {
    /// A variable: operations with it count whatever its value.
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

    fn constant(value: f64) -> Self {
        Self { value, constant: true }
    }

    fn is(self, value: f64) -> bool {
        self.constant && self.value == value
    }

    fn function(self, value: f64, kind: impl FnOnce(&mut Operations)) -> Self {
        if !self.constant {
            tally(kind);
        }
        Self { value, constant: self.constant }
    }
}

impl Add for Count {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        if self.is(0.0) {
            return other;
        }
        if other.is(0.0) {
            return self;
        }
        let constant = self.constant && other.constant;
        if !constant {
            tally(|o| o.add += 1);
        }
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
    fn mul(self, other: Self) -> Self {
        if self.is(0.0) || other.is(0.0) {
            return Self::constant(0.0);
        }
        let free = self.is(1.0) || self.is(-1.0) || other.is(1.0) || other.is(-1.0);
        let constant = self.constant && other.constant;
        if !free && !constant {
            tally(|o| o.mul += 1);
        }
        Self { value: self.value * other.value, constant }
    }
}

impl Div for Count {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        if other.constant {
            return self * Self::constant(1.0 / other.value);
        }
        if self.is(0.0) {
            return self;
        }
        tally(|o| o.div += 1);
        Self::variable(self.value / other.value)
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
    const EPSILON: f64 = f64::EPSILON;
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
    fn recip(self) -> Self {
        self.function(1.0 / self.value, |o| o.div += 1)
    }
    fn sqrt(self) -> Self {
        self.function(self.value.sqrt(), |o| o.sqrt += 1)
    }
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
    fn less(self, other: Self) -> bool {
        if !(self.constant && other.constant) {
            tally(|o| o.less += 1);
        }
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

#[cfg(test)]
mod tests {
    use super::{Count, count};
    use crate::scalar::Scalar;

    #[test]
    fn every_kind_is_counted_and_constants_are_folded() {
        let (x, y) = (Count::variable(2.0), Count::variable(0.0));
        let (value, o) = count(|| {
            let s = x * y + x.times(3.0) - x.times(0.0) + y.plus(0.0);
            let (sin, cos) = s.sin_cos();
            (sin / cos + x.recip() + x.sqrt() + Scalar::tanh(x)).value()
        });
        assert!((value - (6.0_f64.tan() + 0.5 + 2.0_f64.sqrt() + 2.0_f64.tanh())).abs() < 1e-14);
        assert_eq!((o.mul, o.div, o.sqrt, o.sincos, o.exp, o.less), (2 + 4, 2 + 2, 1, 1, 2, 2));
        assert_eq!(o.add, 2 + 3 + 2);
    }

    #[test]
    fn counts_nest() {
        let x = Count::variable(2.0);
        let (inner, outer) = count(|| {
            let before = x * x;
            let (_, inner) = count(|| before + x);
            inner
        });
        assert_eq!((inner.add, inner.mul, outer.add, outer.mul), (1, 0, 0, 1));
    }
}
