//! Just-in-time compilation of recorded programs: generated code for robots that are loaded at run time.
//!
//! [`Compiled`] turns a [`Program`](costate::codegen::Program) into machine code in memory, without a
//! compiler. [`JitQuantity`] does so for a quantity of a robot. Where that is not possible it uses the
//! generic code, and its [`Backend`] has the reason. [`JitLanes`] evaluates four states at once. [`JitModel`]
//! is a model for optimisers and time steps, for one state or for four (`fours`), [`JitVelocityModel`] the
//! same for steps that need f = (v, a).
//!
//! The modules in the order of their work: `step` has the steps of a program, `pairs` joins those of two
//! equal sides of a robot; `plan` and `order` divide the steps into stages between function calls and sort
//! them; `translate`, `emit`, `registers` and `place` choose a register or memory for each value while
//! `assembler` writes the instructions; `code` is the executable memory, `functions` computes sines and
//! cosines, `machine` runs all of it. Machine code is straight: it has no branches, calls nothing, and
//! accesses four slices whose lengths are known when it is written.

#![warn(missing_debug_implementations)]
#![deny(unsafe_op_in_unsafe_fn, clippy::undocumented_unsafe_blocks)]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::panic))]

mod assembler;
mod code;
mod compiled;
mod emit;
mod error;
mod fours;
mod functions;
mod lanes;
mod limit;
mod lists;
mod machine;
mod model;
mod number;
mod order;
mod pairs;
mod place;
mod plan;
mod quantity;
mod registers;
mod step;
mod translate;
mod velocities;

pub use costate::codegen::{OPERATIONS_PER_STEP, Shape};

pub use compiled::{Compiled, supported};
pub use error::JitError;
pub use fours::Fours;
pub use lanes::{JitLanes, finite_states};
pub use limit::{DEFAULT_LIMIT, LANES_LIMIT, limit_of};
pub use model::{JitLanesModel, JitModel};
pub use number::JitNumber;
pub use quantity::{Backend, JitQuantity};
pub use velocities::JitVelocityModel;
