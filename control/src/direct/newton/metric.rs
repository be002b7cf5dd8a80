//! The metric of damping: how far a step moves the accelerations, and a little the rates and positions, as
//! torques.

use super::interval::{IntervalHessian, row_length};
use crate::constants::direct::REST_OF_METRIC;
use crate::direct::limits::barrier::Barrier;
use crate::direct::limits::side::{Limited, Side};
use crate::direct::motion::shape::Shape;
use crate::direct::motion::spline::Spline;
use crate::direct::points::running::Running;
use crate::direct::points::values::Points;
use crate::numerics::chain::ChainMatrix;
use crate::numerics::padded::{add_squares, padded};
use costate_numerics::in_widest;

/// Weights of squared changes of torques in the metric: the effort; without it this cost of a second over the
/// square of the range of the torque.
pub(in crate::direct) fn weigh_torques(running: &Running, barrier: &Barrier, rate: f64, to: &mut [f64]) {
    for (joint, (to, &effort)) in to.iter_mut().zip(&running.effort).enumerate() {
        let own = |side: &&Side| side.limited == Limited::Torque && side.joint == joint;
        let range = || barrier.sides().iter().find(own).map_or(1.0, |side| side.range);
        *to = if effort > 0.0 { effort } else { rate / range().powi(2) };
    }
}

/// Room for the metric of a point, and of an interval.
#[derive(Clone, Debug, Default)]
pub(super) struct Metric {
    /// M and M'RM of a point, in padded rows.
    mass: Vec<f64>,
    square: Vec<f64>,
    hessian: Vec<f64>,
    interval: IntervalHessian,
}

impl Metric {
    /// Room for n joints.
    pub fn new(n: usize, shape: Shape) -> Self {
        let square = || vec![0.0; n * padded(n)];
        Self {
            mass: square(),
            square: square(),
            hessian: vec![0.0; 3 * n * row_length(n)],
            interval: IntervalHessian::new(n, shape),
        }
    }

    /// Adds `sum w T ((M da)' R (M da) + c (M dv/T)' R (M dv/T) + c (M dq/T^2)' R (M dq/T^2))` to a matrix of
    /// zeros; R is diagonal, `weights`. With the small part c every change costs something, that of positions
    /// alone too, which is left where they are free at both ends.
    pub fn fill(&mut self, matrix: &mut ChainMatrix, spline: &Spline, points: &Points, weights: &[f64]) {
        let (n, width) = (spline.dof, padded(spline.dof));
        for p in 0..points.count() {
            let weight = spline.weight(p);
            for (to, tau_z) in self.mass.chunks_exact_mut(width).zip(points.tau_z(p).chunks_exact(3 * n)) {
                to[..n].copy_from_slice(&tau_z[2 * n..]);
            }
            self.square.fill(0.0);
            in_widest!(add_squares(&mut self.square, [width, n], weights, &self.mass));
            let time = spline.clock(spline.mesh.interval_of(p).0);
            let rate = 1.0 / (time * time);
            let of_states = [REST_OF_METRIC * rate * rate, REST_OF_METRIC * rate];
            for (group, part) in of_states.into_iter().chain([1.0]).enumerate() {
                let rows = self.hessian.chunks_exact_mut(row_length(n)).skip(n * group);
                for (to, square) in rows.zip(self.square.chunks_exact(width)) {
                    let to = to[n * group..][..n].iter_mut().zip(square);
                    to.for_each(|(to, square)| *to = part * weight * square);
                }
            }
            let (k, j) = spline.mesh.interval_of(p);
            let factors = spline.factors(k, j);
            self.interval.take(j, n, factors, &self.hessian);
            let points = spline.mesh.own_points(k);
            if j + 1 == points {
                self.interval.add_to(matrix, k, n, points);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Metric;
    use crate::direct::interior::iterate::tests::started;
    use crate::direct::motion::shape::Shape;
    use crate::numerics::chain::ChainMatrix;

    #[test]
    fn nothing_that_is_free_is_undamped() {
        for shape in [Shape::Quartic, Shape::Quintic] {
            let mut interior = started(shape);
            interior.refresh().unwrap();
            // Nothing is removed: a path that is moved as a whole has other positions alone.
            let mut matrix = ChainMatrix::new(shape.node() * 2, shape.inner() * 2);
            matrix.reset(interior.spline.mesh.intervals());
            let (spline, points) = (&interior.spline, &interior.points);
            Metric::new(2, shape).fill(&mut matrix, spline, points, &[1.0, 0.3]);
            assert!(matrix.factorise().is_ok(), "{shape:?}");
        }
    }
}
