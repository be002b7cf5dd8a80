//! The same problem solved again and again, as a controller needs it.

use super::feedback::Feedback;
use super::goals::Goals;
use super::resolved::{Budget, ResolveStatus, Resolved, Shown};
use super::start::Again;
use crate::constants::direct as constants;
use crate::direct::interior::iterate::{End, Interior};
use crate::direct::solve::prepare::{Dynamics, interior, interior_on};
use crate::options::{Method, SolverOptions};
use crate::problem::error::ProblemError;
use crate::problem::limits::JointLimits;
use crate::problem::{BoundaryState, Problem};
use crate::result::trajectory::Trajectory;
use crate::solve::recorder::Interruption;
use crate::task::build::TaskRows;
use costate::EvalError;
use costate::lagrangian::Lagrangian;
use costate::robot::Robot;
use std::fmt;
use std::time::{Duration, Instant};

/// A problem that is solved again and again on one mesh, with other starts, ends, goals, references and
/// places of obstacles.
///
/// The mesh has `(nodes - 1) / 3` equal intervals of the [options](SolverOptions::nodes), whose tolerance is
/// that of each solve. The first solve begins at the guess of [`Solver`](crate::Solver). Every later one
/// begins at the motion that is optimal for the new ends to first order ([`Feedback`]), with the multipliers
/// it has there and the barrier where the last solve ended. After the first solve, and the first
/// [`feedback`](Self::feedback), nothing is allocated.
///
/// ```
/// use costate::robot::Robot;
/// use costate_control::{Budget, MachineCode, Problem, Resolve, ResolveStatus, SolverOptions};
/// use std::time::Duration;
/// # std::env::set_current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))?;
/// let robot = Robot::from_file("robots/ur5.urdf")?;
/// let (from, to) = ([0.0, -1.6, 1.8, -1.8, -1.57, 0.0], [0.5, -1.4, 1.6, -1.6, -1.5, 0.2]);
/// let problem = Problem::rest_to_rest(robot, &from, &to, 1.0);
/// let options = SolverOptions::default().with_tolerance(1e-4).with_machine_code(MachineCode::AtOnce);
/// let mut motion = Resolve::new(&problem, options)?;
/// motion.solve()?;
/// motion.set_start(&[0.01, -1.6, 1.8, -1.79, -1.57, 0.0], &[0.0, 0.1, 0.0, 0.0, 0.0, 0.0])?;
/// let found = motion.solve_again(Budget::steps(12).within(Duration::from_secs(1)))?;
/// assert!(found.status == ResolveStatus::Solved && found.keeps_limits());
/// let mut torques = [0.0; 6];
/// motion.torques_at(0.002, &mut torques)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Resolve {
    pub(super) interior: Interior<Dynamics>,
    options: SolverOptions,
    pub(super) limits: Vec<JointLimits>,
    /// With what it carries.
    pub(super) robot: Robot,
    pub(super) model: Lagrangian<f64>,
    /// (q, v) at start and end.
    pub(super) states: [Vec<f64>; 2],
    pub(super) goals: Goals,
    /// Number of obstacles.
    pub(super) obstacles: usize,
    again: Again,
    feedback: Feedback,
    pub(super) shown: Shown,
    pub(super) z: Vec<f64>,
    /// The damping that steps needed last: where it is needed it is in the next solve too.
    damping: f64,
    /// Longest time of a Newton step.
    longest: Duration,
    pub(super) started: bool,
    /// Whether the equations are factorised near the iterate.
    pub(super) factorised: bool,
}

impl Resolve {
    /// Prepares a problem, whatever [`method`](SolverOptions::method) the options say: always the direct one.
    /// The limits of the robot are kept unless the problem says otherwise.
    ///
    /// # Errors
    /// [`ProblemError`] as [`Solver::new`](crate::Solver::new), and [`ProblemError::NotAgain`] for limits or
    /// costs of jerks and rates of torques, given accelerations, vias and periodic motions.
    pub fn new(problem: &Problem, options: SolverOptions) -> Result<Self, ProblemError> {
        Self::begin(problem, options, problem.limits.from_robot.unwrap_or(true), None)
    }

    /// The same near a motion that was solved, on its mesh: at its nodes, whatever
    /// [`nodes`](SolverOptions::nodes) the options say. The first solve begins at this motion, with the
    /// limits that [`Solver`](crate::Solver) keeps.
    ///
    /// # Errors
    /// As [`new`](Self::new); a motion that begins and ends at one time, or of another robot, counts as none.
    pub fn near(
        problem: &Problem,
        options: SolverOptions,
        motion: &Trajectory,
    ) -> Result<Self, ProblemError> {
        let n = problem.robot.dof();
        let fits = motion.q.iter().all(|q| q.len() == n) && motion.q.len() > 2;
        let near = motion.mesh_nodes().filter(|_| fits).map(|nodes| (motion, nodes));
        Self::begin(problem, options, problem.keeps_robot_limits(), near)
    }

