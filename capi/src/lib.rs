//! The C interface: opaque handles, codes as results, and a text for the last error of a thread.
//!
//! `include/costate.h` declares what is exported here and documents it; `tests/header.rs` compares both.
//! `status` has the codes and keeps panics on this side, `numbers` reads and writes arrays of the caller,
//! `robot`, `dynamics`, `step` and `frame` are the handles, `quantities` more of `dynamics`.

#![deny(unsafe_op_in_unsafe_fn, clippy::undocumented_unsafe_blocks)]
#![allow(missing_docs, reason = "include/costate.h has the documentation of what is exported")]
#![expect(clippy::missing_safety_doc, reason = "include/costate.h says what pointers must be")]

pub mod dynamics;
pub mod frame;
mod handle;
mod numbers;
pub mod quantities;
pub mod robot;
pub mod status;
pub mod step;
