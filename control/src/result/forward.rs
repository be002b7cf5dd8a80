//! Accelerations of a robot, with or without constraints.

use costate::EvalError;
use costate::constraints::ConstrainedHamiltonian;
use costate::lagrangian::Lagrangian;
use costate::robot::Robot;

/// The dynamics of an open tree or of a robot with constraints.
#[derive(Debug)]
pub(super) enum Forward {
    Open(Box<Lagrangian<f64>>),
    Closed(Box<ConstrainedHamiltonian<f64>>),
}

impl Forward {
    pub fn new(robot: &Robot) -> Self {
        match robot.constraints().is_empty() {
            true => Self::Open(Box::new(Lagrangian::new(robot))),
            false => Self::Closed(Box::new(ConstrainedHamiltonian::new(robot))),
        }
    }

    /// The accelerations with these torques.
    ///
    /// # Errors
    /// A state that cannot be evaluated.
    pub fn accelerations(&mut self, q: &[f64], v: &[f64], tau: &[f64]) -> Result<Vec<f64>, EvalError> {
        match self {
            Self::Open(open) => Ok(open.forward_dynamics(q, v, tau)?.to_vec()),
            Self::Closed(closed) => {
                let p = closed.momentum(q, v)?.to_vec();
                Ok(closed.linearise(q, &p, tau)?.acceleration().to_vec())
            }
        }
    }
}
