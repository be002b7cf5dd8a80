//! What a motion has to keep: sides of limits, rows of tasks, powers, and what is given at the ends of
//! phases.
//!
//! [`Barrier`](barrier::Barrier) holds all entries with their slacks and multipliers, and measures how far
//! each of them is from its bound; [`entries`] are the loops over them.

pub(super) mod at_node;
pub(super) mod barrier;
pub(super) mod distances;
pub(super) mod ends;
pub(super) mod entries;
mod entry_places;
mod gait_lifts;
pub(super) mod gait_rows;
mod gait_soles;
pub(super) mod hull;
pub(super) mod model;
mod moved;
pub(super) mod multipliers;
pub(super) mod power;
mod prices;
mod quartic;
pub(super) mod settled;
pub(super) mod side;
mod soften;
mod task_derivatives;
pub(super) mod tasks;
mod vectors;
