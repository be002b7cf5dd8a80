//! Cubic B-splines on [0, 1] with equal intervals.

/// Number of basis functions that are not zero on an interval.
pub(crate) const ACTIVE: usize = 4;

/// Basis of twice continuously differentiable piecewise cubics; at both ends the first two (last two) coefficients alone
/// decide value and slope.
#[derive(Clone, Debug)]
pub(crate) struct Basis {
    pub intervals: usize,
    knots: Vec<f64>,
}

impl Basis {
    pub fn new(intervals: usize) -> Self {
        let last = intervals as f64;
        let knot = |k: usize| (k as f64 - 3.0).clamp(0.0, last) / last;
        Self { intervals, knots: (0..intervals + 7).map(knot).collect() }
    }

    /// Number of coefficients.
    pub fn len(&self) -> usize {
        self.intervals + 3
    }

    /// Where on [0, 1] coefficient k has its place: a path that is linear in s has its own values there as coefficients.
    pub fn place(&self, k: usize) -> f64 {
        self.knots[k + 1..k + 4].iter().sum::<f64>() / 3.0
    }

    /// Coefficient k of a path that is one cubic around it, from value and derivatives of that cubic in s at `s`: its blossom
    /// at the three knots inside the support.
    pub fn coefficient(&self, k: usize, s: f64, [value, first, second, third]: [f64; 4]) -> f64 {
        let [x, y, z] = [1, 2, 3].map(|i| self.knots[k + i] - s);
        value + first * (x + y + z) / 3.0 + second * (x * y + y * z + z * x) / 6.0 + third * x * y * z / 6.0
    }

    /// The middle of an interval on which function k is not zero.
    pub fn middle(&self, k: usize) -> f64 {
        (k.saturating_sub(2).min(self.intervals - 1) as f64 + 0.5) / self.intervals as f64
    }

    /// The interval that s lies on.
    pub fn interval(&self, s: f64) -> usize {
        ((s * self.intervals as f64) as usize).min(self.intervals - 1)
    }

    /// Values and first three derivatives in s of the functions `interval .. interval + 4` at s.
    pub fn at(&self, interval: usize, s: f64) -> [[f64; ACTIVE]; 4] {
        let entry = |order, k| self.derivative(order, 3, interval + k, interval, s);
        [0, 1, 2, 3].map(|order| [0, 1, 2, 3].map(|k| entry(order, k)))
    }

    /// That of order `order` of function k of a degree: the difference of two of one degree less.
    fn derivative(&self, order: usize, degree: usize, k: usize, interval: usize, s: f64) -> f64 {
        if degree == 0 {
            return if k == interval + 3 && order == 0 { 1.0 } else { 0.0 };
        }
        let t = &self.knots;
        let (left, right) = (t[k + degree] - t[k], t[k + degree + 1] - t[k + 1]);
        let part = |length: f64, factor: f64, k: usize| {
            let lower = order.saturating_sub(1);
            if length > 0.0 {
                factor / length * self.derivative(lower, degree - 1, k, interval, s)
            } else {
                0.0
            }
        };
        if order == 0 {
            part(left, s - t[k], k) + part(right, t[k + degree + 1] - s, k + 1)
        } else {
            let degree = degree as f64;
            part(left, degree, k) - part(right, degree, k + 1)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_finer_basis_holds_the_same_path() {
        let (coarse, fine) = (Basis::new(4), Basis::new(8));
        let c = |k: usize| (k as f64 * 1.3).sin();
        let at = |basis: &Basis, c: &dyn Fn(usize) -> f64, s: f64| {
            let interval = basis.interval(s);
            basis.at(interval, s).map(|values| (0..ACTIVE).map(|k| values[k] * c(interval + k)).sum::<f64>())
        };
        let finer = |k: usize| fine.coefficient(k, fine.middle(k), at(&coarse, &c, fine.middle(k)));
        for i in 0..=30 {
            let s = f64::from(i) / 30.0;
            let (a, b) = (at(&coarse, &c, s)[0], at(&fine, &finer, s)[0]);
            assert!((a - b).abs() < 1e-13, "{s}: {a} {b}");
        }
    }

    #[test]
    fn lines_and_cubics_are_reproduced() {
        let basis = Basis::new(5);
        for i in 0..=20 {
            let s = f64::from(i) / 20.0;
            let interval = basis.interval(s);
            let values = basis.at(interval, s);
            let sum = |order: usize, c: &dyn Fn(usize) -> f64| -> f64 {
                (0..ACTIVE).map(|k| values[order][k] * c(interval + k)).sum()
            };
            assert!((sum(0, &|_| 1.0) - 1.0).abs() < 1e-14 && sum(1, &|_| 1.0).abs() < 1e-12);
            assert!((sum(0, &|k| basis.place(k)) - s).abs() < 1e-14);
            assert!((sum(1, &|k| basis.place(k)) - 1.0).abs() < 1e-12);
            assert!(sum(2, &|k| basis.place(k)).abs() < 1e-10);
            // The blossom of s^3 at three knots in a row gives its coefficients.
            let cube = |k: usize| basis.knots[k + 1..k + 4].iter().product::<f64>();
            assert!((sum(0, &cube) - s.powi(3)).abs() < 1e-14, "{s}");
            assert!((sum(1, &cube) - 3.0 * s * s).abs() < 1e-12);
            assert!((sum(2, &cube) - 6.0 * s).abs() < 1e-10);
            assert!((sum(3, &cube) - 6.0).abs() < 1e-9);
        }
    }
}
