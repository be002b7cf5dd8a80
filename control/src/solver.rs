//! From a problem to the best motion found.

use crate::extremal::hamiltonian::RobotExtremal;
use crate::extremal::lagrangian::LagrangianExtremal;
use crate::extremal::legendre::{Mapped, OfRobot};
use crate::options::{Coordinates, Iteration, SolverOptions};
use crate::problem::Problem;
use crate::problem::check::CheckedProblem;
use crate::problem::error::ProblemError;
use crate::result::motion::{ExtremalSolution, Motion};
use crate::result::solution::{RobotNames, Solution, StartResult};
use crate::result::trajectory::Trajectory;
use crate::result::trajectory_error::TrajectoryError;
use crate::search::guess::{Disturbance, RobotGuess};
use crate::search::{PATH, search};
use crate::solve::{Context, Listener};
use crate::status::Status;
use costate::EvalError;

/// Solves a [`Problem`] from one or several guesses and keeps the cheapest motion found.
///
/// The first guess is a saved solution where one was given, else cubics in the joint coordinates that meet both ends,
/// p = M v, and costates zero; further ones (`starts`) add seeded waves to the cubics. Where a guess leads nowhere, or to a
/// motion that costs more than a path of low cost near the cubics, the search goes on from that path.
///
/// ```
/// use costate_control::{SolverOptions, Problem, Solver};
/// use costate::robot::Robot;
/// # std::env::set_current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))?;
/// let robot = Robot::from_file("robots/pendulum.toml")?;
/// let problem = Problem::rest_to_rest(robot, &[0.0], &[std::f64::consts::PI], 1.0);
/// let solution = Solver::new(&problem, SolverOptions::default())?.solve();
/// assert!(solution.status.is_converged());
/// assert!((solution.cost - 74.0616592202).abs() < 1e-8);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Solver<'a> {
    problem: CheckedProblem<'a>,
    options: SolverOptions,
    start: Option<Trajectory>,
    listener: Option<Listener<'a>>,
}

impl<'a> Solver<'a> {
    /// Checks problem and options.
    ///
    /// # Errors
    /// [`ProblemError`].
    pub fn new(problem: &'a Problem, options: SolverOptions) -> Result<Self, ProblemError> {
        let problem = problem.check()?;
        options.check()?;
        Ok(Self { problem, options, start: None, listener: None })
    }

    /// Begins with a trajectory, stretched to the time asked for.
    ///
    /// # Errors
    /// [`TrajectoryError`] where its lists do not fit the robot.
    pub fn with_start(mut self, start: &Trajectory) -> Result<Self, TrajectoryError> {
        start.check(&self.problem.robot)?;
        self.start = Some(start.clone());
        Ok(self)
    }

    /// Tells each Newton step to `listener`.
    pub fn on_iteration(mut self, listener: impl FnMut(&Iteration) + 'a) -> Self {
        self.listener = Some(Box::new(listener));
        self
    }

    /// Solves. Never fails: [`Solution::status`] says how it went, and the best iterate is kept.
    pub fn solve(mut self) -> Solution {
        let mut best: Option<Solution> = None;
        let (mut starts, mut steps) = (Vec::new(), 0);
        for number in 0..self.options.starts {
            let solution = self
                .solve_from(number)
                .unwrap_or_else(|error| self.missing(Status::evaluation_failed(error)));
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

    fn solve_from(&mut self, number: usize) -> Result<Solution, EvalError> {
        let mut momenta = RobotExtremal::new(self.problem, self.options.jacobian)?;
        let found = match self.options.coordinates {
            Coordinates::Hamiltonian => self.search(number, &mut momenta.clone(), &momenta),
            Coordinates::Lagrangian => {
                let mut extremal = LagrangianExtremal::new(self.problem, self.options.jacobian)?;
                self.search(number, &mut extremal, &momenta)
            }
        };
        Ok(self.solution(found, &mut momenta))
    }

    /// In the coordinates of `extremal`; the motion is in (q, p, y_q, y_p).
    fn search<E: OfRobot>(
        &mut self,
        number: usize,
        extremal: &mut E,
        momenta: &RobotExtremal,
    ) -> ExtremalSolution {
        let mut context = Context::new(&self.options, self.listener.take());
        let guess = RobotGuess {
            problem: self.problem.problem(),
            disturbance: Disturbance::draw(&self.problem, self.options.seed, number),
            saved: self.start.as_ref().filter(|_| number == 0),
            momenta: momenta.clone(),
            path: None,
        };
        let mut guess = Mapped::<E>::new(guess, &self.problem.robot);
        let found = search(extremal, self.problem.time, &mut guess, &mut context);
        self.listener = context.listener.take();
        let mut solution = found.into_solution(extremal, context.iterations, self.options.tolerance);
        solution.map(|z| E::give(&mut guess.map, z));
        solution
    }

    /// Rates at the nodes, and the miss at the end.
    pub(crate) fn solution(&self, found: ExtremalSolution, extremal: &mut RobotExtremal) -> Solution {
        let ExtremalSolution { motion, nodes, .. } = found;
        let n = self.problem.robot.len();
        let mut rates = |x: &[f64]| extremal.velocity(x).map_or_else(|_| vec![f64::NAN; n], <[f64]>::to_vec);
        let v = nodes.z.iter().map(|z| rates(&z[..2 * n])).collect();
        let end = &self.problem.end;
        let end_defect = motion.end_state.as_ref().map_or(f64::INFINITY, |x| {
            let v = rates(x);
            let miss = |j: usize| {
                let q = if end.q_free.contains(&j) { 0.0 } else { (x[j] - end.q[j]).abs() };
                let v = if end.v_free.contains(&j) { 0.0 } else { (v[j] - end.v[j]).abs() };
                q.max(v)
            };
            (0..n).map(miss).fold(0.0, f64::max)
        });
        Solution {
            newton_iterations: motion.iterations.iter().filter(|step| step.phase != PATH).count(),
            end_defect,
            trajectory: Trajectory::from_nodes(nodes, v),
            starts: Vec::new(),
            options: self.options.clone(),
            robot: RobotNames::of(&self.problem.robot),
            motion,
        }
    }
}
