//! The C interface: opaque handles, codes as results, and a text for the last error of a thread.
//!
//! `include/costate.h` is what cbindgen makes of the functions, enums and handles that are exported here, of
//! their documentation, and of `cbindgen.toml`, which has the conventions of all functions; `tests/header.rs`
//! writes it. `handle` has the lock behind each handle, `numbers` reads and writes arrays of the caller.

#![deny(unsafe_op_in_unsafe_fn, clippy::undocumented_unsafe_blocks)]
#![allow(non_camel_case_types, reason = "what is exported has the names of C")]
#![expect(clippy::missing_safety_doc, reason = "the conventions in cbindgen.toml say what pointers must be")]

mod handle;
mod numbers;

// The header has its functions in the order of these modules.

// Codes, and the text of the last error; keeps panics on this side.
pub mod status;

// Robots and their names.
pub mod robot;

// f and its derivatives.
pub mod dynamics;

// Accelerations, torques, the mass matrix.
pub mod quantities;

// Time steps.
pub mod step;

// Poses, Jacobians and second derivatives of frames.
pub mod frame;
