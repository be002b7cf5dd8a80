//! Maps between the coordinates of a search and those of a motion.

use crate::extremal::Extremal;
use crate::extremal::hamiltonian::RobotExtremal;
use crate::extremal::lagrangian::LagrangianExtremal;
use costate::EvalError;
use costate::lagrangian::LegendreTransform;
use costate::robot::Robot;

/// An extremal of a robot with its own coordinates. Guesses and motions are in z = (q, p, y_q, y_p).
pub(crate) trait OfRobot: Extremal {
    /// Maps (q, p, y_q, y_p) to the coordinates of the extremal, in place.
    ///
    /// # Errors
    /// A singular mass matrix.
    fn take(map: &mut Legendre, z: &mut [f64]) -> Result<(), EvalError>;

    /// Maps the coordinates of the extremal to (q, p, y_q, y_p), in place. Takes x alone, too.
    ///
    /// # Errors
    /// A singular mass matrix.
    fn give(map: &mut Legendre, z: &mut [f64]) -> Result<(), EvalError>;
}

/// `p = M v`, `y_v = M y_p`, `y_q(q, v) = y_q(q, p) + P'y_p` with P = d(M v)/dq.
pub(crate) struct Legendre {
    map: LegendreTransform<f64>,
    none: Vec<f64>,
}

impl Legendre {
    pub fn new(robot: &Robot) -> Self {
        Self { map: LegendreTransform::new(robot), none: vec![0.0; robot.dof()] }
    }
}

impl OfRobot for RobotExtremal {
    fn take(_: &mut Legendre, _: &mut [f64]) -> Result<(), EvalError> {
        Ok(())
    }

    fn give(_: &mut Legendre, _: &mut [f64]) -> Result<(), EvalError> {
        Ok(())
    }
}

impl OfRobot for LagrangianExtremal {
    fn take(map: &mut Legendre, z: &mut [f64]) -> Result<(), EvalError> {
        let n = map.none.len();
        let (x, y) = z.split_at_mut(2 * n);
        let mut at = map.map.at_momentum(&x[..n], &x[n..], &map.none)?;
        at.costate_to_lagrangian(y)?;
        x[n..].copy_from_slice(at.velocity());
        Ok(())
    }

    fn give(map: &mut Legendre, z: &mut [f64]) -> Result<(), EvalError> {
        let n = map.none.len();
        let (x, y) = z.split_at_mut(2 * n);
        let mut at = map.map.at(&x[..n], &x[n..], &map.none)?;
        if !y.is_empty() {
            at.costate_to_hamiltonian(y)?;
        }
        x[n..].copy_from_slice(at.momentum());
        Ok(())
    }
}
