//! Inverse dynamics at the points of a motion by the generic code, one point or several at a time.

use super::values::{PointDynamics, Points};
use costate::EvalError;
use costate::batch::{Native, Packed};
use costate::lagrangian::LagrangianSecondOrder;
use costate::robot::Robot;
use std::ops::Range;

/// One point after the other.
pub(crate) type RobotPoints = PointsOf<f64>;

/// As many points at a time as the number type has lanes.
#[derive(Debug)]
pub(crate) struct PointsOf<S: Packed<Lane = f64>> {
    model: LagrangianSecondOrder<S>,
    /// z = (q, v, a) of the points.
    z: Vec<S>,
    weights: Vec<S>,
}

impl<S: Packed<Lane = f64>> PointsOf<S> {
    pub fn new(robot: &Robot) -> Self {
        let n = robot.dof();
        let model = LagrangianSecondOrder::new(robot);
        Self { model, z: vec![S::zero(); 3 * n], weights: vec![S::zero(); n] }
    }

    /// tau at a group of points, no more than there are lanes.
    pub fn evaluate_group(&mut self, points: &mut Points, group: Range<usize>) -> Result<(), EvalError> {
        let n = points.dof;
        S::gather(&points.z[3 * n * group.start..3 * n * group.end], 3 * n, &mut self.z);
        let tau = self.model.first().inverse_dynamics(&self.z[..n], &self.z[n..2 * n], &self.z[2 * n..])?;
        let mut to = Rows { rows: &mut points.tau, size: n, group };
        tau.iter().enumerate().for_each(|(i, &tau)| to.put(i, tau));
        Ok(())
    }

    /// tau, tau_z and the Hessian of w.tau at a group of points, no more than there are lanes.
    pub fn contract_group(&mut self, points: &mut Points, group: Range<usize>) -> Result<(), EvalError> {
        let n = points.dof;
        S::gather(&points.z[3 * n * group.start..3 * n * group.end], 3 * n, &mut self.z);
        S::gather(&points.weights[n * group.start..n * group.end], n, &mut self.weights);
        let (q, v, a) = (&self.z[..n], &self.z[n..2 * n], &self.z[2 * n..]);
        let all = self.model.contract_inverse_dynamics(q, v, a, &self.weights)?;
        let (first, hessian) = (all.inverse_dynamics(), all.zz());
        let mut tau = Rows { rows: &mut points.tau, size: n, group: group.clone() };
        first.tau.iter().enumerate().for_each(|(i, &value)| tau.put(i, value));
        let mut tau_z = Rows { rows: &mut points.tau_z, size: 3 * n * n, group: group.clone() };
        for i in 0..n {
            for j in 0..n {
                tau_z.put(3 * n * i + j, first.tau_q[(i, j)]);
                tau_z.put(3 * n * i + n + j, first.tau_v[(i, j)]);
                tau_z.put(3 * n * i + 2 * n + j, first.tau_a[(i, j)]);
            }
        }
        let mut second = Rows { rows: &mut points.hessian, size: 9 * n * n, group };
        for i in 0..3 * n {
            for j in 0..3 * n {
                second.put(3 * n * i + j, hessian[(i, j)]);
            }
        }
        Ok(())
    }
}

impl PointDynamics for RobotPoints {
    fn evaluate_some(&mut self, points: &mut Points, mut which: Range<usize>) -> Result<(), EvalError> {
        which.try_for_each(|p| self.evaluate_group(points, p..p + 1))
    }

    fn contract_some(&mut self, points: &mut Points, mut which: Range<usize>) -> Result<(), EvalError> {
        which.try_for_each(|p| self.contract_group(points, p..p + 1))
    }
}

/// Several points at a time, in the widest vectors that the program is compiled for.
///
/// Where one of them cannot be evaluated, each is evaluated by itself: results and errors are then those of
/// [`RobotPoints`].
#[derive(Debug)]
pub(crate) struct LanePoints {
    pub one: RobotPoints,
    lanes: PointsOf<Native>,
}

impl LanePoints {
    pub fn new(robot: &Robot) -> Self {
        Self { one: PointsOf::new(robot), lanes: PointsOf::new(robot) }
    }
}

impl PointDynamics for LanePoints {
    fn evaluate_some(&mut self, points: &mut Points, which: Range<usize>) -> Result<(), EvalError> {
        for group in groups(which, <Native as Packed>::LANES) {
            if self.lanes.evaluate_group(points, group.clone()).is_err() {
                self.one.evaluate_some(points, group)?;
            }
        }
        Ok(())
    }

    fn contract_some(&mut self, points: &mut Points, which: Range<usize>) -> Result<(), EvalError> {
        for group in groups(which, <Native as Packed>::LANES) {
            if self.lanes.contract_group(points, group.clone()).is_err() {
                self.one.contract_some(points, group)?;
            }
        }
        Ok(())
    }
}

/// These points, so many at a time.
pub(super) fn groups(which: Range<usize>, size: usize) -> impl Iterator<Item = Range<usize>> {
    let end = which.end;
    which.step_by(size).map(move |first| first..(first + size).min(end))
}

/// Rows of `size` entries, one for each point, of which those of a group are written.
pub(super) struct Rows<'a> {
    pub rows: &'a mut [f64],
    pub size: usize,
    pub group: Range<usize>,
}

impl Rows<'_> {
    /// Entry k of the rows, a lane for each point.
    #[inline]
    fn put<S: Packed<Lane = f64>>(&mut self, k: usize, value: S) {
        for (lane, p) in self.group.clone().enumerate() {
            self.rows[self.size * p + k] = value.lane(lane);
        }
    }
}

#[cfg(test)]
#[path = "generic_points_tests.rs"]
pub(super) mod tests;
