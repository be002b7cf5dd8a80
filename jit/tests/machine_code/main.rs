//! Machine code: against the generic code, step by step, at singular states, and what callers may rely on.

#![allow(clippy::unwrap_used, clippy::panic, reason = "tests and their helpers fail by panicking")]

mod contract;
mod models;
mod programs;
mod robots;
mod sides;
mod singular;
