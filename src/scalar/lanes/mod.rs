//! Several states at once: every operation works on all lanes of a vector.

mod dual_num;
mod operators;
mod sin_cos;
#[cfg(test)]
mod tests;
mod vector;

pub use vector::Vector;

use super::number::Scalar;
use super::tanh::real_tanh_and_slope;

/// One `f64` for each of several states, in the lanes of a vector of the crate `wide`.
///
/// The pipeline runs on it unchanged, so that one call computes a quantity at four ([`F64x4`]) or eight
/// ([`F64x8`]) states. Lanes are independent: each holds the `f64` result of its state, within rounding (with
/// fused multiply-add, [`mul_add`](Scalar::mul_add) is fused in both). [`Tangent`](super::Tangent) and
/// num-dual's `Dual`, `Dual2`, `Dual3`, `HyperDual` and `HyperHyperDual` can have lanes as components; those
/// with a vector of derivatives select by one truth value and cannot.
///
/// An error concerns all lanes: if one state is not finite, or its mass matrix is singular, the whole call
/// fails. A [`Batch`](crate::batch::Batch) then evaluates the states one by one. In
/// [`sin_cos`](Scalar::sin_cos) one lane beyond 1e5 rad, or NaN, makes all of them use the standard library
/// one by one: equally exact, but slower.
///
/// The number of registers depends on the compile target: eight lanes are one register with AVX-512, two with
/// AVX, four with SSE2. Compile with `-C target-cpu=native` for the local processor.
///
/// ```
/// use costate::scalar::{F64x4, Scalar};
/// let angle = F64x4::from_lanes(&[0.0, 0.5, 1.0, f64::NAN]);
/// let (sin, cos) = angle.sin_cos();
/// let one = sin * sin + cos * cos;
/// assert!((one.lane(2) - 1.0).abs() < 1e-15 && one.lane(3).is_nan());
/// assert_eq!(F64x4::select(angle.less(F64x4::one()), angle, -angle).lane(1), 0.5);
/// ```
#[derive(Clone, Copy, Debug)]
#[repr(transparent)]
pub struct Lanes<V>(V);

/// Four states at once.
pub type F64x4 = Lanes<wide::f64x4>;

/// Eight states at once.
pub type F64x8 = Lanes<wide::f64x8>;

/// Truth values, one per lane.
#[derive(Clone, Copy, Debug)]
#[repr(transparent)]
pub struct LaneMask<V>(V);

impl<V: Vector> LaneMask<V> {
    /// Whether lane `k` is true.
    pub fn lane(&self, k: usize) -> bool {
        self.0.as_slice()[k].to_bits() != 0
    }
}

impl<V: Vector> Lanes<V> {
    /// From a vector of `wide`.
    #[inline(always)]
    pub fn new(vector: V) -> Self {
        Self(vector)
    }

    /// The vector.
    #[inline(always)]
    pub fn vector(self) -> V {
        self.0
    }

    /// From up to as many values as there are lanes; the remaining lanes repeat the last value, and are zero
    /// if there is none.
    #[inline]
    pub fn from_lanes(values: &[f64]) -> Self {
        let mut lanes = Self(V::splat(values.last().copied().unwrap_or(0.0)));
        lanes.0.as_mut_slice().iter_mut().zip(values).for_each(|(lane, &value)| *lane = value);
        lanes
    }

    /// The value in lane `k`.
    #[inline(always)]
    pub fn lane(&self, k: usize) -> f64 {
        self.0.as_slice()[k]
    }

    /// The values by lane.
    #[inline(always)]
    pub fn as_slice(&self) -> &[f64] {
        self.0.as_slice()
    }

    /// The values by lane, mutable.
    #[inline(always)]
    pub fn as_mut_slice(&mut self) -> &mut [f64] {
        self.0.as_mut_slice()
    }

    /// A function of `f64` in every lane.
    #[inline]
    pub fn map(mut self, function: impl Fn(f64) -> f64) -> Self {
        self.0.as_mut_slice().iter_mut().for_each(|lane| *lane = function(*lane));
        self
    }
}

impl<V: Vector> Scalar for Lanes<V> {
    type Mask = LaneMask<V>;
    type Pack = Self;
    const EPSILON: f64 = f64::EPSILON;
    const ORDER: usize = 0;
    const FUSED: bool = true;

    #[inline(always)]
    fn from_f64(value: f64) -> Self {
        Self(V::splat(value))
    }
    #[inline(always)]
    fn times(self, factor: f64) -> Self {
        Self(self.0 * V::splat(factor))
    }
    #[inline(always)]
    fn plus(self, term: f64) -> Self {
        Self(self.0 + V::splat(term))
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        if cfg!(target_feature = "fma") {
            Self(self.0.mul_add(factor.0, term.0))
        } else {
            self * factor + term
        }
    }
    #[inline(always)]
    fn plus_times(self, term: Self, factor: f64) -> Self {
        Scalar::mul_add(term, Self::from_f64(factor), self)
    }
    #[inline(always)]
    fn recip(self) -> Self {
        Self(V::splat(1.0) / self.0)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0.sqrt())
    }
    #[inline]
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = sin_cos::sin_cos(self.0);
        (Self(sin), Self(cos))
    }
    #[inline]
    fn exp(self) -> Self {
        Self(self.0.exp())
    }
    /// From half of ln 2 to ln 2 by `e^2h - 1 = m (m + 2)`, `m = e^h - 1`, which loses less precision there
    /// than the vector function.
    #[inline]
    fn exp_m1(self) -> Self {
        let size = Scalar::abs(self);
        let direct = self.0.exp_m1();
        let m = self.times(0.5).0.exp_m1();
        let by_halves = m * (m + V::splat(2.0));
        let between = V::less(V::splat(0.346), size.0) & V::less(size.0, V::splat(0.69));
        Self(V::select(between, by_halves, direct))
    }
    #[inline]
    fn tanh_and_slope(self) -> (Self, Self) {
        real_tanh_and_slope(self)
    }
    #[inline(always)]
    fn less(self, other: Self) -> LaneMask<V> {
        LaneMask(self.0.less(other.0))
    }
    #[inline(always)]
    fn select(mask: LaneMask<V>, if_true: Self, if_false: Self) -> Self {
        Self(V::select(mask.0, if_true.0, if_false.0))
    }
    #[inline(always)]
    fn all(mask: LaneMask<V>) -> bool {
        V::all(mask.0)
    }
}
