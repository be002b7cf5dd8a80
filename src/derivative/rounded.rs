//! A number that knows how large its rounding error is.

use crate::scalar::Scalar;
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

/// Half the distance from 1 to the next `f64`: the largest relative error of one operation, u = 2^-53.
pub(super) const UNIT: f64 = 0.5 * f64::EPSILON;

/// A value and the variance of its rounding error, to first order, in units of u^2.
///
/// The model of probabilistic error analysis (Hull and Swenson 1966; Higham and Mary 2019): every operation makes an error of
/// its own, of the size `u |result|`, and all of them are independent. Then variances add, and an error that a later operation
/// multiplies by c has its variance multiplied by c^2:
///
/// ```text
/// var(a + b) = var a + var b + (a + b)^2      var(a b) = b^2 var a + a^2 var b + (a b)^2
/// ```
///
/// What is exact in floating-point arithmetic makes no error: sums with 0, products with 0, 1 and -1. A rotation keeps
/// variances, so that they do not grow from joint to joint as sums of absolute values do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Rounded {
    pub value: f64,
    pub variance: f64,
}

impl Rounded {
    /// A number without error.
    pub fn exact(value: f64) -> Self {
        Self { value, variance: 0.0 }
    }

    /// A number with a standard deviation of `error` units of u.
    pub fn new(value: f64, error: f64) -> Self {
        Self { value, variance: error * error }
    }

    /// Standard deviation of the error, in units of u.
    pub fn error(self) -> f64 {
        self.variance.sqrt()
    }

    /// The result of an operation with errors of its arguments: one more rounding.
    fn rounded(value: f64, variance: f64) -> Self {
        Self { value, variance: variance + value * value }
    }

    /// f(x) for f with this value and slope.
    fn through(self, value: f64, slope: f64) -> Self {
        Self::rounded(value, slope * slope * self.variance)
    }

    fn is(self, value: f64) -> bool {
        self.value == value && self.variance == 0.0
    }
}

impl Add for Rounded {
    type Output = Self;
    #[inline(never)]
    fn add(self, other: Self) -> Self {
        if self.is(0.0) {
            return other;
        }
        if other.is(0.0) {
            return self;
        }
        Self::rounded(self.value + other.value, self.variance + other.variance)
    }
}

impl Sub for Rounded {
    type Output = Self;
    #[inline(never)]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Neg for Rounded {
    type Output = Self;
    fn neg(self) -> Self {
        Self { value: -self.value, ..self }
    }
}

impl Mul for Rounded {
    type Output = Self;
    #[inline(never)]
    fn mul(self, other: Self) -> Self {
        let (a, b) = (self.value, other.value);
        if self.is(0.0) || other.is(0.0) {
            return Self::exact(0.0);
        }
        if self.is(1.0) || self.is(-1.0) {
            return Self { value: a * b, ..other };
        }
        if other.is(1.0) || other.is(-1.0) {
            return Self { value: a * b, ..self };
        }
        Self::rounded(a * b, b * b * self.variance + a * a * other.variance)
    }
}

impl Div for Rounded {
    type Output = Self;
    #[expect(clippy::suspicious_arithmetic_impl, reason = "a quotient is a product with the reciprocal")]
    fn div(self, other: Self) -> Self {
        self * other.recip()
    }
}

impl AddAssign for Rounded {
    #[inline(never)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl SubAssign for Rounded {
    #[inline(never)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl MulAssign for Rounded {
    #[inline(never)]
    fn mul_assign(&mut self, other: Self) {
        *self = *self * other;
    }
}

impl Scalar for Rounded {
    type Mask = bool;
    type Pack = Self;
    const EPSILON: f64 = f64::EPSILON;
    const ORDER: usize = 0;

    fn from_f64(value: f64) -> Self {
        Self::exact(value)
    }
    /// Constants of the model are rounded themselves: other methods start from other ones.
    #[inline(never)]
    fn times(self, factor: f64) -> Self {
        let factor = match factor {
            0.0 | 1.0 | -1.0 | 0.5 | 2.0 | -2.0 => Self::exact(factor),
            _ => Self::new(factor, factor),
        };
        self * factor
    }
    #[inline(never)]
    fn plus(self, term: f64) -> Self {
        self + Self::new(term, term)
    }
    #[inline(never)]
    fn recip(self) -> Self {
        let value = self.value.recip();
        self.through(value, value * value)
    }
    fn sqrt(self) -> Self {
        let value = self.value.sqrt();
        self.through(value, 0.5 / value)
    }
    #[inline(never)]
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.value.sin_cos();
        (self.through(sin, cos), self.through(cos, sin))
    }
    fn exp(self) -> Self {
        let value = self.value.exp();
        self.through(value, value)
    }
    fn exp_m1(self) -> Self {
        self.through(self.value.exp_m1(), self.value.exp())
    }
    #[inline(never)]
    fn tanh_and_slope(self) -> (Self, Self) {
        let (tanh, slope) = self.value.tanh_and_slope();
        (self.through(tanh, slope), self.through(slope, 2.0 * tanh * slope))
    }
    fn less(self, other: Self) -> bool {
        self.value < other.value
    }
    fn select(mask: bool, if_true: Self, if_false: Self) -> Self {
        if mask { if_true } else { if_false }
    }
    fn all(mask: bool) -> bool {
        mask
    }
}
