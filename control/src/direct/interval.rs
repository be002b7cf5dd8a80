//! From derivatives in z = (q, v, a) at the points of an interval to those in the unknowns of a spline.

use super::basis::{COEFFICIENTS, POINTS};
use super::spline::Spline;
use crate::numerics::chain::ChainMatrix;

/// The Hessians of the points of an interval on their way into a matrix.
#[derive(Clone, Debug, Default)]
pub(super) struct IntervalHessian {
    /// B'H of each point, 5n x 3n.
    products: Vec<f64>,
    /// B of each point: derivatives of q, v, a in the coefficients.
    factors: [[[f64; COEFFICIENTS]; 3]; POINTS],
}

impl IntervalHessian {
    /// Room for n joints.
    pub fn new(n: usize) -> Self {
        Self { products: vec![0.0; POINTS * COEFFICIENTS * 3 * n * n], ..Self::default() }
    }

    /// Takes the Hessian of point `j`, 3n x 3n.
    #[inline(always)]
    pub fn take(&mut self, j: usize, n: usize, factors: [[f64; COEFFICIENTS]; 3], hessian: &[f64]) {
        let width = 3 * n;
        self.factors[j] = factors;
        let size = COEFFICIENTS * n * width;
        let (of_q, rest) = hessian.split_at(n * width);
        let (of_v, of_a) = rest.split_at(n * width);
        let products = self.products[size * j..size * (j + 1)].chunks_exact_mut(n * width);
        for (a, product) in products.enumerate() {
            let [f, g, h] = [factors[0][a], factors[1][a], factors[2][a]];
            for (to, (q, (v, a))) in product.iter_mut().zip(of_q.iter().zip(of_v.iter().zip(of_a))) {
                *to = f * q + (g * v + h * a);
            }
        }
    }

    /// Adds B'H B of all points to the rows of interval `k` and of its ends.
    #[inline(always)]
    pub fn add_to(&self, matrix: &mut ChainMatrix, k: usize, n: usize) {
        let [inner_width, node_width, width] = [COEFFICIENTS * n, 4 * n, 3 * n];
        let (inner, left, right) = matrix.interval(k);
        let size = COEFFICIENTS * n * width;
        for row in 0..COEFFICIENTS * n {
            let (a, i) = (row / n, row % n);
            let to = match a {
                0 => &mut inner[inner_width * i..][..inner_width],
                1 | 2 => &mut left[node_width * (row - n)..][(a - 1) * n..node_width],
                _ => &mut right[node_width * (row - 3 * n)..][(a - 3) * n..2 * n],
            };
            let parts: [&[f64]; POINTS] =
                std::array::from_fn(|j| &self.products[size * j + width * row..][..width]);
            for (b, to) in (a..COEFFICIENTS).zip(to.chunks_exact_mut(n)) {
                for (j, part) in parts.iter().enumerate() {
                    let factors = &self.factors[j];
                    let [f, g, h] = [factors[0][b], factors[1][b], factors[2][b]];
                    let [of_q, of_v, of_a] = [0, 1, 2].map(|s| &part[s * n..][..n]);
                    for (l, to) in to.iter_mut().enumerate() {
                        *to += f * of_q[l] + (g * of_v[l] + h * of_a[l]);
                    }
                }
            }
        }
    }
}

/// Adds a gradient in z at a point of interval `k` to one in the unknowns.
#[inline(always)]
pub(super) fn add_gradient(
    spline: &Spline,
    k: usize,
    factors: &[[f64; COEFFICIENTS]; 3],
    from: &[f64],
    to: &mut [f64],
) {
    let n = spline.dof;
    let (nodes, inner) = to.split_at_mut(2 * n * spline.mesh.nodes.len());
    let blocks = inner[n * k..n * (k + 1)]
        .chunks_exact_mut(n)
        .chain(nodes[2 * n * k..2 * n * (k + 2)].chunks_exact_mut(n));
    for (b, to) in blocks.enumerate() {
        let [f, g, h] = [factors[0][b], factors[1][b], factors[2][b]];
        let [of_q, of_v, of_a] = [0, 1, 2].map(|s| &from[s * n..][..n]);
        for (i, to) in to.iter_mut().enumerate() {
            *to += f * of_q[i] + (g * of_v[i] + h * of_a[i]);
        }
    }
}
