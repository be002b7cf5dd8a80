//! Optimal motions of robots, by a direct method and by Pontryagin's maximum principle.
//!
//! A [`Problem`] is to move a robot from its start to its end at the least cost $J = \int l(x, u) \\, dt$.
//! Along an optimal motion there is a costate y with
//!
//! $$ H^\ast(x, y) = \max_u \left[ y^\top f(x, u) - l(x, u) \right], \qquad
//!    x' = \frac{\partial H^\ast}{\partial y}, \qquad y' = -\frac{\partial H^\ast}{\partial x} $$
//!
//! This is a boundary-value problem for z = (q, p, y_q, y_p), whose Jacobian contains the contracted Hessian
//! $y^\top F_{xx}$ ([`RobotExtremal`]). [`Solver`] finds motions by the [direct method](direct_method),
//! which keeps all kinds of [limits](MotionLimits), and solves the boundary-value problem from there by
//! Lobatto collocation, or by multiple [shooting](Method::Shooting) with the variational equations. Sign
//! conventions:
//! $dJ/dT = -H^\ast$, $y(0) = -dJ/dx(0)$, $u = \mathrm{clip}(R^{-1} B y_p)$.
//!
//! | for | use |
//! |---|---|
//! | a robot | [`Problem`], [`Solver`] |
//! | a problem file | [`ProblemFile`] (feature `toml`) |
//! | any model, with limits of states and controls | [`DynamicsProblem`], [`DirectDynamics`] |
//! | extremals of a model that is affine in its controls: a drone, a car | [`DynamicsProblem`], [`solve_dynamics`] |
//! | a boundary-value problem of your own | [`BoundaryValueProblem`], [`solve_extremal`] |
//! | generated or compiled equations | [`pontryagin_program`], [`GeneratedExtremal`] |
//! | solutions while a parameter changes | [`Continuation`] |

mod bvp;
mod closed_loops;
mod constants;
mod continuation;
mod cubics;
mod direct;
pub mod direct_method;
mod direct_states;
mod extremal;
mod free_motions;
mod gains;
mod numerics;
mod options;
mod parallel;
mod polish;
mod problem;
mod progress;
mod result;
mod search;
mod sensitivity;
mod solve;
mod solve_extremal;
mod solver;
mod starts;
mod status;
mod task;
mod verdict;
mod verify;

pub use continuation::{
    Branch, BranchEnd, BranchPoint, Continuation, Parameter, TurningPoint, UnknownParameter,
};
pub use direct::{
    Budget, Feedback, MotionDerivative, MotionParameter, MotionProgram, ProgramRow, ProgramSample, Resolve,
    ResolveError, ResolveStatus, Resolved, SensitivityError,
};
pub use direct_states::independent::StateVerification;
pub use direct_states::problem::{DirectDynamics, DirectDynamicsError};
pub use direct_states::solution::{StateMotion, StateStep};
pub use extremal::dynamics::DynamicsExtremal;
pub use extremal::dynamics::problem::{DynamicsProblem, DynamicsProblemError, EndState};
pub use extremal::generated::{GeneratedEquations, GeneratedExtremal};
pub use extremal::hamiltonian::RobotExtremal;
pub use extremal::lagrangian::LagrangianExtremal;
pub use extremal::program::{ProgramOf, pontryagin_program};
pub use extremal::wrapped::{Hooks, Wrapped};
pub use extremal::{
    BoundSide, BoundaryValueProblem, BoundedControls, ControlLaw, ControlRange, Extremal, HamiltonianTerms,
    Homotopy, Relaxation, SideChange,
};
pub use gains::{GainError, Gains, LimitDerivative, LimitDerivatives};
pub use numerics::almost_block_diagonal::{AlmostBlockDiagonal, SingularMatrix};
pub use options::{Coordinates, JacobianRoute, MachineCode, Method, Polish, SolverOptions, Strategy, Verify};
pub use problem::check::CheckedProblem;
pub use problem::continuation_cause::ContinuationCause;
pub use problem::error::ProblemError;
#[cfg(feature = "toml")]
pub use problem::file::{ProblemFile, ProblemFileCause, ProblemFileError};
pub use problem::key::Key;
pub use problem::limits::JointLimits;
pub use problem::running_cost::{RunningCost, UserTerm};
pub use problem::source_error::SourceError;
pub use problem::warning::ProblemWarning;
pub use problem::{
    BodyPairs, BoundaryState, Bounds, Collision, EndError, FinalTime, FreeMotionError, Gait, GaitError,
    JointReference, Keep, Kept, Leads, LinkCapsule, LoopError, MotionLimits, Objective, Obstacle, Payload,
    Penalty, Problem, Reference, Shape, SoleContact, Task, TaskError, Tool, ToolCost, ToolOrientation,
    ToolPose, ToolReference, TorqueSpeedError, UnfitRates, UrdfBodyError, Via, ViaError,
};
pub use progress::{Cancel, Iteration, Phase};
pub use result::constraint_forces::ConstraintForces;
pub use result::fast_joint::FastJoint;
pub use result::free_entries::FreeEntries;
pub use result::gait::GaitReport;
pub use result::infeasibility::{Infeasibility, RelaxedLimit};
pub use result::limit_use::{ActiveLimit, LimitReport, LimitUse, LimitViolation};
pub use result::motion::{Certificate, ExtremalSolution, Motion};
pub use result::nodes::Nodes;
pub use result::polish_report::{PolishOutcome, PolishReport};
pub use result::rates::MotionRates;
pub use result::samples::{SampleError, Samples};
pub use result::saved_start::SavedStart;
pub use result::solution::{CostateStart, RobotNames, Solution};
pub use result::stage_times::StageTimes;
pub use result::start::{GuessKind, StartResult};
pub use result::trajectory::{Trajectory, TrajectoryPoint};
pub use result::trajectory_error::TrajectoryError;
pub use result::verification::{Check, CheckOutcome, Verification};
pub use sensitivity::{CostDerivative, cost_by_parameters};
pub use solve_extremal::{solve_dynamics, solve_extremal};
pub use solver::Solver;
pub use status::{BoundViolation, EvaluationFailure, Status, UnknownStatus};
pub use verdict::{Remark, RemarkKey, Severity, UnfitMotion};

/// Numbers as remarks show them, for other texts about the same motion.
#[doc(hidden)]
pub mod numbers {
    pub use crate::verdict::numbers::{scientific, short};
}

#[cfg(test)]
#[global_allocator]
static ALLOCATOR: costate_test_support::allocations::Counting = costate_test_support::allocations::Counting;
