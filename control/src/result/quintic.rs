//! Polynomials of degree five between two states of a joint.

/// Position, rate and acceleration of a joint (rad, rad/s, rad/s^2 or m, m/s, m/s^2).
pub(crate) type State = [f64; 3];

/// Position, rate, acceleration and jerk of a joint (rad, ..., rad/s^3 or m, ..., m/s^3).
pub(crate) type StateAndJerk = [f64; 4];

/// The quintic in time that takes a joint from one state to another, at the part `x` of its duration (s).
pub(crate) fn quintic(from: State, to: State, duration: f64, x: f64) -> StateAndJerk {
    let (h, square) = (duration, duration * duration);
    let [q, a, b] = [from[0], h * from[1], 0.5 * square * from[2]];
    // What the parabola from the start misses at the end, in value, slope and curvature over x.
    let miss = [to[0] - q - a - b, h * to[1] - a - 2.0 * b, square * to[2] - 2.0 * b];
    let c = 10.0 * miss[0] - 4.0 * miss[1] + 0.5 * miss[2];
    let d = -15.0 * miss[0] + 7.0 * miss[1] - miss[2];
    let e = 6.0 * miss[0] - 3.0 * miss[1] + 0.5 * miss[2];
    let value = q + x * (a + x * (b + x * (c + x * (d + x * e))));
    let slope = a + x * (2.0 * b + x * (3.0 * c + x * (4.0 * d + x * 5.0 * e)));
    let curvature = 2.0 * b + x * (6.0 * c + x * (12.0 * d + x * 20.0 * e));
    let third = 6.0 * c + x * (24.0 * d + x * 60.0 * e);
    [value, slope / h, curvature / square, third / (h * square)]
}

#[cfg(test)]
mod tests {
    use super::quintic;

    #[test]
    fn a_polynomial_of_degree_five_is_reproduced() {
        let state = |t: f64| {
            let q = 0.3 - t + 2.0 * t.powi(2) - 0.7 * t.powi(3) + 0.2 * t.powi(4) - 0.05 * t.powi(5);
            let v = -1.0 + 4.0 * t - 2.1 * t.powi(2) + 0.8 * t.powi(3) - 0.25 * t.powi(4);
            [q, v, 4.0 - 4.2 * t + 2.4 * t.powi(2) - t.powi(3)]
        };
        let jerk = |t: f64| -4.2 + 4.8 * t - 3.0 * t.powi(2);
        for x in [0.0, 0.2, 0.7, 1.0] {
            let found = quintic(state(0.4), state(1.9), 1.5, x);
            let expected = state(0.4 + 1.5 * x).into_iter().chain([jerk(0.4 + 1.5 * x)]);
            for (found, expected) in found.into_iter().zip(expected) {
                assert!((found - expected).abs() < 1e-12, "{found} {expected}");
            }
        }
    }
}
