//! An interior-point solver for staged nonlinear programs with exact second derivatives, such as optimal
//! control by collocation or multiple shooting. It knows neither robots nor time.
//!
//! # Programs
//!
//! $$ \min_z \; f(z) \quad \text{subject to} \quad c(z) = 0, \qquad l \le g(z) \le u \qquad (1) $$
//!
//! f, c and g are made of functions of one node, of one interval with its two nodes, or of both ends
//! ([`Element`]); a [`Layout`] counts their unknowns and rows, a [`StagedProblem`] computes values, Jacobians
//! and the Hessian of the Lagrangian as dense blocks, element by element. Steps are displacements of a point,
//! so that unknowns may live on manifolds ([`StagedProblem::retract`]), and have typical sizes ([`Scales`]):
//! other units take the same iterations.
//!
//! # Method
//!
//! Ranges have slacks s, and a barrier with parameter mu keeps them inside:
//!
//! $$ \min \; f(z) - \mu \sum \ln (s - l) - \mu \sum \ln (u - s) \quad \text{subject to} \quad c(z) = 0,
//! \qquad g(z) - s = 0 \qquad (2) $$
//!
//! [`Solver`] takes Newton steps on the conditions of optimality of (2) with multipliers of the bounds
//! (primal-dual), while mu falls. With the steps of slacks eliminated they are
//!
//! $$ \begin{pmatrix} W + G^T \Sigma G + \delta M & C^T \\\\ C & 0 \end{pmatrix} \begin{pmatrix} d_z \\\\ d_y
//! \end{pmatrix} = r, \qquad \Sigma = \frac{z_l}{s - l} + \frac{z_u}{u - s} \qquad (3) $$
//!
//! - (3) is factored from stage to stage as LDL' with pivots of order 1 and 2, after its rows and columns
//!   were scaled to entries of about 1. Rows that find no acceptable pivot in a stage are handed on to the
//!   next one, so that multipliers are true ones and the inertia is exact; equations that depend on others
//!   end as zero pivots and are named ([`Solution::dependent`]). The time is linear in the number of
//!   intervals. Solutions are refined by the residual of the whole system.
//! - Beside equations, ranges of several unknowns whose squares in `G' Sigma G` would be more than 1e6 times
//!   as large as W are rows of (3) with `-1/Sigma` on the diagonal: close to bounds the squares would leave
//!   nothing of W. Distances to bounds are unknowns of their own, which may be far below the rounding of the
//!   slacks.
//! - Where the inertia is wrong, a convex Hessian of the program takes the place of W
//!   ([`StagedProblem::convexify`], [`ConvexSettings`]), or a multiple delta of a metric M is added to it,
//!   remembered and decreased ([`RegularisationSettings`]): by default that of the typical sizes of steps, or
//!   that of the program ([`StagedProblem::add_metric`]).
//! - Steps are shortened until a filter accepts them, after second-order corrections ([`FilterSettings`]). If
//!   none is accepted, an elastic program of the form (1) lowers the violation; [`Status::LocallyInfeasible`]
//!   is a local minimum of it.
//! - mu is chosen anew in each iteration, by how much of the complementarity a step for mu = 0 would leave
//!   ([`BarrierSettings`]). A step that bounds cut short is corrected towards the central path, with the
//!   same factors ([`CentralitySettings`]).
//!
//! A solution may begin with multipliers that are known from another mesh or an earlier instant ([`Start`]),
//! and go on one iteration at a time ([`Solver::begin`], [`Solver::advance`]). What the next step promises is
//! known before it is made ([`Solver::promise`]): a loop over meshes ends there.
//!
//! # After a solution
//!
//! The right inertia of (3) certifies a minimum of (2). [`Solver::certify`] judges (1): with held ranges as
//! equations and without barrier or delta. [`Solver::refine`] solves the conditions of (1) on that set by
//! Newton's method, [`Solver::respond`] differentiates the solution by parameters, forward or backward.
//!
//! Sources: A. Waechter, L. T. Biegler, Mathematical Programming 106 (2006), 25-57 (filter, regularisation,
//! restoration); S. Mehrotra, SIAM Journal on Optimization 2 (1992), 575-601 (choice of mu); J. Gondzio,
//! Computational Optimization and Applications 6 (1996), 137-156 (corrections); I. S. Duff, J.
//! K. Reid, ACM TOMS 9 (1983), 302-325 (pivots that are handed on); L. Vanroye, A. Sathya, J. De Schutter, W.
//! Decre, "FATROP", IROS 2023 (staged programs).

#![warn(missing_debug_implementations)]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::panic))]

mod active;
mod barrier;
mod blocks;
mod centrality;
mod certify;
mod condense;
mod convex;
mod correctors;
mod dense;
mod elements;
mod filter;
mod iterate;
mod kkt;
mod layout;
mod newton;
mod outcome;
mod problem;
mod restoration;
mod restore;
mod scaled;
mod scales;
mod search;
mod settings;
mod solve;
mod sparse;
mod tiles;
mod vectors;

pub use active::{Certificate, Changes, Held};
pub use barrier::BarrierSettings;
pub use blocks::{Block, Blocks, Values, Weights};
pub use centrality::CentralitySettings;
pub use convex::ConvexSettings;
pub use dense::Dense;
pub use filter::FilterSettings;
pub use iterate::KktError;
pub use layout::{Element, Layout, Rows};
pub use newton::RegularisationSettings;
pub use outcome::{Iteration, Promise, Solution, SolveError, Status};
pub use problem::StagedProblem;
pub use scales::Scales;
pub use settings::Settings;
pub use solve::{Solver, Start};
pub use sparse::SparseProgram;
