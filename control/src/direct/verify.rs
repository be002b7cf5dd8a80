//! The motion integrated again with its torques.

use super::spline::Spline;
use crate::numerics::dormand_prince::{DormandPrince, Stopped};
use crate::problem::Problem;
use costate::EvalError;
use costate::lagrangian::Lagrangian;

/// Relative tolerance of one integration step.
const TOLERANCE: f64 = 1e-10;

/// The state (q, v) at the end when the torques of a motion, cut to their limits, move the robot from its
/// start.
pub(super) fn integrate(problem: &Problem, spline: &Spline) -> Result<Vec<f64>, Stopped> {
    let n = spline.dof;
    let limits = problem.joint_limits();
    let (mut inverse, mut forward) =
        (Lagrangian::<f64>::new(&problem.robot), Lagrangian::<f64>::new(&problem.robot));
    let mut z = vec![0.0; 3 * n];
    spline.in_interval(0, 0.0, &mut z);
    let mut x = z[..2 * n].to_vec();
    let mut tau = vec![0.0; n];
    let mut integrator = DormandPrince::new(2 * n, TOLERANCE);
    for k in 0..spline.mesh.intervals() {
        let length = spline.mesh.width(k) * spline.time;
        integrator.integrate(&mut x, 0.0..length, |t, x, rate| -> Result<(), EvalError> {
            spline.in_interval(k, t / length, &mut z);
            tau.copy_from_slice(inverse.inverse_dynamics(&z[..n], &z[n..2 * n], &z[2 * n..])?);
            for (tau, limit) in tau.iter_mut().zip(&limits) {
                *tau = tau.clamp(limit.torque[0], limit.torque[1]);
            }
            rate.copy_from_slice(forward.evaluate(&x[..n], &x[n..], &tau)?);
            Ok(())
        })?;
    }
    Ok(x)
}
