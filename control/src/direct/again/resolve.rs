//! The same problem solved again and again, as a controller needs it.

use super::feedback::Feedback;
use super::goals::Goals;
use super::resolve_error::ResolveError;
use super::resolved::{Budget, ResolveStatus, Resolved, Shown};
use super::start::Again;
use crate::constants::direct as constants;
use crate::direct::interior::iterate::{End, Interior};
use crate::direct::solve::direct::{Dynamics, interior};
use crate::options::{Method, SolverOptions};
use crate::problem::error::ProblemError;
use crate::problem::limits::JointLimits;
use crate::problem::{BoundaryState, Problem, Reference, Shape, TaskError};
use crate::solve::recorder::Interruption;
use crate::task::build::TaskRows;
use crate::task::check_references::check_reference;
use costate::EvalError;
use costate::lagrangian::Lagrangian;
use std::fmt;
use std::time::{Duration, Instant};

/// A problem that is solved again and again on one mesh, with other starts, ends, goals, references and places
/// of obstacles.
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
    interior: Interior<Dynamics>,
    options: SolverOptions,
    limits: Vec<JointLimits>,
    model: Lagrangian<f64>,
    /// (q, v) at start and end.
    states: [Vec<f64>; 2],
    goals: Goals,
    /// Number of obstacles.
    obstacles: usize,
    again: Again,
    feedback: Feedback,
    shown: Shown,
    z: Vec<f64>,
    /// The damping that steps needed last: where it is needed it is in the next solve too.
    damping: f64,
    /// Longest time of a Newton step.
    longest: Duration,
    started: bool,
    /// Whether the equations are factorised near the iterate.
    factorised: bool,
}

