//! The scalar type that the whole pipeline is generic over.
//!
//! Every formula of the library is written once, for any [`Scalar`]: `f64` and `f32` compute values, num-dual's
//! numbers carry derivatives through the same code, [`Count`] counts what the code does, `Lanes` (feature `wide`) computes
//! several states at once. A scalar offers ring
//! operations, a division, a few functions, and comparison only in the form [`less`](Scalar::less) /
//! [`select`](Scalar::select): generic code cannot branch on a value, so every scalar walks the same path.

mod count;
mod dual;
mod dual_num;
#[cfg(feature = "wide")]
mod lanes;
mod pack;
mod real;
mod tangent;

pub use count::{Constants, Count, Operations, count, count_with};
#[cfg(feature = "wide")]
pub use lanes::{F64x4, F64x8, LaneMask, Lanes, Vector};
pub(crate) use pack::MOST_LANES;
pub use pack::Pack;
pub use tangent::Tangent;

use std::fmt::Debug;
use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

/// A number that robot dynamics can be computed with.
///
/// Implemented for `f64`, `f32`, [`Count`], [`Expr`](crate::codegen::Expr) and `Lanes` (feature `wide`: `F64x4`, `F64x8`), for
/// [`Tangent`] over any scalar, and for num-dual's numbers of static size, each over any scalar that num-dual takes, so that
/// nested ones work too: `Dual`, `Dual2`, `Dual3`, `HyperDual`, `HyperHyperDual`, `DualSVec`, `Dual2SVec`, `HyperDualSVec` (the
/// last three not over `Lanes`). Constants of a model stay `f64` and enter by [`times`](Scalar::times) and
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
    /// What is iterated to a fixed point (see [`step`](crate::step)) needs it: derivatives converge after the value.
    const ORDER: usize;

    /// Whether values are checked at the edge of the library (finite input, regular mass matrix).
    ///
    /// `false` for a scalar that only counts or records: what it computes holds for any input.
    const CHECKED: bool = true;

    /// Whether a product costs no more than a sum, and both together no more than one: formulas are then chosen for few steps one
    /// after another, not for few products.
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

    /// `self * factor + term`, rounded once where the processor that is compiled for does that in one instruction.
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
    /// With `m = exp(-2 |x|) - 1` and `e = exp(-2 |x|)`: `|t| = -m / (m + 2)`, slope `4 e / (1 + e)^2`. Derivatives
    /// follow from `t' = 1 - t^2`, so that they too are 0, not rounding, where they should be (t'' at 0, all at large
    /// arguments); num-dual's own tanh = sinh / cosh is not a number beyond 710.
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

/// [`Scalar::tanh_and_slope`] from the exponential functions, for numbers without derivatives.
#[inline]
pub(crate) fn real_tanh_and_slope<S: Scalar>(x: S) -> (S, S) {
    let twice = x.abs().times(-2.0);
    let (m, e) = (twice.exp_m1(), twice.exp());
    let t = -m / m.plus(2.0);
    let root = e.plus(1.0).recip();
    (S::select(x.less(S::zero()), -t, t), (e * root * root).times(4.0))
}

#[cfg(test)]
mod tests {
    use super::{Count, Scalar, Tangent};
    use nalgebra::Const;
    use num_dual::{
        Derivative, Dual, Dual2_64, Dual2SVec64, Dual3_64, Dual64, DualSVec64, HyperDual64, HyperDualSVec64,
        HyperHyperDual64,
    };

    #[test]
    fn tanh_is_accurate_and_free_of_overflow() {
        for x in [1e-300, 1e-12, 1e-3, 0.3, 1.0, 5.0, 19.0, 400.0, 711.0, 1e6, 1e300] {
            for x in [x, -x] {
                let (ours, exact) = (Scalar::tanh(x), f64::tanh(x));
                assert!((ours - exact).abs() <= 4e-16 * exact.abs(), "tanh({x}) = {ours}, not {exact}");
            }
        }
        assert_eq!(Scalar::tanh(0.0), 0.0);
        assert!(Scalar::tanh(f64::NAN).is_nan());
    }

    #[test]
    fn tanh_of_dual_numbers_keeps_its_derivatives() {
        for x in [-800.0, -2.0, 0.0, 0.7, 711.0, 1e8] {
            let t = f64::tanh(x);
            let d1 = 1.0 - t * t;
            let d2 = -2.0 * t * d1;
            let d3 = -2.0 * d1 * (1.0 - 3.0 * t * t);
            let y = Scalar::tanh(Dual3_64::from_re(x).derivative());
            let worst = (y.v1 - d1).abs().max((y.v2 - d2).abs()).max((y.v3 - d3).abs());
            assert!(worst < 2e-15, "derivatives of tanh at {x}: {y}");
            let (_, slope) = Scalar::tanh_and_slope(Dual3_64::from_re(x).derivative());
            let d4 = 8.0 * t * d1 * (2.0 - 3.0 * t * t);
            let worst = (slope.re - d1).abs().max((slope.v1 - d2).abs()).max((slope.v2 - d3).abs());
            assert!(worst.max((slope.v3 - d4).abs()) < 4e-15, "derivatives of the slope at {x}: {slope}");
        }
        assert_eq!(Scalar::tanh(HyperDual64::new(0.0, 0.3, 0.7, 0.0)).eps1eps2, 0.0);
        assert!(
            num_dual::DualNum::tanh(&Dual64::from_re(711.0)).re.is_nan(),
            "num-dual's own tanh overflows"
        );
    }

