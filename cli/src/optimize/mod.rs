//! `costate optimize`: an optimal motion of a robot, from a problem file.

mod continuation;
mod kinematics;
mod progress;
mod report;
mod summary;
mod task;

use crate::{Outcome, terminal};
use costate::robot::LoadOptions;
use costate_control::{BranchEnd, Problem, Solution, Solver};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;
use task::Task;

#[derive(clap::Args)]
pub struct Arguments {
    /// Problem file (.toml): robot, start, end, time, cost
    problem: PathBuf,
    /// Print one JSON object and nothing else
    #[arg(long)]
    json: bool,
    /// Write the report, one HTML file
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Write the plots of the report as SVG files
    #[arg(long, value_name = "FOLDER")]
    svg: Option<PathBuf>,
    /// Write the solution, or the best iterate, as JSON that `[start_from] file` reads
    #[arg(long, value_name = "FILE")]
    save: Option<PathBuf>,
    /// Follow the solutions while a parameter changes: final_time, gravity, armature, bounds, penalty_weight, smoothing
    #[arg(long = "continue", value_name = "PARAMETER=FROM:TO")]
    way: Option<continuation::Way>,
    /// Print the table of Newton steps too
    #[arg(long)]
    iterations: bool,
    /// Refuse robots that are not physical (massless links, violated triangle inequality)
    #[arg(long)]
    strict: bool,
    /// Load `<dynamics damping friction>` of a URDF as viscous and smooth Coulomb friction
    #[arg(long)]
    friction: bool,
}

/// Exit status of a problem that was not solved.
const NOT_CONVERGED: u8 = 3;

pub fn run(arguments: &Arguments) -> Outcome {
    let load = LoadOptions::default().strict(arguments.strict).friction(arguments.friction);
    let mut task = Task::read(&arguments.problem, load)?;
    task.problem.robot.warnings().iter().for_each(|warning| terminal::warning(warning));
    task.problem.warnings().iter().for_each(|warning| terminal::warning(warning));
    let started = Instant::now();
    let branch = arguments.way.map(|way| continuation::follow(&mut task, way)).transpose()?;
    let solution = match &branch {
        Some(branch) => branch.solution.clone(),
        None => solve(&task)?,
    };
    let seconds = started.elapsed().as_secs_f64();
    let problem = &task.problem;
    let warnings = problem.limit_warnings(&solution.trajectory);
    warnings.iter().for_each(|warning| terminal::warning(warning));
    if let Some(file) = &arguments.save {
        write(file, &serde_json::to_string(&solution)?)?;
    }
    let motion = report::Motion { problem, solution: &solution, source: &task.text, warnings: &warnings };
    if let Some(file) = &arguments.output {
        write(file, &report::page(&motion))?;
    }
    if let Some(folder) = &arguments.svg {
        std::fs::create_dir_all(folder).map_err(|error| unwritable(folder, &error))?;
        for (name, text) in report::files(&motion) {
            write(&folder.join(name), &text)?;
        }
    }
    if arguments.json && !solution.motion.status.is_solved() {
        terminal::warning(format!("not a solution but the best iterate: {}", solution.motion.status));
    }
    let mut out = std::io::stdout().lock();
    if arguments.json {
        let continuation = branch.as_ref().map(continuation::Points::new);
        let printed = Printed { solution: &solution, continuation };
        writeln!(out, "{}", serde_json::to_string(&printed)?)?;
    } else {
        if let Some(branch) = &branch {
            continuation::print(branch, &mut out)?;
        }
        summary::print(problem, &solution, seconds, &mut out)?;
        if arguments.iterations {
            summary::print_iterations(&solution, &mut out)?;
        }
    }
    let reached = branch.as_ref().is_none_or(|branch| branch.end == BranchEnd::Reached);
    Ok(if solution.motion.status.is_solved() && reached {
        ExitCode::SUCCESS
    } else {
        ExitCode::from(NOT_CONVERGED)
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

/// Solves the task, with a line on a terminal that says how far it is.
fn solve(task: &Task) -> Result<Solution, Box<dyn std::error::Error>> {
    let line = progress::Line::new(&task.problem.robot)?;
    let mut solver = Solver::new(&task.problem, task.options.clone())?;
    if let Some(start) = &task.start_from {
        solver = solver.with_start(start)?;
    }
    let solution = solver.on_iteration(|iteration| line.show(iteration)).solve();
    line.clear();
    Ok(solution)
}

fn write(file: &Path, text: &str) -> Result<(), String> {
    std::fs::write(file, text).map_err(|error| unwritable(file, &error))
}

fn unwritable(path: &Path, error: &std::io::Error) -> String {
    format!("{}: cannot be written ({error}); check the path and the permissions", path.display())
}

/// Whether the motion may take any time.
fn time_is_free(problem: &Problem) -> bool {
    matches!(problem.time, costate_control::FinalTime::Free { .. })
}
