//! Inverse dynamics of the robots of all phases.

use costate::EvalError;
use costate::lagrangian::Lagrangian;
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
}

/// Those of trees without constraints.
#[derive(Clone, Debug)]
pub(crate) struct Trees {
    /// Different ones, and that of each phase.
    models: Vec<Lagrangian<f64>>,
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
        Self { models: different.into_iter().map(Lagrangian::new).collect(), of_phase }
    }
}

impl InverseDynamics for Trees {
    fn torques(&mut self, phase: usize, z: &[f64], tau: &mut [f64]) -> Result<(), EvalError> {
        let n = tau.len();
        let model = &mut self.models[self.of_phase[phase]];
        tau.copy_from_slice(model.inverse_dynamics(&z[..n], &z[n..2 * n], &z[2 * n..3 * n])?);
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
        let found = model.linearise_inverse_dynamics(&z[..n], &z[n..2 * n], &z[2 * n..3 * n])?;
        tau.copy_from_slice(found.tau);
        for (i, row) in tau_z.chunks_exact_mut(3 * n).enumerate() {
            for j in 0..n {
                row[j] = found.tau_q[(i, j)];
                row[n + j] = found.tau_v[(i, j)];
                row[2 * n + j] = found.tau_a[(i, j)];
            }
        }
        Ok(())
    }
}
