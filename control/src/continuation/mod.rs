//! Branches of solutions as a parameter of the problem changes: pseudo-arclength continuation.
//!
//! The parameter `lambda` in [0, 1] is one more unknown, and the correction stays in the plane across the
//! tangent:
//!
//! $$ r(x, \lambda) = 0, \qquad c^T (x - x_0) + c_\lambda \thinspace (\lambda - \lambda_0) = 0 $$
//!
//! with `(c, c_lambda)` along the branch and `(x_0, lambda_0)` the prediction. These equations stay regular
//! at a turning point, where the Jacobian of r in x is singular. Source: H. B. Keller, *Numerical solution of
//! bifurcation and nonlinear eigenvalue problems*, in: P. H. Rabinowitz (ed.), Applications of Bifurcation
//! Theory, Academic Press 1977.

mod bordered;
mod family;
mod parameter;
mod points;
mod run;
mod start;
mod steps;
mod walk;

pub use parameter::{Parameter, UnknownParameter};
pub use points::{Branch, BranchEnd, BranchPoint, TurningPoint};

use crate::options::SolverOptions;
use crate::problem::Problem;
use crate::problem::continuation_cause::ContinuationCause;
use crate::problem::error::ProblemError;
use crate::progress::{Cancel, Iteration, Listener};
use crate::result::solution::Solution;
use crate::result::trajectory::Trajectory;
use crate::result::trajectory_error::TrajectoryError;
use crate::solve::Recorder;
use crate::solve::recorder::Stop;
use family::Family;
use run::{PointListener, Run, Walked};
use std::fmt;
use std::ops::ControlFlow;

/// Follows the solutions of a [`Problem`] while one of its parameters changes.
///
/// The step along the branch is doubled where the branch is straight, and halved where it bends or Newton's
/// method fails. A change of sign of d parameter / d length is a [`TurningPoint`]; it is located before the
/// next step.
///
/// ```
/// use costate_control::{BranchEnd, Continuation, SolverOptions, Parameter, Problem};
/// use costate::robot::Robot;
/// # std::env::set_current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))?;
/// let robot = Robot::from_file("robots/pendulum.toml")?;
/// let problem = Problem::rest_to_rest(robot, &[0.0], &[std::f64::consts::PI], 1.0);
/// let options = SolverOptions::default().with_tolerance(1e-9);
/// let branch = Continuation::new(&problem, Parameter::Gravity, 0.0, 1.0, options)?.follow();
/// assert_eq!(branch.end, BranchEnd::Reached);
/// let (first, last) = (&branch.points[0], &branch.solution);
/// assert!((first.cost - 6.0 * std::f64::consts::PI.powi(2)).abs() < 1e-7);
/// assert!((last.motion.cost - 74.0616592202).abs() < 1e-7);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use = "a continuation does nothing until `follow` is called"]
pub struct Continuation<'a> {
    family: Family<'a>,
    options: SolverOptions,
    start: Option<Trajectory>,
    listener: Option<Listener<'a>>,
    point_listener: Option<PointListener<'a>>,
    cancel: Option<Cancel>,
}

impl<'a> Continuation<'a> {
    /// From one value of a parameter to another.
    ///
    /// # Errors
    /// [`ProblemError`]: of the problem at either end, of the options, or of a parameter that the problem
    /// does not have.
    pub fn new(
        problem: &'a Problem,
        parameter: Parameter,
        from: f64,
        to: f64,
        options: SolverOptions,
    ) -> Result<Self, ProblemError> {
        options.check()?;
        for value in [from, to] {
            parameter.apply(problem, value)?;
        }
        if from == to {
            let cause = ContinuationCause::SameValue;
            return Err(ProblemError::Continuation { parameter: parameter.name(), value: to, cause });
        }
        let family = Family { problem, parameter, from, to, jacobian: options.jacobian };
        Ok(Self { family, options, start: None, listener: None, point_listener: None, cancel: None })
    }

    /// Begins with a saved motion of the problem at the first value, and tries no other guess.
    ///
    /// # Errors
    /// [`TrajectoryError`] if the lists of the motion do not fit the robot.
    pub fn with_start(mut self, start: &Trajectory) -> Result<Self, TrajectoryError> {
        start.check(&self.family.problem.robot)?;
        self.start = Some(start.clone());
        Ok(self)
    }

    /// Calls `listener` after each Newton step. If it returns [`ControlFlow::Break`], the continuation stops
    /// with [`BranchEnd::Interrupted`] at the last point.
    pub fn on_iteration(mut self, listener: impl FnMut(&Iteration) -> ControlFlow<()> + Send + 'a) -> Self {
        self.listener = Some(Box::new(listener));
        self
    }

    /// Calls `listener` after each point. If it returns [`ControlFlow::Break`], the continuation stops there
    /// with [`BranchEnd::Interrupted`].
    pub fn on_point(mut self, listener: impl FnMut(&BranchPoint) -> ControlFlow<()> + Send + 'a) -> Self {
        self.point_listener = Some(Box::new(listener));
        self
    }

    /// Stops when `cancel` says so, with [`BranchEnd::Interrupted`] at the last point.
    pub fn with_cancel(mut self, cancel: Cancel) -> Self {
        self.cancel = Some(cancel);
        self
    }

    /// Solves at the first value and follows the branch to the last one. Never fails: [`Branch::end`] says
    /// how it ended.
    pub fn follow(self) -> Branch {
        let Self { family, options, start, listener, point_listener, cancel } = self;
        let (parameter, problem) = (family.parameter, family.problem);
        let mut walked = Walked {
            points: Vec::new(),
            turning_points: Vec::new(),
            end: BranchEnd::NotStarted,
            first: None,
        };
        let recorder = Recorder::new(listener, Stop::new(cancel, options.time_limit));
        let run = Run { family, options: &options, start: start.as_ref(), point_listener };
        let last = run.walk(&mut walked, recorder);
        let Walked { points, turning_points, end, first } = walked;
        let solution = last.unwrap_or_else(|status| {
            let without = || Solution::without_motion(problem, status.clone());
            let mut solution = first.unwrap_or_else(without);
            solution.motion.status = status;
            solution
        });
        Branch { parameter, points, turning_points, end, solution }
    }
}

impl fmt::Debug for Continuation<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Family { problem, parameter, from, to, .. } = self.family;
        f.debug_struct("Continuation")
            .field("robot", &problem.robot.name())
            .field("parameter", &parameter)
            .field("from", &from)
            .field("to", &to)
            .field("options", &self.options)
            .field("start", &self.start.as_ref().map(|start| start.t.len()))
            .finish_non_exhaustive()
    }
}
