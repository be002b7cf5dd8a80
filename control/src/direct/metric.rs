//! The metric of damping: how far a step moves the accelerations, and a little the rates and positions, as
//! torques.

use super::ends::Ends;
use super::interval::IntervalHessian;
use super::points::Points;
use super::shape::Shape;
use super::spline::Spline;
use crate::constants::direct::REST_OF_METRIC;
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

    /// Adds `sum w T ((M da)' R (M da) + c (M dv/T)' R (M dv/T) + c (M dq/T^2)' R (M dq/T^2))` to a matrix of
    /// zeros; R is diagonal, `weights`. With the small part c every change costs something, that of positions
    /// alone too, which is left where they are free at both ends.
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
            let rate = 1.0 / (spline.time * spline.time);
            let of_states = [REST_OF_METRIC * rate * rate, REST_OF_METRIC * rate];
            for i in 0..n {
                for j in 0..n {
                    let entries = (0..n).map(|l| {
                        let row = &tau_z[width * l + 2 * n..][..n];
                        weights[l] * row[i] * row[j]
                    });
                    let square = weight * entries.sum::<f64>();
                    for (group, part) in of_states.into_iter().chain([1.0]).enumerate() {
                        self.hessian[width * (n * group + i) + n * group + j] = part * square;
                    }
                }
            }
            let (k, j) = spline.mesh.interval_of(p);
            let factors = spline.mesh.basis(k, j).in_time(1.0 / spline.time);
            self.interval.take(j, n, factors, &self.hessian);
            let points = spline.mesh.own_points(k);
            if j + 1 == points {
                self.interval.add_to(matrix, k, n, points);
            }
        }
        ends.all(spline.mesh.intervals(), spline.time).for_each(|(k, i, _)| matrix.remove(k, i));
    }
}

#[cfg(test)]
mod tests {
    use super::super::interior::tests::started;
    use super::super::shape::Shape;
    use super::Metric;
    use crate::numerics::chain::ChainMatrix;

    #[test]
    fn nothing_that_is_free_is_undamped() {
        for shape in [Shape::Quartic, Shape::Quintic] {
            let mut interior = started(shape);
            interior.refresh().unwrap();
            // Nothing is given: a path that is moved as a whole has other positions alone.
            interior.ends.given = interior.ends.given.each_ref().map(|given| vec![None; given.len()]);
            let mut matrix = ChainMatrix::new(shape.node() * 2, shape.inner() * 2);
            matrix.reset(interior.spline.mesh.intervals());
            let (spline, points, ends) = (&interior.spline, &interior.points, &interior.ends);
            Metric::new(2, shape).fill(&mut matrix, spline, points, &[1.0, 0.3], ends);
            assert!(matrix.factorise().is_ok(), "{shape:?}");
        }
    }
}
