//! From a problem to the best motion found.

use crate::closed_loops;
use crate::direct::{Direct, Looseness};
use crate::free_motions;
use crate::options::{Method, Polish, SolverOptions, Verify};
use crate::polish::{may_polish, polish, polish_saved, unpolished};
use crate::problem::check::CheckedProblem;
use crate::problem::error::ProblemError;
use crate::problem::rounded::rounded_up;
use crate::problem::{FinalTime, Problem};
use crate::progress::{Cancel, Iteration, Listener};
use crate::result::polish_report::PolishOutcome;
use crate::result::solution::Solution;
use crate::result::stage_times::StageTimes;
use crate::result::start::StartResult;
use crate::result::trajectory::Trajectory;
use crate::result::trajectory_error::TrajectoryError;
use crate::solve::Recorder;
use crate::solve::recorder::{Interruption, Stop};
use crate::starts::{Starts, rough_tolerance, saved as saved_motion};
use crate::status::Status;
use crate::task::build::TaskRows;
use crate::verdict::settled;
use std::fmt;
use std::ops::ControlFlow;
use std::time::Instant;

/// Solves a [`Problem`] from one or several guesses and keeps the cheapest motion found.
///
/// The first guess is a saved motion if there is one, else cubics in the joint coordinates that meet both
/// ends. Further starts add seeded waves to the cubics. The direct method begins there, unless the number of
/// starts is left to it: then it looks at other guesses for tools and obstacles too
/// ([`GuessKind`](crate::GuessKind)), and goes on with the best one. Where nothing but controls is at its
/// limits, what it found is the first guess of an extremal ([`Polish`](crate::Polish)). Collocation and
/// shooting begin at what the direct method finds roughly, and go on from cubics and from relaxed problems
/// where that fails ([`Strategy`](crate::Strategy)).
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
    takes_times: bool,
}

