//! Optimal motions by Pontryagin's maximum principle.
//!
//! A [`Problem`] asks for the control that takes a robot from its start to its end and makes the cost
//! `J = integral of l(x, u) dt` least. Along such a motion there is a costate y with
//!
//! ```text
//! H*(x, y) = max_u [ y'f(x, u) - l(x, u) ]      x' = H*_y      y' = -H*_x
//! ```
//!
//! a boundary-value problem for z = (q, p, y_q, y_p), whose Jacobian holds the contracted Hessian y'F_xx
//! ([`RobotExtremal`]). [`Solver`] solves it by collocation at Lobatto's points, or by multiple [shooting](Method::Shooting)
//! with the variational equations, and Newton's method; anything that is an [`Extremal`], [generated code](GeneratedExtremal) for
//! one, goes the same way through [`solve_extremal`]. Signs are those of H* above throughout: `dJ/dT = -H*`,
//! `y(0) = -dJ/dx(0)`, `u = clip(R^-1 B'y_p)`. [`Continuation`] follows solutions while a parameter changes.

mod bvp;
mod continuation;
mod extremal;
mod numerics;
mod options;
mod path;
mod problem;
mod result;
mod search;
mod solve;
mod solve_dynamics;
mod solver;
mod status;

pub use continuation::{Branch, BranchEnd, BranchPoint, Continuation, Parameter, TurningPoint};
pub use extremal::dynamics::DynamicsExtremal;
pub use extremal::dynamics::problem::{DynamicsProblem, DynamicsProblemError, EndState};
pub use extremal::generated::{GeneratedEquations, GeneratedExtremal};
pub use extremal::hamiltonian::RobotExtremal;
pub use extremal::lagrangian::LagrangianExtremal;
pub use extremal::program::{ProgramOf, pontryagin_program};
pub use extremal::wrapped::{Hooks, Wrapped};
pub use extremal::{
    BoundSide, BoundaryValueProblem, BoundedControls, ControlLaw, Extremal, HamiltonianTerms, Homotopy,
    Relaxation,
};
pub use numerics::almost_block_diagonal::{AlmostBlockDiagonal, SingularMatrix};
pub use options::{Coordinates, Iteration, JacobianRoute, Method, SolverOptions, Ways};
pub use problem::check::CheckedProblem;
pub use problem::error::{ProblemError, SourceError};
#[cfg(feature = "toml")]
pub use problem::file::{ProblemFile, ProblemFileCause, ProblemFileError};
pub use problem::key::Key;
pub use problem::running_cost::{RunningCost, UserTerm};
pub use problem::warning::ProblemWarning;
pub use problem::{BoundaryState, Bounds, FinalTime, Objective, Penalty, Problem};
pub use result::motion::{Certificate, ExtremalSolution, Motion};
pub use result::nodes::Nodes;
pub use result::solution::{RobotNames, Solution, StartResult};
pub use result::trajectory::{Trajectory, TrajectoryPoint};
pub use result::trajectory_error::TrajectoryError;
pub use search::solve_extremal;
pub use solve_dynamics::solve_dynamics;
pub use solver::Solver;
pub use status::Status;
