//! Loops compiled for the widest vectors of the processor.
//!
//! A build for any x86-64 processor uses vectors of two doubles. [`widest`] runs a closure compiled for
//! AVX-512, AVX2 or the vectors of the build, chosen at run time, with the same bits on all processors;
//! [`widest_fused`] also fuses products and sums. Plain loops over rows of a dozen numbers and more gain,
//! such as those of an elimination.

#![warn(missing_debug_implementations)]
#![deny(unsafe_op_in_unsafe_fn, clippy::undocumented_unsafe_blocks)]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::panic))]

mod widest;

pub use widest::{widest, widest_fused};
