//! Machine code: of random programs, of the quantities of robots, at singular poses, in the solver, and what
//! callers may rely on.

#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail by panicking")]

mod contract;
mod extremals;
#[path = "../../../tests/common/generic.rs"]
mod generic;
mod programs;
#[path = "../../../tests/common/random_robot.rs"]
mod random_robot;
mod robots;
mod singular;
