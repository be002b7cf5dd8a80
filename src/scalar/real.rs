//! `f64` and `f32`.

use super::number::Scalar;
use super::tanh::real_tanh_and_slope;

macro_rules! impl_scalar_for_float {
    ($float:ident, $pack:ty) => {
        impl Scalar for $float {
            type Mask = bool;
            type Pack = $pack;
            const EPSILON: f64 = $float::EPSILON as f64;
            const ORDER: usize = 0;
            const FUSED: bool = true;

            #[inline]
            fn from_f64(value: f64) -> Self {
                value as $float
            }
            #[inline]
            fn times(self, factor: f64) -> Self {
                self * factor as $float
            }
            #[inline]
            fn plus(self, term: f64) -> Self {
                self + term as $float
            }
            #[inline(always)]
            fn mul_add(self, factor: Self, term: Self) -> Self {
                if cfg!(any(target_feature = "fma", target_arch = "aarch64")) {
                    $float::mul_add(self, factor, term)
                } else {
                    self * factor + term
                }
            }
            #[inline(always)]
            fn plus_times(self, term: Self, factor: f64) -> Self {
                Scalar::mul_add(term, factor as $float, self)
            }
            #[inline]
            fn recip(self) -> Self {
                $float::recip(self)
            }
            #[inline]
            fn sqrt(self) -> Self {
                $float::sqrt(self)
            }
            #[inline]
            fn sin_cos(self) -> (Self, Self) {
                $float::sin_cos(self)
            }
            #[inline]
            fn exp(self) -> Self {
                $float::exp(self)
            }
            #[inline]
            fn exp_m1(self) -> Self {
                $float::exp_m1(self)
            }
            #[inline]
            fn tanh_and_slope(self) -> (Self, Self) {
                real_tanh_and_slope(self)
            }
            #[inline]
            fn less(self, other: Self) -> bool {
                self < other
            }
            #[inline]
            fn select(mask: bool, if_true: Self, if_false: Self) -> Self {
                if mask { if_true } else { if_false }
            }
            #[inline]
            fn all(mask: bool) -> bool {
                mask
            }
        }
    };
}

#[cfg(feature = "wide")]
impl_scalar_for_float!(f64, super::F64x4);
#[cfg(not(feature = "wide"))]
impl_scalar_for_float!(f64, f64);
impl_scalar_for_float!(f32, f32);