impl Resolve {
    /// Prepares a problem, whatever [`method`](SolverOptions::method) the options say: always the direct one.
    /// The limits of the robot are kept unless the problem says otherwise.
    ///
    /// # Errors
    /// [`ProblemError`] as [`Solver::new`](crate::Solver::new), and [`ProblemError::NotAgain`] for limits or
    /// costs of jerks and rates of torques, given accelerations, vias and periodic motions.
    pub fn new(problem: &Problem, options: SolverOptions) -> Result<Self, ProblemError> {
        let from_robot = problem.limits.from_robot.unwrap_or(true);
        let problem = &problem.clone().with_limits(problem.limits.clone().with_from_robot(from_robot));
        let rows = TaskRows::new(problem)?;
        problem.check_for(Method::Direct)?;
        if let Some(key) = problem.first_of_rates().or(problem.first_of_phases()) {
            return Err(ProblemError::NotAgain { key });
        }
        options.check()?;
        let n = problem.robot.dof();
        let state = |state: &BoundaryState| [&state.q[..], &state.v].concat();
        Ok(Self {
            interior: interior(problem, &rows, &options, 0, None),
            limits: problem.joint_limits(),
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

    /// The next solve starts at these positions (rad, m) and rates (rad/s, m/s), n entries each. Those that
    /// the problem leaves free do not count.
    ///
    /// # Errors
    /// [`ResolveError`]: another length, a number that is not finite, or one beyond its limits.
    pub fn set_start(&mut self, q: &[f64], v: &[f64]) -> Result<(), ResolveError> {
        self.set(0, ["q at the start", "v at the start"], q, v)
    }

    /// The next solve ends at these positions and rates, as [`set_start`](Self::set_start).
    ///
    /// # Errors
    /// As [`set_start`](Self::set_start).
    pub fn set_end(&mut self, q: &[f64], v: &[f64]) -> Result<(), ResolveError> {
        self.set(1, ["q at the end", "v at the end"], q, v)
    }

    fn set(
        &mut self,
        end: usize,
        names: [&'static str; 2],
        q: &[f64],
        v: &[f64],
    ) -> Result<(), ResolveError> {
        let n = self.dof();
        let given = &self.interior.ends.given[end];
        for (group, (what, values)) in names.into_iter().zip([q, v]).enumerate() {
            if values.len() != n {
                return Err(ResolveError::WrongLength { what, expected: n, found: values.len() });
            }
            for (joint, (&value, limits)) in values.iter().zip(&self.limits).enumerate() {
                if !given[n * group + joint] {
                    continue;
                }
                if !value.is_finite() {
                    return Err(ResolveError::NotFinite { what, entry: joint });
                }
                let [low, high] = if group == 0 { limits.q } else { [-limits.v, limits.v] };
                if !(low..=high).contains(&value) {
                    return Err(ResolveError::Outside { what, joint, value, low, high });
                }
            }
        }
        self.states[end][..n].copy_from_slice(q);
        self.states[end][n..].copy_from_slice(v);
        Ok(())
    }

    /// The next solve has this position (m) in [`Task::start_tools`](crate::Task::start_tools)`[tool]`.
    /// Coordinates that the problem leaves free stay free.
    ///
    /// # Errors
    /// [`ResolveError::NoTool`], [`ResolveError::NotFinite`].
    pub fn set_start_tool(&mut self, tool: usize, position: [f64; 3]) -> Result<(), ResolveError> {
        let rows = self.goals.rows("start.tool", 0, tool, &position)?;
        self.set_end_rows(0, rows, position);
        Ok(())
    }

    /// The same of [`Task::end_tools`](crate::Task::end_tools).
    ///
    /// # Errors
    /// As [`set_start_tool`](Self::set_start_tool).
    pub fn set_end_tool(&mut self, tool: usize, position: [f64; 3]) -> Result<(), ResolveError> {
        let rows = self.goals.rows("end.tool", 1, tool, &position)?;
        self.set_end_rows(1, rows, position);
        Ok(())
    }

    fn set_end_rows(&mut self, end: usize, rows: [Option<usize>; 3], position: [f64; 3]) {
        for (row, x) in rows.into_iter().zip(position).filter_map(|(row, x)| Some((row?, x))) {
            self.interior.tasks.set_end_value(end, row, x);
            self.interior.barrier.set_end_bound(end, row, x);
        }
    }

    /// The next solve has this position (m) in [`Task::tool_costs`](crate::Task::tool_costs)`[cost]`, as
    /// [`set_start_tool`](Self::set_start_tool).
    ///
    /// # Errors
    /// As [`set_start_tool`](Self::set_start_tool).
    pub fn set_tool_cost(&mut self, cost: usize, position: [f64; 3]) -> Result<(), ResolveError> {
        let rows = self.goals.rows("cost.tool", 2, cost, &position)?;
        for (row, x) in rows.into_iter().zip(position).filter_map(|(row, x)| Some((row?, x))) {
            self.interior.running.set_tool_value(row, x);
        }
        Ok(())
    }

    /// The next solve has this shape in [`Task::obstacles`](crate::Task::obstacles)`[obstacle]`: the same one in
    /// another place, a capsule of any length. It stands still during the motion; what moves is where it is
    /// in the next solve. Whether the start keeps away from it is not checked: limits that cannot be kept
    /// show in [`Resolved::violation`].
    ///
    /// # Errors
    /// [`ResolveError::NoEntry`]; [`ResolveError::Task`]: another shape or size, numbers that are not finite.
    pub fn set_obstacle(&mut self, obstacle: usize, shape: &Shape) -> Result<(), ResolveError> {
        let (table, entry) = ("obstacle", obstacle);
        if obstacle >= self.obstacles {
            return Err(ResolveError::NoEntry { table, entry });
        }
        let moved = self.interior.tasks.move_obstacle(obstacle, shape);
        moved.map_err(|cause| ResolveError::Task { table, entry, cause })
    }

    /// The next solve has this reference in [`Task::references`](crate::Task::references)`[reference]`, of the
    /// same joints, or of the same tool and coordinates; with its weights. Allocates only if it has more knots
    /// than any before it.
    ///
    /// # Errors
    /// [`ResolveError::NoEntry`]; [`ResolveError::Task`]: a reference of something else, or one that
    /// [`Problem::check`] would refuse.
    pub fn set_reference(&mut self, reference: usize, to: &Reference) -> Result<(), ResolveError> {
        let (table, entry, n) = ("cost.reference", reference, self.dof());
        let references = &mut self.interior.running.references;
        if reference >= references.count() {
            return Err(ResolveError::NoEntry { table, entry });
        }
        let task = |cause| ResolveError::Task { table, entry, cause };
        check_reference(to, n).map_err(|(_, cause)| task(cause))?;
        references.set(reference, to).map_err(|_| task(TaskError::OtherReference))
    }

    /// The next solve starts at this time (s) of all references: what they are at `time` they are at the start
    /// of the motion. 0 at first.
    ///
    /// # Errors
    /// [`ResolveError::NotFinite`].
    pub fn set_start_time(&mut self, time: f64) -> Result<(), ResolveError> {
        if !time.is_finite() {
            return Err(ResolveError::NotFinite { what: "the start time", entry: 0 });
        }
        self.interior.running.references.start = time;
        Ok(())
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
            *longest = (*longest).max(now - last);
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
            time: began.elapsed(),
        })
    }

    /// Duration of the motion (s); 0 before the first solve.
    pub fn final_time(&self) -> f64 {
        self.shown.spline.duration()
    }

    /// Writes q, v, a at time t (s), 3n entries; those of the ends beyond them.
    ///
    /// # Errors
    /// [`ResolveError::NotSolved`] before the first solve, [`ResolveError::WrongLength`].
    pub fn state_at(&self, t: f64, z: &mut [f64]) -> Result<(), ResolveError> {
        let (spline, expected) = (&self.shown.spline, 3 * self.dof());
        if spline.dof == 0 {
            return Err(ResolveError::NotSolved);
        }
        if z.len() != expected {
            return Err(ResolveError::WrongLength { what: "the state", expected, found: z.len() });
        }
        let (k, x) = spline.mesh.place(spline.place_of(t));
        spline.in_interval(k, x, z);
        Ok(())
    }

    /// Writes the torques and forces at time t (s), n entries, cut to their limits.
    ///
    /// # Errors
    /// As [`state_at`](Self::state_at); [`EvalError`] where the dynamics cannot be evaluated.
    pub fn torques_at(&mut self, t: f64, torques: &mut [f64]) -> Result<(), ResolveError> {
        let n = self.dof();
        if torques.len() != n {
            let found = torques.len();
            return Err(ResolveError::WrongLength { what: "the torques", expected: n, found });
        }
        let mut z = std::mem::take(&mut self.z);
        let state = self.state_at(t, &mut z);
        let found = state.and_then(|()| {
            let tau = self.model.inverse_dynamics(&z[..n], &z[n..2 * n], &z[2 * n..])?;
            for ((to, tau), limits) in torques.iter_mut().zip(tau).zip(&self.limits) {
                *to = tau.clamp(limits.torque[0], limits.torque[1]);
            }
            Ok(())
        });
        self.z = z;
        found
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
