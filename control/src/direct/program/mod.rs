//! A motion on one mesh as a staged nonlinear program.
//!
//! [`Structure`](structure::Structure) says which unknowns and rows there are,
//! [`Program`](staged::Program) evaluates them.

pub(super) mod staged;
pub(super) mod structure;
