//! Newton's equations of the barrier problem: from derivatives at points to a factorised system.
//!
//! [`point_terms`] collects the Lagrange function at one point, [`interval`] carries it to the unknowns of a
//! spline, and [`System`](system::System) eliminates the bubbles and factorises what remains, block
//! tridiagonal with a [`border`] of unknowns that many intervals share.

pub(super) mod border;
pub(super) mod by_times;
pub(super) mod end_columns;
mod factors;
pub(super) mod interval;
pub(super) mod metric;
pub(super) mod point_terms;
pub(super) mod rate_rows;
pub(super) mod rate_terms;
pub(super) mod rests;
pub(super) mod side_terms;
pub(super) mod system;
pub(super) mod system_rates;
pub(super) mod torque_rows;
mod touches;
