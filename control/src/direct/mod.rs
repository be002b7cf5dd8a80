//! The direct method: motions as piecewise polynomials, torques from inverse dynamics, hard limits by an
//! interior-point method.
//!
//! The unknowns are q and dq/ds at the nodes of a mesh in s = t/T, the height of a bubble of q on each
//! interval, and T. With vias s goes on by one in each phase ([`mesh`], [`spline`]), phases have times of
//! their own ([`times`]), and what all intervals share is the [`border`] of Newton's equations.
//! q(s) is a polynomial of degree four on each interval ([`spline`]), and the torques
//! `tau(q, v, a)` follow from inverse dynamics at Gauss's three points ([`shape`]), where the limits hold;
//! those of positions and rates hold at the nodes too. The points integrate the cost. Newton's equations have
//! the exact Hessian of the Lagrange function: the contracted second derivatives of inverse dynamics with the
//! multipliers ([`system`]); tools and clearances are rows g(q, v) beside the torques ([`tasks`]), powers are
//! rows h(v, tau) ([`power`]). The bubbles are eliminated interval by interval, and what remains is block
//! tridiagonal, 2n unknowns a node. Where jerks or rates of torques are limited or cost anything ([`rates`]),
//! q'' is continuous and an unknown at the nodes too, in place of the bubbles: [`shape`] says what changes.
//! [`interior`] iterates, [`refine`] finds intervals that are too wide, [`restore`] looks for a motion that
//! keeps its limits where that is stuck, [`solve`] puts it together.

mod again;
mod basis;
mod between;
mod border;
mod clock;
mod corrector;
mod costates;
mod elastic;
mod end_columns;
mod ends;
mod energy;
mod entries;
mod feedback;
mod figures;
mod filter;
mod first_time;
mod found;
mod goals;
mod guess;
mod infeasible;
mod interior;
mod interval;
mod jumps;
mod limits;
mod measures;
mod mesh;
mod metric;
mod move_inside;
mod multipliers;
mod neighbours;
mod phase_times;
mod phases;
mod point_terms;
mod points;
mod power;
#[cfg(feature = "jit")]
mod program_points;
#[cfg(feature = "jit")]
mod programs;
mod rate_rows;
mod rate_terms;
mod rates;
mod rates_between;
mod refine;
mod relaxation;
mod report;
mod resolve;
mod resolve_error;
mod resolved;
mod restore;
mod rounding;
mod running;
mod search;
mod shape;
mod side;
mod smooth_costates;
mod smoothing;
mod solve;
mod spline;
mod squares;
mod step;
mod system;
mod system_rates;
mod tasks;
mod times;
mod verify;
mod warm;

pub use feedback::Feedback;
pub(crate) use power::Powers;
pub use resolve::Resolve;
pub use resolve_error::ResolveError;
pub use resolved::{Budget, ResolveStatus, Resolved};
pub(crate) use shape::{PLACES, POINTS, WEIGHTS};
pub(crate) use solve::Direct;
