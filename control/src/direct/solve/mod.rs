//! From a problem to a solution: starts, looks at several guesses, smoothed first steps, one mesh after the
//! other, and a motion that keeps its limits where the iteration is stuck.
//!
//! [`Direct`](direct::Direct) puts it together.

mod around;
mod candidates;
pub(super) mod direct;
mod finer_mesh;
pub(super) mod first;
pub(super) mod first_time;
mod looks;
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
