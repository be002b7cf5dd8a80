//! From a problem to the best motion found.

use crate::extremal::Extremal;
use crate::extremal::hamiltonian::RobotExtremal;
use crate::extremal::lagrangian::LagrangianExtremal;
use crate::extremal::legendre::OfRobot;
use crate::options::{Coordinates, Options};
use crate::path::cubics::Disturbance;
use crate::problem::error::ProblemError;
use crate::problem::{Problem, Time};
use crate::progress::{Cancel, Iteration, Listener};
use crate::result::motion::Motion;
use crate::result::solution::{Solution, Trajectory};
use crate::search::Search;
use crate::search::guess::{Plain, RobotGuess, SavedMotion, StartError};
use crate::search::mapped::Mapped;
use crate::solve::Recorder;
use crate::solve::recorder::Stop;
use crate::status::Status;
use costate::EvalError;
use std::fmt;
use std::ops::ControlFlow;

/// Solves an extremal from a guess of z at t/T in [0, 1].
///
/// With a free final time, the problem is solved for the fixed time of the guess first: at zero costates H* =
/// 0 does not determine T.
///
/// ```
/// use costate_control::{Options, Time, solve_extremal};
/// # use costate_control::{Extremal, Law, Rate};
/// # use costate::EvalError;
/// # struct Line;
/// # impl Extremal for Line {
/// #     fn states(&self) -> usize { 1 }
/// #     fn rate(&mut self, z: &[f64], _: Law<'_>, g: &mut [f64]) -> Result<Rate, EvalError> {
/// #         g.copy_from_slice(&[z[1], 0.0]);
/// #         let cost = 0.5 * z[1] * z[1];
/// #         Ok(Rate { hamiltonian: z[1] * z[1] - cost, cost, ..Rate::default() })
/// #     }
/// #     fn linear(&mut self, z: &[f64], law: Law<'_>, g: &mut [f64], j: &mut [f64]) -> Result<Rate, EvalError> {
/// #         j.copy_from_slice(&[0.0, 1.0, 0.0, 0.0]);
/// #         self.rate(z, law, g)
/// #     }
/// #     fn start(&mut self, z: &[f64], r: &mut [f64], j: &mut [f64]) -> Result<(), EvalError> {
/// #         r[0] = z[0];
/// #         j.copy_from_slice(&[1.0, 0.0]);
/// #         Ok(())
/// #     }
/// #     fn end(&mut self, z: &[f64], r: &mut [f64], j: &mut [f64]) -> Result<(), EvalError> {
/// #         r[0] = z[0] - 1.0;
/// #         j.copy_from_slice(&[1.0, 0.0]);
/// #         Ok(())
/// #     }
/// #     fn state_rate(&mut self, _: &[f64], u: &[f64], f: &mut [f64]) -> Result<(), EvalError> {
/// #         f.copy_from_slice(u);
/// #         Ok(())
/// #     }
/// #     fn controls(&self) -> usize { 1 }
/// #     fn unbounded_controls(&mut self, z: &[f64], u: &mut [f64]) { u[0] = z[1]; }
/// # }
/// // `Line`: dx/dt = u from 0 to 1, l = u^2/2.
/// let motion = solve_extremal(&mut Line, Time::Fixed(2.0), &Options::default(), |s, z| z[0] = s);
/// assert!(motion.status.is_converged() && (motion.cost - 0.25).abs() < 1e-12);
/// ```
pub fn solve_extremal<E: Extremal>(
    extremal: &mut E,
    time: Time,
    options: &Options,
    guess: impl FnMut(f64, &mut [f64]),
) -> Motion {
    let mut recorder = Recorder::new(None, Stop::new(None, options.time_limit));
    let search = Search { extremal, time, guess: &mut Plain(guess), recorder: &mut recorder };
    let found = search.run(options);
    found.into_motion(extremal, recorder.iterations)
}

/// Solves a [`Problem`] from one or several guesses and keeps the cheapest motion found.
///
/// The first guess is a saved motion if there is one, else cubics in the joint coordinates that meet both
/// ends, p = M v, and zero costates. Further starts add seeded waves to the cubics. If a guess fails, or
/// leads to a motion that costs more than a path of low cost near the cubics, the search continues from that
/// path; if that fails too, from relaxed problems ([`Strategy`](crate::Strategy)).
///
/// ```
/// use costate_control::{Options, Problem, Solver};
/// use costate::robot::Robot;
/// # std::env::set_current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))?;
/// let robot = Robot::from_file("robots/pendulum.toml")?;
/// let problem = Problem::rest_to_rest(robot, &[0.0], &[std::f64::consts::PI], 1.0);
/// let solution = Solver::new(&problem, Options::default())?.solve();
/// assert!(solution.status.is_converged());
/// assert!((solution.cost - 74.0616592202).abs() < 1e-8);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use = "a solver does nothing until `solve` is called"]
pub struct Solver<'a> {
    problem: &'a Problem,
    options: Options,
    start: Option<Trajectory>,
    listener: Option<Listener<'a>>,
    cancel: Option<Cancel>,
}

