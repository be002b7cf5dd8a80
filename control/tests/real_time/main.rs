//! What optimal motions change by, and motions that are solved again and again.

#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail by panicking")]

mod sensitivity;
