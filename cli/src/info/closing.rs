//! Whether the loops of a robot can be closed.

use costate::configuration::ConfigurationSpace;
use costate::constraints::{ConstrainedHamiltonian, ConstraintError};
use costate::robot::Robot;

/// Why no position near q = 0 satisfies all constraints, as far as it was found. `None` if one does, or if
/// the robot cannot be evaluated.
pub fn unsatisfied(robot: &Robot) -> Option<ConstraintError> {
    if robot.constraints().is_empty() {
        return None;
    }
    let mut q = ConfigurationSpace::new(robot).neutral();
    let held = vec![false; robot.dof()];
    match ConstrainedHamiltonian::<f64>::new(robot).close(&mut q, &held) {
        Ok(()) | Err(ConstraintError::Evaluation(_)) => None,
        Err(cause) => Some(cause),
    }
}
