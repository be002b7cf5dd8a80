//! Extremals of Pontryagin's principle: a differential equation for state and costate with conditions at both
//! ends.

pub(crate) mod actuation;
pub(crate) mod component_ends;
pub(crate) mod controls;
pub(crate) mod differences;
pub(crate) mod dynamics;
pub(crate) mod generated;
pub(crate) mod given_rows;
pub(crate) mod hamiltonian;
pub(crate) mod lagrangian;
pub(crate) mod legendre;
pub(crate) mod penalty;
pub(crate) mod program;
pub(crate) mod relaxable;
pub(crate) mod relaxation;
pub(crate) mod roles;
pub(crate) mod user_terms;
pub(crate) mod wrapped;

pub use controls::{BoundSide, ControlLaw, ControlRange, SideChange};
pub use relaxation::Relaxation;
pub use roles::{BoundaryValueProblem, BoundedControls, Extremal, HamiltonianTerms, Homotopy};
