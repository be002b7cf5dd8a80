//! Loops: holonomic constraints g(q) = const on trees, and the Hamiltonian state equation under them.
//!
//! [`Robot::with_constraint`](crate::robot::Robot::with_constraint) closes loops of a tree, or a table
//! `[[constraint]]` of a [file](crate::robot::file). [`Constraints`] computes g, its Jacobian J and its
//! contracted Hessian; [`ConstrainedHamiltonian`] F, F_x, y'F_x, accelerations and the forces of the
//! constraints; [`ConstrainedHamiltonianSecondOrder`] adds y'F_xx and its product with a vector.
//! [`ConstrainedLagrangian`] and [`ConstrainedLagrangianSecondOrder`] have accelerations and forces in
//! (q, v, u), [`Impact`] what happens where constraints set in or are released.
//!
//! The transform is that of impetus and striction (J. H. Maddocks, R. L. Pego, "An unconstrained Hamiltonian
//! formulation for incompressible fluid flow", Communications in Mathematical Physics 170 (1995) 207-217),
//! for rigid bodies. It is right for holonomic constraints only: J must be a gradient.

mod assembly;
mod blocks;
mod chain;
mod conflict;
#[cfg(test)]
mod conflict_tests;
mod directions;
mod elimination;
mod error;
#[cfg(test)]
mod free_samples;
#[cfg(test)]
mod free_tests;
mod hamiltonian;
mod held;
mod impact;
#[cfg(test)]
mod impact_tests;
mod kkt;
mod lagrangian;
mod lagrangian_rows;
mod lagrangian_second_order;
#[cfg(test)]
mod lagrangian_tests;
mod linearisation;
#[cfg(test)]
mod loop_tests;
mod orders;
mod position;
mod projection;
mod quaternion;
mod rows;
#[cfg(test)]
mod samples;
mod second_order;
mod singular;
mod state;
#[cfg(test)]
mod tests;

pub use error::{Conflict, ConstraintError};
pub use hamiltonian::ConstrainedHamiltonian;
pub use impact::{AfterImpact, Impact, ImpactLinearisation, ImpactWeights};
pub use lagrangian::{AccelerationLinearisation, ConstrainedLagrangian};
pub use lagrangian_second_order::{AccelerationContraction, ConstrainedLagrangianSecondOrder};
pub use linearisation::{
    ConstrainedAdjoint, ConstrainedContraction, ConstrainedLinearisation, ConstrainedRate,
};
pub use rows::Constraints;
pub use second_order::ConstrainedHamiltonianSecondOrder;
