//! Whether a stationary motion is a minimum or a saddle.

use super::iterate::Interior;
use crate::constants::direct as constants;
use crate::direct::points::values::PointDynamics;
use costate::EvalError;

/// The signs of the eigenvalues of the exact Hessian of cost and barrier along all changes that keep the
/// equations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Inertia {
    Positive,
    /// One of them at least is negative, and no rounding.
    Negative,
    /// The smallest one is about zero.
    Unknown,
}

impl<D: PointDynamics> Interior<D> {
    /// Those at a motion that is solved. Squares of the equations are in the matrix, as stiff as it takes:
    /// the Hessian is positive along what keeps the equations where the matrix is so for some stiffness
    /// (G. Debreu, Definite and semidefinite quadratic forms, Econometrica 20, 1952).
    ///
    /// # Errors
    /// A motion that cannot be evaluated.
    pub fn inertia(&mut self) -> Result<Inertia, EvalError> {
        if self.figures.is_minimum {
            return Ok(Inertia::Positive);
        }
        self.refresh()?;
        self.system.exact = true;
        let stiffness = self.barrier.stiffness;
        let has_equations = self.barrier.equations().next().is_some();
        let mut found = Inertia::Negative;
        for factor in if has_equations { &constants::STIFFNESSES[..] } else { &constants::STIFFNESSES[..1] } {
            self.barrier.stiffness = factor * stiffness;
            self.assemble();
            if self.factorise(0.0) {
                found = Inertia::Positive;
                break;
            }
            if self.factorise(constants::ROUNDED_INERTIA) {
                found = Inertia::Unknown;
            }
        }
        self.barrier.stiffness = stiffness;
        Ok(found)
    }
}
