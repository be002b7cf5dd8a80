//! Properties of the state equation and its derivatives on random trees, and what happens at bad states.

#![allow(clippy::unwrap_used, clippy::panic, reason = "tests and their helpers fail by panicking")]

mod constraints;
mod edits;
mod free_joints;
mod identities;
mod inputs;
mod kernels;
mod kinematics;
mod lagrangian;
mod mimics;
mod parameters;
mod rounding_scan;
mod routes;
mod second_order;
mod singular;
mod structure;
mod tensors;
mod wrenches;
