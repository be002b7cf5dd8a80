/// The operations that the function below needs.
#[allow(dead_code, missing_docs)]
pub trait Number:
    Copy
    + core::ops::Add<Output = Self>
    + core::ops::Sub<Output = Self>
    + core::ops::Mul<Output = Self>
    + core::ops::Div<Output = Self>
    + core::ops::Neg<Output = Self>
{
    /// Outcome of a comparison.
    type Mask: Copy;
    fn from_f64(value: f64) -> Self;
    fn times(self, factor: f64) -> Self;
    fn plus(self, term: f64) -> Self;
    fn mul_add(self, factor: Self, term: Self) -> Self;
    fn recip(self) -> Self;
    fn sqrt(self) -> Self;
    fn sin_cos(self) -> (Self, Self);
    fn exp(self) -> Self;
    fn exp_m1(self) -> Self;
    fn less(self, other: Self) -> Self::Mask;
    fn select(mask: Self::Mask, if_true: Self, if_false: Self) -> Self;
}

#[rustfmt::skip]
#[allow(clippy::all, clippy::pedantic)]
impl Number for f64 {
    type Mask = bool;
    #[inline(always)]
    fn from_f64(value: f64) -> Self { value }
    #[inline(always)]
    fn times(self, factor: f64) -> Self { self * factor }
    #[inline(always)]
    fn plus(self, term: f64) -> Self { self + term }
    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        if cfg!(any(target_feature = "fma", target_arch = "aarch64")) {
            f64::mul_add(self, factor, term)
        } else {
            self * factor + term
        }
    }
    #[inline(always)]
    fn recip(self) -> Self { 1.0 / self }
    #[inline(always)]
    fn sqrt(self) -> Self { f64::sqrt(self) }
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        #[cold]
        #[inline(never)]
        fn of_library(x: f64) -> (f64, f64) { x.sin_cos() }
        if self.abs() < 1e5 { sin_cos_in_range(self) } else { of_library(self) }
    }
    #[inline(always)]
    fn exp(self) -> Self { f64::exp(self) }
    #[inline(always)]
    fn exp_m1(self) -> Self { f64::exp_m1(self) }
    #[inline(always)]
    fn less(self, other: Self) -> bool { self < other }
    #[inline(always)]
    fn select(mask: bool, if_true: Self, if_false: Self) -> Self { if mask { if_true } else { if_false } }
}

#[rustfmt::skip]
#[allow(clippy::all, clippy::pedantic)]
impl Angle for f64 {
    #[inline(always)]
    fn splat(value: f64) -> Self { value }
    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self { Number::mul_add(self, factor, term) }
    #[inline(always)]
    fn has_bit(self, bit: u64) -> Self { f64::from_bits((self.to_bits() / bit & 1).wrapping_neg()) }
    #[inline(always)]
    fn select(mask: Self, if_true: Self, if_false: Self) -> Self {
        let (mask, a, b) = (mask.to_bits(), if_true.to_bits(), if_false.to_bits());
        f64::from_bits(b ^ ((a ^ b) & mask))
    }
    #[inline(always)]
    fn negate(self, mask: Self, other: Self) -> Self {
        f64::from_bits(self.to_bits() ^ ((mask.to_bits() ^ other.to_bits()) & (1 << 63)))
    }
}

