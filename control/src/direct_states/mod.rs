//! The direct method for models of a user: states and controls at Radau's points, the model by its defects.
//!
//! On interval k, of width h in s = t/T, x(s) is a cubic through the node $x_k$ and the values $X_j$ at
//! Radau's three points, of which the last is the next node; u has values $U_j$ there and may jump at nodes:
//!
//! $$ d_{j0} x_k + \sum_i d_{ji} X_i = h T f(X_j, U_j), \qquad
//!    J \approx c_t T + \sum_{k, j} h T b_j (\tfrac12 U_j^\top R U_j + l(X_j, U_j)) $$
//!
//! The end of an interval has an error of order five. A primal-dual interior-point method keeps
//! the bounds on x and u at the points (A. Waechter, L. T. Biegler, Mathematical Programming 106, 2006). Its
//! Newton equations have the exact Hessian: the second derivatives of $\lambda_j^\top f$, contracted by
//! the model. The defects of an interval give $dX$ by $(dx_k, dT, dU)$, and what is left is a
//! linear-quadratic problem over the nodes with state (x, T) and control $(U_1, U_2, U_3)$, solved by
//! Riccati's recursion in O(N n^3). What is given at the end, components and linear functions of x, are
//! squares with a multiplier. All Cholesky
//! factors of the recursion exist if and only if the Hessian plus these squares is positive definite along
//! the linearised defects, so that the last step also tells a minimum on the mesh from a saddle.
//!
//! | file | content |
//! |---|---|
//! | [`problem`] | what is asked for, and what is refused |
//! | [`guess`], [`begin`] | where the iteration begins, and the size of the cost |
//! | [`points`] | Radau's points, unknowns and their bounds |
//! | [`ends`] | what is given at the end |
//! | [`running_cost`], [`evaluate`] | cost, defects and their derivatives |
//! | [`interval`] | derivatives of one interval, and its condensation |
//! | [`recursion`] | Riccati's recursion |
//! | [`newton`] | Newton's step |
//! | [`interior`], [`iterate`] | the iterate on one mesh, and the iteration |
//! | [`search`] | the part of a step that is taken, and its corrections of second order |
//! | [`refine`], [`cost_error`] | estimated errors, the next mesh |
//! | [`solve`] | from a problem to a motion |
//! | [`outcome`], [`independent`] | verification: integrated again, and between the points |
//! | [`solution`] | the motion |
//!
//! The filter is that of [`direct`](crate::direct). Its loop is not: that one is written for distances of
//! splines in q and a border of times, here states, controls and defects are unknowns of their own.

mod begin;
mod cost_error;
mod ends;
mod evaluate;
mod guess;
pub(crate) mod independent;
mod interior;
mod interval;
mod iterate;
mod newton;
#[cfg(test)]
mod newton_tests;
mod outcome;
pub(crate) mod points;
pub(crate) mod problem;
mod recursion;
mod refine;
mod running_cost;
mod search;
pub(crate) mod solution;
mod solve;
