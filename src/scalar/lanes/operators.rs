//! Arithmetic in every lane, and the supertraits of num-dual's numbers.

use super::{Lanes, Vector};
use crate::scalar::number::Scalar;
use num_traits::{FromPrimitive, Inv, Num, One, Signed, Zero};
use std::cmp::Ordering;
use std::fmt;
use std::iter::{Product, Sum};
use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Rem, RemAssign, Sub, SubAssign};

impl<V: Vector> Neg for Lanes<V> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

/// An operator of the vector.
macro_rules! vector_operators {
    ($($operator:ident, $apply:ident;)*) => {$(
        impl<V: Vector> $operator for Lanes<V> {
            type Output = Self;
            #[inline(always)]
            fn $apply(self, other: Self) -> Self {
                Self(self.0.$apply(other.0))
            }
        }
    )*};
}

vector_operators! { Add, add; Sub, sub; Mul, mul; Div, div; }

impl<V: Vector> Rem for Lanes<V> {
    type Output = Self;
    fn rem(self, other: Self) -> Self {
        self.combine(other, |a, b| a % b)
    }
}

/// An operator with a reference and with a constant on the right, and the three that assign.
macro_rules! forward_operators {
    ($($operator:ident, $apply:ident, $assigning:ident, $assign:ident;)*) => {$(
        impl<V: Vector> $operator<&Self> for Lanes<V> {
            type Output = Self;
            #[inline(always)]
            fn $apply(self, other: &Self) -> Self {
                self.$apply(*other)
            }
        }
        impl<V: Vector> $operator<f64> for Lanes<V> {
            type Output = Self;
            #[inline(always)]
            fn $apply(self, other: f64) -> Self {
                self.$apply(Self::from(other))
            }
        }
        impl<V: Vector> $assigning for Lanes<V> {
            #[inline(always)]
            fn $assign(&mut self, other: Self) {
                *self = self.$apply(other);
            }
        }
        impl<V: Vector> $assigning<f64> for Lanes<V> {
            #[inline(always)]
            fn $assign(&mut self, other: f64) {
                *self = self.$apply(other);
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

impl<V: Vector> Lanes<V> {
    /// A function of two `f64` in every lane.
    pub(super) fn combine(mut self, other: Self, function: impl Fn(f64, f64) -> f64) -> Self {
        let lanes = self.0.as_mut_slice().iter_mut().zip(other.0.as_slice());
        lanes.for_each(|(lane, &other)| *lane = function(*lane, other));
        self
    }

    /// Whether a condition holds in every lane.
    fn every(&self, other: &Self, holds: impl Fn(&f64, &f64) -> bool) -> bool {
        self.as_slice().iter().zip(other.as_slice()).all(|(a, b)| holds(a, b))
    }
}

impl<V: Vector> From<f64> for Lanes<V> {
    #[inline(always)]
    fn from(value: f64) -> Self {
        Self(V::splat(value))
    }
}

impl<V: Vector> FromPrimitive for Lanes<V> {
    fn from_i64(n: i64) -> Option<Self> {
        f64::from_i64(n).map(Self::from)
    }
    fn from_u64(n: u64) -> Option<Self> {
        f64::from_u64(n).map(Self::from)
    }
    fn from_f64(x: f64) -> Option<Self> {
        Some(Self::from(x))
    }
}

impl<V: Vector> Zero for Lanes<V> {
    #[inline(always)]
    fn zero() -> Self {
        Self::from(0.0)
    }
    fn is_zero(&self) -> bool {
        *self == 0.0
    }
}

impl<V: Vector> One for Lanes<V> {
    #[inline(always)]
    fn one() -> Self {
        Self::from(1.0)
    }
}

impl<V: Vector> Num for Lanes<V> {
    type FromStrRadixErr = <f64 as Num>::FromStrRadixErr;
    fn from_str_radix(text: &str, radix: u32) -> Result<Self, Self::FromStrRadixErr> {
        f64::from_str_radix(text, radix).map(Self::from)
    }
}

impl<V: Vector> Signed for Lanes<V> {
    fn abs(&self) -> Self {
        Scalar::abs(*self)
    }
    fn abs_sub(&self, other: &Self) -> Self {
        Self::select(self.less(*other), Scalar::zero(), *self - *other)
    }
    fn signum(&self) -> Self {
        self.map(f64::signum)
    }
    fn is_positive(&self) -> bool {
        self.as_slice().iter().all(|lane| *lane > 0.0)
    }
    fn is_negative(&self) -> bool {
        self.as_slice().iter().all(|lane| *lane < 0.0)
    }
}

impl<V: Vector> Inv for Lanes<V> {
    type Output = Self;
    fn inv(self) -> Self {
        Scalar::recip(self)
    }
}

impl<V: Vector> Sum for Lanes<V> {
    fn sum<I: Iterator<Item = Self>>(terms: I) -> Self {
        terms.fold(Scalar::zero(), Add::add)
    }
}

impl<V: Vector> Product for Lanes<V> {
    fn product<I: Iterator<Item = Self>>(factors: I) -> Self {
        factors.fold(Scalar::one(), Mul::mul)
    }
}

/// Equality in every lane.
impl<V: Vector> PartialEq for Lanes<V> {
    fn eq(&self, other: &Self) -> bool {
        self.every(other, |a, b| a == b)
    }
}

impl<V: Vector> PartialEq<f64> for Lanes<V> {
    fn eq(&self, other: &f64) -> bool {
        *self == Self::from(*other)
    }
}

/// Ordered if all lanes have the same order; otherwise neither is less.
impl<V: Vector> PartialOrd for Lanes<V> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        let order = self.lane(0).partial_cmp(&other.lane(0));
        if self.every(other, |a, b| a.partial_cmp(b) == order) { order } else { None }
    }
}

impl<V: Vector> PartialOrd<f64> for Lanes<V> {
    fn partial_cmp(&self, other: &f64) -> Option<Ordering> {
        self.partial_cmp(&Self::from(*other))
    }
}

impl<V: Vector> fmt::Display for Lanes<V> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.as_slice()).finish()
    }
}
