//! Verification of a motion that is independent of the method that found it.
//!
//! It knows the problem, the motion as [polynomials of time](path) between nodes, the costates at these nodes
//! and the multipliers of limits as data. Torques come from inverse dynamics; [places](splits) where
//! something narrow happens are found from the polynomials; nothing is evaluated at the points of a solver.
//!
//! [`cost`] integrates the cost, [`motion`] the equations of motion, [`limits`] looks at hard limits,
//! [`optimality`] bounds what the motion costs too much; [`blame`] says which intervals are divided where one
//! of these fails.

pub(crate) mod adjoint;
pub(crate) mod blame;
pub(crate) mod cost;
pub(crate) mod dynamics;
mod jerk_gaps;
pub(crate) mod jerk_optimality;
pub(crate) mod limits;
pub(crate) mod motion;
pub(crate) mod optimality;
pub(crate) mod path;
pub(crate) mod running;
pub(crate) mod splits;
mod torque_optimality;

use costate::EvalError;

/// The matrix of accelerations, multipliers included, cannot be inverted.
fn singular() -> EvalError {
    EvalError::SingularMassMatrix { joint: "base".into() }
}

#[cfg(test)]
mod tests;
