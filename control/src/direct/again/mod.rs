//! The same problem solved again and again, as a controller needs it.
//!
//! A solved motion is the [start](start::Again) of the next one; [`feedback`] is how it changes with its
//! ends. [`Resolve`](resolve::Resolve) is what users hold.

mod active_rows;
mod begin;
pub(super) mod cost_by_robot;
pub(super) mod feedback;
pub(super) mod goals;
mod limit_sides;
mod motion_at;
pub(super) mod motion_derivative;
pub(super) mod neighbours;
mod orientations;
mod other_limits;
pub(super) mod parameter_columns;
mod recovery;
pub(super) mod resolve;
pub(super) mod resolve_error;
pub(super) mod resolved;
mod rest_gains;
mod row_column;
mod row_differences;
pub(super) mod sensitivity_error;
mod settings;
mod solve_again;
mod solved_near;
pub(super) mod start;
mod touches;
pub(super) mod undecided;

#[cfg(test)]
mod allocation_tests;
