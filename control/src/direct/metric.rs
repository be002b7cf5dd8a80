//! The metric of damping: how far a step moves the accelerations, as torques.

use super::basis::{Basis, PLACES, POINTS};
use super::ends::Ends;
use super::points::Points;
use super::scatter::{add_inner, add_node, remove, scaled};
use super::spline::Spline;
use crate::numerics::block_tridiagonal::BlockTridiagonal;

/// Adds `sum w T (M da)' R (M da)` to a matrix of zeros; R is diagonal, `weights`.
pub(super) fn fill_metric(
    matrix: &mut BlockTridiagonal,
    spline: &Spline,
    points: &Points,
    weights: &[f64],
    ends: &Ends,
) {
    let (n, width) = (spline.dof, 3 * spline.dof);
    let scales = [1.0, 1.0 / spline.time, 1.0 / (spline.time * spline.time)];
    let mut hessian = vec![0.0; width * width];
    let mut product = vec![0.0; 2 * width * width];
    for p in 0..points.count() {
        let weight = spline.point(p).1 * spline.time;
        let tau_z = points.tau_z(p);
        for i in 0..n {
            for j in 0..n {
                let entries = (0..n).map(|l| {
                    let r = weights[l];
                    r * tau_z[width * l + 2 * n + i] * tau_z[width * l + 2 * n + j]
                });
                hessian[width * (2 * n + i) + 2 * n + j] = weight * entries.sum::<f64>();
            }
        }
        let (k, j) = (p / POINTS, p % POINTS);
        if j == 0 {
            add_node(matrix, k, n, &hessian, scales);
        } else {
            let basis = scaled(&Basis::at(PLACES[j - 1], spline.width(k)), scales);
            add_inner(matrix, k, n, &hessian, &basis, &mut product);
        }
    }
    for (k, fixed) in [(0, &ends.start), (spline.intervals(), &ends.end)] {
        (0..width).filter(|&i| fixed[i].is_some()).for_each(|i| remove(matrix, k, i, width));
    }
}
