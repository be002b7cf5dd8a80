//! Sine and cosine of all lanes at once, by the source that generated Rust code contains.

use super::Vector;

#[path = "../../codegen/emit/runtime/sin_cos.rs"]
mod runtime;

use runtime::{Angle, sin_cos_in_range};

/// Largest angle (rad) that is reduced here, as in generated code.
const LARGEST: f64 = 1e5;

/// Sine and cosine to two units in the last place, for any angle (rad).
#[inline]
pub(super) fn sin_cos<V: Vector>(x: V) -> (V, V) {
    let limit = <V as Vector>::splat(LARGEST);
    if !V::all(V::less(x, limit) & V::less(-x, limit)) {
        return one_by_one(x);
    }
    // The sign apart, so that the sine of -0 is -0.
    let negative = x & <V as Vector>::splat(-0.0);
    let (sin, cos) = sin_cos_in_range(x ^ negative);
    (sin ^ negative, cos)
}

/// Lane by lane, by the standard library.
#[cold]
#[inline(never)]
fn one_by_one<V: Vector>(x: V) -> (V, V) {
    let (mut sin, mut cos) = (x, x);
    let lanes = sin.as_mut_slice().iter_mut().zip(cos.as_mut_slice());
    lanes.for_each(|(sin, cos)| (*sin, *cos) = cos.sin_cos());
    (sin, cos)
}

impl<V: Vector> Angle for V {
    #[inline(always)]
    fn splat(value: f64) -> Self {
        <V as Vector>::splat(value)
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, term: Self) -> Self {
        Vector::mul_add(self, factor, term)
    }
    /// The bit beside the exponent of 1 is a number above 1.
    #[inline(always)]
    fn has_bit(self, bit: u64) -> Self {
        let one = <V as Vector>::splat(1.0);
        V::less(one, (self & <V as Vector>::splat(f64::from_bits(bit))) | one)
    }
    #[inline(always)]
    fn select(mask: Self, if_true: Self, if_false: Self) -> Self {
        <V as Vector>::select(mask, if_true, if_false)
    }
    #[inline(always)]
    fn negate(self, mask: Self, other: Self) -> Self {
        self ^ ((mask ^ other) & <V as Vector>::splat(-0.0))
    }
}
