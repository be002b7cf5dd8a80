//! Every number type through the whole pipeline and every scheme: dual numbers, lanes, numbers that count.

#![allow(clippy::unwrap_used, clippy::panic, reason = "tests and their helpers fail by panicking")]

#[cfg(feature = "wide")]
mod lane_calls;
#[cfg(feature = "wide")]
mod lanes;
mod operation_table;
mod operations;
mod scalars;
mod steps;
