//! The rotation vector of a rotation, and its derivatives.
//!
//! Every function here is analytic for all angles up to a half turn, 0 among them: there is no limit to take
//! and no branch by the angle, so that dual numbers are right everywhere.

use crate::scalar::Scalar;
use crate::spatial::Vec3;
use std::f64::consts::PI;

/// How often the half angle is halved before the series of the arcsine: the sine is then at most
/// sin(pi / 32) < 0.1.
const HALVINGS: u32 = 4;

/// `arcsin(x) / x = sum_k a_k x^2k`, as far as double precision needs it for |x| < 0.1.
const ARCSINE: [f64; 9] = [
    1.0,
    1.0 / 6.0,
    3.0 / 40.0,
    5.0 / 112.0,
    35.0 / 1152.0,
    63.0 / 2816.0,
    231.0 / 13312.0,
    143.0 / 10240.0,
    6435.0 / 557_056.0,
];

/// `zeta(2 k) - 1` for k = 1, 2, ...: the coefficients of the cotangent, see [`curvature`].
const ZETA_LESS_ONE: [f64; 14] = [
    6.449_340_668_482_264e-1,
    8.232_323_371_113_82e-2,
    1.734_306_198_444_914e-2,
    4.077_356_197_944_339e-3,
    9.945_751_278_180_853e-4,
    2.460_865_533_080_483e-4,
    6.124_813_505_870_483e-5,
    1.528_225_940_865_187e-5,
    3.817_293_264_999_84e-6,
    9.539_620_338_728e-7,
    2.384_505_027_277_33e-7,
    5.960_818_905_125_948e-8,
    1.490_155_482_836_504e-8,
    3.725_334_024_788_457e-9,
];

/// The unit quaternion of a rotation, given by rows: `cos(angle / 2) >= 0` and `sin(angle / 2) axis`.
///
/// Of the four formulas `4 (cos^2, x^2, y^2, z^2) = 1 +- R_xx +- R_yy +- R_zz` the one with the largest
/// square, at least 1, gives its entry by a root, and the others by division with it.
pub(crate) fn quaternion<S: Scalar>([a, b, c]: [Vec3<S>; 3]) -> (S, Vec3<S>) {
    let [x, y, z] = [c.y - b.z, a.z - c.x, b.x - a.y];
    let [xy, xz, yz] = [a.y + b.x, a.z + c.x, b.z + c.y];
    let candidates = [
        [(a.x + b.y + c.z).plus(1.0), x, y, z],
        [x, (a.x - b.y - c.z).plus(1.0), xy, xz],
        [y, xy, (b.y - a.x - c.z).plus(1.0), yz],
        [z, xz, yz, (c.z - a.x - b.y).plus(1.0)],
    ];
    let (mut square, mut row) = (candidates[0][0], candidates[0]);
    for (k, candidate) in candidates.into_iter().enumerate().skip(1) {
        let larger = square.less(candidate[k]);
        square = S::select(larger, candidate[k], square);
        for (entry, other) in row.iter_mut().zip(candidate) {
            *entry = S::select(larger, other, *entry);
        }
    }
    let scale = square.sqrt().recip().times(0.5);
    let scale = S::select(row[0].less(S::zero()), -scale, scale);
    let [cos, x, y, z] = row.map(|entry| entry * scale);
    (cos, Vec3::new(x, y, z))
}

/// The rotation vector e = angle axis, of the quaternion `(cos, sin axis)` of the half angle, by halving the
/// angle and the series of the arcsine.
pub(crate) fn rotation_vector<S: Scalar>(mut cos: S, mut sin: Vec3<S>) -> Vec3<S> {
    for _ in 0..HALVINGS {
        cos = cos.plus(1.0).times(0.5).sqrt();
        sin = sin.scaled(cos.recip().times(0.5));
    }
    let ratio = polynomial(&ARCSINE, sin.dot(sin));
    sin.scaled(ratio.times(f64::from(2_u32 << HALVINGS)))
}

/// `c(s) = (1 - (a/2) cot(a/2)) / a^2` and dc/ds, for `s = a^2`, the square of an angle up to a half turn.
///
/// Since `1 - x cot x = 2 sum_m x^2 / (m^2 pi^2 - x^2)`, with `t = s / (4 pi^2) <= 1/4`:
/// `2 pi^2 c = sum_m 1 / (m^2 - t) = 1 / (1 - t) + sum_k (zeta(2 k) - 1) t^(k-1)`.
pub(crate) fn curvature<S: Scalar>(s: S) -> (S, S) {
    let scale = 1.0 / (4.0 * PI * PI);
    let t = s.times(scale);
    let first = (-t).plus(1.0).recip();
    let mut slopes = [0.0; ZETA_LESS_ONE.len() - 1];
    for (power, (slope, zeta)) in slopes.iter_mut().zip(&ZETA_LESS_ONE[1..]).enumerate() {
        *slope = (power + 1) as f64 * zeta;
    }
    let value = first + polynomial(&ZETA_LESS_ONE, t);
    let slope = first * first + polynomial(&slopes, t);
    (value.times(2.0 * scale), slope.times(2.0 * scale * scale))
}

/// `sum_k a_k x^k`.
fn polynomial<S: Scalar>(coefficients: &[f64], x: S) -> S {
    coefficients.iter().rev().fold(S::zero(), |sum, &coefficient| (sum * x).plus(coefficient))
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Rotation3, UnitQuaternion, Vector3};
    use num_dual::Dual2_64;

    fn rows(rotation: &Rotation3<f64>) -> [Vec3<f64>; 3] {
        let r = rotation.matrix();
        [0, 1, 2].map(|i| Vec3::new(r[(i, 0)], r[(i, 1)], r[(i, 2)]))
    }

    #[test]
    fn rotation_vectors_are_found_for_all_angles_and_axes() {
        let axes = [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [0.6, 0.0, -0.8], [-0.4, 0.7, 0.59]];
        for axis in axes.map(|axis| Vector3::from(axis).normalize()) {
            for angle in [0.0, 1e-12, 1e-3, 0.7, 1.5, 2.0, 2.5, 3.1, PI - 1e-5] {
                let rotation = Rotation3::from_scaled_axis(axis * angle);
                let (cos, sin) = quaternion(rows(&rotation));
                let expected = UnitQuaternion::from_scaled_axis(axis * angle);
                assert!((cos - expected.w).abs() < 1e-15, "{axis} {angle}");
                assert!((Vector3::from(sin.to_array()) - expected.imag()).amax() < 1e-15, "{axis} {angle}");
                let e = Vector3::from(rotation_vector(cos, sin).to_array());
                assert!((e - axis * angle).amax() < 2e-15, "{e} is not {}", axis * angle);
            }
        }
    }

    #[test]
    fn curvature_is_the_textbook_formula_with_its_derivative() {
        let textbook = |a: f64| (1.0 - 0.5 * a / (0.5 * a).tan()) / (a * a);
        for angle in [0.2, 0.5, 1.0, 2.0, 3.0, PI] {
            assert!((curvature(angle * angle).0 - textbook(angle)).abs() < 1e-14, "{angle}");
        }
        assert_eq!(curvature(0.0).0, 1.0 / 12.0);
        for s in [0.0, 1e-9, 0.3, 4.0, PI * PI] {
            let (value, slope) = curvature(Dual2_64::from_re(s).derivative());
            assert!((value.v1 - curvature(s).1).abs() < 1e-16 && (slope.v1 - value.v2).abs() < 1e-17, "{s}");
        }
        assert!((curvature(0.0).1 - 1.0 / 720.0).abs() < 1e-17, "c = 1/12 + s/720 + ...");
    }
}
