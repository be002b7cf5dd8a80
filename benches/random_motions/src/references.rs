//! Values of references over time, from the formulas of `docs/optimize.md`.

/// A curve through knots: piecewise cubics, which hold their end values outside of the knots.
pub struct Curve {
    times: Vec<f64>,
    values: Vec<Vec<f64>>,
    slopes: Vec<Vec<f64>>,
}

impl Curve {
    /// With these slopes at the knots; without them the cubic spline, C2 between the first and the last
    /// knot, where it rests.
    pub fn new(times: &[f64], values: Vec<Vec<f64>>, slopes: Option<Vec<Vec<f64>>>) -> Self {
        let slopes = slopes.unwrap_or_else(|| spline_slopes(times, &values));
        Self { times: times.to_vec(), values, slopes }
    }

    pub fn at(&self, t: f64) -> Vec<f64> {
        let last = self.times.len() - 1;
        if t <= self.times[0] {
            return self.values[0].clone();
        }
        if t >= self.times[last] {
            return self.values[last].clone();
        }
        let k = self.times.partition_point(|&knot| knot <= t) - 1;
        let h = self.times[k + 1] - self.times[k];
        let x = (t - self.times[k]) / h;
        let (left, right) = (1.0 - x, x);
        let weights = [
            left * left * (1.0 + 2.0 * right),
            right * right * (1.0 + 2.0 * left),
            h * right * left * left,
            -h * left * right * right,
        ];
        (0..self.values[k].len())
            .map(|i| {
                weights[0] * self.values[k][i]
                    + weights[1] * self.values[k + 1][i]
                    + weights[2] * self.slopes[k][i]
                    + weights[3] * self.slopes[k + 1][i]
            })
            .collect()
    }
}

/// Slopes of the clamped cubic spline: `s_{k-1}/h_{k-1} + 2 (1/h_{k-1} + 1/h_k) s_k + s_{k+1}/h_k =
/// 3 (d_{k-1}/h_{k-1}^2 + d_k/h_k^2)` with the differences d, and zero at both ends; by Thomas's algorithm.
fn spline_slopes(times: &[f64], values: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let (n, width) = (times.len(), values.first().map_or(0, Vec::len));
    let mut slopes = vec![vec![0.0; width]; n];
    for i in 0..width {
        let (mut upper, mut right) = (vec![0.0; n], vec![0.0; n]);
        for k in 1..n.saturating_sub(1) {
            let (a, b) = (1.0 / (times[k] - times[k - 1]), 1.0 / (times[k + 1] - times[k]));
            let load =
                3.0 * ((values[k][i] - values[k - 1][i]) * a * a + (values[k + 1][i] - values[k][i]) * b * b);
            let pivot = 2.0 * (a + b) - a * upper[k - 1];
            upper[k] = b / pivot;
            right[k] = (load - a * right[k - 1]) / pivot;
        }
        for k in (1..n.saturating_sub(1)).rev() {
            slopes[k][i] = right[k] - upper[k] * slopes[k + 1][i];
        }
    }
    slopes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_spline_is_twice_continuous_and_rests_at_its_ends() {
        let times = [0.0, 0.4, 1.0, 1.3];
        let values = vec![vec![0.0], vec![1.0], vec![-0.5], vec![0.2]];
        let curve = Curve::new(&times, values, None);
        let d = 1e-4;
        let f = |t: f64| curve.at(t)[0];
        for knot in [0.4, 1.0] {
            let left = (f(knot) - 2.0 * f(knot - d) + f(knot - 2.0 * d)) / (d * d);
            let right = (f(knot) - 2.0 * f(knot + d) + f(knot + 2.0 * d)) / (d * d);
            assert!((left - right).abs() < 0.05 * (1.0 + left.abs()), "{knot}: {left} {right}");
        }
        assert!(((f(d) - f(0.0)) / d).abs() < 1e-2 && ((f(1.3) - f(1.3 - d)) / d).abs() < 1e-2);
        assert_eq!((f(-1.0), f(2.0)), (0.0, 0.2));
    }
}
