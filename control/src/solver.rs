//! From a problem to the best motion found.

use crate::extremal::hamiltonian::RobotExtremal;
use crate::extremal::lagrangian::LagrangianExtremal;
use crate::extremal::legendre::OfRobot;
use crate::options::{Coordinates, SolverOptions};
use crate::path::cubics::Disturbance;
use crate::problem::Problem;
use crate::problem::check::CheckedProblem;
use crate::problem::error::ProblemError;
use crate::progress::{Cancel, Iteration, Listener, Phase};
use crate::result::motion::{ExtremalSolution, Motion};
use crate::result::solution::{RobotNames, Solution, StartResult};
use crate::result::trajectory::Trajectory;
use crate::result::trajectory_error::TrajectoryError;
use crate::search::Search;
use crate::search::guess::{RobotGuess, SavedMotion};
use crate::search::mapped::Mapped;
use crate::solve::Recorder;
use crate::solve::recorder::Stop;
use crate::status::Status;
use costate::EvalError;
use std::fmt;
use std::ops::ControlFlow;

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
/// let solution = Solver::new(&problem, SolverOptions::default())?.solve();
/// assert!(solution.motion.status.is_converged());
/// assert!((solution.motion.cost - 74.0616592202).abs() < 1e-8);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use = "a solver does nothing until `solve` is called"]
pub struct Solver<'a> {
    problem: CheckedProblem<'a>,
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
        let problem = problem.check()?;
        options.check()?;
        Ok(Self { problem, options, start: None, listener: None, cancel: None })
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
    /// [`ControlFlow::Break`], the search stops with [`Status::Cancelled`] and keeps the best iterate.
    pub fn on_iteration(mut self, listener: impl FnMut(&Iteration) -> ControlFlow<()> + Send + 'a) -> Self {
        self.listener = Some(Box::new(listener));
        self
    }

    /// Stops the search when `cancel` says so, with [`Status::Cancelled`] and the best iterate.
    pub fn with_cancel(mut self, cancel: Cancel) -> Self {
        self.cancel = Some(cancel);
        self
    }

    /// Solves. Never fails: [`Motion::status`] says how it ended, and the best iterate is kept.
    pub fn solve(self) -> Solution {
        let Self { problem, options, start, listener, cancel } = self;
        let mut recorder = Recorder::new(listener, Stop::new(cancel, options.time_limit));
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

/// A motion as the start of a search.
pub(crate) fn saved(trajectory: &Trajectory) -> SavedMotion<'_> {
    let Trajectory { t, q, p, y_q, y_p, .. } = trajectory;
    SavedMotion { t, parts: [q, p, y_q, y_p] }
}

/// A problem that is solved from one or several guesses.
pub(crate) struct Starts<'a> {
    pub problem: CheckedProblem<'a>,
    pub options: &'a SolverOptions,
    /// Where the first start begins.
    pub saved: Option<SavedMotion<'a>>,
}

impl Starts<'_> {
    /// The best solution of all starts: the cheapest converged one if there is any.
    pub fn solve(&self, recorder: &mut Recorder<'_>) -> Solution {
        let mut best: Option<Solution> = None;
        let (mut starts, mut steps) = (Vec::new(), 0);
        for number in 0..self.options.starts {
            let solution = self
                .start(number, recorder)
                .unwrap_or_else(|error| self.missing(Status::EvaluationFailed(error.into())));
            steps += solution.newton_iterations;
            let (total, status) = (solution.motion.total(), solution.motion.status.clone());
            starts.push(StartResult { total, status });
            let better = best.as_ref().is_none_or(|best| {
                let rank = |motion: &Motion| (!motion.status.is_solved(), motion.total());
                rank(&solution.motion) < rank(&best.motion)
            });
            if better {
                best = Some(solution);
            }
            if recorder.interruption().is_some() {
                break;
            }
        }
        let mut best = best.unwrap_or_else(|| self.missing(Status::NewtonFailed));
        best.newton_iterations = steps;
        best.starts = starts;
        best.options = self.options.clone();
        best
    }

    fn missing(&self, status: Status) -> Solution {
        Solution::missing(&self.problem.robot, status, self.problem.time.value())
    }

    fn start(&self, number: usize, recorder: &mut Recorder<'_>) -> Result<Solution, EvalError> {
        let mut momenta = RobotExtremal::new(self.problem, self.options.jacobian)?;
        let found = match self.options.coordinates {
            Coordinates::Hamiltonian => self.search(number, &mut momenta.clone(), &momenta, recorder),
            Coordinates::Lagrangian => {
                let mut extremal = LagrangianExtremal::new(self.problem, self.options.jacobian)?;
                self.search(number, &mut extremal, &momenta, recorder)
            }
        };
        Ok(solution(self.problem.problem(), self.options, found, &mut momenta))
    }

    /// In the coordinates of `extremal`; the motion is in (q, p, y_q, y_p).
    fn search<E: OfRobot>(
        &self,
        number: usize,
        extremal: &mut E,
        momenta: &RobotExtremal,
        recorder: &mut Recorder<'_>,
    ) -> ExtremalSolution {
        let guess = RobotGuess {
            problem: self.problem.problem(),
            disturbance: Disturbance::draw(&self.problem, self.options.seed, number),
            saved: self.saved.filter(|_| number == 0),
            momenta: momenta.clone(),
            path: None,
        };
        let mut guess = Mapped::<E>::new(guess, &self.problem.robot);
        let search = Search { extremal, time: self.problem.time, guess: &mut guess, recorder };
        let found = search.run(self.options);
        let iterations = std::mem::take(&mut recorder.iterations);
        let mut solution = found.into_solution(extremal, iterations, self.options.tolerance);
        solution.map(|z| E::give(&mut guess.map, z));
        solution
    }
}

/// The solution of a problem from that of its extremal: adds the velocities at the nodes and the largest error at the
/// end.
pub(crate) fn solution(
    problem: &Problem,
    options: &SolverOptions,
    found: ExtremalSolution,
    extremal: &mut RobotExtremal,
) -> Solution {
    let ExtremalSolution { motion, nodes, .. } = found;
    let n = problem.robot.len();
    let mut velocities = |x: &[f64]| extremal.velocity(x).map_or_else(|_| vec![f64::NAN; n], <[f64]>::to_vec);
    let v = nodes.z.iter().map(|z| velocities(&z[..2 * n])).collect();
    let end = &problem.end;
    let end_defect = motion.end_state.as_ref().map_or(f64::INFINITY, |x| {
        let v = velocities(x);
        let miss = |j: usize| {
            let q = if end.q_free.contains(&j) { 0.0 } else { (x[j] - end.q[j]).abs() };
            let v = if end.v_free.contains(&j) { 0.0 } else { (v[j] - end.v[j]).abs() };
            q.max(v)
        };
        (0..n).map(miss).fold(0.0, f64::max)
    });
    // A motion that breaks the bounds is no result.
    let trajectory = match motion.status {
        Status::BoundsNotReached(_) => Trajectory::default(),
        _ => Trajectory::from_nodes(nodes, v),
    };
    Solution {
        newton_iterations: motion.iterations.iter().filter(|step| step.phase != Phase::Path).count(),
        end_defect,
        trajectory,
        starts: Vec::new(),
        options: options.clone(),
        robot: RobotNames::of(&problem.robot),
        motion,
    }
}
