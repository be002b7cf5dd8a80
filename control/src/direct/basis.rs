//! Quintic Hermite polynomials of one interval, and the points at which a motion is evaluated.
//!
//! On an interval of width h the position is a polynomial of degree five with the positions, first and second
//! derivatives of both ends as coefficients. The acceleration is a cubic, continuous over the nodes; its
//! square has degree six, and Lobatto's five points integrate it exactly.

/// Points inside of an interval.
pub(super) const INNER: usize = 3;
/// Points of an interval, with the node at its left end.
pub(super) const POINTS: usize = INNER + 1;

/// Where the inner points lie on [0, 1]: 1/2 and 1/2 -+ sqrt(3/28).
pub(super) const PLACES: [f64; INNER] = [0.172_673_164_646_011_43, 0.5, 0.827_326_835_353_988_6];
/// Weights of the inner points.
pub(super) const INNER_WEIGHTS: [f64; INNER] = [49.0 / 180.0, 16.0 / 45.0, 49.0 / 180.0];
/// Weight of each end.
pub(super) const END_WEIGHT: f64 = 1.0 / 20.0;

/// Coefficients of an interval and joint: q, q', q'' at its left end, then at its right end.
pub(super) const COEFFICIENTS: usize = 6;

/// q, q', q'' at a point as sums over the coefficients.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Basis {
    /// Factors of the coefficients in q.
    pub position: [f64; COEFFICIENTS],
    /// In q'.
    pub first: [f64; COEFFICIENTS],
    /// In q''.
    pub second: [f64; COEFFICIENTS],
    /// In q'''.
    pub third: [f64; COEFFICIENTS],
}

/// Polynomials on [0, 1], lowest power first: position, first and second derivative 1 at the left end, then
/// at the right end; everything else 0 at both ends.
const HERMITE: [[f64; 6]; COEFFICIENTS] = [
    [1.0, 0.0, 0.0, -10.0, 15.0, -6.0],
    [0.0, 1.0, 0.0, -6.0, 8.0, -3.0],
    [0.0, 0.0, 0.5, -1.5, 1.5, -0.5],
    [0.0, 0.0, 0.0, 10.0, -15.0, 6.0],
    [0.0, 0.0, 0.0, -4.0, 7.0, -3.0],
    [0.0, 0.0, 0.0, 0.5, -1.0, 0.5],
];

impl Basis {
    /// At the part `x` of an interval of width `h`.
    pub fn at(x: f64, h: f64) -> Self {
        let mut basis = Self { position: [0.0; 6], first: [0.0; 6], second: [0.0; 6], third: [0.0; 6] };
        for (i, powers) in HERMITE.iter().enumerate() {
            let (mut value, mut slope, mut curvature, mut third) = (0.0, 0.0, 0.0, 0.0);
            for &power in powers.iter().rev() {
                third = third * x + 3.0 * curvature;
                curvature = curvature * x + 2.0 * slope;
                slope = slope * x + value;
                value = value * x + power;
            }
            let scale = [1.0, h, h * h][i % 3];
            basis.position[i] = scale * value;
            basis.first[i] = scale / h * slope;
            basis.second[i] = scale / (h * h) * curvature;
            basis.third[i] = scale / (h * h * h) * third;
        }
        basis
    }

    /// Position, first and second derivative in this order.
    pub fn rows(&self) -> [&[f64; COEFFICIENTS]; 3] {
        [&self.position, &self.first, &self.second]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quintic_is_reproduced_with_its_derivatives() {
        let value = |t: f64| 1.0 - t + 0.5 * t.powi(3) - 0.3 * t.powi(5);
        let slope = |t: f64| -1.0 + 1.5 * t * t - 1.5 * t.powi(4);
        let curvature = |t: f64| 3.0 * t - 6.0 * t.powi(3);
        let (left, h) = (0.3, 0.7);
        let coefficients = [left, left + h].map(|t| [value(t), slope(t), curvature(t)]).concat();
        for x in [0.0, 0.1, 0.5, 0.9, 1.0] {
            let (basis, t) = (Basis::at(x, h), left + x * h);
            let sum = |row: &[f64; 6]| -> f64 { row.iter().zip(&coefficients).map(|(b, c)| b * c).sum() };
            let [q, first, second] = basis.rows().map(sum);
            assert!((q - value(t)).abs() < 1e-14);
            assert!((first - slope(t)).abs() < 1e-13 && (second - curvature(t)).abs() < 1e-12);
        }
    }

    #[test]
    fn the_points_integrate_powers_up_to_seven() {
        for power in 0..8 {
            let inner: f64 = PLACES.iter().zip(INNER_WEIGHTS).map(|(x, w)| w * x.powi(power)).sum();
            let ends = END_WEIGHT * (1.0 + if power == 0 { 1.0 } else { 0.0 });
            assert!((inner + ends - 1.0 / (f64::from(power) + 1.0)).abs() < 1e-15, "{power}");
        }
    }
}
