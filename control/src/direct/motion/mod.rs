//! Motions as piecewise polynomials: the mesh, how smooth a motion is, positions and rates from the unknowns
//! at nodes and in intervals, and the times of phases.
//!
//! A [`guess`](guess::guess) gives the first motion. Nothing here knows of a robot's dynamics or of limits.

pub(super) mod basis;
mod closing;
pub(super) mod guess;
pub(super) mod mesh;
mod path;
pub(super) mod phase_times;
pub(super) mod reached;
pub(super) mod shape;
pub(super) mod spline;
pub(super) mod times;
mod way_time;
