//! Solutions as a parameter of the problem changes.

mod bordered;
mod parameter;
mod points;
mod start;
mod walk;

pub use parameter::Parameter;
pub use points::{Branch, BranchEnd, BranchPoint, TurningPoint};

use crate::options::{Method, SolverOptions};
use crate::problem::Problem;
use crate::problem::error::ProblemError;
use crate::result::solution::Solution;
use crate::result::trajectory::Trajectory;
use crate::result::trajectory_error::TrajectoryError;
use crate::solve::{Context, Extremum};
use crate::solver::Solver;
use crate::status::Status;
use walk::{Aim, Found, Walker};

/// Follows the solutions of a [`Problem`] while one of its parameters changes.
///
/// The branch is walked along its own length, predicted by its tangent: with one more unknown, the parameter, and one more
/// condition, that Newton's corrections stay in the plane across the tangent, the equations stay regular where the branch turns
/// back. Steps are doubled where the branch is straight and halved where it bends or Newton's method fails. A change of sign of d parameter/d length
/// is a [`TurningPoint`], which is located before the walk goes on behind it.
///
/// ```
/// use costate_control::{BranchEnd, Continuation, SolverOptions, Parameter, Problem};
/// use costate::robot::Robot;
/// # std::env::set_current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))?;
/// let robot = Robot::from_file("robots/pendulum.toml")?;
/// let problem = Problem::rest_to_rest(robot, &[0.0], &[std::f64::consts::PI], 1.0);
/// let branch = Continuation::new(&problem, Parameter::Gravity, 0.0, 1.0, SolverOptions::default())?.follow();
/// assert_eq!(branch.end, BranchEnd::Reached);
/// let (first, last) = (&branch.points[0], &branch.solution);
/// assert!((first.cost - 6.0 * std::f64::consts::PI.powi(2)).abs() < 1e-7);
/// assert!((last.cost - 74.0616592202).abs() < 1e-7);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Continuation<'a> {
    problem: &'a Problem,
    parameter: Parameter,
    ends: (f64, f64),
    options: SolverOptions,
    start: Option<Trajectory>,
}

/// First step, and the largest.
const STEP: (f64, f64) = (0.05, 0.4);
/// How far a point may be from where it was expected, in parts of the step: what is farther may be on another branch.
const MOST_BEND: f64 = 0.15;
/// Smallest step.
const LEAST_STEP: f64 = 1e-6;
/// Most points.
const MOST_POINTS: usize = 500;

