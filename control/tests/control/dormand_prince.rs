//! An integrator for tests.

use nalgebra::SVector;

/// Nodes, weights of the stages, and weights of order 5 less those of order 4: J. R. Dormand, P. J. Prince,
/// "A family of embedded Runge-Kutta formulae", Journal of Computational and Applied Mathematics 6 (1980)
/// 19-26.
const C: [f64; 7] = [0.0, 0.2, 0.3, 0.8, 8.0 / 9.0, 1.0, 1.0];
const A: [[f64; 6]; 7] = [
    [0.0; 6],
    [0.2, 0.0, 0.0, 0.0, 0.0, 0.0],
    [3.0 / 40.0, 9.0 / 40.0, 0.0, 0.0, 0.0, 0.0],
    [44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0, 0.0, 0.0, 0.0],
    [19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0, 0.0, 0.0],
    [9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0, 0.0],
    [35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0],
];
const ERROR: [f64; 7] =
    [71.0 / 57600.0, 0.0, -71.0 / 16695.0, 71.0 / 1920.0, -17253.0 / 339200.0, 22.0 / 525.0, -1.0 / 40.0];

/// The solution of y' = f(t, y) after a duration, from t = 0. The estimated error of a step is at most
/// `tolerance` times 1 + |y| in each component, and a step is at most an eighth of the duration. `see` gets t
/// and y after each step.
pub(crate) fn integrated<const N: usize>(
    mut y: SVector<f64, N>,
    duration: f64,
    tolerance: f64,
    mut f: impl FnMut(f64, &SVector<f64, N>) -> SVector<f64, N>,
    mut see: impl FnMut(f64, &SVector<f64, N>),
) -> SVector<f64, N> {
    let longest = duration / 8.0;
    let (mut t, mut h) = (0.0, longest);
    loop {
        let is_last = t + 1.001 * h >= duration;
        h = if is_last { duration - t } else { h };
        let mut slopes = [SVector::<f64, N>::zeros(); 7];
        let mut next = y;
        for stage in 0..7 {
            next = (0..stage).fold(y, |sum, j| sum + slopes[j] * (h * A[stage][j]));
            slopes[stage] = f(t + C[stage] * h, &next);
        }
        let missed =
            slopes.iter().zip(ERROR).fold(SVector::<f64, N>::zeros(), |sum, (slope, e)| sum + slope * e);
        let part = missed.zip_map(&y, |missed, y| h * missed.abs() / (tolerance * (1.0 + y.abs()))).max();
        if part <= 1.0 {
            (t, y) = (if is_last { duration } else { t + h }, next);
            see(t, &y);
            if is_last {
                return y;
            }
        }
        h = (h * (0.9 * part.max(1e-9).powf(-0.2)).clamp(0.2, 5.0)).min(longest);
        assert!(h > 1e-12 * duration, "the integration stops at {t}");
    }
}

#[test]
fn the_integrator_follows_an_oscillator() {
    let y = SVector::<f64, 2>::new(1.0, 0.0);
    for tolerance in [1e-8, 1e-12] {
        let mut last = 0.0;
        let end =
            integrated(y, 3.0, tolerance, |_, y| SVector::<f64, 2>::new(y[1], -4.0 * y[0]), |t, _| last = t);
        let miss = (end - SVector::<f64, 2>::new(6.0_f64.cos(), -2.0 * 6.0_f64.sin())).amax();
        assert!(last == 3.0 && miss < 200.0 * tolerance, "{miss} {tolerance}");
    }
}