impl<'a> Solver<'a> {
    /// Checks problem and options.
    ///
    /// # Errors
    /// [`ProblemError`]: the first key of the problem or option that is out of range.
    pub fn new(problem: &'a Problem, options: Options) -> Result<Self, ProblemError> {
        problem.check()?;
        options.check()?;
        Ok(Self { problem, options, start: None, listener: None, cancel: None })
    }

    /// Begins the first start with a saved motion, stretched to the final time of the problem.
    ///
    /// # Errors
    /// [`StartError`] if the motion is not whole or belongs to a robot with another number of joints.
    pub fn with_start(mut self, start: &Trajectory) -> Result<Self, StartError> {
        saved(start).check(self.problem.robot.len())?;
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

    /// Solves. Never fails: [`Solution::status`] says how it ended, and the best iterate is kept.
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
    pub problem: &'a Problem,
    pub options: &'a Options,
    /// Where the first start begins.
    pub saved: Option<SavedMotion<'a>>,
}

impl Starts<'_> {
    /// The best solution of all starts: the cheapest converged one if there is any.
    pub fn solve(&self, recorder: &mut Recorder<'_>) -> Solution {
        let mut best: Option<Solution> = None;
        let (mut others, mut steps) = (Vec::new(), 0);
        for number in 0..self.options.starts {
            let solution = self
                .start(number, recorder)
                .unwrap_or_else(|error| failed(self.problem, Status::EvaluationFailed(error.into())));
            steps += solution.newton_iterations;
            others.push((solution.total(), solution.status.clone()));
            let better = best.as_ref().is_none_or(|best| {
                let rank = |solution: &Solution| !solution.status.is_converged();
                (rank(&solution), solution.total()) < (rank(best), best.total())
            });
            if better {
                best = Some(solution);
            }
            if recorder.interruption().is_some() {
                break;
            }
        }
        let mut best = best.unwrap_or_else(|| failed(self.problem, Status::NewtonFailed));
        best.newton_iterations = steps;
        best.others = others;
        best
    }

    fn start(&self, number: usize, recorder: &mut Recorder<'_>) -> Result<Solution, EvalError> {
        let mut momenta = RobotExtremal::new(self.problem, self.options.jacobian)?;
        let motion = match self.options.coordinates {
            Coordinates::Hamiltonian => self.search(number, &mut momenta.clone(), &momenta, recorder),
            Coordinates::Lagrangian => {
                let mut extremal = LagrangianExtremal::new(self.problem, self.options.jacobian)?;
                self.search(number, &mut extremal, &momenta, recorder)
            }
        };
        Ok(solution(self.problem, motion, &mut momenta))
    }

    /// In the coordinates of `extremal`; the motion is in (q, p, y_q, y_p).
    fn search<E: OfRobot>(
        &self,
        number: usize,
        extremal: &mut E,
        momenta: &RobotExtremal,
        recorder: &mut Recorder<'_>,
    ) -> Motion {
        let guess = RobotGuess {
            problem: self.problem,
            disturbance: Disturbance::draw(self.problem, self.options.seed, number),
            saved: self.saved.filter(|_| number == 0),
            momenta: momenta.clone(),
            path: None,
        };
        let mut guess = Mapped::<E>::new(guess, &self.problem.robot);
        let search = Search { extremal, time: self.problem.time, guess: &mut guess, recorder };
        let found = search.run(self.options);
        let mut motion = found.into_motion(extremal, std::mem::take(&mut recorder.iterations));
        for z in motion.z.iter_mut().chain(&mut motion.end_state) {
            if E::give(&mut guess.map, z).is_err() {
                z.fill(f64::NAN);
            }
        }
        motion
    }
}

/// A solution from a motion: adds the rates at the nodes and the largest error at the end.
pub(crate) fn solution(problem: &Problem, motion: Motion, extremal: &mut RobotExtremal) -> Solution {
    let n = problem.robot.len();
    let mut rates = |x: &[f64]| extremal.velocity(x).map_or_else(|_| vec![f64::NAN; n], <[f64]>::to_vec);
    let v = motion.z.iter().map(|z| rates(&z[..2 * n])).collect();
    let end = &problem.end;
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

/// A solution without a motion.
pub(crate) fn failed(problem: &Problem, status: Status) -> Solution {
    let n = problem.robot.len();
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
        certificate: crate::result::motion::Certificate::NotChecked,
        errors: Vec::new(),
        iterations: Vec::new(),
        trajectory: Trajectory::default(),
        switches: Vec::new(),
        others: Vec::new(),
    }
}
