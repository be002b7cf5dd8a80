//! From a problem to the best motion found.

use crate::direct::Direct;
use crate::options::{Method, SolverOptions};
use crate::polish::polish;
use crate::problem::Problem;
use crate::problem::check::CheckedProblem;
use crate::problem::error::ProblemError;
use crate::progress::{Cancel, Iteration, Listener};
use crate::result::solution::Solution;
use crate::result::trajectory::Trajectory;
use crate::result::trajectory_error::TrajectoryError;
use crate::solve::Recorder;
use crate::solve::recorder::Stop;
use crate::starts::{Starts, saved};
use crate::task::build::TaskRows;
use std::fmt;
use std::ops::ControlFlow;
use std::time::Instant;

/// Solves a [`Problem`] from one or several guesses and keeps the cheapest motion found.
///
/// The first guess is a saved motion if there is one, else cubics in the joint coordinates that meet both
/// ends, p = M v, and zero costates. Further starts add seeded waves to the cubics. If a guess fails, or
/// leads to a motion that costs more than a path of low cost near the cubics, the search continues from that
/// path; if that fails too, from relaxed problems ([`Strategy`](crate::Strategy)).
///
/// ```
/// use costate_control::{SolverOptions, Problem, Solver};
/// use costate::robot::Robot;
/// # std::env::set_current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))?;
/// let robot = Robot::from_file("robots/pendulum.toml")?;
/// let problem = Problem::rest_to_rest(robot, &[0.0], &[std::f64::consts::PI], 1.0);
/// let options = SolverOptions::default().with_tolerance(1e-9);
/// let solution = Solver::new(&problem, options)?.solve();
/// assert!(solution.motion.status.is_converged());
/// assert!((solution.motion.cost - 74.0616592202).abs() < 1e-8);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use = "a solver does nothing until `solve` is called"]
pub struct Solver<'a> {
    problem: CheckedProblem<'a>,
    /// The functions of its task, for the direct method.
    rows: Option<TaskRows>,
    options: SolverOptions,
    start: Option<Trajectory>,
    listener: Option<Listener<'a>>,
    cancel: Option<Cancel>,
}

impl<'a> Solver<'a> {
    /// Checks problem and options.
    ///
    /// # Errors
    /// [`ProblemError`]: the first key of the problem or option that is out of range.
    pub fn new(problem: &'a Problem, options: SolverOptions) -> Result<Self, ProblemError> {
        let rows = match options.method {
            Method::Direct => Some(TaskRows::new(problem)?),
            _ => None,
        };
        let problem = problem.check_for(options.method)?;
        options.check()?;
        Ok(Self { problem, rows, options, start: None, listener: None, cancel: None })
    }

    /// Begins the first start with a saved motion, stretched to the final time of the problem.
    ///
    /// # Errors
    /// [`TrajectoryError`] if the lists of the motion do not fit the robot.
    pub fn with_start(mut self, start: &Trajectory) -> Result<Self, TrajectoryError> {
        start.check(&self.problem.robot)?;
        self.start = Some(start.clone());
        Ok(self)
    }

    /// Calls `listener` after each Newton step and each descent step of a path. If it returns
    /// [`ControlFlow::Break`], the search stops with [`Status::Cancelled`](crate::Status::Cancelled) and
    /// keeps the best iterate.
    pub fn on_iteration(mut self, listener: impl FnMut(&Iteration) -> ControlFlow<()> + Send + 'a) -> Self {
        self.listener = Some(Box::new(listener));
        self
    }

    /// Stops the search when `cancel` says so, with [`Status::Cancelled`](crate::Status::Cancelled) and the
    /// best iterate.
    pub fn with_cancel(mut self, cancel: Cancel) -> Self {
        self.cancel = Some(cancel);
        self
    }

    /// Solves. Never fails: [`Motion::status`](crate::Motion::status) says how it ended, and the best iterate
    /// is kept.
    pub fn solve(self) -> Solution {
        let Self { problem, rows, options, start, listener, cancel } = self;
        let mut recorder = Recorder::new(listener, Stop::new(cancel, options.time_limit));
        if let Some(rows) = rows {
            let began = Instant::now();
            let direct = Direct { problem, rows: &rows, options: &options, saved: start.as_ref() };
            let found = direct.solve(&mut recorder);
            return polish(&problem, &options, found, began.elapsed(), &mut recorder);
        }
        let starts = Starts { problem, options: &options, saved: start.as_ref().map(saved) };
        starts.solve(&mut recorder)
    }
}

impl fmt::Debug for Solver<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Solver")
            .field("robot", &self.problem.robot.name())
            .field("options", &self.options)
            .field("start", &self.start.as_ref().map(|start| start.t.len()))
            .field("listener", &self.listener.is_some())
            .field("cancel", &self.cancel)
            .finish_non_exhaustive()
    }
}
