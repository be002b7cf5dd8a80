//! Derivatives of the torques of an interval by its unknowns and by the time of its phase.

use super::point_terms::Work;
use crate::direct::limits::hull::COEFFICIENTS;
use crate::direct::motion::shape::{MOST_COEFFICIENTS, Shape};
use crate::direct::motion::spline::Spline;
use crate::direct::points::values::Points;
use crate::numerics::chain::dot;
use crate::numerics::padded::{LANES, combine};
use costate_numerics::in_widest;

/// The order of the unknowns of an interval.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Order {
    /// Inner ones, those of the left and of the right node: as coefficients of the spline.
    InnerFirst,
    /// Those of the left node, inner ones, those of the right node: as the columns of an element.
    LeftFirst,
}

/// Room for the rows of one interval.
#[derive(Clone, Debug, Default)]
pub(crate) struct TorqueRows {
    /// The interval, if there is any yet.
    interval: Option<usize>,
    /// n rows a point, each as long as the unknowns of the interval and the lanes of a vector.
    rows: Vec<f64>,
    /// Derivatives by the time.
    by_time: Vec<f64>,
    width: usize,
    dof: usize,
    /// One row of a point, and room behind it.
    row: Vec<f64>,
    /// The row of a coefficient.
    sum: Vec<f64>,
    work: Work,
}

impl TorqueRows {
    /// For n joints.
    pub fn new(n: usize, shape: Shape) -> Self {
        let (size, points) = (shape.coefficients() * n, shape.places().len());
        Self {
            interval: None,
            rows: vec![0.0; points * n * (size + LANES)],
            by_time: vec![0.0; points * n],
            width: size + LANES,
            dof: n,
            row: vec![0.0; 3 * n + LANES],
            sum: vec![0.0; size],
            work: Work::new(n, [0; 2]),
        }
    }

    /// To be called where the motion changes.
    pub fn invalidate(&mut self) {
        self.interval = None;
    }

    /// Makes the rows of an interval, if they are not there.
    #[inline(always)]
    pub fn take(&mut self, k: usize, order: Order, spline: &Spline, points: &Points) {
        if self.interval.replace(k) != Some(k) {
            self.fill(k, order, spline, points);
        }
    }

    #[inline(never)]
    fn fill(&mut self, k: usize, order: Order, spline: &Spline, points: &Points) {
        let (n, shape) = (self.dof, spline.mesh.shape);
        let count = shape.coefficients();
        let (inner, node) = (shape.inner(), shape.node());
        let order = std::array::from_fn(|at| match at {
            at if order == Order::InnerFirst || at >= inner + node => at,
            at if at < node => at + inner,
            at => at - node,
        });
        for j in 0..shape.places().len() {
            let p = spline.mesh.first_point(k) + j;
            let factors = spline.factors(k, j);
            self.work.differentiate_in_time(points.z(p), spline, k, &factors);
            let (rows, by_time) =
                (&mut self.rows[n * self.width * j..], &mut self.by_time[n * j..n * (j + 1)]);
            let row = &mut self.row[..];
            in_widest!(fill_point(points.tau_z(p), (&factors, &order, count), (rows, self.width), row));
            for (by_time, tau_z) in by_time.iter_mut().zip(points.tau_z(p).chunks_exact(3 * n)) {
                *by_time = dot(tau_z, &self.work.z_t);
            }
        }
    }

    /// The derivatives of torque i at point j by the unknowns, and the one by the time.
    #[inline(always)]
    pub fn at_point(&self, j: usize, i: usize) -> (&[f64], f64) {
        let at = self.dof * j + i;
        (&self.rows[self.width * at..][..self.width - LANES], self.by_time[at])
    }

    /// Likewise for coefficient c of the quadratic through the values of the torque ([`COEFFICIENTS`]).
    pub fn coefficient(&mut self, c: usize, i: usize) -> (&[f64], f64) {
        let mut sum = std::mem::take(&mut self.sum);
        let [first, second, third] = [0, 1, 2].map(|j| self.at_point(j, i));
        in_widest!(combine(&mut sum, COEFFICIENTS[c], [first.0, second.0, third.0]));
        let slopes = COEFFICIENTS[c].iter().zip([first.1, second.1, third.1]);
        let by_time = slopes.map(|(factor, slope)| factor * slope).sum();
        self.sum = sum;
        (&self.sum, by_time)
    }
}

