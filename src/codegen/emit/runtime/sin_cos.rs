/// What sine and cosine are computed with: one `f64`, or one in each lane of a vector. A mask has all bits
/// set or none.
#[allow(dead_code)]
pub trait Angle:
    Copy + core::ops::Sub<Output = Self> + core::ops::Mul<Output = Self> + core::ops::Neg<Output = Self>
{
    /// The number in every lane.
    fn splat(value: f64) -> Self;
    /// `self * factor + term`, rounded once where that is one instruction.
    fn mul_add(self, factor: Self, term: Self) -> Self;
    /// Mask of the numbers in whose representation this bit, 1 or 2, is set.
    fn has_bit(self, bit: u64) -> Self;
    /// `if_true` where the mask is set.
    fn select(mask: Self, if_true: Self, if_false: Self) -> Self;
    /// `-self` where exactly one of the masks is set.
    fn negate(self, mask: Self, other: Self) -> Self;
}

/// Sine and cosine to two units in the last place, for angles below 1e5 rad.
#[inline(always)]
#[allow(dead_code, clippy::all, clippy::pedantic)]
pub fn sin_cos_in_range<V: Angle>(x: V) -> (V, V) {
    // k = the nearest multiple of pi/2. Added to 3/2 2^52 it is rounded to an integer, which is in the lowest
    // bits.
    let round = V::splat(6755399441055744.0);
    let shifted = x.mul_add(V::splat(core::f64::consts::FRAC_2_PI), round);
    let k = shifted - round;
    // r = x - k pi/2. The first two parts of pi/2 have 33 bits: their products with k < 2^20 are exact.
    let r = (-k).mul_add(V::splat(1.5707963267341256), x);
    let r = (-k).mul_add(V::splat(6.077100506303966e-11), r);
    let r = (-k).mul_add(V::splat(2.0222662487959506e-21), r);
    // Taylor series, |r| <= pi/4: to r^15 and r^16.
    let z = r * r;
    let mut s = V::splat(-1.0 / 1307674368000.0);
    for c in [1.0 / 6227020800.0, -1.0 / 39916800.0, 1.0 / 362880.0, -1.0 / 5040.0, 1.0 / 120.0, -1.0 / 6.0] {
        s = s.mul_add(z, V::splat(c));
    }
    let mut c = V::splat(1.0 / 20922789888000.0);
    for d in
        [-1.0 / 87178291200.0, 1.0 / 479001600.0, -1.0 / 3628800.0, 1.0 / 40320.0, -1.0 / 720.0, 1.0 / 24.0]
    {
        c = c.mul_add(z, V::splat(d));
    }
    let s = (r * z).mul_add(s, r);
    let c = (z * z).mul_add(c, V::splat(-0.5).mul_add(z, V::splat(1.0)));
    // k mod 4 = 0, 1, 2, 3: the sine is s, c, -s, -c, the cosine c, -s, -c, s.
    let (odd, upper) = (shifted.has_bit(1), shifted.has_bit(2));
    let zero = V::splat(0.0);
    (V::select(odd, c, s).negate(upper, zero), V::select(odd, s, c).negate(upper, odd))
}
