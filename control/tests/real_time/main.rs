//! What optimal motions change by, and motions that are solved again and again.

#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail by panicking")]

use costate_test_support::allocations::Counting;

mod costates;
mod feedback;
mod gains_again;
mod kinds;
mod kinds_feedback;
mod motion_derivative;
mod moving_tasks;
mod recovery;
mod resolve;
mod row_numbers;
mod sensitivity;
mod sensitivity_kinds;
mod settings;
mod solved;

#[global_allocator]
static ALLOCATOR: Counting = Counting;
