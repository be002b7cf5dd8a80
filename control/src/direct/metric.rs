//! The metric of damping: how far a step moves the accelerations, as torques.

use super::basis::POINTS;
use super::ends::Ends;
use super::interval::IntervalHessian;
use super::points::Points;
use super::spline::Spline;
use crate::numerics::chain::ChainMatrix;

/// Room for the metric of a point, and of an interval.
#[derive(Clone, Debug, Default)]
pub(super) struct Metric {
    hessian: Vec<f64>,
    interval: IntervalHessian,
}

impl Metric {
    /// Room for n joints.
    pub fn new(n: usize) -> Self {
        Self { hessian: vec![0.0; 9 * n * n], interval: IntervalHessian::new(n) }
    }

    /// Adds `sum w T (M da)' R (M da)` to a matrix of zeros; R is diagonal, `weights`.
    pub fn fill(
        &mut self,
        matrix: &mut ChainMatrix,
        spline: &Spline,
        points: &Points,
        weights: &[f64],
        ends: &Ends,
    ) {
        let (n, width) = (spline.dof, 3 * spline.dof);
        for p in 0..points.count() {
            let weight = spline.mesh.point(p).1 * spline.time;
            let tau_z = points.tau_z(p);
            for i in 0..n {
                for j in 0..n {
                    let entries = (0..n).map(|l| {
                        let row = &tau_z[width * l + 2 * n..][..n];
                        weights[l] * row[i] * row[j]
                    });
                    self.hessian[width * (2 * n + i) + 2 * n + j] = weight * entries.sum::<f64>();
                }
            }
            let (k, j) = (p / POINTS, p % POINTS);
            self.interval.take(j, n, spline.mesh.basis[p].in_time(1.0 / spline.time), &self.hessian);
            if j + 1 == POINTS {
                self.interval.add_to(matrix, k, n);
            }
        }
        ends.all(spline.mesh.intervals()).for_each(|(k, i, _)| matrix.remove(k, i));
    }
}
