//! From a problem to the best motion found.

use super::error::ProblemError;
use super::guess::{Disturbance, RobotGuess};
use super::lagrangian_extremal::LagrangianExtremal;
use super::legendre::{Mapped, OfRobot};
use super::motion::Motion;
use super::options::{Coordinates, Iteration, Options};
use super::problem::Problem;
use super::refine::{Context, Listener};
use super::robot_extremal::RobotExtremal;
use super::search::search;
use super::solution::{Solution, Trajectory};
use super::status::Status;
use crate::error::EvalError;

/// Solves a [`Problem`] from one or several guesses and keeps the cheapest motion found.
///
/// The first guess is a saved solution where one was given, else cubics in the joint coordinates that meet both ends,
/// p = M v, and costates zero; further ones (`starts`) add seeded waves to the cubics. Where a guess leads nowhere, or to a
/// motion that costs more than a path of low cost near the cubics, the search goes on from that path.
///
/// ```
/// use costate::control::{Options, Problem, Solver};
/// use costate::robot::Robot;
/// # std::env::set_current_dir(env!("CARGO_MANIFEST_DIR"))?;
/// let robot = Robot::from_file("robots/pendulum.toml")?;
/// let problem = Problem::rest_to_rest(robot, &[0.0], &[std::f64::consts::PI], 1.0);
/// let solution = Solver::new(&problem, Options::default())?.solve();
/// assert!(solution.status.is_converged());
/// assert!((solution.cost - 74.0616592202).abs() < 1e-8);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Solver<'a> {
    problem: &'a Problem,
    options: Options,
    start: Option<Trajectory>,
    listener: Option<Listener<'a>>,
}

impl<'a> Solver<'a> {
    /// Checks problem and options.
    ///
    /// # Errors
    /// [`ProblemError`].
    pub fn new(problem: &'a Problem, options: Options) -> Result<Self, ProblemError> {
        problem.check()?;
        options.check()?;
        Ok(Self { problem, options, start: None, listener: None })
    }

    /// Begins with a saved solution, stretched to the time asked for; one that does not [fit](Problem::check_start) the robot
    /// is left aside.
    pub fn from(mut self, start: &Solution) -> Self {
        if self.problem.check_start(start).is_ok() {
            self.start = Some(start.trajectory.clone());
        }
        self
    }

    /// Tells each Newton step to `listener`.
    pub fn on_iteration(mut self, listener: impl FnMut(&Iteration) + 'a) -> Self {
        self.listener = Some(Box::new(listener));
        self
    }

    /// Solves. Never fails: [`Solution::status`] says how it went, and the best iterate is kept.
    pub fn solve(mut self) -> Solution {
        let mut best: Option<Solution> = None;
        let (mut others, mut steps) = (Vec::new(), 0);
        for number in 0..self.options.starts {
            let solution = self
                .solve_from(number)
                .unwrap_or_else(|error| failed(self.problem, Status::EvaluationFailed(error.to_string())));
            steps += solution.newton_iterations;
            others.push((solution.total(), solution.status.clone()));
            let better = best.as_ref().is_none_or(|best| {
                let rank = |solution: &Solution| !solution.status.is_converged();
                (rank(&solution), solution.total()) < (rank(best), best.total())
            });
            if better {
                best = Some(solution);
            }
        }
        let mut best = best.unwrap_or_else(|| failed(self.problem, Status::NewtonFailed));
        best.newton_iterations = steps;
        best.others = others;
        best
    }

    fn solve_from(&mut self, number: usize) -> Result<Solution, EvalError> {
        let mut momenta = RobotExtremal::new(self.problem, self.options.jacobian)?;
        let motion = match self.options.coordinates {
            Coordinates::Hamiltonian => self.search(number, &mut momenta.clone(), &momenta),
            Coordinates::Lagrangian => {
                let mut extremal = LagrangianExtremal::new(self.problem, self.options.jacobian)?;
                self.search(number, &mut extremal, &momenta)
            }
        };
        Ok(self.solution(motion, &mut momenta))
    }

    /// In the coordinates of `extremal`; the motion is in (q, p, y_q, y_p).
    fn search<E: OfRobot>(&mut self, number: usize, extremal: &mut E, momenta: &RobotExtremal) -> Motion {
        let mut context = Context::new(&self.options, self.listener.take());
        let guess = RobotGuess {
            problem: self.problem,
            disturbance: Disturbance::draw(self.problem, self.options.seed, number),
            saved: self.start.as_ref().filter(|_| number == 0),
            momenta: momenta.clone(),
            path: None,
        };
        let mut guess = Mapped::<E>::new(guess, &self.problem.robot);
        let found = search(extremal, self.problem.time, &mut guess, &mut context);
        self.listener = context.listener.take();
        let mut motion = found.into_motion(extremal, context.iterations);
        for z in motion.z.iter_mut().chain(&mut motion.end_state) {
            if E::give(&mut guess.map, z).is_err() {
                z.fill(f64::NAN);
            }
        }
        motion
    }

    /// Rates at the nodes, and the miss at the end.
    pub(super) fn solution(&self, motion: Motion, extremal: &mut RobotExtremal) -> Solution {
        let n = self.problem.robot.dof();
        let mut rates = |x: &[f64]| extremal.velocity(x).map_or_else(|_| vec![f64::NAN; n], <[f64]>::to_vec);
        let v = motion.z.iter().map(|z| rates(&z[..2 * n])).collect();
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
        Solution::from_motion(motion, v, end_defect)
    }
}

/// A solution without a motion.
pub(super) fn failed(problem: &Problem, status: Status) -> Solution {
    let n = problem.robot.dof();
    Solution {
        status,
        cost: f64::INFINITY,
        penalty_cost: 0.0,
        smoothing: 0.0,
        final_time: problem.time.value(),
        hamiltonian: 0.0,
        hamiltonian_drift: 0.0,
        costate_start: (vec![0.0; n], vec![0.0; n]),
        end_defect: f64::INFINITY,
        shooting_defect: f64::INFINITY,
        newton_iterations: 0,
        nodes: 0,
        conjugate_time: None,
        certificate: super::motion::Certificate::NotChecked,
        errors: Vec::new(),
        iterations: Vec::new(),
        trajectory: Trajectory::default(),
        switches: Vec::new(),
        others: Vec::new(),
    }
}
