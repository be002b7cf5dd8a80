//! The Jacobian of the extremals of a robot by differences, for comparison.

use super::extremal::{Extremal, Law};
use super::robot_extremal::RobotExtremal;
use crate::error::EvalError;

impl RobotExtremal {
    /// The Jacobian by central differences of the right-hand side.
    pub(super) fn by_differences(
        &mut self,
        z: &[f64],
        law: Law<'_>,
        jacobian: &mut [f64],
    ) -> Result<(), EvalError> {
        let mut differences = std::mem::take(&mut self.differences);
        let outcome = differences.jacobian(z, jacobian, |z, g| self.rate(z, law, g).map(|_| ()));
        self.differences = differences;
        outcome
    }
}
