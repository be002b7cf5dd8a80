//! Powers of growth: straight lines through logarithms.

/// `y = factor x^exponent`, by least squares of the logarithms.
#[derive(Clone, Copy, Debug)]
pub struct Power {
    pub exponent: f64,
    /// Standard error of the exponent.
    pub error: f64,
    pub factor: f64,
}

impl Power {
    /// Through these points; `None` of less than three.
    pub fn through(points: &[(f64, f64)]) -> Option<Self> {
        let count = points.len() as f64;
        if points.len() < 3 {
            return None;
        }
        let logs: Vec<(f64, f64)> = points.iter().map(|(x, y)| (x.ln(), y.ln())).collect();
        let mean = |of: fn(&(f64, f64)) -> f64| logs.iter().map(of).sum::<f64>() / count;
        let (x, y) = (mean(|p| p.0), mean(|p| p.1));
        let squares: f64 = logs.iter().map(|p| (p.0 - x).powi(2)).sum();
        let exponent = logs.iter().map(|p| (p.0 - x) * (p.1 - y)).sum::<f64>() / squares;
        let residuals: f64 = logs.iter().map(|p| (p.1 - y - exponent * (p.0 - x)).powi(2)).sum();
        let error = (residuals / (count - 2.0) / squares).sqrt();
        Some(Self { exponent, error, factor: (y - exponent * x).exp() })
    }

    pub fn at(&self, x: f64) -> f64 {
        self.factor * x.powf(self.exponent)
    }
}

#[cfg(test)]
mod tests {
    use super::Power;

    #[test]
    fn a_power_is_found_again() {
        let points: Vec<(f64, f64)> =
            [2.0_f64, 3.0, 7.0, 20.0].iter().map(|x| (*x, 0.3 * x.powf(1.7))).collect();
        let power = Power::through(&points).unwrap();
        assert!((power.exponent - 1.7).abs() < 1e-12 && power.error < 1e-12);
        assert!((power.at(5.0) - 0.3 * 5.0_f64.powf(1.7)).abs() < 1e-12);
        assert!(Power::through(&points[..2]).is_none());
    }
}
