//! From derivatives in z = (q, v, a) at the points of an interval to those in the unknowns of a spline.

use super::shape::{MOST_COEFFICIENTS, MOST_POINTS, Shape};
use super::spline::{Spline, TimeDerivative};
use crate::numerics::chain::ChainMatrix;

/// The Hessians of the points of an interval on their way into a matrix.
///
/// All derivatives of z in the coefficients are numbers times the identity. So Hessians are kept as
/// blocks, n x n for each pair of derivatives or of coefficients, and whole blocks are combined.
#[derive(Clone, Debug, Default)]
pub(super) struct IntervalHessian {
    shape: Shape,
    /// The blocks of a Hessian in z: 3 x 3.
    blocks: Vec<f64>,
    /// B'H of each point: 3 blocks for each coefficient.
    products: Vec<f64>,
    /// B'H B: a block for each pair of coefficients.
    sums: Vec<f64>,
    /// B of each point: derivatives of q, v, a in the coefficients.
    factors: [[[f64; MOST_COEFFICIENTS]; 3]; MOST_POINTS],
}

impl IntervalHessian {
    /// Room for n joints.
    pub fn new(n: usize, shape: Shape) -> Self {
        let count = shape.coefficients();
        Self {
            shape,
            blocks: vec![0.0; 9 * n * n],
            products: vec![0.0; shape.places().len() * count * 3 * n * n],
            sums: vec![0.0; count * (count + 1) / 2 * n * n],
            ..Self::default()
        }
    }

    /// Takes the Hessian of point `j`, 3n x 3n.
    #[inline(always)]
    pub fn take(&mut self, j: usize, n: usize, factors: [[f64; MOST_COEFFICIENTS]; 3], hessian: &[f64]) {
        self.factors[j] = factors;
        let square = n * n;
        for (row, entries) in hessian.chunks_exact(3 * n).enumerate() {
            for (t, entries) in entries.chunks_exact(n).enumerate() {
                self.blocks[(3 * (row / n) + t) * square + row % n * n..][..n].copy_from_slice(entries);
            }
        }
        let size = self.shape.coefficients() * 3 * square;
        let (of_q, rest) = self.blocks.split_at(3 * square);
        let (of_v, of_a) = rest.split_at(3 * square);
        let products = self.products[size * j..size * (j + 1)].chunks_exact_mut(3 * square);
        for (a, product) in products.enumerate() {
            let [f, g, h] = [factors[0][a], factors[1][a], factors[2][a]];
            for (to, (q, (v, a))) in product.iter_mut().zip(of_q.iter().zip(of_v.iter().zip(of_a))) {
                *to = f * q + (g * v + h * a);
            }
        }
    }

    /// Adds B'H B of the first points, so many, to the rows of interval `k` and of its ends.
    #[inline(always)]
    pub fn add_to(&mut self, matrix: &mut ChainMatrix, k: usize, n: usize, points: usize) {
        let (square, count) = (n * n, self.shape.coefficients());
        let size = count * 3 * square;
        let pairs = (0..count).flat_map(|a| (a..count).map(move |b| (a, b)));
        for ((a, b), sum) in pairs.zip(self.sums.chunks_exact_mut(square)) {
            let mut overwrite = true;
            let of_points = self.factors[..points].iter().zip(self.products.chunks_exact(size));
            for (factors, products) in of_points {
                let [f, g, h] = [factors[0][b], factors[1][b], factors[2][b]];
                let row = &products[3 * square * a..3 * square * (a + 1)];
                let (of_q, rest) = row.split_at(square);
                let (of_v, of_a) = rest.split_at(square);
                let entries = of_q.iter().zip(of_v.iter().zip(of_a));
                if overwrite {
                    for (to, (q, (v, a))) in sum.iter_mut().zip(entries) {
                        *to = f * q + (g * v + h * a);
                    }
                } else {
                    for (to, (q, (v, a))) in sum.iter_mut().zip(entries) {
                        *to += f * q + (g * v + h * a);
                    }
                }
                overwrite = false;
            }
        }
        self.scatter(matrix, k, n);
    }

