//! An interior-point solver for staged nonlinear programs with exact second derivatives.

#![warn(missing_debug_implementations)]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::panic))]

mod blocks;
mod layout;
mod problem;

pub use blocks::{Block, Blocks, Dense, Values, Weights};
pub use layout::{Element, Layout, Rows};
pub use problem::{Scales, StagedProblem};
