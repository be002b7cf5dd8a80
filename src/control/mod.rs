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

mod accuracy;
mod actuation;
mod almost_block_diagonal;
mod arcs;
mod borders;
mod branch;
mod collocation;
mod condensed;
mod continuation;
mod differences;
mod discretised;
mod dormand_prince;
mod ends;
mod equations;
mod error;
mod extremal;
mod final_time;
mod generated;
mod guess;
mod jacobi;
mod lagrangian_ends;
mod lagrangian_extremal;
mod lagrangian_jacobian;
mod legendre;
mod lobatto;
mod lu;
mod mesh;
mod mismatch;
mod motion;
mod multiple_shooting;
mod newton;
mod options;
mod path;
mod penalty;
mod polynomial;
mod problem;
mod refine;
mod residuals;
mod robot_extremal;
mod running_cost;
mod search;
mod shooting;
mod solution;
mod solver;
mod source;
mod stages;
mod status;
mod timed;
mod user_terms;
mod values;

pub use almost_block_diagonal::{AlmostBlockDiagonal, SingularMatrix};
pub use branch::{Branch, BranchEnd, BranchPoint, Continuation, Parameter, TurningPoint};
pub use error::{ProblemError, SourceError};
pub use extremal::{Ease, Extremal, Law, Rate, Side};
pub use generated::GeneratedExtremal;
pub use lagrangian_extremal::LagrangianExtremal;
pub use motion::{Certificate, Motion};
pub use options::{Coordinates, Iteration, Jacobian, Method, Options, Ways};
pub use problem::{Bounds, Cost, End, Penalty, Problem, Start, Time};
pub use robot_extremal::RobotExtremal;
pub use running_cost::{RunningCost, UserTerm};
pub use search::solve_extremal;
pub use solution::{Solution, Trajectory};
pub use solver::Solver;
pub use source::{ProgramOf, pontryagin_program};
pub use status::Status;
