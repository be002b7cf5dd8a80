//! Functions of (q, v) that a task asks for: poses and speeds of tools, clearances, with exact first and
//! second derivatives.
//!
//! [`PathFunction`](functions::PathFunction) is what a solver sees;
//! [`TaskFunctions`](functions::TaskFunctions) are those of one place of a motion (its start, its end, or all
//! of it), with the bounds between which they must lie. [`build`] makes them from a problem, [`check`] finds
//! tasks that cannot be done.

pub(crate) mod accelerations;
mod bodies;
pub(crate) mod build;
pub(crate) mod check;
pub(crate) mod check_references;
mod clearance;
pub(crate) mod collision;
pub(crate) mod costs;
pub(crate) mod functions;
mod given;
mod kept;
pub(crate) mod orient;
mod payloads;
mod placed;
pub(crate) mod reach;
pub(crate) mod references;
pub(crate) mod row;
mod tool;
mod tool_rows;
mod turns;

#[cfg(test)]
#[path = "allocation_tests.rs"]
mod allocation;
#[cfg(test)]
mod differences;
