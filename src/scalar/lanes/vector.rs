//! The primitive operations of a vector of `wide`.

use std::fmt::Debug;
use std::ops::{Add, BitAnd, BitOr, BitXor, Div, Mul, Neg, Sub};

/// A SIMD vector of `f64`; implemented for `wide::f64x4` and `wide::f64x8`.
///
/// Masks are vectors too: all bits of a lane set, or none.
pub trait Vector:
    sealed::Sealed
    + Copy
    + Debug
    + Send
    + Sync
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + BitAnd<Output = Self>
    + BitOr<Output = Self>
    + BitXor<Output = Self>
    + 'static
{
    /// Number of lanes.
    const LANES: usize;

    /// The same value in every lane.
    fn splat(value: f64) -> Self;

    /// The values by lane.
    fn as_slice(&self) -> &[f64];

    /// The values by lane, mutable.
    fn as_mut_slice(&mut self) -> &mut [f64];

    /// `self * factor + term`, rounded once if the target has the instruction.
    fn mul_add(self, factor: Self, term: Self) -> Self;

    /// Square root.
    fn sqrt(self) -> Self;

    /// `e^x` to one unit in the last place.
    fn exp(self) -> Self;

    /// `e^x - 1`: to one unit in the last place up to half of ln 2, to six beyond.
    fn exp_m1(self) -> Self;

    /// Mask of `self < other`; false if one of them is NaN.
    fn less(self, other: Self) -> Self;

    /// `if_true` where the mask holds, `if_false` elsewhere.
    fn select(mask: Self, if_true: Self, if_false: Self) -> Self;

    /// Whether the mask is true in every lane.
    fn all(mask: Self) -> bool;
}

mod sealed {
    /// Restricts [`Vector`](super::Vector) to the two supported types.
    pub trait Sealed {}
    impl Sealed for wide::f64x4 {}
    impl Sealed for wide::f64x8 {}
}

macro_rules! impl_vector {
    ($vector:ty, $lanes:literal) => {
        impl Vector for $vector {
            const LANES: usize = $lanes;

            #[inline(always)]
            fn splat(value: f64) -> Self {
                <$vector>::splat(value)
            }
            #[inline(always)]
            fn as_slice(&self) -> &[f64] {
                self.as_array()
            }
            #[inline(always)]
            fn as_mut_slice(&mut self) -> &mut [f64] {
                self.as_mut_array()
            }
            #[inline(always)]
            fn mul_add(self, factor: Self, term: Self) -> Self {
                <$vector>::mul_add(self, factor, term)
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                <$vector>::sqrt(self)
            }
            #[inline]
            fn exp(self) -> Self {
                <$vector>::exp(self)
            }
            #[inline]
            fn exp_m1(self) -> Self {
                <$vector>::exp_m1(self)
            }
            #[inline(always)]
            fn less(self, other: Self) -> Self {
                self.simd_lt(other)
            }
            #[inline(always)]
            fn select(mask: Self, if_true: Self, if_false: Self) -> Self {
                mask.select(if_true, if_false)
            }
            #[inline(always)]
            fn all(mask: Self) -> bool {
                <$vector>::all(mask)
            }
        }
    };
}

impl_vector!(wide::f64x4, 4);
impl_vector!(wide::f64x8, 8);