    #[test]
    fn finite_is_judged_by_the_value() {
        assert!(1e308.is_finite() && !Scalar::is_finite(f64::NAN) && !Scalar::is_finite(f64::NEG_INFINITY));
        assert!(
            Scalar::is_finite(Dual64::from_re(3.0)) && !Scalar::is_finite(Dual64::from_re(f64::INFINITY))
        );
    }

    #[test]
    fn select_takes_the_derivatives_along() {
        let a = HyperDual64::new(1.0, 2.0, 3.0, 4.0);
        let b = HyperDual64::new(5.0, 6.0, 7.0, 8.0);
        let smaller = Scalar::select(b.less(a), b, a);
        assert_eq!((smaller.eps1, smaller.eps2, smaller.eps1eps2), (2.0, 3.0, 4.0));
        let x = DualSVec64::<2>::from_re(-3.0).derivative(1);
        assert_eq!(Scalar::abs(x).eps.0.unwrap()[1], -1.0);
    }

    /// With value 0 and all derivatives 1, the power `ORDER` is the last that is not zero.
    #[test]
    fn the_order_is_that_of_the_last_power_of_an_infinitesimal() {
        fn is_last<S: Scalar>(x: S, parts: impl Fn(S) -> Vec<f64>) {
            let power = (0..S::ORDER).fold(S::one(), |power, _| power * x);
            assert!(parts(power).iter().any(|part| *part != 0.0), "order {} is too high", S::ORDER);
            assert!(parts(power * x).iter().all(|part| *part == 0.0), "order {} is too low", S::ORDER);
        }
        fn all<const M: usize, const N: usize>(
            part: Derivative<f64, Const<M>, Const<N>>,
        ) -> impl Iterator<Item = f64> {
            part.0.into_iter().flat_map(|entries| entries.iter().copied().collect::<Vec<_>>())
        }
        let ones = || nalgebra::Vector2::repeat(1.0);
        is_last(0.0_f64, |x| vec![x]);
        is_last(0.0_f32, |x| vec![f64::from(x)]);
        is_last(Count::variable(0.0), |x| vec![x.value()]);
        is_last(Tangent::new(0.0, 1.0), |x| vec![x.re, x.eps]);
        #[cfg(feature = "wide")]
        is_last(super::F64x4::zero(), |x| x.as_slice().to_vec());
        is_last(Dual64::new(0.0, 1.0), |x| vec![x.re, x.eps]);
        is_last(Dual2_64::new(0.0, 1.0, 1.0), |x| vec![x.re, x.v1, x.v2]);
        is_last(Dual3_64::new(0.0, 1.0, 1.0, 1.0), |x| vec![x.re, x.v1, x.v2, x.v3]);
        is_last(HyperDual64::new(0.0, 1.0, 1.0, 1.0), |x| vec![x.re, x.eps1, x.eps2, x.eps1eps2]);
        is_last(HyperHyperDual64::new(0.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0), |x| {
            vec![x.re, x.eps1, x.eps2, x.eps3, x.eps1eps2, x.eps1eps3, x.eps2eps3, x.eps1eps2eps3]
        });
        is_last(DualSVec64::new(0.0, Derivative::some(ones())), |x| all(x.eps).chain([x.re]).collect());
        let v2 = Derivative::some(nalgebra::Matrix2::repeat(1.0));
        let x = Dual2SVec64::new(0.0, Derivative::some(ones().transpose()), v2);
        is_last(x, |x| all(x.v1).chain(all(x.v2)).chain([x.re]).collect());
        let x = HyperDualSVec64::new(0.0, Derivative::some(ones()), Derivative::some(ones().transpose()), v2);
        is_last(x, |x| all(x.eps1).chain(all(x.eps2)).chain(all(x.eps1eps2)).chain([x.re]).collect());
        let nested = Dual::new(HyperDual64::new(0.0, 1.0, 1.0, 1.0), HyperDual64::new(1.0, 1.0, 1.0, 1.0));
        is_last(nested, |x| {
            [x.re, x.eps].iter().flat_map(|part| [part.re, part.eps1, part.eps2, part.eps1eps2]).collect()
        });
        let nested = Tangent::new(Tangent::new(0.0, 1.0), Tangent::new(1.0, 1.0));
        is_last(nested, |x| vec![x.re.re, x.re.eps, x.eps.re, x.eps.eps]);
    }
}
