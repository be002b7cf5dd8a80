//! Factorisation of the equations of a Newton step.
//!
//! `front` is a partial LDL' of one dense symmetric matrix; `chain` runs it from stage to stage, with the
//! factors of a stage in `factors`.

mod chain;
mod factors;
mod front;

pub(crate) use chain::{Chain, Inertia, Kept, Matrices};
