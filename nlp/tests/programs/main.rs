//! Programs of optimal control with solutions in closed form, or published by others.

#![allow(clippy::unwrap_used, clippy::panic)]

mod allocation;
#[path = "../../../tests/support/src/allocations.rs"]
mod allocations;
mod by_duals;
mod closed_forms;
mod collocation;
mod hard;
mod published;
mod second_order;
mod steps;

#[global_allocator]
static ALLOCATOR: allocations::Counting = allocations::Counting;
