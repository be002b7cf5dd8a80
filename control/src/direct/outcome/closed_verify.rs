//! Motions of robots with constraints, integrated again.

use super::integrate::Driven;
use crate::direct::motion::spline::Spline;
use crate::direct::points::closed_points::ClosedPoints;
use crate::problem::loop_rows::{LoopPhase, Loops};
use costate::EvalError;
use costate::constraints::{ConstrainedHamiltonian, Constraints};

/// How far the constraints that hold are missed along a motion, each row from its value at the start: at the
/// ends of all intervals and between them (m, rad).
pub(super) fn drift(loops: &Loops, spline: &Spline) -> Result<f64, EvalError> {
    let mut rows = Constraints::<f64>::new(&loops.robot);
    let n = rows.dof();
    let mut z = vec![0.0; 3 * spline.dof];
    spline.in_interval(0, 0.0, &mut z);
    rows.set_position(&z[..n])?;
    let start = rows.values().to_vec();
    let mut most = 0.0_f64;
    let held = |phase: &LoopPhase| phase.robot.constraints().iter().map(|one| one.kind.rows()).sum();
    let held: Vec<usize> = loops.phases.iter().map(held).collect();
    for k in 0..spline.mesh.intervals() {
        let held = held[spline.mesh.phase(k)];
        for part in [0.25, 0.5, 0.75, 1.0] {
            spline.in_interval(k, part, &mut z);
            rows.set_position(&z[..n])?;
            for (g, start) in rows.values()[..held].iter().zip(&start) {
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
    /// Those of each phase.
    models: Vec<(ClosedPoints, ConstrainedHamiltonian<f64>)>,
}

impl ClosedTree {
    pub fn new(loops: &Loops) -> Self {
        let phases = loops.phases.iter().enumerate();
        let models = phases.map(|(number, phase)| {
            (ClosedPoints::new(loops, number), ConstrainedHamiltonian::new(&phase.robot))
        });
        Self { models: models.collect() }
    }
}

impl Driven for ClosedTree {
    fn begin(&mut self, phase: usize, z: &[f64]) -> Result<Vec<f64>, EvalError> {
        let (_, model) = &mut self.models[phase];
        let (n, all) = (model.dof(), z.len() / 3);
        let p = model.momentum(&z[..n], &z[all..all + n])?;
        Ok([&z[..n], p].concat())
    }

    fn pass(&mut self, phase: usize, x: &mut [f64]) -> Result<(), EvalError> {
        let (q, p) = x.split_at_mut(x.len() / 2);
        let (v, _) = self.models[phase].1.velocity(q, p)?;
        let v = v.to_vec();
        p.copy_from_slice(self.models[phase + 1].1.momentum(q, &v)?);
        Ok(())
    }

    fn torques(&mut self, phase: usize, z: &[f64], tau: &mut [f64]) -> Result<(), EvalError> {
        self.models[phase].0.inverse_dynamics(z, tau)
    }

    fn rate(&mut self, phase: usize, x: &[f64], tau: &[f64], rate: &mut [f64]) -> Result<(), EvalError> {
        let (_, model) = &mut self.models[phase];
        let n = model.dof();
        rate.copy_from_slice(model.evaluate(&x[..n], &x[n..], &tau[..n])?.f);
        Ok(())
    }

    fn read(&mut self, phase: usize, x: &[f64], z: &[f64]) -> Result<Vec<f64>, EvalError> {
        let (_, model) = &mut self.models[phase];
        let (n, all) = (model.dof(), z.len() / 3);
        let (v, _) = model.velocity(&x[..n], &x[n..])?;
        Ok([&x[..n], &z[n..all], v, &z[all + n..2 * all]].concat())
    }
}
