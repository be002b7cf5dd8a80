//! The supertraits of num-dual's numbers: operators in all forms, constants, comparisons.

use super::{Count, Kind, tally};
use crate::scalar::number::Scalar;
use num_traits::{FromPrimitive, Inv, Num, One, Signed, Zero};
use std::cmp::Ordering;
use std::fmt;
use std::iter::{Product, Sum};
use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Rem, RemAssign, Sub, SubAssign};

impl Rem for Count {
    type Output = Self;
    fn rem(self, other: Self) -> Self {
        self.other_of_two(other, self.value() % other.value())
    }
}

impl DivAssign for Count {
    fn div_assign(&mut self, other: Self) {
        *self = *self / other;
    }
}

impl RemAssign for Count {
    fn rem_assign(&mut self, other: Self) {
        *self = *self % other;
    }
}

/// An operator with a reference, and with a constant, on the right.
macro_rules! forward_operators {
    ($($operator:ident, $apply:ident, $assigning:ident, $assign:ident;)*) => {$(
        impl $operator<&Self> for Count {
            type Output = Self;
            fn $apply(self, other: &Self) -> Self {
                self.$apply(*other)
            }
        }
        impl $operator<f64> for Count {
            type Output = Self;
            fn $apply(self, other: f64) -> Self {
                self.$apply(Self::model(other))
            }
        }
        impl $assigning<f64> for Count {
            fn $assign(&mut self, other: f64) {
                self.$assign(Self::model(other));
            }
        }
    )*};
}

forward_operators! {
    Add, add, AddAssign, add_assign;
    Sub, sub, SubAssign, sub_assign;
    Mul, mul, MulAssign, mul_assign;
    Div, div, DivAssign, div_assign;
    Rem, rem, RemAssign, rem_assign;
}

impl Count {
    fn constant_with(self, other: Self) -> bool {
        self.is_constant() && other.is_constant()
    }

    /// A function that is not counted by kind, and whose slope is not known.
    pub(super) fn other(self, value: f64) -> Self {
        self.function(value, f64::NAN, Kind::Other)
    }

    /// The same for a function of two numbers.
    pub(super) fn other_of_two(self, second: Self, value: f64) -> Self {
        Self { constant: self.constant_with(second), ..self }.other(value)
    }
}

impl From<f64> for Count {
    fn from(value: f64) -> Self {
        Self::constant(value)
    }
}

impl FromPrimitive for Count {
    fn from_i64(n: i64) -> Option<Self> {
        f64::from_i64(n).map(Self::constant)
    }
    fn from_u64(n: u64) -> Option<Self> {
        f64::from_u64(n).map(Self::constant)
    }
    fn from_f64(x: f64) -> Option<Self> {
        Some(Self::constant(x))
    }
}

impl Zero for Count {
    fn zero() -> Self {
        Self::constant(0.0)
    }
    fn is_zero(&self) -> bool {
        *self == 0.0
    }
}

impl One for Count {
    fn one() -> Self {
        Self::constant(1.0)
    }
}

impl Num for Count {
    type FromStrRadixErr = <f64 as Num>::FromStrRadixErr;
    fn from_str_radix(text: &str, radix: u32) -> Result<Self, Self::FromStrRadixErr> {
        f64::from_str_radix(text, radix).map(Self::constant)
    }
}

impl Signed for Count {
    fn abs(&self) -> Self {
        Scalar::abs(*self)
    }
    fn abs_sub(&self, other: &Self) -> Self {
        Self::select(self.less(*other), Self::constant(0.0), *self - *other)
    }
    fn signum(&self) -> Self {
        self.other(self.value().signum())
    }
    fn is_positive(&self) -> bool {
        Self::constant(0.0).less(*self)
    }
    fn is_negative(&self) -> bool {
        self.less(Self::constant(0.0))
    }
}

impl Inv for Count {
    type Output = Self;
    fn inv(self) -> Self {
        Scalar::recip(self)
    }
}

impl Sum for Count {
    fn sum<I: Iterator<Item = Self>>(terms: I) -> Self {
        terms.fold(Self::constant(0.0), Add::add)
    }
}

impl Product for Count {
    fn product<I: Iterator<Item = Self>>(factors: I) -> Self {
        factors.fold(Self::constant(1.0), Mul::mul)
    }
}

impl PartialEq for Count {
    fn eq(&self, other: &Self) -> bool {
        tally(self.constant_with(*other), Kind::Less);
        self.value() == other.value()
    }
}

impl PartialEq<f64> for Count {
    fn eq(&self, other: &f64) -> bool {
        *self == Self::constant(*other)
    }
}

impl PartialOrd for Count {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        tally(self.constant_with(*other), Kind::Less);
        self.value().partial_cmp(&other.value())
    }
}

impl PartialOrd<f64> for Count {
    fn partial_cmp(&self, other: &f64) -> Option<Ordering> {
        self.partial_cmp(&Self::constant(*other))
    }
}

impl fmt::Display for Count {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.value().fmt(f)
    }
}
