//! Motions of robots with constraints, integrated again.

use super::integrate::Driven;
use crate::direct::motion::spline::Spline;
use crate::direct::points::closed_points::ClosedPoints;
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

/// A robot with constraints, moved by `ConstrainedHamiltonian` without a projection: x = (q, p) of its
/// joints.
///
/// Multipliers and what they are rates of are those of the motion: p + J'kappa is the same motion, so they
/// say nothing.
pub(super) struct ClosedTree {
    torques: ClosedPoints,
    model: ConstrainedHamiltonian<f64>,
}

impl ClosedTree {
    pub fn new(loops: &Loops) -> Self {
        Self { torques: ClosedPoints::new(loops), model: ConstrainedHamiltonian::new(&loops.robot) }
    }
}

impl Driven for ClosedTree {
    fn begin(&mut self, z: &[f64]) -> Result<Vec<f64>, EvalError> {
        let (n, all) = (self.model.dof(), z.len() / 3);
        let p = self.model.momentum(&z[..n], &z[all..all + n])?;
        Ok([&z[..n], p].concat())
    }

    fn torques(&mut self, _: usize, z: &[f64], tau: &mut [f64]) -> Result<(), EvalError> {
        self.torques.inverse_dynamics(z, tau)
    }

    fn rate(&mut self, _: usize, x: &[f64], tau: &[f64], rate: &mut [f64]) -> Result<(), EvalError> {
        let n = self.model.dof();
        rate.copy_from_slice(self.model.evaluate(&x[..n], &x[n..], &tau[..n])?.f);
        Ok(())
    }

    fn read(&mut self, x: &[f64], z: &[f64]) -> Result<Vec<f64>, EvalError> {
        let (n, all) = (self.model.dof(), z.len() / 3);
        let (v, _) = self.model.velocity(&x[..n], &x[n..])?;
        Ok([&x[..n], &z[n..all], v, &z[all + n..2 * all]].concat())
    }
}
