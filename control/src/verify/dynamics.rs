//! Inverse dynamics of the robots of all phases.

use costate::EvalError;
use costate::lagrangian::{InverseDynamicsLinearisation, LagrangianSecondOrder};
use costate::robot::Robot;

/// tau(z), z = (q, v, a): the torques of the joints of a robot; of one with constraints also the equations
/// of the multipliers, which are further coordinates.
pub(crate) trait InverseDynamics {
    /// Into `tau`, n entries.
    ///
    /// # Errors
    /// States that cannot be evaluated.
    fn torques(&mut self, phase: usize, z: &[f64], tau: &mut [f64]) -> Result<(), EvalError>;

    /// The same with tau_z, n rows of 3n.
    ///
    /// # Errors
    /// As [`torques`](Self::torques).
    fn linearise(
        &mut self,
        phase: usize,
        z: &[f64],
        tau: &mut [f64],
        tau_z: &mut [f64],
    ) -> Result<(), EvalError>;

    /// tau, tau_z and the Hessian of w.tau by z, 3n rows of 3n, for these weights w.
    ///
    /// # Errors
    /// As [`torques`](Self::torques).
    fn contract(
        &mut self,
        phase: usize,
        z: &[f64],
        weights: &[f64],
        found: [&mut [f64]; 3],
    ) -> Result<(), EvalError>;
}

/// Those of trees without constraints.
#[derive(Debug)]
pub(crate) struct Trees {
    /// Different ones, and that of each phase.
    models: Vec<LagrangianSecondOrder<f64>>,
    of_phase: Vec<usize>,
}

impl Trees {
    /// With the robot of each phase.
    pub fn new(robots: &[Robot]) -> Self {
        let mut different: Vec<&Robot> = Vec::new();
        let mut number = |robot| {
            different.iter().position(|other| *other == robot).unwrap_or_else(|| {
                different.push(robot);
                different.len() - 1
            })
        };
        let of_phase = robots.iter().map(&mut number).collect();
        Self { models: different.into_iter().map(LagrangianSecondOrder::new).collect(), of_phase }
    }
}

impl InverseDynamics for Trees {
    fn torques(&mut self, phase: usize, z: &[f64], tau: &mut [f64]) -> Result<(), EvalError> {
        let n = tau.len();
        let model = &mut self.models[self.of_phase[phase]];
        tau.copy_from_slice(model.first().inverse_dynamics(&z[..n], &z[n..2 * n], &z[2 * n..3 * n])?);
        Ok(())
    }

    fn linearise(
        &mut self,
        phase: usize,
        z: &[f64],
        tau: &mut [f64],
        tau_z: &mut [f64],
    ) -> Result<(), EvalError> {
        let n = tau.len();
        let model = &mut self.models[self.of_phase[phase]];
        let found = model.first().linearise_inverse_dynamics(&z[..n], &z[n..2 * n], &z[2 * n..3 * n])?;
        take(&found, tau, tau_z);
        Ok(())
    }

    fn contract(
        &mut self,
        phase: usize,
        z: &[f64],
        weights: &[f64],
        [tau, tau_z, hessian]: [&mut [f64]; 3],
    ) -> Result<(), EvalError> {
        let n = tau.len();
        let model = &mut self.models[self.of_phase[phase]];
        let (q, v, a) = (&z[..n], &z[n..2 * n], &z[2 * n..3 * n]);
        let found = model.contract_inverse_dynamics(q, v, a, weights)?;
        take(&found.inverse_dynamics(), tau, tau_z);
        for (i, row) in hessian.chunks_exact_mut(3 * n).enumerate() {
            row.iter_mut().enumerate().for_each(|(j, to)| *to = found.zz()[(i, j)]);
        }
        Ok(())
    }
}

fn take(found: &InverseDynamicsLinearisation<'_, f64>, tau: &mut [f64], tau_z: &mut [f64]) {
    let n = tau.len();
    tau.copy_from_slice(found.tau);
    for (i, row) in tau_z.chunks_exact_mut(3 * n).enumerate() {
        for j in 0..n {
            row[j] = found.tau_q[(i, j)];
            row[n + j] = found.tau_v[(i, j)];
            row[2 * n + j] = found.tau_a[(i, j)];
        }
    }
}
