//! The traits of a scalar and of a pack of scalars.

use std::fmt::Debug;
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

/// A number type for robot dynamics.
///
/// Implemented for `f64`, `f32`, [`Count`](super::Count), [`Expr`](crate::codegen::Expr) and `Lanes` (feature
/// `wide`: `F64x4`, `F64x8`), for [`Tangent`](super::Tangent) over any scalar, and for num-dual's numbers of
/// static size, each over any scalar that implements num-dual's traits, so that they can be nested: `Dual`,
/// `Dual2`, `Dual3`, `HyperDual`, `HyperHyperDual`, `DualSVec`, `Dual2SVec`, `HyperDualSVec` (the last three
/// not over `Lanes`). Model constants stay `f64` and enter by [`times`](Scalar::times) and
/// [`plus`](Scalar::plus), which are much cheaper for a dual number than operations between two of them.
///
/// ```
/// use costate::scalar::Scalar;
/// use num_dual::Dual64;
///
/// fn energy<S: Scalar>(angle: S, rate: S) -> S {
///     let (_, cos) = angle.sin_cos();
///     (rate * rate).times(0.5) - cos.times(9.81)
/// }
/// let e = energy(Dual64::from_re(0.3).derivative(), Dual64::from_re(2.0));
/// assert_eq!(e.re, energy(0.3, 2.0));
/// assert!((e.eps - 9.81 * 0.3_f64.sin()).abs() < 1e-15);
/// ```
pub trait Scalar:
    Copy
    + Debug
    + Send
    + Sync
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
    + 'static
{
    /// Result of a comparison: one truth value, or one per lane.
    type Mask: Copy;

    /// A vector of several of these numbers of one state; the type itself if there is none.
    type Pack: Pack<Self>;

    /// Machine epsilon of the base precision.
    const EPSILON: f64;

    /// Order of the highest derivatives that the number carries; 0 for a plain value.
    ///
    /// Fixed-point iterations (see [`step`](crate::step)) need it: derivatives converge after the value.
    const ORDER: usize;

    /// Whether the library checks values at its interface (finite input, regular mass matrix).
    ///
    /// `false` for a scalar that only counts or records, whose result holds for any input.
    const CHECKED: bool = true;

    /// Whether operations with constants are free, as for a scalar that records the operations of one robot:
    /// algorithms are then chosen for entries that are zero.
    const FOLDED: bool = false;

    /// Whether multiply-add is a single cheap instruction: formulas are then chosen for short dependency
    /// chains, not for few products.
    const FUSED: bool = false;

    /// Whether operations are a few instructions. If so, the small functions of the pipeline, and sums and
    /// products of a [`Tangent`](super::Tangent), are inlined; if not, they are calls, which compile much
    /// faster.
    const INLINED: bool = true;

    /// The constant `value`, with derivatives zero.
    fn from_f64(value: f64) -> Self;

    /// The constant 0.
    #[inline]
    fn zero() -> Self {
        Self::from_f64(0.0)
    }

    /// The constant 1.
    #[inline]
    fn one() -> Self {
        Self::from_f64(1.0)
    }

    /// `factor * self` for a constant.
    fn times(self, factor: f64) -> Self;

    /// `self + term` for a constant.
    fn plus(self, term: f64) -> Self;

    /// `self * factor + term`, rounded once if the target processor has a fused instruction.
    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        self * factor + term
    }

    /// `self + term * factor` for a constant factor, rounded as [`mul_add`](Scalar::mul_add) is.
    #[inline(always)]
    fn plus_times(self, term: Self, factor: f64) -> Self {
        self + term.times(factor)
    }

    /// `1 / self`.
    fn recip(self) -> Self;

    /// Square root.
    fn sqrt(self) -> Self;

    /// Sine and cosine, in this order.
    fn sin_cos(self) -> (Self, Self);

    /// Exponential function.
    fn exp(self) -> Self;

    /// `exp(self) - 1` without cancellation near 0.
    fn exp_m1(self) -> Self;

    /// `self < other`; false if one of them is NaN.
    fn less(self, other: Self) -> Self::Mask;

    /// `if_true` where the mask is true, else `if_false`. The caller computes both.
    fn select(mask: Self::Mask, if_true: Self, if_false: Self) -> Self;

    /// Whether the mask is true in every lane.
    ///
    /// For checks at the interface of the library, never to choose between two formulas.
    fn all(mask: Self::Mask) -> bool;

    /// Absolute value, by `select`; its derivative at 0 is that of `self`.
    #[inline]
    fn abs(self) -> Self {
        Self::select(self.less(Self::zero()), -self, self)
    }

    /// Hyperbolic tangent `t` and its slope `1 - t^2`, both to full relative accuracy, free of overflow.
    ///
    /// With `m = exp(-2 |x|) - 1` and `e = exp(-2 |x|)`: `|t| = -m / (m + 2)`, slope `4 e / (1 + e)^2`.
    /// Derivatives follow from `t' = 1 - t^2`, so that they are exactly 0 where they should be (t'' at 0, all
    /// at large arguments). num-dual's own tanh = sinh / cosh is NaN beyond 710.
    fn tanh_and_slope(self) -> (Self, Self);

    /// Hyperbolic tangent, see [`tanh_and_slope`](Scalar::tanh_and_slope).
    #[inline]
    fn tanh(self) -> Self {
        self.tanh_and_slope().0
    }

    /// Whether the value is finite in every lane; derivatives are not checked.
    #[inline]
    fn is_finite(self) -> bool {
        let limit = Self::from_f64(f64::INFINITY);
        Self::all(self.less(limit)) && Self::all((-limit).less(self))
    }
}

/// A vector of numbers of type S whose operations work on all of its lanes.
///
/// The pipeline processes [`LANES`](Pack::LANES) joints at once: four for `f64` with the feature `wide`.
/// Every scalar is a pack of itself with one lane.
pub trait Pack<S>: Scalar {
    /// As many packs side by side as fit into a register.
    type Wide: Scalar;

    /// Number of lanes.
    const LANES: usize;

    /// Number of packs in a [`Wide`](Pack::Wide).
    const WIDTH: usize;

    /// The same value in every lane.
    fn splat(value: S) -> Self;

    /// The value in lane `k`.
    fn lane(&self, k: usize) -> S;

    /// A copy with another value in lane `k`.
    #[must_use]
    fn with_lane(self, k: usize, value: S) -> Self;

    /// Sets lane `k` in memory; reading the whole pack right afterwards stalls.
    fn set_lane(&mut self, k: usize, value: S);

    /// Lanes before `k` of `self`, the others of `other`.
    #[must_use]
    fn before(self, k: usize, other: Self) -> Self;

    /// Writes the lanes to `to`, as many as fit.
    fn write(&self, to: &mut [S]);

    /// Reads up to as many values as there are lanes; the remaining lanes are zero.
    fn read(from: &[S]) -> Self;

    /// Transposes a square block: as many packs as there are lanes.
    fn transpose(block: &mut [Self]);

    /// The same value in every lane.
    fn splat_wide(value: S) -> Self::Wide;

    /// The first [`WIDTH`](Pack::WIDTH) packs side by side.
    fn join(packs: &[Self]) -> Self::Wide;

    /// The packs of a [`Wide`](Pack::Wide), one by one.
    fn split(wide: Self::Wide, packs: &mut [Self]);
}
