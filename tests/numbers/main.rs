//! Every scalar type through the whole pipeline: dual numbers, lanes, numbers that count.

#![allow(clippy::unwrap_used, clippy::panic, reason = "tests and their helpers fail by panicking")]

#[cfg(feature = "wide")]
mod lanes;
mod operations;
#[path = "../../benches/frames/robots.rs"]
mod robots;
mod scalars;
