//! From a problem to a solution: starts, looks at several guesses, smoothed first steps, one mesh after the
//! other, and a motion that keeps its limits where the iteration is stuck.
//!
//! [`Direct`](direct::Direct) puts it together.

mod around;
mod candidates;
mod conclusion;
pub(super) mod direct;
mod dry_friction;
mod finer_mesh;
pub(super) mod first;
pub(super) mod first_time;
mod last_solved;
mod limits_between;
mod looks;
mod mending;
mod meshes;
pub(super) mod motion_program;
mod next_mesh;
mod once_more;
pub(super) mod prepare;
pub(super) mod refined;
mod refinement;
mod rest_pose;
pub(super) mod restore;
mod saddle;
mod settle;
pub(super) mod smoothing;
mod verified;
mod waiting;
mod with_effort;
