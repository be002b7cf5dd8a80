//! Estimated errors of the cost.

use super::interior::Interior;
use super::points::POINTS;
use crate::numerics::lagrange;

/// Integral over (0, 1) of the square of the cubic that vanishes at Radau's points and is 1 at 0: it is half
/// the difference of Legendre's polynomials of degrees three and two, so (1/7 + 1/5) / 4.
const MEAN_SQUARE: f64 = 3.0 / 35.0;

impl Interior {
    /// Where u is smooth, the optimal one differs on interval k by about a cubic that vanishes at the points.
    /// u is exact at the end of the interval before, so that the jump at the node is the value of the cubic
    /// there:
    ///
    /// $$ \Delta J_k = \tfrac12 h T \Delta u^\top H_{uu} \Delta u \int_0^1 c(s)^2 ds $$
    ///
    /// with the Hessian at the first point. Needs that of the iterate, without barriers.
    pub fn errors_of_cost(&self) -> Vec<f64> {
        let (n, m) = (self.layout.n, self.layout.m);
        let size = n + m;
        let [_, a, b, c] = self.radau.places;
        let at_0 = lagrange::values(&[a, b, c], 0.0);
        let mut jump = vec![0.0; m];
        let mut errors = vec![0.0; self.layout.intervals];
        for (k, error) in errors.iter_mut().enumerate().skip(1) {
            for (i, jump) in jump.iter_mut().enumerate() {
                let u = |k: usize, j: usize| self.w[self.layout.point(k, j) + n + i];
                let first: f64 = (0..POINTS).map(|j| at_0[j] * u(k, j)).sum();
                let at = self.layout.point(k, 0) + n + i;
                *jump = first.max(self.low[at]).min(self.high[at]) - u(k - 1, POINTS - 1);
            }
            let hessian = &self.intervals[k].hessian;
            let mut square = 0.0;
            for (i, row) in hessian[n * size..size * size].chunks_exact(size).enumerate() {
                square += jump[i] * row[n..].iter().zip(&jump).map(|(h, jump)| h * jump).sum::<f64>();
            }
            *error = 0.5 * MEAN_SQUARE * square.abs() / self.radau.weights[0];
        }
        // The first interval has none before it.
        if let [first, second, ..] = errors.as_mut_slice() {
            *first = *second;
        }
        errors
    }
}
