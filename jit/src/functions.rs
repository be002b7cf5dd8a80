//! Sine and cosine of four angles at once.
//!
//! ```text
//! x = k pi/2 + r ,  |r| <= pi/4:    sin x, cos x = +- sin r, +- cos r, exchanged for odd k
//! sin r = r + r^3 (-1/3! + r^2/5! - ...)      cos r = 1 + r^2 (-1/2! + r^2/4! - ...)
//! ```
//!
//! Both series end where their remainder is below a tenth of the rounding error. pi/2 is taken in three
//! parts; with fused operations the first difference is exact. Angles beyond [`LIMIT`], and NaN, are left to
//! the standard library.

use std::f64::consts::{FRAC_2_PI, FRAC_PI_2};

/// Largest angle (rad) that is reduced here.
const LIMIT: f64 = 1e5;
/// pi/2 - FRAC_PI_2, and the rest of pi/2 after both.
const LOW: f64 = 6.123233995736766e-17;
const LOWEST: f64 = -1.4973849048591698e-33;
/// 1.5 2^52: a number of moderate size that is added to it is rounded to an integer, in the lowest bits.
const ROUND: f64 = 6_755_399_441_055_744.0;

/// `(-1)^j / (2 j + first)!` for j = 1, 2, ... 8.
const fn series(first: u32) -> [f64; 8] {
    let mut terms = [0.0; 8];
    let (mut term, mut j) = (1.0, 1);
    while j <= 8 {
        let n = (2 * j + first) as f64;
        term /= -n * (n - 1.0);
        terms[j as usize - 1] = term;
        j += 1;
    }
    terms
}
const SINE: [f64; 8] = series(1);
const COSINE: [f64; 8] = series(0);

/// Sines and cosines of four angles.
///
/// The angles are passed one by one, in registers: four stores followed by one load of all would stall.
///
/// # Safety
/// The processor has AVX2 and FMA.
#[inline]
pub(crate) unsafe fn sin_cos(a: f64, b: f64, c: f64, d: f64) -> ([f64; 4], [f64; 4]) {
    // SAFETY: the contract of this function; there is none on other processors.
    #[allow(unused_unsafe)]
    unsafe {
        reduced(a, b, c, d)
    }
}

#[cfg_attr(target_arch = "x86_64", target_feature(enable = "avx2,fma"))]
#[inline(never)]
fn reduced(a: f64, b: f64, c: f64, d: f64) -> ([f64; 4], [f64; 4]) {
    let angles = [a, b, c, d];
    let (mut sines, mut cosines) = ([0.0; 4], [0.0; 4]);
    let within = angles.map(|angle| angle.abs() <= LIMIT);
    if within != [true; 4] {
        for lane in 0..4 {
            (sines[lane], cosines[lane]) = angles[lane].sin_cos();
        }
        return (sines, cosines);
    }
    let (mut r, mut square, mut quadrant) = ([0.0; 4], [0.0; 4], [0; 4]);
    for lane in 0..4 {
        let shifted = angles[lane].mul_add(FRAC_2_PI, ROUND);
        quadrant[lane] = shifted.to_bits();
        let k = shifted - ROUND;
        let reduced = (-k).mul_add(LOW, (-k).mul_add(FRAC_PI_2, angles[lane]));
        r[lane] = (-k).mul_add(LOWEST, reduced);
        square[lane] = r[lane] * r[lane];
    }
    let (mut sine, mut cosine) = ([0.0; 4], [0.0; 4]);
    for lane in 0..4 {
        sine[lane] = polynomial(&SINE, square[lane]);
        cosine[lane] = polynomial(&COSINE, square[lane]);
    }
    for lane in 0..4 {
        let sine = (r[lane] * square[lane]).mul_add(sine[lane], r[lane]).to_bits();
        let cosine = square[lane].mul_add(cosine[lane], 1.0).to_bits();
        let exchanged = (quadrant[lane] & 1).wrapping_neg();
        let difference = (sine ^ cosine) & exchanged;
        let sine_sign = (quadrant[lane] & 2) << 62;
        let cosine_sign = (quadrant[lane].wrapping_add(1) & 2) << 62;
        sines[lane] = f64::from_bits(sine ^ difference ^ sine_sign);
        cosines[lane] = f64::from_bits(cosine ^ difference ^ cosine_sign);
    }
    (sines, cosines)
}

/// `c0 + c1 z + ... + c7 z^7`, in pairs: half as deep as one coefficient after the other.
#[cfg_attr(target_arch = "x86_64", target_feature(enable = "avx2,fma"))]
#[inline]
fn polynomial(c: &[f64; 8], z: f64) -> f64 {
    let (z2, z4) = (z * z, (z * z) * (z * z));
    let low = z.mul_add(c[3], c[2]).mul_add(z2, z.mul_add(c[1], c[0]));
    let high = z.mul_add(c[7], c[6]).mul_add(z2, z.mul_add(c[5], c[4]));
    high.mul_add(z4, low)
}

#[cfg(test)]
mod tests {
    use super::sin_cos;
    use crate::code::Code;
    use std::f64::consts::{FRAC_PI_4, PI};

    /// The largest relative error, in units of 2^-52, of sines and cosines against the standard library.
    fn worst(angles: impl Iterator<Item = f64>) -> f64 {
        assert!(Code::supported().is_ok());
        let error = |x: f64| {
            // SAFETY: `Code::supported` checked the processor.
            let (sines, cosines) = unsafe { sin_cos(x, 0.1, x, -0.3) };
            assert_eq!((sines[0], cosines[0]), (sines[2], cosines[2]), "lanes differ at {x}");
            let (sin, cos) = x.sin_cos();
            ((sines[2] - sin) / sin).abs().max(((cosines[2] - cos) / cos).abs()) / f64::EPSILON
        };
        angles.map(error).fold(0.0, f64::max)
    }

    #[test]
    fn sines_and_cosines_are_right_to_the_last_bit_but_one() {
        if Code::supported().is_err() {
            return;
        }
        let mut random = fastrand::Rng::with_seed(1);
        for range in [1e-3, 1.0, 7.0, 300.0, 1e5] {
            let angles = (0..100_000).map(|_| range * (2.0 * random.f64() - 1.0));
            assert!(worst(angles) <= 1.0, "angles up to {range}");
        }
        let near = (-2000..2000).flat_map(|k| {
            let x = f64::from(k) * FRAC_PI_4;
            [x.next_down(), x, x.next_up()]
        });
        assert!(worst(near.filter(|x| *x != 0.0)) <= 1.0, "near multiples of pi / 4");
    }

    #[test]
    fn special_angles_are_those_of_the_standard_library() {
        if Code::supported().is_err() {
            return;
        }
        for x in [0.0, -0.0, PI, 1e5, 100_000.1, -1e22, f64::MAX, f64::MIN_POSITIVE, f64::NAN, f64::INFINITY]
        {
            // SAFETY: `Code::supported` checked the processor.
            let (sines, cosines) = unsafe { sin_cos(0.5, x, -0.5, x) };
            let (sin, cos) = x.sin_cos();
            for lane in [1, 3] {
                assert!(sines[lane] == sin || sin.is_nan() && sines[lane].is_nan(), "sin {x}");
                assert!(cosines[lane] == cos || cos.is_nan() && cosines[lane].is_nan(), "cos {x}");
            }
        }
    }
}
