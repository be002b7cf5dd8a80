//! From a problem to a solution: starts, smoothed first steps, one mesh after the other, and a motion that
//! keeps its limits where the iteration is stuck.
//!
//! [`Direct`](direct::Direct) puts it together.

mod around;
pub(super) mod direct;
pub(super) mod first_time;
mod mending;
mod meshes;
pub(super) mod prepare;
pub(super) mod refined;
mod rest_pose;
pub(super) mod restore;
mod saddle;
pub(super) mod smoothing;
mod waiting;
mod with_effort;
