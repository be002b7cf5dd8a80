//! `costate optimize`: an optimal motion of a robot, from a problem file.

mod continuation;
mod kinematics;
mod outputs;
mod progress;
mod report;
mod summary;
mod task;

use crate::interrupt::{self, Interrupt};
use crate::{Outcome, terminal};
use clap::ValueHint;
use continuation::ParameterRange;
use costate::robot::LoadOptions;
use costate_control::{BranchEnd, Problem, Solution, Solver};
use outputs::Outputs;
use std::io::Write;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::{Duration, Instant};
use task::Task;

#[derive(clap::Args)]
pub struct Arguments {
    /// Problem file (.toml)
    #[arg(value_hint = ValueHint::FilePath)]
    problem: PathBuf,
    /// Print the solution as one JSON object instead of a table
    #[arg(long)]
    json: bool,
    /// Write the report, a single HTML file
    #[arg(short, long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    output: Option<PathBuf>,
    /// Write the figures of the report as SVG files; figures of an earlier run are removed
    #[arg(long, value_name = "FOLDER", value_hint = ValueHint::DirPath)]
    svg: Option<PathBuf>,
    /// Save the solution, or the best iterate, as JSON; a problem file reads it with [start_from]
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    save: Option<PathBuf>,
    /// Follow the solution while a parameter changes: final_time, gravity, armature, bounds, penalty_weight
    /// or smoothing
    #[arg(long = "continue", value_name = "PARAMETER=FROM:TO")]
    range: Option<ParameterRange>,
    /// Stop after this time (s) and keep the best iterate; overrides solver.time_limit of the problem file
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    time_limit: Option<Duration>,
    /// Also print the table of Newton steps
    #[arg(long)]
    iterations: bool,
    /// Refuse robots that are not physical (massless links, principal moments that no rigid body has)
    #[arg(long)]
    strict: bool,
    /// Load <dynamics damping friction> of a URDF as viscous and smooth Coulomb friction
    #[arg(long)]
    friction: bool,
}

/// Exit status of a problem that was not solved.
const NOT_SOLVED: u8 = 3;

/// Parser of a time limit.
fn seconds(text: &str) -> Result<Duration, String> {
    let limit = crate::arguments::positive(text)?;
    Duration::try_from_secs_f64(limit).ok().filter(|limit| !limit.is_zero()).ok_or_else(|| {
        "must be at least a nanosecond and less than 1e19 s; leave it out for no limit".to_owned()
    })
}

pub fn run(arguments: &Arguments) -> Outcome {
    let load = LoadOptions::default().strict(arguments.strict).friction(arguments.friction);
    let mut task = Task::read(&arguments.problem, load)?;
    if let Some(limit) = arguments.time_limit {
        task.options = task.options.with_time_limit(limit);
    }
    let outputs = Outputs::prepare(arguments, &task.inputs)?;
    task.problem.robot.warnings().iter().for_each(terminal::warning);
    task.problem.warnings().iter().for_each(terminal::warning);

    let interrupt = Interrupt::listen()?;
    let started = Instant::now();
    let branch =
        arguments.range.map(|range| continuation::follow(&mut task, range, &interrupt)).transpose()?;
    let solution = match &branch {
        Some(branch) => branch.solution.clone(),
        None => solve(&task, &interrupt)?,
    };
    let seconds = started.elapsed().as_secs_f64();
    let interrupted = interrupt.is_requested();

    let problem = &task.problem;
    let warnings = problem.limit_warnings(&solution.trajectory);
    warnings.iter().for_each(terminal::warning);
    let motion = report::Motion { problem, solution: &solution, source: &task.text, warnings: &warnings };
    outputs.write(&motion)?;
    if interrupted {
        terminal::note("interrupted; the best motion so far was kept");
    }
    if arguments.json {
        let remarks = [summary::explanation(problem, &solution), summary::skipped_starts(&solution)];
        remarks.iter().flatten().for_each(terminal::warning);
        let continuation = branch.as_ref().map(continuation::Points::new);
        let printed = Printed { solution: &solution, continuation };
        writeln!(std::io::stdout().lock(), "{}", serde_json::to_string(&printed)?)?;
    } else if !outputs.use_standard_output() {
        let mut out = std::io::stdout().lock();
        if let Some(branch) = &branch {
            continuation::print(branch, &mut out)?;
        }
        summary::print(problem, &solution, seconds, &mut out)?;
        if arguments.iterations {
            summary::print_iterations(&solution, &mut out)?;
        }
    }
    let reached = branch.as_ref().is_none_or(|branch| branch.end == BranchEnd::Reached);
    Ok(match (interrupted, solution.motion.status.is_solved() && reached) {
        (true, _) => ExitCode::from(interrupt::EXIT_CODE),
        (false, true) => ExitCode::SUCCESS,
        (false, false) => ExitCode::from(NOT_SOLVED),
    })
}

/// What `--json` prints: the solution as it is saved, and the points of a continuation.
#[derive(serde::Serialize)]
struct Printed<'a> {
    #[serde(flatten)]
    solution: &'a Solution,
    #[serde(skip_serializing_if = "Option::is_none")]
    continuation: Option<continuation::Points<'a>>,
}

/// Solves the problem, with a progress line. A signal stops the search, which keeps the best iterate.
fn solve(task: &Task, interrupt: &Interrupt) -> Result<Solution, Box<dyn std::error::Error>> {
    let line = progress::Line::new(&task.problem.robot)?;
    let mut solver = Solver::new(&task.problem, task.options.clone())?;
    if let Some(start) = &task.start_from {
        solver = solver.with_start(start)?;
    }
    let solver = solver.on_iteration(|iteration| {
        line.show_iteration(iteration);
        unless_requested(interrupt)
    });
    let solution = solver.solve();
    line.clear();
    Ok(solution)
}

/// Goes on until a signal has arrived.
fn unless_requested(interrupt: &Interrupt) -> ControlFlow<()> {
    if interrupt.is_requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
}

/// Whether the final time is free.
fn time_is_free(problem: &Problem) -> bool {
    matches!(problem.time, costate_control::FinalTime::Free { .. })
}

#[cfg(test)]
mod tests {
    use super::seconds;
    use std::time::Duration;

    #[test]
    fn time_limits_are_positive_and_finite() {
        assert_eq!(seconds("0.5"), Ok(Duration::from_millis(500)));
        for text in ["0", "-1", "inf", "nan", "1e300", "1e-12", "soon"] {
            assert!(seconds(text).is_err(), "{text}");
        }
    }
}
