//! The counting number and its arithmetic, with the rounding error of each operation.

use super::{Kind, tally};
use crate::scalar::number::Scalar;
use crate::scalar::tanh::real_tanh_and_slope;
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

/// A value that counts the operations done with it, see [`count`](super::count).
///
/// It knows whether it is a constant: a number of the model, or a result of constants only. A variable with
/// the value 0 is not a constant, so that counts do not depend on the state. It implements num-dual's traits:
/// dual and hyper-dual numbers over it count the operations of those over `f64`.
///
/// # Rounding
/// It also carries the variance of its rounding error, to first order and in units of u^2, u = 2^-53. This is
/// the model of probabilistic error analysis (Hull and Swenson 1966; Higham and Mary 2019): every operation
/// makes an error of its own, of the size `u |result|`, and all of them are independent. Then variances add,
/// and an error that a later operation multiplies by c has its variance multiplied by c^2:
///
/// ```text
/// var(a + b) = var a + var b + (a + b)^2      var(a b) = b^2 var a + a^2 var b + (a b)^2
/// var f(a) = f'(a)^2 var a + f(a)^2
/// ```
///
/// What is exact in floating-point arithmetic makes no error: sums with 0, products with 0 and with 1/2, 1, 2
/// and their negatives. A 0 that rounded terms leave is not exact. A rotation keeps variances: they do not
/// grow from joint to joint as sums of absolute values do.
#[derive(Clone, Copy, Debug)]
pub struct Count {
    pub(super) value: f64,
    /// Of the rounding error, in units of u^2.
    pub(super) variance: f64,
    pub(super) constant: bool,
}

impl Count {
    /// A variable without error: its operations count regardless of its value.
    pub fn variable(value: f64) -> Self {
        Self { value, variance: 0.0, constant: false }
    }

    /// A variable that was rounded once: its error has the standard deviation `u |value|`.
    pub fn rounded(value: f64) -> Self {
        Self { value, variance: value * value, constant: false }
    }

    /// The value.
    pub fn value(self) -> f64 {
        self.value
    }

    /// Whether it is known without any input.
    pub fn is_constant(self) -> bool {
        self.constant
    }

    /// Standard deviation of the rounding error, in units of u = 2^-53; not-a-number after a function whose
    /// slope is not known here (the pipeline has none).
    ///
    /// ```
    /// use costate::scalar::{Count, Scalar};
    /// let x = Count::variable(3.0);
    /// let sum = x * x + x.times(-9.0); // 9 and 27 are rounded, -9 as well; 9 - 27 once more
    /// assert_eq!(sum.rounding(), (9.0_f64.powi(2) + 2.0 * 27.0_f64.powi(2) + 18.0_f64.powi(2)).sqrt());
    /// ```
    pub fn rounding(self) -> f64 {
        self.variance.sqrt()
    }

    pub(super) fn constant(value: f64) -> Self {
        Self { value, variance: 0.0, constant: true }
    }

    /// A constant of the model, which was rounded itself: other methods start from other constants.
    pub(super) fn model(value: f64) -> Self {
        let exact = value == 0.0 || is_power(value);
        Self { value, variance: if exact { 0.0 } else { value * value }, constant: true }
    }

    fn is(self, value: f64) -> bool {
        self.constant && self.value == value
    }

    /// Whether the result of a product with it is known beforehand.
    fn is_trivial_factor(self) -> bool {
        self.is(0.0) || self.is(1.0) || self.is(-1.0)
    }

    /// A function of this number alone, by its value and slope.
    pub(super) fn function(self, value: f64, slope: f64, kind: Kind) -> Self {
        tally(self.constant, kind);
        self.through(value, slope)
    }

    /// As [`function`](Self::function), not counted.
    fn through(self, value: f64, slope: f64) -> Self {
        Self { value, variance: slope * slope * self.variance + value * value, constant: self.constant }
    }

