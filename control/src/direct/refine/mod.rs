//! Where a mesh is too coarse: errors estimated between the points, jumps inside of intervals, and limits
//! that are exceeded there.
//!
//! [`Resolution`](resolution::Resolution) measures them and chooses the nodes of the next mesh.

pub(super) mod at_ends;
pub(super) mod between;
mod crossings;
mod division;
mod excess;
pub(super) mod jumps;
mod limit_errors;
pub(super) mod move_inside;
pub(super) mod overshoots;
pub(super) mod peak;
mod peaks;
pub(super) mod rates_between;
pub(super) mod resolution;
mod seeds;
