//! What was found, in the words of the user: costates from multipliers, the trajectory, how limits are used,
//! the motion integrated again, or the limits that cannot be kept.

pub(super) mod clock;
pub(super) mod closed_map;
mod closed_verify;
mod costates;
pub(super) mod found;
pub(super) mod hamiltonians;
pub(super) mod independent;
pub(super) mod infeasible;
mod integrate;
pub(super) mod interval_part;
pub(super) mod named;
pub(super) mod report;
pub(super) mod smooth_costates;
mod stationarity;
pub(super) mod verify;
