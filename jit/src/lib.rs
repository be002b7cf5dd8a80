//! Just-in-time compilation of recorded programs: a robot loaded at run time runs at the speed of generated code.
//!
//! [`Compiled`] turns a [`Program`](costate::codegen::Program) into machine code in memory, without any compiler;
//! [`Evaluator`] does so for a quantity of a robot and falls back to the generic code where that is not possible, with a
//! [`Status`] that says why.
//!
//! How it works, in the order of the modules: `order` and `plan` put the steps into an order and divide them where functions
//! are called; `registers`, `place`, `emit` and `translate` decide which value is in which register or memory while
//! `assembler` writes the instructions; `code` is the memory that is executed, `functions` computes sines and cosines.
//! Machine code is straight: it has no branches, calls nothing, and touches four slices whose lengths are known when it is
//! written.

#![deny(unsafe_op_in_unsafe_fn, clippy::undocumented_unsafe_blocks)]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::panic))]

mod assembler;
mod code;
mod compiled;
mod emit;
mod error;
mod evaluator;
mod functions;
mod generic;
mod number;
mod order;
mod place;
mod plan;
mod registers;
mod translate;

pub use compiled::{Compiled, DEFAULT_LIMIT, LANES_LIMIT};
pub use error::JitError;
pub use evaluator::{Evaluator, OPERATIONS_PER_STEP, Status};
pub use generic::Shape;
pub use number::Number;
