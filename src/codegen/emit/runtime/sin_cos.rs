/// Sine and cosine are computed below this angle (rad), where the reduction to |r| <= pi/4 is exact.
pub const LARGEST_ANGLE: f64 = 1e6;

/// What sine and cosine are computed with: one `f64`, or one in each lane of a vector. A mask has all bits set or none.
pub trait Angle:
    Copy
    + core::ops::Add<Output = Self>
    + core::ops::Sub<Output = Self>
    + core::ops::Mul<Output = Self>
    + core::ops::Neg<Output = Self>
{
    /// The number in every lane.
    fn splat(value: f64) -> Self;
    /// `self * factor + term`, rounded once where that is one instruction.
    fn mul_add(self, factor: Self, term: Self) -> Self;
    /// Bitwise and.
    fn and(self, other: Self) -> Self;
    /// Bitwise exclusive or.
    fn xor(self, other: Self) -> Self;
    /// Mask of the numbers in whose representation this bit is set; one of the lowest 51.
    fn has_bit(self, bit: u64) -> Self;
    /// `if_true` where the mask is set.
    fn select(mask: Self, if_true: Self, if_false: Self) -> Self;
}

/// Sine and cosine to two units in the last place, for angles below [`LARGEST_ANGLE`].
///
/// `|angle| = n pi/2 + r + tail`, |r| <= pi/4: sine and cosine of r by polynomials, exchanged for odd n, with signs by n.
#[inline(always)]
pub fn sin_cos_in_range<V: Angle>(angle: V) -> (V, V) {
    // 3/2 2^52: added to a number, it rounds the number to an integer, which is then in the lowest bits.
    const ROUND: f64 = 6755399441055744.0;
    // pi/2 in three parts. The first two have 33 bits: their products with an integer below 2^20 are exact.
    const HALF_PI: [f64; 3] = [1.5707963267341256, 6.077100506303966e-11, 2.0222662487959506e-21];
    // (sin r - r) / r^3 and (cos r - 1 + r^2/2) / r^4 as polynomials in r^2, highest power first; minimax by the Remez
    // algorithm, relative error of sine and cosine below 4e-18.
    const SIN: [f64; 6] = [
        1.5896213900738097e-10,
        -2.5050747490622135e-8,
        2.7557313619702316e-6,
        -0.00019841269829584855,
        0.008333333333322113,
        -0.1666666666666663,
    ];
    const COS: [f64; 6] = [
        -1.1358525208068056e-11,
        2.0875700628463847e-9,
        -2.755731417776405e-7,
        2.4801587288846537e-5,
        -0.001388888888887305,
        0.041666666666666595,
    ];
    let horner = |c: [f64; 6], z: V| {
        let high = V::splat(c[0]).mul_add(z, V::splat(c[1])).mul_add(z, V::splat(c[2]));
        high.mul_add(z, V::splat(c[3])).mul_add(z, V::splat(c[4])).mul_add(z, V::splat(c[5]))
    };
    let (sign, one) = (V::splat(-0.0), V::splat(1.0));
    let negative = angle.and(sign);
    let x = angle.xor(negative);
    let shifted = x.mul_add(V::splat(core::f64::consts::FRAC_2_PI), V::splat(ROUND));
    let n = shifted - V::splat(ROUND);
    // Exact: x and n HALF_PI[0] agree in their leading bits.
    let near = x - n * V::splat(HALF_PI[0]);
    let product = n * V::splat(HALF_PI[1]);
    let high = near - product;
    // The rounding error of this difference, whichever of the two is larger.
    let back = near - high;
    let lost = (near - (high + back)) + (back - product);
    let rest = lost - n * V::splat(HALF_PI[2]);
    let r = high + rest;
    let tail = (high - r) + rest;
    let z = r * r;
    let half = z * V::splat(0.5);
    // sin(r + tail) = r + (r^3 S + tail (1 - r^2/2))
    let sin = r + (r * z).mul_add(horner(SIN, z), tail.mul_add(-half, tail));
    // cos(r + tail) = 1 - r^2/2 + (r^4 C - r tail), with the rounding error of 1 - r^2/2
    let above = one - half;
    let below = (one - above) - half;
    let cos = above + (below + (z * z).mul_add(horner(COS, z), -(r * tail)));
    // n mod 4 = 0, 1, 2, 3: the sine is s, c, -s, -c, the cosine c, -s, -c, s.
    let (odd, upper) = (shifted.has_bit(1), shifted.has_bit(2));
    let sine = V::select(odd, cos, sin).xor(upper.and(sign)).xor(negative);
    let cosine = V::select(odd, sin, cos).xor(upper.xor(odd).and(sign));
    (sine, cosine)
}
