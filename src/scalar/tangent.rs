//! A value with one directional derivative, over any scalar.

use super::inlined::inlined;
use super::number::Scalar;
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

/// `re + eps d`, `d^2 = 0`: a dual number over any scalar.
///
/// The pipeline differentiates with it internally, for every scalar. (num-dual's numbers need components that
/// compare and print like a float, which counting, recording and vector scalars do not.) As in num-dual, a
/// quotient is a product with the reciprocal.
#[derive(Clone, Copy, Debug)]
pub struct Tangent<S> {
    /// Value.
    pub re: S,
    /// Derivative.
    pub eps: S,
}

impl<S: Scalar> Tangent<S> {
    /// A number with this value and derivative.
    #[inline(always)]
    pub fn new(re: S, eps: S) -> Self {
        Self { re, eps }
    }
}

impl<S: Scalar> Add for Tangent<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        inlined!(S, Self::new(self.re + other.re, self.eps + other.eps))
    }
}

impl<S: Scalar> Sub for Tangent<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        inlined!(S, Self::new(self.re - other.re, self.eps - other.eps))
    }
}

impl<S: Scalar> Neg for Tangent<S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(-self.re, -self.eps)
    }
}

impl<S: Scalar> Mul for Tangent<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        inlined!(S, Self::new(self.re * other.re, self.eps * other.re + self.re * other.eps))
    }
}

impl<S: Scalar> Div for Tangent<S> {
    type Output = Self;
    #[inline(always)]
    #[expect(clippy::suspicious_arithmetic_impl, reason = "a quotient is a product with the reciprocal")]
    fn div(self, other: Self) -> Self {
        self * other.recip()
    }
}

impl<S: Scalar> AddAssign for Tangent<S> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<S: Scalar> SubAssign for Tangent<S> {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl<S: Scalar> MulAssign for Tangent<S> {
    #[inline(always)]
    fn mul_assign(&mut self, other: Self) {
        *self = *self * other;
    }
}

impl<S: Scalar> Scalar for Tangent<S> {
    type Mask = S::Mask;
    type Pack = Self;
    const EPSILON: f64 = S::EPSILON;
    const ORDER: usize = S::ORDER + 1;
    const CHECKED: bool = S::CHECKED;
    const FOLDED: bool = S::FOLDED;
    const INLINED: bool = S::INLINED;

    #[inline(always)]
    fn from_f64(value: f64) -> Self {
        Self::new(S::from_f64(value), S::zero())
    }
    #[inline(always)]
    fn times(self, factor: f64) -> Self {
        Self::new(self.re.times(factor), self.eps.times(factor))
    }
    #[inline(always)]
    fn plus(self, term: f64) -> Self {
        Self::new(self.re.plus(term), self.eps)
    }
    /// `(1/x)' = -x' / x^2`.
    #[inline]
    fn recip(self) -> Self {
        let inverse = self.re.recip();
        Self::new(inverse, -(self.eps * inverse * inverse))
    }
    /// `sqrt(x)' = x' / (2 sqrt(x))`.
    #[inline]
    fn sqrt(self) -> Self {
        let root = self.re.sqrt();
        Self::new(root, (self.eps * root.recip()).times(0.5))
    }
    #[inline]
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.re.sin_cos();
        (Self::new(sin, self.eps * cos), Self::new(cos, -(self.eps * sin)))
    }
    #[inline]
    fn exp(self) -> Self {
        let value = self.re.exp();
        Self::new(value, self.eps * value)
    }
    #[inline]
    fn exp_m1(self) -> Self {
        Self::new(self.re.exp_m1(), self.eps * self.re.exp())
    }
    /// With slope s: `t' = s x'`, `s' = -2 t s x'`.
    #[inline]
    fn tanh_and_slope(self) -> (Self, Self) {
        let (t, slope) = self.re.tanh_and_slope();
        let along = self.eps * slope;
        (Self::new(t, along), Self::new(slope, (t * along).times(-2.0)))
    }
    #[inline]
    fn less(self, other: Self) -> S::Mask {
        self.re.less(other.re)
    }
    #[inline]
    fn select(mask: S::Mask, if_true: Self, if_false: Self) -> Self {
        Self::new(S::select(mask, if_true.re, if_false.re), S::select(mask, if_true.eps, if_false.eps))
    }
    #[inline]
    fn all(mask: S::Mask) -> bool {
        S::all(mask)
    }
}

#[cfg(test)]
mod tests {
    use super::Tangent;
    use crate::scalar::Scalar;
    use num_dual::Dual64;

    /// All operations of a scalar in one expression.
    fn everything<S: Scalar>(x: S) -> S {
        let (sin, cos) = (x * x).sin_cos();
        let mut sum = sin / cos + x.recip() - x.sqrt() + (-x).exp() * x.exp_m1() + x.times(3.0).plus(1.0);
        let (t, slope) = x.tanh_and_slope();
        sum += t;
        sum -= slope.times(0.3);
        sum *= x.tanh();
        S::select(x.less(S::one()), sum, sum.abs())
    }

    #[test]
    fn agrees_with_num_dual() {
        for x in [0.3, 0.9, 1.7, 30.0] {
            let (ours, theirs) = (everything(Tangent::new(x, 0.7)), everything(Dual64::new(x, 0.7)));
            assert!((ours.re - theirs.re).abs() <= 1e-15 * theirs.re.abs().max(1.0));
            assert!(
                (ours.eps - theirs.eps).abs() <= 1e-14 * theirs.eps.abs().max(1.0),
                "{x}: {ours:?} {theirs}"
            );
        }
    }
}