/// The rows of one point: for each coefficient in this order `f tau_q + g tau_v + h tau_a`. Whole vectors are
/// written from left to right: what is beyond a coefficient is overwritten by the next one.
#[inline(always)]
fn fill_point<const FUSED: bool>(
    tau_z: &[f64],
    (factors, order, count): (&[[f64; MOST_COEFFICIENTS]; 3], &[usize; MOST_COEFFICIENTS], usize),
    (rows, width): (&mut [f64], usize),
    row: &mut [f64],
) {
    let size = row.len() - LANES;
    let n = size / 3;
    for (from, to) in tau_z.chunks_exact(size).zip(rows.chunks_exact_mut(width)) {
        row[..size].copy_from_slice(from);
        for (at, &b) in order[..count].iter().enumerate() {
            let of_coefficient = [0, 1, 2].map(|s| factors[s][b]);
            for first in (0..n).step_by(LANES) {
                let parts = [0, 1, 2].map(|s| &row[n * s + first..][..LANES]);
                combine::<FUSED>(&mut to[n * at + first..][..LANES], of_coefficient, parts);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Order, TorqueRows};
    use crate::direct::limits::side::{Limited, Side};
    use crate::direct::motion::shape::{POINTS, Shape};
    use crate::direct::newton::rate_rows::RateRows;
    use crate::direct::newton::system::tests::case::{Case, Kind};

    /// Rows of all points and coefficients against those that are made one at a time.
    #[test]
    fn rows_are_those_of_single_torques() {
        for (shape, kind) in [(Shape::Quartic, Kind::Vias), (Shape::Quintic, Kind::Vias)] {
            let Case { spline, points, .. } = Case::new(shape, kind);
            let (n, node, inner) = (spline.dof, shape.node(), shape.inner());
            let mut single = RateRows::new(n);
            let mut rows = [TorqueRows::new(n, shape), TorqueRows::new(n, shape)];
            let orders = [Order::InnerFirst, Order::LeftFirst];
            for k in 0..spline.mesh.intervals() {
                rows.iter_mut().zip(orders).for_each(|(rows, order)| rows.take(k, order, &spline, &points));
                let mut compare = |expected: (&[f64], f64), which: (bool, usize, usize)| {
                    let (is_coefficient, at, joint) = which;
                    let [first, left] = rows.each_mut().map(|rows| {
                        let found = if is_coefficient {
                            rows.coefficient(at, joint)
                        } else {
                            rows.at_point(at, joint)
                        };
                        (found.0.to_vec(), found.1)
                    });
                    let size = expected.0.iter().fold(1.0, |most: f64, entry| most.max(entry.abs()));
                    let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-13 * size, "{which:?}: {a} {b}");
                    first.0.iter().zip(expected.0).for_each(|(a, b)| close(*a, *b));
                    let reordered = first.0[inner * n..(inner + node) * n]
                        .iter()
                        .chain(&first.0[..inner * n])
                        .chain(&first.0[(inner + node) * n..]);
                    assert!(left.0.iter().eq(reordered) && left.0.len() == first.0.len());
                    for by_time in [first.1, left.1] {
                        assert!((by_time - expected.1).abs() < 1e-12 * (size + expected.1.abs()));
                    }
                };
                for joint in 0..n {
                    let side = &Side::pair(Limited::Torque, joint, -1.0, 1.0).next().unwrap();
                    for j in 0..shape.places().len() {
                        let factors = single.go_to((k, j), &spline, &points);
                        let p = spline.mesh.first_point(k) + j;
                        let by_time = single.take_row(p, &factors, side, &spline, &points);
                        compare((&single.row, by_time), (false, j, joint));
                    }
                    for c in 0..if shape.is_smooth() { 0 } else { POINTS } {
                        let by_time = single.take_coefficient(k, c, side, &spline, &points);
                        compare((&single.row, by_time), (true, c, joint));
                    }
                }
            }
        }
    }
}
