//! An interior-point solver for staged nonlinear programs with exact second derivatives.

#![warn(missing_debug_implementations)]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::panic))]

mod active;
mod barrier;
mod blocks;
mod certify;
mod elements;
mod filter;
mod iterate;
mod kkt;
mod layout;
mod newton;
mod outcome;
mod problem;
mod restoration;
mod scaled;
mod solve;

pub use active::{Certificate, Changes, Held};
pub use barrier::BarrierSettings;
pub use blocks::{Block, Blocks, Dense, Values, Weights};
pub use filter::FilterSettings;
pub use iterate::KktError;
pub use kkt::Inertia;
pub use layout::{Element, Layout, Rows};
pub use newton::RegularisationSettings;
pub use outcome::{Iteration, Solution, SolveError, Status};
pub use problem::{Scales, StagedProblem};
pub use solve::{Settings, Solver};
