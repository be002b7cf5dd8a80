//! The direct method: motions as piecewise polynomials, torques from inverse dynamics, hard limits by an
//! interior-point method.
//!
//! The unknowns are q and dq/ds at the nodes of a mesh in s = t/T, the height of a bubble of q on each
//! interval, and T. With vias s goes on by one in each phase, phases have times of their own, and what all
//! intervals share is the border of Newton's equations. q(s) is a polynomial of degree four on each
//! interval, and the torques `tau(q, v, a)` follow from inverse dynamics at Gauss's three points, where the
//! limits hold; those of positions and rates hold at the nodes too. The points integrate the cost. Newton's
//! equations have the exact Hessian of the Lagrange function: the contracted second derivatives of inverse
//! dynamics with the multipliers; tools and clearances are rows g(q, v) beside the torques, powers are rows
//! h(v, tau). The bubbles are eliminated interval by interval, and what remains is block tridiagonal, 2n
//! unknowns a node. Where jerks or rates of torques are limited or cost anything, q'' is continuous and an
//! unknown at the nodes too, in place of the bubbles: `motion::shape` says what changes.
//!
//! Each folder uses those above it:
//!
//! | folder | content |
//! |---|---|
//! | [`motion`] | splines, meshes, times of phases, guesses |
//! | [`points`] | torques, costs and rates at the points, with their derivatives |
//! | [`limits`] | sides of limits, rows of tasks, powers, ends; slacks and multipliers |
//! | [`newton`] | the Lagrange function in the unknowns, Newton's equations and their factorisation |
//! | [`program`] | a motion on one mesh as a staged nonlinear program |
//! | [`interior`] | the interior-point iteration on one mesh |
//! | [`refine`] | estimated errors and limits between the points; the next mesh |
//! | [`outcome`] | costates, trajectory, report, verification, limits that cannot be kept |
//! | [`solve`] | from a problem to a solution |
//! | [`again`] | the same problem solved again and again |

mod again;
mod interior;
mod limits;
mod motion;
mod newton;
mod outcome;
mod points;
mod program;
mod refine;
mod solve;

pub(crate) use again::cost_by_robot::moves_links;
pub use again::feedback::Feedback;
pub use again::motion_derivative::{MotionDerivative, MotionParameter};
pub use again::resolve::Resolve;
pub use again::resolve_error::ResolveError;
pub use again::resolved::{Budget, ResolveStatus, Resolved};
pub use again::sensitivity_error::SensitivityError;
pub(crate) use again::undecided::OneSided;
pub(crate) use interior::filter::{Figure, Filter, is_better};
pub(crate) use interior::looseness::Looseness;
pub(crate) use limits::power::Powers;
pub(crate) use motion::shape::{PLACES, POINTS, WEIGHTS};
pub(crate) use solve::direct::Direct;
pub use solve::motion_program::{MotionProgram, ProgramRow, ProgramSample};
