//! Lagrange's polynomials: 1 at one place, 0 at the others.

/// The values of all of them at x,
///
/// $$ \ell_m(x) = \prod_{l \ne m} \frac{x - x_l}{x_m - x_l} $$
pub(crate) const fn values<const N: usize>(places: &[f64; N], x: f64) -> [f64; N] {
    let mut values = [1.0; N];
    let mut m = 0;
    while m < N {
        let mut l = 0;
        while l < N {
            if l != m {
                values[m] *= (x - places[l]) / (places[m] - places[l]);
            }
            l += 1;
        }
        m += 1;
    }
    values
}

/// Their derivatives at x,
///
/// $$ \ell_m'(x) = \sum_{l \ne m} \frac{1}{x_m - x_l} \prod_{i \ne l, m} \frac{x - x_i}{x_m - x_i} $$
pub(crate) const fn slopes<const N: usize>(places: &[f64; N], x: f64) -> [f64; N] {
    let mut slopes = [0.0; N];
    let mut m = 0;
    while m < N {
        let mut l = 0;
        while l < N {
            if l != m {
                let mut product = 1.0 / (places[m] - places[l]);
                let mut i = 0;
                while i < N {
                    if i != m && i != l {
                        product *= (x - places[i]) / (places[m] - places[i]);
                    }
                    i += 1;
                }
                slopes[m] += product;
            }
            l += 1;
        }
        m += 1;
    }
    slopes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quartics_through_five_places_are_exact() {
        let places = [0.0, 0.1, 0.5, 0.8, 1.0];
        let (y, slope) = (|x: f64| 0.3 - x + 2.0 * x.powi(4), |x: f64| 8.0 * x.powi(3) - 1.0);
        for x in [0.0, 0.1, 0.3, 0.8, 1.0] {
            let sum = |factors: [f64; 5]| -> f64 { factors.iter().zip(places).map(|(f, x)| f * y(x)).sum() };
            assert!((sum(values(&places, x)) - y(x)).abs() < 1e-13, "{x}");
            assert!((sum(slopes(&places, x)) - slope(x)).abs() < 1e-12, "{x}");
        }
    }
}