    fn begin(
        problem: &Problem,
        options: SolverOptions,
        from_robot: bool,
        near: Option<(&Trajectory, Vec<f64>)>,
    ) -> Result<Self, ProblemError> {
        let problem = &problem.clone().with_limits(problem.limits.clone().with_from_robot(from_robot));
        let rows = TaskRows::new(problem)?;
        problem.check_for(Method::Direct)?;
        Self::takes(problem)?;
        options.check()?;
        let n = problem.robot.dof();
        let state = |state: &BoundaryState| [&state.q[..], &state.v].concat();
        Ok(Self {
            interior: match near {
                Some((motion, nodes)) => interior_on(problem, &rows, &options, 0, Some(motion), &nodes),
                None => interior(problem, &rows, &options, 0, None),
            },
            limits: problem.joint_limits(),
            robot: problem.robot.clone(),
            model: Lagrangian::new(&problem.robot),
            states: [state(&problem.start), state(&problem.end)],
            goals: Goals::of(&problem.task),
            obstacles: problem.task.obstacles.len(),
            again: Again::new(n),
            feedback: Feedback::default(),
            shown: Shown::default(),
            z: vec![0.0; 3 * n],
            damping: 0.0,
            longest: Duration::ZERO,
            started: false,
            factorised: false,
            options,
        })
    }

    /// Number of joints, n.
    pub fn dof(&self) -> usize {
        self.limits.len()
    }

    /// Begins the warm start later by `dt` (s), the time since the last solve: the part of the motion that is
    /// over is left out. With a fixed final time the motion goes on beyond its end at the rates there; with a
    /// free one its rest remains. Less than half an interval makes no difference: the new start and end
    /// take the motion along.
    pub fn advance(&mut self, dt: f64) {
        if self.started && dt > 0.0 && dt.is_finite() {
            self.interior.shift(dt, &mut self.again);
        }
    }

    /// Solves with the limits on steps and time of the options: the first solve.
    ///
    /// # Errors
    /// [`EvalError`] where the motion cannot be evaluated.
    pub fn solve(&mut self) -> Result<Resolved, EvalError> {
        let budget = Budget { iterations: self.options.max_iterations, time: self.options.time_limit };
        self.solve_again(budget)
    }

    /// Solves the problem with what was set since the last time.
    ///
    /// # Errors
    /// [`EvalError`] where the motion cannot be evaluated; the next solve begins anew then, at the motion
    /// that was shown last.
    pub fn solve_again(&mut self, budget: Budget) -> Result<Resolved, EvalError> {
        let began = Instant::now();
        let found = self.try_again(budget, began);
        if found.is_err() {
            (self.started, self.factorised) = (false, false);
            // What cannot be evaluated is no guess.
            if self.shown.spline.dof > 0 {
                self.interior.spline.copy_from(&self.shown.spline);
            }
        }
        found
    }

    fn try_again(&mut self, budget: Budget, began: Instant) -> Result<Resolved, EvalError> {
        let states = self.states.each_ref().map(|state| &state[..]);
        if self.started {
            self.interior.follow(states, self.factorised, &mut self.again)?;
        } else {
            self.interior.put_ends(states);
            self.interior.start(None)?;
            self.interior.reserve(&mut self.again);
        }
        self.shown.take(&self.interior);
        let first = self.interior.figures.iterations;
        let deadline = budget.time.and_then(|time| began.checked_add(time));
        self.interior.damping = self.damping;
        self.damping *= constants::DAMPING_DOWN;
        let (shown, longest, damping) = (&mut self.shown, &mut self.longest, &mut self.damping);
        let mut last = Instant::now();
        let watch = |iterate: &mut Interior<Dynamics>, _: f64| {
            shown.offer(iterate);
            *damping = iterate.damping;
            let now = Instant::now();
            // One step that the system held up does not count for ever.
            *longest = longest.mul_f64(constants::FADES).max(now - last);
            last = now;
            deadline.filter(|&deadline| now + *longest > deadline).map(|_| Interruption::TimeLimit)
        };
        let end = self.interior.iterate(self.options.tolerance, budget.iterations.max(1), watch)?;
        self.started = true;
        self.factorised = end != End::NoProgress;
        let status = match end {
            End::Solved => ResolveStatus::Solved,
            End::IterationLimit => ResolveStatus::Iterations,
            End::NoProgress => ResolveStatus::NoProgress,
            End::Interrupted(_) => ResolveStatus::OutOfTime,
        };
        if status == ResolveStatus::Solved {
            // The last step is known, and the next solve begins after it. It is shown if limits are kept
            // there.
            let _ = self.interior.search();
            if self.interior.figures.violation <= constants::VIOLATION_ACCEPTED {
                self.shown.take(&self.interior);
            } else {
                self.shown.offer(&self.interior);
            }
        }
        Ok(Resolved {
            status,
            iterations: self.interior.figures.iterations - first,
            cost: self.shown.cost,
            gap: self.shown.gap,
            violation: self.shown.violation,
            clearance_violation: self.shown.sweep(&mut self.interior.model.tasks)?,
            time: began.elapsed(),
        })
    }

    /// The derivatives of the motion by its ends. The equations of its last Newton step are factorised anew
    /// at the motion: one evaluation at the points.
    ///
    /// `None` where the matrix is not positive definite: before a solution is near, or at one that is no
    /// strict minimum.
    ///
    /// # Errors
    /// [`EvalError`] where the motion cannot be evaluated.
    pub fn feedback(&mut self) -> Result<Option<&Feedback>, EvalError> {
        if !self.started {
            return Ok(None);
        }
        self.factorised = self.interior.linearise()?;
        if !self.factorised {
            return Ok(None);
        }
        self.interior.fill_feedback(&mut self.feedback);
        Ok(Some(&self.feedback))
    }
}

impl fmt::Debug for Resolve {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Resolve")
            .field("options", &self.options)
            .field("states", &self.states)
            .field("started", &self.started)
            .finish_non_exhaustive()
    }
}