impl<'a> Continuation<'a> {
    /// From one value of a parameter to another.
    ///
    /// # Errors
    /// [`ProblemError`]: of the problem at either end, of the options, or of a parameter that the problem does not have.
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
            let reason = "the way must end elsewhere than where it begins".into();
            return Err(ProblemError::Continuation { parameter: parameter.name(), value: to, reason });
        }
        Ok(Self { problem, parameter, ends: (from, to), options, start: None })
    }

    /// Begins with a solution of the problem at `from`, which is solved from there and nowhere else.
    ///
    /// # Errors
    /// [`TrajectoryError`] where its lists do not fit the robot.
    pub fn with_start(mut self, start: &Trajectory) -> Result<Self, TrajectoryError> {
        start.check(&self.problem.robot)?;
        self.start = Some(start.clone());
        Ok(self)
    }

    /// Solves at `from` and walks to `to`. Never fails: [`Branch::end`] says how it went.
    pub fn follow(self) -> Branch {
        let mut branch = Branch {
            parameter: self.parameter,
            points: Vec::new(),
            turning_points: Vec::new(),
            end: BranchEnd::NotStarted,
            solution: Solution::missing(&self.problem.robot, Status::NewtonFailed, self.problem.time.value()),
        };
        let found = self.walk(&mut branch);
        if let Err(status) = found {
            branch.solution.motion.status = status;
        }
        branch
    }

    fn walk(&self, branch: &mut Branch) -> Result<(), Status> {
        let problem = self.problem;
        let refused = |error: ProblemError| Status::refused(error);
        let first = self.parameter.apply(problem, self.ends.0).map_err(refused)?;
        let extremal = walk::extremal(problem, (self.parameter, self.ends.0), &self.options);
        let extremal = extremal.map_err(Status::from)?;
        let options = SolverOptions { method: Method::Collocation, ..self.options.clone() };
        let context = Context::new(&options, None);
        let (parameter, ends) = (self.parameter, self.ends);
        let mut walker = Walker { problem, parameter, ends, extremal, context };
        let start = self.start(&first, &mut walker, branch)?;
        walker.context.phase = "continuation";
        let mut at = walker.begun(start)?;
        branch.end = BranchEnd::Stuck;
        let mut counted = walker.report(&at, branch, 0);
        let mut step = STEP.0;
        while branch.points.len() < MOST_POINTS {
            let ahead = at.position + step * at.slope;
            let border = match ahead {
                ahead if ahead >= 1.0 => Some(1.0),
                ahead if ahead <= 0.0 => Some(0.0),
                _ => None,
            };
            let aim = border.map_or(Aim::Along(step, at.slope), Aim::At);
            let next = walker.go(&at, aim).and_then(|found| walker.on_its_arcs(found));
            let next = match next {
                Ok(found) if found.bend < MOST_BEND && (0.0..=1.0).contains(&found.position) => found,
                _ => {
                    step *= 0.5;
                    if step < LEAST_STEP {
                        return self.ended(branch, &mut walker, at, BranchEnd::Stuck);
                    }
                    continue;
                }
            };
            if border.is_none() && next.slope * at.slope < 0.0 {
                let turn = walker.turn(&at, &next, step);
                branch.turning_points.push(TurningPoint { after: branch.points.len(), ..turn });
            }
            let straight = next.bend < 0.25 * MOST_BEND;
            at = next;
            counted = walker.report(&at, branch, counted);
            match border {
                Some(1.0) => return self.ended(branch, &mut walker, at, BranchEnd::Reached),
                Some(_) => return self.ended(branch, &mut walker, at, BranchEnd::TurnedBack),
                None => {}
            }
            if straight {
                step = (2.0 * step).min(STEP.1);
            }
        }
        self.ended(branch, &mut walker, at, BranchEnd::TooManyPoints)
    }

    /// A solution where the way begins.
    fn start(
        &self,
        first: &Problem,
        walker: &mut Walker<'_>,
        branch: &mut Branch,
    ) -> Result<Extremum, Status> {
        if self.parameter == Parameter::Smoothing {
            return walker.smoothed(first);
        }
        if let Some(start) = &self.start {
            return Ok(walker.extremum(start, first.time));
        }
        let refused = |error: ProblemError| Status::refused(error);
        let solution = Solver::new(first, self.options.clone()).map_err(refused)?.solve();
        let status = solution.motion.status.clone();
        let rough = status.is_solved().then(|| walker.extremum(&solution.trajectory, first.time));
        branch.solution = solution;
        rough.ok_or(status)
    }

    /// The last point in full.
    fn ended(
        &self,
        branch: &mut Branch,
        walker: &mut Walker<'_>,
        at: Found,
        end: BranchEnd,
    ) -> Result<(), Status> {
        let refused = |error: String| Status::refused(error);
        let last = self.parameter.apply(self.problem, walker.value(at.position));
        let last = last.map_err(|error| refused(error.to_string()))?;
        let value = walker.value(at.position);
        let extremal = walk::extremal(self.problem, (self.parameter, value), &walker.context.options);
        let mut extremal = extremal.map_err(|failure| refused(failure.to_string()))?;
        let iterations = std::mem::take(&mut walker.context.iterations);
        let tolerance = self.options.tolerance;
        let mut found = at.extremum.into_solution(&mut extremal, iterations, tolerance);
        found.motion.status = match end {
            BranchEnd::Stuck | BranchEnd::TooManyPoints => Status::ContinuationFailed,
            _ => found.motion.status,
        };
        branch.end = end;
        let solver = Solver::new(&last, self.options.clone()).map_err(|error| refused(error.to_string()))?;
        branch.solution = solver.solution(found, &mut extremal);
        Ok(())
    }
}
