//! Sine and cosine of all lanes at once.

use super::Vector;

/// The multiple of pi/2 is found by adding this, 3/2 2^52: what stands behind the point is rounded away, the integer is in
/// the lowest bits.
const ROUND: f64 = 6_755_399_441_055_744.0;

/// pi/2 in three parts. The first two have 33 bits: their products with an integer below 2^20 are exact.
const HALF_PI: [f64; 3] = [1.570_796_326_734_125_6, 6.077_100_506_303_966e-11, 2.022_266_248_795_950_6e-21];

/// Above this the reduction below is not exact, and lanes are computed one by one.
const LARGEST: f64 = 1.0e6;

/// `(sin r - r) / r^3` and `(cos r - 1 + r^2/2) / r^4` as polynomials in r^2, r up to pi/4; relative error of sin and cos
/// below 4e-18 (minimax, by Remez's exchange).
const SIN: [f64; 6] = [
    -0.166_666_666_666_666_3,
    0.008_333_333_333_322_113,
    -0.000_198_412_698_295_848_55,
    2.755_731_361_970_231_6e-6,
    -2.505_074_749_062_213_5e-8,
    1.589_621_390_073_809_7e-10,
];
const COS: [f64; 6] = [
    0.041_666_666_666_666_595,
    -0.001_388_888_888_887_305,
    2.480_158_728_884_653_7e-5,
    -2.755_731_417_776_405e-7,
    2.087_570_062_846_384_7e-9,
    -1.135_852_520_806_805_6e-11,
];

/// Sine and cosine to two units in the last place of each, whatever the angle (rad).
#[inline]
pub(super) fn sin_cos<V: Vector>(x: V) -> (V, V) {
    let limit = V::splat(LARGEST);
    if V::all(V::less(x, limit) & V::less(-x, limit)) { of_moderate(x) } else { one_by_one(x) }
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

/// `|angle| = x = n pi/2 + r + tail`, |r| up to pi/4; n picks sine or cosine of r and the signs.
#[inline]
fn of_moderate<V: Vector>(angle: V) -> (V, V) {
    let sign = V::splat(-0.0);
    let negative = angle & sign;
    let x = angle ^ negative;
    let [first, second, third] = HALF_PI;
    let (first, second, third) = (V::splat(first), V::splat(second), V::splat(third));
    let shifted = x.mul_add(V::splat(std::f64::consts::FRAC_2_PI), V::splat(ROUND));
    let n = shifted - V::splat(ROUND);
    // Exact: x and n first agree in their leading bits.
    let near = x - n * first;
    let product = n * second;
    let high = near - product;
    // What the last difference has lost, for whichever of the two is larger.
    let back = near - high;
    let lost = (near - (high + back)) + (back - product);
    let rest = lost - n * third;
    let r = high + rest;
    let tail = (high - r) + rest;
    let square = r * r;
    let half = square * V::splat(0.5);
    // sin(r + tail) = r + (r^3 S + tail (1 - r^2/2))
    let sin = r + (r * square).mul_add(polynomial(SIN, square), tail.mul_add(-half, tail));
    // cos(r + tail) = 1 - r^2/2 + (r^4 C - r tail), with what rounding 1 - r^2/2 loses
    let above = V::splat(1.0) - half;
    let below = (V::splat(1.0) - above) - half;
    let cos = above + (below + (square * square).mul_add(polynomial(COS, square), -(r * tail)));
    // n odd: the two change places. Bits 0 and 1 of n, made into masks beside the exponent of 1.
    let one = V::splat(1.0);
    let bit = |k: u64| V::less(one, (shifted & V::splat(f64::from_bits(k))) | one);
    let (odd, upper) = (bit(1), bit(2));
    // n mod 4 = 0, 1, 2, 3: sin is s, c, -s, -c; cos is c, -s, -c, s.
    let minus_sin = upper & sign;
    let minus_cos = (upper ^ odd) & sign;
    (V::select(odd, cos, sin) ^ minus_sin ^ negative, V::select(odd, sin, cos) ^ minus_cos)
}

/// Horner's rule.
#[inline(always)]
fn polynomial<V: Vector>(coefficients: [f64; 6], x: V) -> V {
    let [c0, c1, c2, c3, c4, c5] = coefficients;
    let upper = V::splat(c5).mul_add(x, V::splat(c4)).mul_add(x, V::splat(c3));
    upper.mul_add(x, V::splat(c2)).mul_add(x, V::splat(c1)).mul_add(x, V::splat(c0))
}