    fn product(self, other: Self, constant: bool) -> Self {
        let (a, b) = (self.value, other.value);
        let own = if self.is_exact_power() || other.is_exact_power() { 0.0 } else { (a * b).powi(2) };
        Self { value: a * b, variance: b * b * self.variance + a * a * other.variance + own, constant }
    }

    /// Part of the variance of the product that is due to this factor, if it is a constant 0: one that was
    /// rounded (`c - c` of rounded c) passes its error on.
    fn variance_of_zero_times(self, other: Self) -> f64 {
        if self.is(0.0) && self.variance != 0.0 { other.value * other.value * self.variance } else { 0.0 }
    }

    /// Whether it is 0, without error.
    fn is_exactly_zero(self) -> bool {
        self.value == 0.0 && self.variance == 0.0
    }

    /// Whether products with it are exact.
    fn is_exact_power(self) -> bool {
        self.variance == 0.0 && is_power(self.value)
    }
}

/// Whether it is one of those powers of two, or their negatives, that formulas contain.
fn is_power(value: f64) -> bool {
    matches!(value.abs(), 0.5 | 1.0 | 2.0)
}

impl Add for Count {
    type Output = Self;
    #[inline(never)]
    fn add(self, other: Self) -> Self {
        let constant = self.constant && other.constant;
        tally(constant || self.is(0.0) || other.is(0.0), Kind::Add);
        let value = self.value + other.value;
        let exact = self.is_exactly_zero() || other.is_exactly_zero();
        let own = if exact { 0.0 } else { value * value };
        Self { value, variance: self.variance + other.variance + own, constant }
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
        tally(constant || self.is_trivial_factor() || other.is_trivial_factor(), Kind::Mul);
        if self.is(0.0) || other.is(0.0) {
            let variance = self.variance_of_zero_times(other) + other.variance_of_zero_times(self);
            return Self { value: 0.0, variance, constant: true };
        }
        self.product(other, constant)
    }
}

impl Div for Count {
    type Output = Self;
    #[inline(never)]
    fn div(self, other: Self) -> Self {
        let constant = self.constant && other.constant;
        let free = constant || self.is(0.0) || other.is(1.0) || other.is(-1.0);
        if other.constant && !free && super::folds() {
            tally(false, Kind::Mul);
        } else {
            tally(free, Kind::Div);
        }
        if self.is(0.0) && self.variance == 0.0 {
            return self;
        }
        let (value, reciprocal) = (self.value / other.value, 1.0 / other.value);
        let slope = value * reciprocal;
        let own = if other.is_exact_power() { 0.0 } else { value * value };
        let variance = reciprocal * reciprocal * self.variance + slope * slope * other.variance + own;
        Self { value, variance, constant }
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
    const INLINED: bool = false;

    fn from_f64(value: f64) -> Self {
        Self::constant(value)
    }
    fn times(self, factor: f64) -> Self {
        self * Self::model(factor)
    }
    fn plus(self, term: f64) -> Self {
        self + Self::model(term)
    }
    #[inline(never)]
    fn recip(self) -> Self {
        let value = 1.0 / self.value;
        self.function(value, value * value, Kind::Div)
    }
    fn sqrt(self) -> Self {
        let value = self.value.sqrt();
        self.function(value, 0.5 / value, Kind::Sqrt)
    }
    #[inline(never)]
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.value.sin_cos();
        (self.function(sin, cos, Kind::SinCos), self.through(cos, sin))
    }
    fn exp(self) -> Self {
        let value = self.value.exp();
        self.function(value, value, Kind::Exp)
    }
    fn exp_m1(self) -> Self {
        self.function(self.value.exp_m1(), self.value.exp(), Kind::Exp)
    }
    fn tanh_and_slope(self) -> (Self, Self) {
        real_tanh_and_slope(self)
    }
    #[inline(never)]
    fn less(self, other: Self) -> bool {
        tally(self.constant && other.constant, Kind::Less);
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
