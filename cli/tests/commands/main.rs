//! The commands as a user calls them.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

mod child;
mod eval;
mod free_joints;
mod info;
mod manual;
mod optimize;
mod references;
mod reports;
mod source;
mod streams;
