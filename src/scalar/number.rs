//! The traits of a scalar and of a pack of scalars.

use std::fmt::Debug;
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

/// A number that robot dynamics can be computed with.
///
/// Implemented for `f64`, `f32`, [`Count`](super::Count), [`Expr`](crate::codegen::Expr) and `Lanes` (feature
/// `wide`: `F64x4`, `F64x8`), for [`Tangent`](super::Tangent) over any scalar, and for num-dual's numbers of
/// static size, each over any scalar that num-dual takes, so that nested ones work too: `Dual`, `Dual2`,
/// `Dual3`, `HyperDual`, `HyperHyperDual`, `DualSVec`, `Dual2SVec`, `HyperDualSVec` (the last three not over
/// `Lanes`). Constants of a model stay `f64` and enter by [`times`](Scalar::times) and
/// [`plus`](Scalar::plus), which cost a dual number much less than an operation between two of them.
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
    /// Outcome of a comparison: one truth value, or one per lane.
    type Mask: Copy;

    /// What handles several of these numbers of one state at once; the type itself where nothing does.
    type Pack: Pack<Self>;

    /// Relative spacing of the numbers at the bottom: the rounding of one operation.
    const EPSILON: f64;

    /// Order of the highest derivatives that the number carries; 0 for one that is a value and nothing else.
    ///
    /// What is iterated to a fixed point (see [`step`](crate::step)) needs it: derivatives converge after the
    /// value.
    const ORDER: usize;

    /// Whether values are checked at the edge of the library (finite input, regular mass matrix).
    ///
    /// `false` for a scalar that only counts or records: what it computes holds for any input.
    const CHECKED: bool = true;

    /// Whether a product costs no more than a sum, and both together no more than one: formulas are then
    /// chosen for few steps one after another, not for few products.
    const FUSED: bool = false;

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

    /// `self * factor + term`, rounded once where the processor that is compiled for does that in one
    /// instruction.
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

    /// `self < other`; false where one of them is not a number.
    fn less(self, other: Self) -> Self::Mask;

    /// `if_true` where the mask holds, `if_false` elsewhere. Both are computed by the caller.
    fn select(mask: Self::Mask, if_true: Self, if_false: Self) -> Self;

    /// Whether the mask holds in every lane.
    ///
    /// For the checks at the edge of the library, never for the choice between two formulas.
    fn all(mask: Self::Mask) -> bool;

    /// Absolute value, by `select`; its derivative at 0 is that of `self`.
    #[inline]
    fn abs(self) -> Self {
        Self::select(self.less(Self::zero()), -self, self)
    }

    /// Hyperbolic tangent `t` and its slope `1 - t^2`, both to full relative accuracy, free of overflow.
    ///
    /// With `m = exp(-2 |x|) - 1` and `e = exp(-2 |x|)`: `|t| = -m / (m + 2)`, slope `4 e / (1 + e)^2`.
    /// Derivatives follow from `t' = 1 - t^2`, so that they too are 0, not rounding, where they should be
    /// (t'' at 0, all at large arguments); num-dual's own tanh = sinh / cosh is not a number beyond 710.
    fn tanh_and_slope(self) -> (Self, Self);

    /// Hyperbolic tangent, see [`tanh_and_slope`](Scalar::tanh_and_slope).
    #[inline]
    fn tanh(self) -> Self {
        self.tanh_and_slope().0
    }

    /// Whether the value is neither infinite nor not-a-number (in every lane; derivatives are not looked at).
    #[inline]
    fn is_finite(self) -> bool {
        let limit = Self::from_f64(f64::INFINITY);
        Self::all(self.less(limit)) && Self::all((-limit).less(self))
    }
}

/// A vector of numbers of type S whose operations work on all of its lanes.
///
/// What the pipeline does in the same way for many joints it does for [`LANES`](Pack::LANES) of them at once:
/// with `f64`, four where the feature `wide` is on. Every scalar is a pack of itself, of one lane.
pub trait Pack<S>: Scalar {
    /// Number of lanes.
    const LANES: usize;

    /// The same number in every lane.
    fn splat(value: S) -> Self;

    /// The number in lane `k`.
    fn lane(&self, k: usize) -> S;

    /// The same with another number in lane `k`.
    #[must_use]
    fn with_lane(self, k: usize, value: S) -> Self;

    /// Puts a number into lane `k`, in memory: what reads the whole pack next waits for it.
    fn set_lane(&mut self, k: usize, value: S);

    /// Puts the lanes one after the other into `to`, as many as it has places.
    fn write(&self, to: &mut [S]);

    /// From as many numbers as there are lanes, or fewer; the lanes left over are zero.
    fn read(from: &[S]) -> Self;

    /// Transposes a square block: as many packs as there are lanes.
    fn transpose(block: &mut [Self]);
}
