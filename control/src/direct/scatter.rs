//! From derivatives in z = (q, v, a) at a point to those in the unknowns of a spline.

use super::basis::{Basis, COEFFICIENTS, PLACES, POINTS};
use super::spline::Spline;
use crate::numerics::block_tridiagonal::BlockTridiagonal;

/// Factors of the derivatives in time: those in s, times 1, 1/T, 1/T^2.
pub(super) fn scaled(basis: &Basis, scales: [f64; 3]) -> [[f64; COEFFICIENTS]; 3] {
    let rows = basis.rows();
    [0, 1, 2].map(|s| rows[s].map(|factor| factor * scales[s]))
}

/// Adds the Hessian of a node to its diagonal block.
pub(super) fn add_node(matrix: &mut BlockTridiagonal, k: usize, n: usize, hessian: &[f64], scales: [f64; 3]) {
    let width = 3 * n;
    for (i, (to, from)) in
        matrix.block_row(k).chunks_exact_mut(2 * width).zip(hessian.chunks_exact(width)).enumerate()
    {
        for j in i..width {
            to[j] += scales[i / n] * scales[j / n] * from[j];
        }
    }
}

/// Adds the Hessian of an inner point to the blocks of its interval.
pub(super) fn add_inner(
    matrix: &mut BlockTridiagonal,
    k: usize,
    n: usize,
    hessian: &[f64],
    basis: &[[f64; COEFFICIENTS]; 3],
    product: &mut [f64],
) {
    let width = 3 * n;
    // product[i] = sum over t of H[i, t] basis[t][b], columns b n + j.
    for (to, from) in product.chunks_exact_mut(2 * width).zip(hessian.chunks_exact(width)) {
        for (b, to) in to.chunks_exact_mut(n).enumerate() {
            let [f0, f1, f2] = [basis[0][b], basis[1][b], basis[2][b]];
            for j in 0..n {
                to[j] = f0 * from[j] + f1 * from[n + j] + f2 * from[2 * n + j];
            }
        }
    }
    let (here, next) = matrix.block_rows(k);
    for (a, i) in (0..COEFFICIENTS).flat_map(|a| (0..n).map(move |i| (a, i))) {
        let factors = [basis[0][a], basis[1][a], basis[2][a]];
        let [p0, p1, p2] = [0, 1, 2].map(|s| &product[2 * width * (s * n + i)..][..2 * width]);
        let (to, from) = if a < 3 {
            (&mut here[2 * width * (a * n + i)..][a * n..2 * width], a * n)
        } else {
            (&mut next[2 * width * ((a - 3) * n + i)..][(a - 3) * n..width], a * n)
        };
        for (j, to) in to.iter_mut().enumerate() {
            *to += factors[0] * p0[from + j] + factors[1] * p1[from + j] + factors[2] * p2[from + j];
        }
    }
}

/// Adds a gradient in z at a point to one in the unknowns.
pub(super) fn add_gradient(
    spline: &Spline,
    p: usize,
    n: usize,
    from: &[f64],
    scales: [f64; 3],
    to: &mut [f64],
) {
    let (k, j) = (p / POINTS, p % POINTS);
    let to = &mut to[3 * n * k..];
    if j == 0 {
        for (i, (to, from)) in to.iter_mut().zip(from).enumerate() {
            *to += scales[i / n] * from;
        }
        return;
    }
    let basis = scaled(&Basis::at(PLACES[j - 1], spline.width(k)), scales);
    for (b, to) in to.chunks_exact_mut(n).take(COEFFICIENTS).enumerate() {
        for (i, to) in to.iter_mut().enumerate() {
            *to += basis[0][b] * from[i] + basis[1][b] * from[n + i] + basis[2][b] * from[2 * n + i];
        }
    }
}

/// Makes row and column of an unknown those of the identity.
pub(super) fn remove(matrix: &mut BlockTridiagonal, k: usize, i: usize, block: usize) {
    let width = 2 * block;
    let rows = matrix.block_row(k);
    rows[width * i..][..width].fill(0.0);
    (0..i).for_each(|l| rows[width * l + i] = 0.0);
    rows[width * i + i] = 1.0;
    if k > 0 {
        let above = matrix.block_row(k - 1);
        (0..block).for_each(|l| above[width * l + block + i] = 0.0);
    }
}
