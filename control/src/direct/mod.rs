//! The direct method: motions as piecewise polynomials, torques from inverse dynamics, hard limits by an
//! interior-point method.
//!
//! The unknowns are q, dq/ds and d2q/ds2 at the nodes of a mesh in s = t/T, and T. Between the nodes q(s) is
//! a polynomial of degree five ([`spline`]), so velocities and accelerations are continuous and the torques
//! `tau(q, v, a)` follow from inverse dynamics. Limits hold at Lobatto's points of each interval ([`basis`]);
//! the same points integrate the cost. Newton's equations have the exact Hessian of the Lagrange function:
//! the contracted second derivatives of inverse dynamics with the multipliers ([`system`]). They are block
//! tridiagonal, 3n unknowns a node. [`interior`] iterates, [`refine`] finds intervals that are too wide,
//! [`solve`] puts it together.

mod basis;
mod ends;
mod found;
mod guess;
mod interior;
mod limits;
mod metric;
mod point_terms;
mod points;
#[cfg(feature = "jit")]
mod program_points;
#[cfg(feature = "jit")]
mod programs;
mod refine;
mod report;
mod running;
mod scatter;
mod search;
mod solve;
mod spline;
mod step;
mod system;
mod verify;

pub(crate) use solve::Direct;
