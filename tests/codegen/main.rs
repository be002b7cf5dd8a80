//! Code generation: recording, evaluation, emitted source.

#![allow(clippy::unwrap_used, clippy::panic, reason = "tests and their helpers fail by panicking")]

mod abi;
mod expr;
mod programs;
mod random;
mod sine_and_cosine;
mod text;
