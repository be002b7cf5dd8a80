//! From a problem to the best motion found.

use crate::extremal::Extremal;
use crate::options::Options;
use crate::problem::error::ProblemError;
use crate::problem::{Problem, Time};
use crate::progress::{Cancel, Iteration, Listener};
use crate::result::motion::Motion;
use crate::result::solution::{Solution, Trajectory};
use crate::search::Search;
use crate::search::guess::{Plain, StartError};
use crate::solve::Recorder;
use crate::solve::recorder::Stop;
use crate::starts::{Starts, saved};
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
