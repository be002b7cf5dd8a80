//! Motions of robots with constraints, integrated again.

use crate::constants::direct as constants;
use crate::direct::motion::spline::Spline;
use crate::direct::points::closed_points::ClosedPoints;
use crate::numerics::dormand_prince::{DormandPrince, Stopped};
use crate::problem::Problem;
use crate::problem::loop_rows::Loops;
use costate::EvalError;
use costate::constraints::{ConstrainedHamiltonian, Constraints};

/// How far the constraints are missed along a motion, each row from its value at the start: at the ends of
/// all intervals and between them (m, rad).
pub(super) fn drift(loops: &Loops, spline: &Spline) -> Result<f64, EvalError> {
    let mut rows = Constraints::<f64>::new(&loops.robot);
    let n = rows.dof();
    let mut z = vec![0.0; 3 * spline.dof];
    spline.in_interval(0, 0.0, &mut z);
    rows.set_position(&z[..n])?;
    let start = rows.values().to_vec();
    let mut most = 0.0_f64;
    for k in 0..spline.mesh.intervals() {
        for part in [0.25, 0.5, 0.75, 1.0] {
            spline.in_interval(k, part, &mut z);
            rows.set_position(&z[..n])?;
            for (g, start) in rows.values().iter().zip(&start) {
                most = most.max((g - start).abs());
            }
        }
    }
    Ok(most)
}

/// The state of all coordinates at the end when the torques of a motion, cut to their limits, move the robot
/// by `ConstrainedHamiltonian`, without a projection, from its start, and from its own state at the first
/// node after each `part` (s) again; `at_part` sees the state that was reached there and that of the motion.
///
/// Multipliers and what they are rates of are those of the motion: p + J'kappa is the same motion, so they
/// say nothing.
pub(super) fn integrate(
    (problem, loops): (&Problem, &Loops),
    spline: &Spline,
    part: f64,
    stops: &mut dyn FnMut() -> bool,
    mut at_part: impl FnMut(&[f64], &[f64]),
) -> Result<Vec<f64>, Stopped> {
    let (all, limits) = (spline.dof, problem.joint_limits());
    let mut torques = ClosedPoints::new(loops);
    let mut model = ConstrainedHamiltonian::<f64>::new(&loops.robot);
    let n = model.dof();
    let (mut z, mut tau) = (vec![0.0; 3 * all], vec![0.0; all]);
    let momentum = |model: &mut ConstrainedHamiltonian<f64>, z: &[f64]| {
        let p = model.momentum(&z[..n], &z[all..all + n]).map_err(Stopped::Evaluation)?;
        Ok::<_, Stopped>([&z[..n], p].concat())
    };
    let state = |model: &mut ConstrainedHamiltonian<f64>, x: &[f64], z: &[f64]| {
        let (v, _) = model.velocity(&x[..n], &x[n..]).map_err(Stopped::Evaluation)?;
        Ok::<_, Stopped>([&x[..n], &z[n..all], v, &z[all + n..2 * all]].concat())
    };
    let mut integrator = DormandPrince::new(2 * n, constants::INTEGRATION);
    spline.in_interval(0, 0.0, &mut z);
    let mut x = momentum(&mut model, &z)?;
    let mut since = 0.0;
    for k in 0..spline.mesh.intervals() {
        let length = spline.length(k);
        integrator.integrate_until(&mut x, 0.0..length, |t, x, rate| -> Result<(), Stopped> {
            if stops() {
                return Err(Stopped::Interrupted);
            }
            spline.in_interval(k, t / length, &mut z);
            torques.inverse_dynamics(&z, &mut tau)?;
            for (tau, limit) in tau.iter_mut().zip(&limits) {
                *tau = tau.clamp(limit.torque[0], limit.torque[1]);
            }
            rate.copy_from_slice(model.evaluate(&x[..n], &x[n..], &tau[..n])?.f);
            Ok(())
        })?;
        since += length;
        spline.in_interval(k, 1.0, &mut z);
        if since >= part && k + 1 < spline.mesh.intervals() {
            at_part(&state(&mut model, &x, &z)?, &z[..2 * all]);
            x = momentum(&mut model, &z)?;
            since = 0.0;
        }
    }
    state(&mut model, &x, &z)
}
