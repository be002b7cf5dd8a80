//! The Jacobian of the extremals of a robot by differences, for comparison.

use super::extremal::{Extremal, Law};
use super::robot_extremal::RobotExtremal;
use crate::error::EvalError;

impl RobotExtremal {
    /// The Jacobian by central differences of the right-hand side.
    pub(super) fn differences(
        &mut self,
        z: &[f64],
        law: Law<'_>,
        jacobian: &mut [f64],
    ) -> Result<(), EvalError> {
        let m = z.len();
        let mut point = std::mem::take(&mut self.point);
        let mut beside = std::mem::take(&mut self.beside);
        point.copy_from_slice(z);
        let mut outcome = Ok(());
        for j in 0..m {
            let step = f64::EPSILON.cbrt() * z[j].abs().max(1.0);
            for (g, sign) in beside.iter_mut().zip([1.0, -1.0]) {
                point[j] = z[j] + sign * step;
                outcome = outcome.and_then(|()| self.rate(&point, law, g).map(|_| ()));
            }
            point[j] = z[j];
            for i in 0..m {
                jacobian[i * m + j] = (beside[0][i] - beside[1][i]) / (2.0 * step);
            }
        }
        (self.point, self.beside) = (point, beside);
        outcome
    }
}
