//! From derivatives in z = (q, v, a) at the points of an interval to those in the unknowns of a spline.

use crate::direct::motion::shape::{MOST_COEFFICIENTS, MOST_POINTS, Shape};
use crate::direct::motion::spline::{Spline, TimeDerivative};
use crate::numerics::chain::ChainMatrix;
use crate::numerics::padded::{LANES, Parts, combine, padded, sums_of_parts};
use costate_numerics::in_widest;

/// Most blocks that are summed at once.
const MOST_BLOCKS: usize = 4;

/// Length of the rows of a Hessian in z: the last n entries may be read as a padded row.
pub(super) fn row_length(n: usize) -> usize {
    padded(2 * n + padded(n))
}

/// The Hessians of the points of an interval on their way into a matrix.
///
/// All derivatives of z in the coefficients are numbers times the identity. So rows of Hessians are
/// combined as wholes.
#[derive(Clone, Debug, Default)]
pub(super) struct IntervalHessian {
    shape: Shape,
    /// B'H of each point: n padded rows for each coefficient.
    products: Vec<f64>,
    /// B'H B: n padded rows for each pair of coefficients.
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
            products: vec![0.0; shape.places().len() * count * n * row_length(n)],
            sums: vec![0.0; count * (count + 1) / 2 * n * padded(n)],
            ..Self::default()
        }
    }

    /// Takes the Hessian of point `j`: 3n rows of [`row_length`].
    #[inline(never)]
    pub fn take(&mut self, j: usize, n: usize, factors: [[f64; MOST_COEFFICIENTS]; 3], hessian: &[f64]) {
        in_widest!(self.take_rows(j, n, factors, hessian));
    }

    #[inline(always)]
    fn take_rows<const FUSED: bool>(
        &mut self,
        j: usize,
        n: usize,
        factors: [[f64; MOST_COEFFICIENTS]; 3],
        hessian: &[f64],
    ) {
        self.factors[j] = factors;
        let (count, width) = (self.shape.coefficients(), row_length(n));
        let (of_q, rest) = hessian.split_at(n * width);
        let (of_v, of_a) = rest.split_at(n * width);
        let size = count * n * width;
        let products = self.products[size * j..size * (j + 1)].chunks_exact_mut(n * width);
        for (a, product) in products.enumerate() {
            combine::<FUSED>(product, [0, 1, 2].map(|s| factors[s][a]), [of_q, of_v, of_a]);
        }
    }

    /// Adds B'H B of the first points, so many, to the rows of interval `k` and of its ends.
    #[inline(never)]
    pub fn add_to(&mut self, matrix: &mut ChainMatrix, k: usize, n: usize, points: usize) {
        in_widest!(self.add_sums(matrix, k, n, points));
    }

    #[inline(always)]
    fn add_sums<const FUSED: bool>(&mut self, matrix: &mut ChainMatrix, k: usize, n: usize, points: usize) {
        let (count, mut first) = (self.shape.coefficients(), 0);
        for a in 0..count {
            let mut b = a;
            while b < count {
                // Blocks whose sums stay in registers are made from rows that are read once.
                let blocks = (count - b).min(MOST_BLOCKS);
                match blocks {
                    1 => self.sum_blocks::<FUSED, 1>([a, b, first], n, points),
                    2 => self.sum_blocks::<FUSED, 2>([a, b, first], n, points),
                    3 => self.sum_blocks::<FUSED, 3>([a, b, first], n, points),
                    _ => self.sum_blocks::<FUSED, MOST_BLOCKS>([a, b, first], n, points),
                }
                (b, first) = (b + blocks, first + blocks);
            }
        }
        self.scatter(matrix, k, n);
    }

    /// `B` blocks of B'H B, those of coefficient a with b and the next ones; they stand in `sums` from the
    /// block `first`.
    #[inline(always)]
    fn sum_blocks<const FUSED: bool, const B: usize>(
        &mut self,
        [a, b, first]: [usize; 3],
        n: usize,
        points: usize,
    ) {
        let (width, column) = (row_length(n), padded(n));
        let (size, block) = (self.shape.coefficients() * n * width, n * column);
        let mut factors = [[[0.0; B]; 3]; MOST_POINTS];
        for (factors, all) in factors.iter_mut().zip(&self.factors) {
            for (factors, all) in factors.iter_mut().zip(all) {
                factors.copy_from_slice(&all[b..b + B]);
            }
        }
        let sums = &mut self.sums[block * first..block * (first + B)];
        for i in 0..n {
            for at in (0..column).step_by(LANES) {
                let of_points = factors[..points].iter().zip(self.products.chunks_exact(size));
                let terms = of_points.map(|(factors, products)| Parts {
                    rows: &products[n * width * a..n * width * (a + 1)],
                    factors: *factors,
                });
                let found = sums_of_parts::<FUSED, B>(terms, [i, width, n, at]);
                for (sums, found) in sums.chunks_exact_mut(block).zip(&found) {
                    sums[column * i + at..][..LANES].copy_from_slice(found);
                }
            }
        }
    }

    /// Adds the blocks to the rows of a matrix.
    #[inline(always)]
    fn scatter(&self, matrix: &mut ChainMatrix, k: usize, n: usize) {
        let (count, node, own) = (self.shape.coefficients(), self.shape.node(), self.shape.inner());
        let (inner, left, right) = matrix.interval(k);
        let [inner_width, node_width] = [count * n, 2 * node * n];
        let pairs = (0..count).flat_map(|a| (a..count).map(move |b| (a, b)));
        for ((a, b), block) in pairs.zip(self.sums.chunks_exact(n * padded(n))) {
            let (rows, width, row, column) = if a < own {
                (&mut inner[..], inner_width, a, b)
            } else if a < own + node {
                (&mut left[..], node_width, a - own, b - own)
            } else {
                (&mut right[..], node_width, a - own - node, b - own - node)
            };
            let rows = rows[width * row * n..].chunks_exact_mut(width);
            for (row, block) in rows.zip(block.chunks_exact(padded(n))) {
                row[column * n..][..n].iter_mut().zip(block).for_each(|(to, entry)| *to += entry);
            }
        }
    }
}

/// Adds a gradient in z at a point of interval `k` to one in the unknowns.
#[inline(never)]
pub(crate) fn add_gradient(
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
    let [of_q, of_v, of_a] = [&from[..n], &from[n..2 * n], &from[2 * n..3 * n]];
    blocks.enumerate().for_each(|(b, to)| {
        let [f, g, h] = [factors[0][b], factors[1][b], factors[2][b]];
        for (((to, q), v), a) in to.iter_mut().zip(of_q).zip(of_v).zip(of_a) {
            *to += f * q + (g * v + h * a);
        }
    });
}

/// Adds what the derivatives of z by the unknowns change by with the time of the phase, beside what z itself
/// does: those of unknowns that are derivatives in time have a factor `T^m`, and the gradient is one in z.
#[inline(never)]
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
pub(crate) fn add_local(spline: &Spline, k: usize, row: &[f64], factor: f64, to: &mut [f64]) {
    let (node, own) = (spline.node(), spline.mesh.shape.inner() * spline.dof);
    let (nodes, inner) = to.split_at_mut(node * spline.mesh.nodes.len());
    let entries = inner[own * k..own * (k + 1)].iter_mut().chain(&mut nodes[node * k..node * (k + 2)]);
    entries.zip(row).for_each(|(to, entry)| *to += factor * entry);
}