    /// Adds the blocks to the rows of a matrix.
    #[inline(always)]
    fn scatter(&self, matrix: &mut ChainMatrix, k: usize, n: usize) {
        let (count, node, own) = (self.shape.coefficients(), self.shape.node(), self.shape.inner());
        let (inner, left, right) = matrix.interval(k);
        let [inner_width, node_width] = [count * n, 2 * node * n];
        let pairs = (0..count).flat_map(|a| (a..count).map(move |b| (a, b)));
        for ((a, b), block) in pairs.zip(self.sums.chunks_exact(n * n)) {
            let (rows, width, row, column) = if a < own {
                (&mut inner[..], inner_width, a, b)
            } else if a < own + node {
                (&mut left[..], node_width, a - own, b - own)
            } else {
                (&mut right[..], node_width, a - own - node, b - own - node)
            };
            let rows = rows[width * row * n..].chunks_exact_mut(width);
            for (row, block) in rows.zip(block.chunks_exact(n)) {
                row[column * n..][..n].iter_mut().zip(block).for_each(|(to, entry)| *to += entry);
            }
        }
    }
}

/// Adds a gradient in z at a point of interval `k` to one in the unknowns.
#[inline(always)]
pub(super) fn add_gradient(
    spline: &Spline,
    k: usize,
    factors: &[[f64; MOST_COEFFICIENTS]; 3],
    from: &[f64],
    to: &mut [f64],
) {
    let (n, node, own) = (spline.dof, spline.node(), spline.mesh.shape.inner() * spline.dof);
    let (nodes, inner) = to.split_at_mut(node * spline.mesh.nodes.len());
    let blocks = inner[own * k..own * (k + 1)]
        .chunks_exact_mut(n)
        .chain(nodes[node * k..node * (k + 2)].chunks_exact_mut(n));
    for (b, to) in blocks.enumerate() {
        let [f, g, h] = [factors[0][b], factors[1][b], factors[2][b]];
        let [of_q, of_v, of_a] = [0, 1, 2].map(|s| &from[s * n..][..n]);
        for (i, to) in to.iter_mut().enumerate() {
            *to += f * of_q[i] + (g * of_v[i] + h * of_a[i]);
        }
    }
}

/// Adds what the derivatives of z by the unknowns change by with the time of the phase, beside what z itself
/// does: those of unknowns that are derivatives in time have a factor `T^m`, and the gradient is one in z.
#[inline(always)]
pub(super) fn add_by_time(
    spline: &Spline,
    k: usize,
    factors: &[[f64; MOST_COEFFICIENTS]; 3],
    from: &[f64],
    to: &mut [f64],
) {
    let n = spline.dof;
    for TimeDerivative { column, order, first } in spline.time_derivatives(k) {
        let scale = order / spline.clock(k);
        let [f, g, h] = [0, 1, 2].map(|s| scale * factors[s][column]);
        let [of_q, of_v, of_a] = [0, 1, 2].map(|s| &from[s * n..][..n]);
        for (i, to) in to[first..first + n].iter_mut().enumerate() {
            *to += f * of_q[i] + (g * of_v[i] + h * of_a[i]);
        }
    }
}

/// Adds a multiple of a row over the unknowns of interval `k`, inner ones first, to a gradient.
pub(super) fn add_local(spline: &Spline, k: usize, row: &[f64], factor: f64, to: &mut [f64]) {
    let (node, own) = (spline.node(), spline.mesh.shape.inner() * spline.dof);
    let (nodes, inner) = to.split_at_mut(node * spline.mesh.nodes.len());
    let entries = inner[own * k..own * (k + 1)].iter_mut().chain(&mut nodes[node * k..node * (k + 2)]);
    entries.zip(row).for_each(|(to, entry)| *to += factor * entry);
}
