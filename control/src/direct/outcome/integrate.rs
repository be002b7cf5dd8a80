//! A robot that moves under the torques of a motion.

use crate::constants::direct as constants;
use crate::direct::motion::spline::Spline;
use crate::numerics::dormand_prince::{DormandPrince, Stopped};
use crate::problem::limits::JointLimits;
use crate::verify::splits::Splits;
use costate::EvalError;
use costate::lagrangian::Lagrangian;
use costate::robot::Robot;

/// The dynamics of a robot in the state x that is integrated, and how x follows from a motion.
///
/// A motion is given by z = (q, v, a) of its coordinates, `phase` counts the phase.
pub(super) trait Driven {
    /// x of a motion in a phase.
    fn begin(&mut self, phase: usize, z: &[f64]) -> Result<Vec<f64>, EvalError>;
    /// x at the end of a phase becomes that at the start of the next one; positions and rates stay.
    fn pass(&mut self, phase: usize, x: &mut [f64]) -> Result<(), EvalError>;
    /// The torques of a motion.
    fn torques(&mut self, phase: usize, z: &[f64], tau: &mut [f64]) -> Result<(), EvalError>;
    /// dx/dt under these torques.
    fn rate(&mut self, phase: usize, x: &[f64], tau: &[f64], rate: &mut [f64]) -> Result<(), EvalError>;
    /// (q, v) of x in a phase, at a time at which the motion has this z.
    fn read(&mut self, phase: usize, x: &[f64], z: &[f64]) -> Result<Vec<f64>, EvalError>;
}

/// The state (q, v) at the end when the torques of a motion, cut to their limits, move a robot from the start
/// of the motion, and from its own state at the first node after each `part` (s) again; `at_part` sees the
/// state that was reached there and that of the motion. Steps end where something narrow happens
/// ([`Splits`]).
pub(super) fn integrate(
    driven: &mut dyn Driven,
    limits: &[JointLimits],
    (spline, splits): (&Spline, &Splits),
    part: f64,
    stops: &mut dyn FnMut() -> bool,
    at_part: &mut dyn FnMut(&[f64], &[f64]),
) -> Result<Vec<f64>, Stopped> {
    let n = spline.dof;
    let (mut z, mut tau) = (vec![0.0; 3 * n], vec![0.0; n]);
    spline.in_interval(0, 0.0, &mut z);
    let mut x = driven.begin(0, &z)?;
    let mut integrator = DormandPrince::new(x.len(), constants::INTEGRATION);
    let mut since = 0.0;
    for k in 0..spline.mesh.intervals() {
        let (length, phase) = (spline.length(k), spline.mesh.phase(k));
        for pair in splits.of(k).windows(2) {
            let time = pair[0] * length..pair[1] * length;
            integrator.integrate_until(&mut x, time, |t, x, rate| -> Result<(), Stopped> {
                if stops() {
                    return Err(Stopped::Interrupted);
                }
                spline.in_interval(k, t / length, &mut z);
                driven.torques(phase, &z, &mut tau)?;
                for (tau, limit) in tau.iter_mut().zip(limits) {
                    *tau = tau.max(limit.torque[0]).min(limit.torque[1]);
                }
                Ok(driven.rate(phase, x, &tau, rate)?)
            })?;
        }
        since += length;
        spline.in_interval(k, 1.0, &mut z);
        if k + 1 == spline.mesh.intervals() {
            break;
        }
        let next = spline.mesh.phase(k + 1);
        if since >= part {
            at_part(&driven.read(phase, &x, &z)?, &z[..2 * n]);
            x = driven.begin(next, &z)?;
            since = 0.0;
        } else if next != phase {
            driven.pass(phase, &mut x)?;
        }
    }
    Ok(driven.read(spline.mesh.phases() - 1, &x, &z)?)
}

/// A tree without constraints: x = (q, v).
pub(super) struct OpenTree {
    /// Those of each phase, for inverse and for forward dynamics.
    models: Vec<[Lagrangian<f64>; 2]>,
}

impl OpenTree {
    /// With the robot of each phase.
    pub fn new(robots: &[Robot]) -> Self {
        Self { models: robots.iter().map(|robot| [0, 1].map(|_| Lagrangian::new(robot))).collect() }
    }
}

impl Driven for OpenTree {
    fn begin(&mut self, _: usize, z: &[f64]) -> Result<Vec<f64>, EvalError> {
        Ok(z[..2 * z.len() / 3].to_vec())
    }

    fn pass(&mut self, _: usize, _: &mut [f64]) -> Result<(), EvalError> {
        Ok(())
    }

    fn torques(&mut self, phase: usize, z: &[f64], tau: &mut [f64]) -> Result<(), EvalError> {
        let n = tau.len();
        let [inverse, _] = &mut self.models[phase];
        tau.copy_from_slice(inverse.inverse_dynamics(&z[..n], &z[n..2 * n], &z[2 * n..])?);
        Ok(())
    }

    fn rate(&mut self, phase: usize, x: &[f64], tau: &[f64], rate: &mut [f64]) -> Result<(), EvalError> {
        let (q, v) = x.split_at(tau.len());
        let [_, forward] = &mut self.models[phase];
        rate.copy_from_slice(forward.evaluate(q, v, tau)?);
        Ok(())
    }

    fn read(&mut self, _: usize, x: &[f64], _: &[f64]) -> Result<Vec<f64>, EvalError> {
        Ok(x.to_vec())
    }
}
