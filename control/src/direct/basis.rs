//! Polynomials of one interval, and the points at which a motion is evaluated.
//!
//! On an interval of width h the position is a polynomial of degree four: the cubic with the positions and
//! first derivatives of both ends, and a bubble that vanishes at both ends with its first derivative. The
//! acceleration is a quadratic, which may jump at the nodes. It has as many values at Gauss's three points as
//! the polynomial has coefficients beside the state at its left end, so torques at limits determine the
//! motion, and multipliers of torques are costates.

/// Points of an interval.
pub(crate) const POINTS: usize = 3;

/// Where the points lie on [0, 1]: 1/2 and 1/2 -+ sqrt(3/20).
pub(crate) const PLACES: [f64; POINTS] = [0.112_701_665_379_258_31, 0.5, 0.887_298_334_620_741_7];
/// Weights of the points.
pub(crate) const WEIGHTS: [f64; POINTS] = [5.0 / 18.0, 4.0 / 9.0, 5.0 / 18.0];

/// Coefficients of an interval and joint: the height of the bubble, then q, q' at the left end and at the
/// right end.
pub(super) const COEFFICIENTS: usize = 5;

/// q, q', q'' at a point as sums over the coefficients.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Basis {
    /// Factors of the coefficients in q, q' and q''.
    pub rows: [[f64; COEFFICIENTS]; 3],
}

/// Polynomials on [0, 1], lowest power first: 16 x^2 (1 - x)^2, which is 1 in the middle; then position and
/// first derivative 1 at the left end, then at the right end, everything else 0 at both ends.
const POLYNOMIALS: [[f64; 5]; COEFFICIENTS] = [
    [0.0, 0.0, 16.0, -32.0, 16.0],
    [1.0, 0.0, -3.0, 2.0, 0.0],
    [0.0, 1.0, -2.0, 1.0, 0.0],
    [0.0, 0.0, 3.0, -2.0, 0.0],
    [0.0, 0.0, -1.0, 1.0, 0.0],
];

impl Basis {
    /// At the part `x` of an interval of width `h`.
    pub fn at(x: f64, h: f64) -> Self {
        let mut rows = [[0.0; COEFFICIENTS]; 3];
        for (i, powers) in POLYNOMIALS.iter().enumerate() {
            let (mut value, mut slope, mut curvature) = (0.0, 0.0, 0.0);
            for &power in powers.iter().rev() {
                curvature = curvature * x + 2.0 * slope;
                slope = slope * x + value;
                value = value * x + power;
            }
            let scale = [1.0, 1.0, h, 1.0, h][i];
            rows[0][i] = scale * value;
            rows[1][i] = scale / h * slope;
            rows[2][i] = scale / (h * h) * curvature;
        }
        Self { rows }
    }

    /// Factors of the derivatives in time: those in s, times 1, 1/T, 1/T^2.
    pub fn in_time(&self, inverse: f64) -> [[f64; COEFFICIENTS]; 3] {
        let scales = [1.0, inverse, inverse * inverse];
        [0, 1, 2].map(|s| self.rows[s].map(|factor| factor * scales[s]))
    }

    /// q, q', q'' from the coefficients: heights of the bubbles (n), states of both ends (4n).
    pub fn combine(&self, n: usize, inner: &[f64], ends: &[f64], z: &mut [f64]) {
        for (row, z) in self.rows.iter().zip(z.chunks_exact_mut(n)) {
            let parts = [inner, &ends[..n], &ends[n..2 * n], &ends[2 * n..3 * n], &ends[3 * n..4 * n]];
            let [a, b, c, d, e] = parts.map(|part| &part[..n]);
            for (i, z) in z.iter_mut().enumerate() {
                *z = (row[0] * a[i] + row[1] * b[i] + row[2] * c[i]) + (row[3] * d[i] + row[4] * e[i]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quartic_is_reproduced_with_its_derivatives() {
        let value = |t: f64| 1.0 - t + 0.5 * t.powi(3) - 0.3 * t.powi(4);
        let slope = |t: f64| -1.0 + 1.5 * t * t - 1.2 * t.powi(3);
        let curvature = |t: f64| 3.0 * t - 3.6 * t * t;
        let (left, h) = (0.3, 0.7);
        let ends = [left, left + h].map(|t| [value(t), slope(t)]).concat();
        let mut middle = [0.0; 3];
        Basis::at(0.5, h).combine(1, &[0.0], &ends, &mut middle);
        let bubble = [value(left + 0.5 * h) - middle[0]];
        for x in [0.0, 0.1, 0.5, 0.9, 1.0] {
            let t = left + x * h;
            let mut z = [0.0; 3];
            Basis::at(x, h).combine(1, &bubble, &ends, &mut z);
            let errors = [z[0] - value(t), z[1] - slope(t), z[2] - curvature(t)];
            assert!(errors.iter().all(|error| error.abs() < 1e-13), "{x}: {errors:?}");
        }
    }

    #[test]
    fn the_points_integrate_powers_up_to_five() {
        for power in 0..6 {
            let sum: f64 = PLACES.iter().zip(WEIGHTS).map(|(x, w)| w * x.powi(power)).sum();
            assert!((sum - 1.0 / (f64::from(power) + 1.0)).abs() < 1e-15, "{power}");
        }
    }
}
