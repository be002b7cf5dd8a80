//! Optimal motions against values known in closed form or published.

#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail by panicking")]

mod bounded;
mod branch;
mod extremals;
mod free_start;
mod known;
mod lagrangian;
mod linear_algebra;
mod one_state;
mod problems;
mod shooting;
mod source;
mod user_terms;
