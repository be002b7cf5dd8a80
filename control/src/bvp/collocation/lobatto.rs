//! Lobatto quadrature as a collocation method (Lobatto IIIA).
//!
//! $$ z(c_i) = z(0) + h \sum_j a_{ij} \thinspace g_j, \qquad a_{ij} = \int_0^{c_i} \ell_j(c) \thinspace dc $$
//!
//! with the Lagrange polynomials `l_j` of the points. Source: E. Hairer, G. Wanner, *Solving Ordinary
//! Differential Equations II*, Springer 1996, section IV.5.

use crate::numerics::lu;
use std::sync::OnceLock;

/// Collocation at the s Lobatto points c_j on [0, 1], which include both ends.
///
/// On an interval of length h the polynomial of degree s with `z' = g(z)` at all c_j satisfies `z(c_i) = z(0)
/// + h sum_j a_ij g_j`. Its end value is the quadrature, of order 2s - 2. s = 3 is Simpson's rule.
#[derive(Debug)]
pub(crate) struct Lobatto {
    /// c_j, rising from 0 to 1.
    pub points: Vec<f64>,
    /// a_ij, s x s; the last row has the weights of the quadrature.
    pub a: Vec<f64>,
    /// `integrals[j][k]`: coefficient of `c^(k+1)` in the integral of the j-th Lagrange polynomial from 0 to
    /// c.
    integrals: Vec<f64>,
}

impl Lobatto {
    /// The method with s = 3, 4 or 5 points: order 4, 6 or 8. Each is made once.
    pub fn of(points: usize) -> &'static Self {
        static METHODS: [OnceLock<Lobatto>; 3] = [const { OnceLock::new() }; 3];
        let s = points.clamp(3, 5);
        METHODS[s - 3].get_or_init(|| Self::new(s))
    }

    fn new(points: usize) -> Self {
        let inner = match points {
            0..=3 => vec![0.5],
            4 => {
                let half = 0.2_f64.sqrt() / 2.0;
                vec![0.5 - half, 0.5 + half]
            }
            _ => {
                let half = (3.0_f64 / 7.0).sqrt() / 2.0;
                vec![0.5 - half, 0.5, 0.5 + half]
            }
        };
        let points: Vec<f64> = std::iter::once(0.0).chain(inner).chain([1.0]).collect();
        let s = points.len();
        // Coefficients of the Lagrange polynomials: the inverse of the matrix of powers.
        let mut powers: Vec<f64> =
            points.iter().flat_map(|&c| (0..s).map(move |k| c.powi(k as i32))).collect();
        let mut coefficients: Vec<f64> =
            (0..s * s).map(|e| if e % (s + 1) == 0 { 1.0 } else { 0.0 }).collect();
        let mut exchanges = vec![0; s];
        lu::eliminate(&mut powers, s, s, &mut exchanges);
        lu::solve(&powers, s, &exchanges, &mut coefficients, s);
        let mut integrals = vec![0.0; s * s];
        for j in 0..s {
            for k in 0..s {
                integrals[j * s + k] = coefficients[k * s + j] / (k + 1) as f64;
            }
        }
        let mut method = Self { points, a: vec![0.0; s * s], integrals };
        for i in 0..s {
            for j in 0..s {
                method.a[i * s + j] = method.weight(j, method.points[i]);
            }
        }
        method
    }

    /// Number of points, s.
    pub fn len(&self) -> usize {
        self.points.len()
    }

    /// Order of the end value, 2s - 2.
    pub fn order(&self) -> usize {
        2 * self.len() - 2
    }

    /// Weights of the quadrature over [0, 1].
    pub fn weights(&self) -> &[f64] {
        &self.a[self.a.len() - self.len()..]
    }

    /// The j-th Lagrange polynomial at c.
    pub fn lagrange(&self, j: usize, c: f64) -> f64 {
        let s = self.len();
        let coefficients = self.integrals[j * s..(j + 1) * s].iter().enumerate().rev();
        coefficients.fold(0.0, |sum, (k, integral)| sum * c + (k + 1) as f64 * integral)
    }

    /// Integral of the j-th Lagrange polynomial from 0 to c: weight of h g_j in `z(c) - z(0)`.
    pub fn weight(&self, j: usize, c: f64) -> f64 {
        let s = self.len();
        self.integrals[j * s..(j + 1) * s].iter().rev().fold(0.0, |sum, k| (sum + k) * c)
    }
}

#[cfg(test)]
mod tests {
    use super::Lobatto;

    #[test]
    fn quadratures_integrate_powers_up_to_their_order() {
        for (s, order) in [(3, 4), (4, 6), (5, 8)] {
            let method = Lobatto::of(s);
            assert_eq!(method.order(), order);
            for k in 0..order {
                let sum: f64 =
                    method.points.iter().zip(method.weights()).map(|(c, w)| w * c.powi(k as i32)).sum();
                assert!((sum - 1.0 / (k + 1) as f64).abs() < 1e-14, "{s} points, power {k}: {sum}");
            }
            let beyond: f64 =
                method.points.iter().zip(method.weights()).map(|(c, w)| w * c.powi(order as i32)).sum();
            assert!((beyond - 1.0 / (order + 1) as f64).abs() > 1e-5);
        }
    }

    #[test]
    fn polynomials_of_degree_s_are_collocated_exactly() {
        let method = Lobatto::of(4);
        for c in [0.1, 0.37, 0.9] {
            // z = c^4, z' = 4 c^3.
            let z: f64 =
                method.points.iter().enumerate().map(|(j, p)| method.weight(j, c) * 4.0 * p.powi(3)).sum();
            assert!((z - c.powi(4)).abs() < 1e-15);
        }
    }
}
