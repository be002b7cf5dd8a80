//! Jerks and rates of torques along motions of the direct method.

use crate::problem::Problem;
use crate::result::samples::SampleError;
use crate::result::solution::Solution;
use costate::lagrangian::Lagrangian;

/// Jerks and rates of torques: rows are times, entries of a row are joints in the order of the robot.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct MotionRates {
    /// Derivatives of the accelerations (rad/s^3, m/s^3).
    pub jerk: Vec<Vec<f64>>,
    /// Derivatives of the torques and forces at the joints (N m/s, N/s).
    pub torque_rate: Vec<Vec<f64>>,
}

impl Solution {
    /// $$ \\dot\\tau = \\tau\_q v + \\tau\_v a + M j $$
    ///
    /// with the jerk j, at given times (s), of a motion of the direct method; `None` for other motions, whose
    /// accelerations are those of forward dynamics, and for robots with constraints. `problem` is the one
    /// that was solved.
    ///
    /// q(t) is a polynomial of degree five between two points of the mesh, and both are its derivatives.
    /// Where accelerations may jump, their jumps do not count. The solver keeps limits of torque rates with
    /// the derivative of the polynomial through the torques at the points of an interval, which differs from
    /// this one by the error of the discretisation.
    ///
    /// # Errors
    /// [`SampleError`], for a motion of another robot and where the dynamics cannot be evaluated.
    pub fn rates_at(&self, problem: &Problem, times: &[f64]) -> Result<Option<MotionRates>, SampleError> {
        let trajectory = &self.trajectory;
        let (Some(row), Some(_)) = (trajectory.q.first(), trajectory.accelerations()) else {
            return Ok(None);
        };
        if problem.is_closed() {
            return Ok(None);
        }
        let (found, expected) = (row.len(), problem.robot.dof());
        if found != expected {
            return Err(SampleError::OtherRobot { found, expected });
        }
        let (Some(&start), Some(&last)) = (trajectory.t.first(), trajectory.t.last()) else {
            return Ok(None);
        };
        let mut models: Vec<_> = problem.robots().iter().map(Lagrangian::<f64>::new).collect();
        let mut rates = MotionRates::default();
        for t in times.iter().map(|t| t.max(start).min(last)) {
            let (Some(point), Some(a), Some(jerk)) =
                (trajectory.at(t), trajectory.acceleration(t), trajectory.jerk(t))
            else {
                return Ok(None);
            };
            let phase = trajectory.phase_at(t).min(models.len() - 1);
            let torque = models[phase].linearise_inverse_dynamics(&point.q, &point.v, &a)?;
            let row = |i: usize| -> f64 {
                let term = |j: usize| {
                    torque.tau_q[(i, j)] * point.v[j]
                        + torque.tau_v[(i, j)] * a[j]
                        + torque.tau_a[(i, j)] * jerk[j]
                };
                (0..expected).map(term).sum()
            };
            rates.torque_rate.push((0..expected).map(row).collect());
            rates.jerk.push(jerk);
        }
        Ok(Some(rates))
    }
}
