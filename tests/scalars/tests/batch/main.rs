//! Batches: every node is what one evaluation gives, whatever the number of nodes, lanes, threads, and bad
//! nodes.

#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail by panicking")]

mod arrays;
mod failures;
mod functions;
mod models;
mod steps;
mod threads;