impl<'a> Solver<'a> {
    /// Checks problem and options.
    ///
    /// # Errors
    /// [`ProblemError`]: the first key of the problem or option that is out of range.
    pub fn new(problem: &'a Problem, options: SolverOptions) -> Result<Self, ProblemError> {
        let rows = match options.method {
            Method::Direct if problem.robot.free_joints().is_empty() => Some(TaskRows::new(problem)?),
            _ => None,
        };
        let problem = problem.check_for(options.method)?;
        options.check()?;
        let (start, listener, cancel) = (None, None, None);
        Ok(Self { problem, rows, options, start, listener, cancel, takes_times: false })
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

    /// Calls `listener` after each Newton step. If it returns
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

    /// Measures where the time of the direct method goes
    /// ([`Solution::stage_times`](crate::Solution::stage_times)): a clock is read a few times in each Newton
    /// step.
    pub fn with_stage_times(mut self) -> Self {
        self.takes_times = true;
        self
    }

    /// Solves. Never fails: [`Motion::status`](crate::Motion::status) says how it ended, and the best iterate
    /// is kept.
    pub fn solve(self) -> Solution {
        let Self { problem, rows, options, start, listener, cancel, takes_times } = self;
        let mut recorder = Recorder::new(listener, Stop::new(cancel, options.time_limit));
        recorder.takes_times = takes_times;
        let found = solve(problem, rows.as_ref(), &options, start.as_ref(), &mut recorder);
        let found = with_solved_time(&problem, &options, start.as_ref(), found, &mut recorder);
        settled(found, recorder.interruption())
    }
}

/// By the method that the robot and the options ask for.
fn solve(
    problem: CheckedProblem<'_>,
    rows: Option<&TaskRows>,
    options: &SolverOptions,
    start: Option<&Trajectory>,
    recorder: &mut Recorder<'_>,
) -> Solution {
    if problem.problem().is_closed() {
        let found = closed_loops::solve(problem.problem(), options, start, recorder);
        return unpolished(found, options, &problem);
    }
    if !problem.robot.free_joints().is_empty() {
        let found = free_motions::solve(problem.problem(), options, start, recorder);
        return unpolished(found, options, &problem);
    }
    if let Some(rows) = rows {
        return directly(problem, rows, options.clone(), start.cloned(), recorder);
    }
    let starts = Starts { problem, options, saved: start.map(saved_motion), alone: false };
    starts.solve(recorder)
}

/// Factors of the time that an elastic phase found, which is about the least one: close to it motions have no
/// room, and are hard to find.
const LONGER: [f64; 3] = [1.01, 1.1, 1.3];
/// Work of each trial, Newton steps times nodes, relative to that of the search, ..
const WORK: usize = 10;
/// .. with so much beside it.
const LEAST_WORK: usize = 10_000;
/// Digits of the time that is proposed.
const DIGITS: usize = 4;

/// Replaces the longer final time that an elastic phase found by one with which the problem is solved, with
/// these options; by none if it is not. What is proposed is tried first.
fn with_solved_time(
    problem: &Problem,
    options: &SolverOptions,
    start: Option<&Trajectory>,
    mut found: Solution,
    recorder: &mut Recorder<'_>,
) -> Solution {
    let Some(infeasible) = &mut found.limits.infeasible else { return found };
    let Some(time) = infeasible.final_time.take() else { return found };
    let starts = options.starts.map(|_| 1);
    // That a motion keeps all limits is what is tried: a smaller tolerance of its cost makes that no truer.
    let tolerance = options.tolerance.max(SolverOptions::default().tolerance);
    let alone = SolverOptions { starts, polish: Polish::Never, tolerance, ..options.clone() };
    let steps = found.motion.iterations.iter();
    let most = LEAST_WORK + WORK * steps.map(|step| step.nodes).sum::<usize>();
    for factor in LONGER {
        if recorder.interruption().is_some() {
            break;
        }
        let time = rounded_up(factor * time, DIGITS);
        let longer = problem.clone().with_time(FinalTime::Fixed(time));
        let Ok(checked) = longer.check_for(options.method) else { continue };
        let rows = match options.method {
            Method::Direct if longer.robot.free_joints().is_empty() => TaskRows::new(&longer).ok(),
            _ => None,
        };
        let tried = recorder.within(most, |recorder| solve(checked, rows.as_ref(), &alone, start, recorder));
        let mut tried = settled(tried, recorder.interruption());
        found.newton_iterations += tried.newton_iterations;
        found.motion.iterations.append(&mut tried.motion.iterations);
        if tried.motion.status.is_solved() {
            infeasible.final_time = Some(time);
            break;
        }
    }
    found
}

/// By the direct method, with a polish. What a polish makes exact need not be exact before: the direct method
/// is rough at first where a polish may apply, and goes on where that fails.
fn directly(
    problem: CheckedProblem<'_>,
    rows: &TaskRows,
    options: SolverOptions,
    mut start: Option<Trajectory>,
    recorder: &mut Recorder<'_>,
) -> Solution {
    let polishes = options.polish != Polish::Never && may_polish(&problem);
    if let Some(saved) =
        start.as_ref().filter(|_| polishes && options.count() == 1 && !problem.needs_direct())
        && let Some(found) = polish_saved(&problem, &options, saved_motion(saved), recorder)
    {
        return found;
    }
    let tolerance = rough_tolerance(&problem, &options);
    let rough = polishes && tolerance > options.tolerance;
    let (mut iterations, mut steps, mut times) = (Vec::new(), 0, StageTimes::default());
    let mut begun = Vec::new();
    let first = SolverOptions { tolerance, verify: options.verify.min(Verify::Factors), ..options.clone() };
    // A polish begins at a motion as exact as that of an extremal does.
    let looseness = if polishes { Looseness::default() } else { Looseness::of(options.tolerance) };
    // The starts of a rough stage of which only the best motion is worth going on with.
    let mut kept = None;
    for stage in rough.then_some(&first).into_iter().chain([&options]) {
        let began = Instant::now();
        let alone = kept.is_some().then(|| SolverOptions { starts: Some(1), ..stage.clone() });
        let from = alone.as_ref().unwrap_or(stage);
        let direct = Direct { problem, rows, options: from, looseness, saved: start.as_ref() };
        let mut found = direct.solve(recorder);
        if let Some((starts, total)) = kept.take() {
            let of_best = std::mem::replace(&mut found.starts, starts).pop();
            let best = found.starts.iter_mut().find(|start| start.total.to_bits() == f64::to_bits(total));
            if let (Some(best), Some(of_best)) = (best, of_best) {
                *best = StartResult { guess: best.guess, looks: best.looks, ..of_best };
            }
        } else if let ([begun], [start]) = (&begun[..], &mut found.starts[..]) {
            let StartResult { guess, looks, .. } = begun;
            (start.guess, start.looks) = (*guess, *looks);
        }
        times = times.and(&found.stage_times.unwrap_or_default());
        let taken = began.elapsed();
        let mut found = polish(&problem, &options, found, recorder);
        times.polish += (began.elapsed() - taken).as_secs_f64();
        found.motion.iterations.splice(0..0, iterations);
        let polished = found.polish.as_ref().is_some_and(|report| report.outcome.is_polished());
        let (is_rough, interruption) = (!std::ptr::eq(stage, &options), recorder.interruption());
        let is_last = !is_rough || interruption.is_some();
        steps += found.newton_iterations;
        if polished || is_last {
            if let Some(interruption) = interruption.filter(|_| is_rough && !polished) {
                stop_short(&mut found, interruption);
            }
            let stage_times = recorder.takes_times.then_some(times);
            return Solution { newton_iterations: steps, stage_times, options: options.clone(), ..found };
        }
        iterations = std::mem::take(&mut found.motion.iterations);
        let outcome = found.polish.as_ref().map(|report| report.outcome);
        let is_limited = outcome == Some(PolishOutcome::Limited) && found.motion.status.is_solved();
        let status = &found.motion.status;
        let is_infeasible =
            matches!(status, Status::Infeasible | Status::LocallyInfeasible) && found.trajectory.t.len() > 1;
        kept = (is_limited || is_infeasible).then(|| (std::mem::take(&mut found.starts), found.total()));
        begun = std::mem::take(&mut found.starts);
        start = if found.is_motion() || is_infeasible { Some(found.trajectory) } else { start };
    }
    Solution::without_motion(&problem, Status::Cancelled)
}

/// The motions of a rough stage after which the search was stopped: they are solved, but neither as exactly
/// as they were asked for, nor verified.
fn stop_short(found: &mut Solution, interruption: Interruption) {
    let statuses = found.starts.iter_mut().map(|start| &mut start.status);
    for status in statuses.chain([&mut found.motion.status]).filter(|status| status.is_solved()) {
        *status = interruption.into();
    }
    found.motion.verification = Verify::None;
}

impl fmt::Debug for Solver<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Solver")
            .field("robot", &self.problem.robot.name())
            .field("options", &self.options)
            .field("start", &self.start.as_ref().map(|start| start.t.len()))
            .field("listener", &self.listener.is_some())
            .field("cancel", &self.cancel)
            .field("takes_times", &self.takes_times)
            .finish_non_exhaustive()
    }
}
