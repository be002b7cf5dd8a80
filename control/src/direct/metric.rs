//! The metric of damping: how far a step moves the accelerations, as torques.

use super::interval::IntervalHessian;
use super::points::Points;
use super::shape::Shape;
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
    pub fn new(n: usize, shape: Shape) -> Self {
        Self { hessian: vec![0.0; 9 * n * n], interval: IntervalHessian::new(n, shape) }
    }

    /// Adds `sum w T (M da)' R (M da)` to a matrix of zeros; R is diagonal, `weights`.
    pub fn fill(&mut self, matrix: &mut ChainMatrix, spline: &Spline, points: &Points, weights: &[f64]) {
        let (n, width) = (spline.dof, 3 * spline.dof);
        for p in 0..points.count() {
            let weight = spline.weight(p);
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
            let (k, j) = spline.mesh.interval_of(p);
            let factors = spline.basis(k, j).in_time(1.0 / spline.clock(k));
            self.interval.take(j, n, factors, &self.hessian);
            let points = spline.mesh.own_points(k);
            if j + 1 == points {
                self.interval.add_to(matrix, k, n, points);
            }
        }
    }
}
