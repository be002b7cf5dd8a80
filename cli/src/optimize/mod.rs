//! `costate optimize`: an optimal motion of a robot, from a problem file.

mod arguments;
mod continuation;
mod cpu_time;
mod feedback;
mod models;
mod outputs;
mod progress;
mod samples;
mod sensitivities;
mod summary;
mod task;

use crate::arguments::warn_of_urdf_flags;
use crate::interrupt::{self, Interrupt};
use crate::{Outcome, terminal};
pub use arguments::Arguments;
use costate::robot::{LoadOptions, RobotFormat, printable};
use costate_control::{
    BranchEnd, CostDerivative, FinalTime, Remark, Samples, Severity, Solution, Solver, StageTimes,
};
use costate_report::ReportOptions;
use cpu_time::cpu_time;
use outputs::Outputs;
use std::error::Error;
use std::io::Write;
use std::num::NonZeroUsize;
use std::process::ExitCode;
use std::time::Instant;
use task::Task;

/// Exit status of a problem that was not solved.
const NOT_SOLVED: u8 = 3;

pub fn run(arguments: &Arguments) -> Outcome {
    let load = LoadOptions::default()
        .strict(arguments.strict)
        .friction(arguments.friction)
        .floating_base(arguments.floating_base)
        .quaternions(arguments.quaternions);
    let mut task = Task::read(&arguments.problem, load)?;
    if let Some(limit) = arguments.time_limit {
        task.options = task.options.with_time_limit(limit);
    }
    if let Some(starts) = arguments.starts {
        task.options = task.options.with_starts(starts.get());
    }
    if let Some(threads) = arguments.threads {
        task.options = task.options.with_threads(threads.get());
    }
    if let Some(level) = arguments.verify {
        task.options = task.options.with_verify(level.into());
    }
    if let Some(when) = arguments.polish {
        task.options = task.options.with_polish(when.into());
    }
    if let Some(folder) = arguments.package_path.iter().find(|folder| !folder.is_dir()) {
        return Err(format!("--package-path: there is no folder {}", folder.display()).into());
    }
    let outputs = Outputs::prepare(arguments, &task.inputs)?;
    if let (Some(rate), FinalTime::Fixed(time), None) = (arguments.sample, task.problem.time, arguments.range)
    {
        Samples::count(time, rate).map_err(|error| format!("--sample: {error}"))?;
    }
    let format = task.robot_path.as_ref().and_then(|path| RobotFormat::of_path(path).ok());
    warn_of_urdf_flags(format, [arguments.friction, arguments.floating_base, arguments.quaternions]);
    terminal::about_robot(&task.problem.robot);
    for warning in task.problem.warnings() {
        if warning.is_note() { terminal::note(&warning) } else { terminal::warning(&warning) }
    }
    if let Some(key) = task.problem.keeps_robot_limits_by() {
        terminal::note(format!(
            "the limits of the robot are kept, since {} is given; limits.from_robot = false leaves them out",
            key.part()
        ));
    }
    if task.problem.leaves_out_robot_limits() {
        let why = task.problem.joint_without_limits().map_or_else(
            || "the problem has bounds or penalties of its own".into(),
            |joint| format!("joint '{}' has no limit of rate or effort", printable(joint)),
        );
        terminal::note(format!(
            "the limits of the robot are not kept, since [limits] is not given and {why}; limits.from_robot = true \
             keeps them"
        ));
    }
    let jumps = task.problem.jumps_at_rest();
    if !jumps.is_empty() {
        let keys: Vec<_> = jumps.iter().map(|end| format!("{end}.a = [0.0, ...]")).collect();
        terminal::note(format!(
            "accelerations are continuous, but free at the {}, where they jump from or to rest; {} avoids that",
            jumps.join(" and the "),
            keys.join(" and ")
        ));
    }

    let interrupt = Interrupt::listen()?;
    let (started, cpu_before) = (Instant::now(), cpu_time());
    let branch =
        arguments.range.map(|range| continuation::follow(&mut task, range, &interrupt)).transpose()?;
    let (solution, taken) = match &branch {
        Some(branch) => (branch.solution.clone(), Taken::since(started, cpu_before)),
        None => solve_repeatedly(&task, arguments, &interrupt)?,
    };
    let interrupted = interrupt.is_requested();

    let problem = &task.problem;
    let remarks = solution.remarks(problem);
    let options = ReportOptions::default().with_source(&task.text);
    let options = if arguments.output.is_some() {
        options.with_models(models::read(&task, arguments))
    } else {
        options
    };
    let sampled = |rate| samples::sample(problem, &solution, rate);
    // What cannot be sampled or fed back to is printed and written all the same; the error comes after it.
    let mut failed: Option<Box<dyn Error>> = None;
    let samples = arguments.sample.map(sampled).transpose().unwrap_or_else(|error| {
        failed = Some(format!("--sample: {error}").into());
        None
    });
    outputs.write((problem, &solution), &options, samples.as_ref())?;
    let is_solved = remarks.iter().all(|remark| !remark.is_error());
    if arguments.feedback.is_some() && !is_solved {
        terminal::warning("--feedback: nothing is written, since the motion is not solved");
    } else if arguments.feedback.is_some() && failed.is_none() {
        let text = feedback::feedback(&task, &solution, arguments.sample);
        failed = text.and_then(|text| outputs.write_feedback(&text)).err();
    }
    let derivatives = match arguments.sensitivities {
        true => match sensitivities::sensitivities(problem, &solution) {
            Ok(derivatives) => Some(derivatives),
            Err(error) => {
                terminal::warning(error);
                None
            }
        },
        false => None,
    };
    if interrupted {
        terminal::note("interrupted; the best motion so far was kept");
    }
    if arguments.json || outputs.use_standard_output() {
        for remark in &remarks {
            match remark.severity {
                Severity::Note => terminal::note(remark),
                _ => terminal::warning(remark),
            }
        }
    }
    if arguments.json {
        let continuation = branch.as_ref().map(continuation::Points::new);
        let samples = samples.as_ref();
        let sensitivities = derivatives.as_deref();
        let (stage_times, warnings) = (solution.stage_times, &remarks[..]);
        let printed = Printed {
            solution: &solution,
            warnings,
            taken,
            stage_times,
            continuation,
            samples,
            sensitivities,
        };
        writeln!(std::io::stdout().lock(), "{}", serde_json::to_string(&printed)?)?;
    } else if !outputs.use_standard_output() {
        let mut out = std::io::stdout().lock();
        if let Some(branch) = &branch {
            continuation::print(branch, &mut out)?;
        }
        summary::print(problem, &solution, taken.solve_time, &mut out)?;
        if arguments.iterations {
            summary::print_iterations(&solution, &mut out)?;
        }
        if let Some(derivatives) = &derivatives {
            sensitivities::print(derivatives, &mut out)?;
        }
    }
    if let Some(error) = failed {
        match is_solved && !interrupted {
            true => return Err(error),
            // The exit status tells what matters more.
            false => terminal::error(error),
        }
    }
    let reached = branch.as_ref().is_none_or(|branch| branch.end == BranchEnd::Reached);
    Ok(match (interrupted, is_solved && reached) {
        (true, _) => ExitCode::from(interrupt::EXIT_CODE),
        (false, true) => ExitCode::SUCCESS,
        (false, false) => ExitCode::from(NOT_SOLVED),
    })
}

/// What `--json` prints: the solution as it is saved, the time it took, the points of a continuation,
/// samples, and derivatives of the cost.
#[derive(serde::Serialize)]
struct Printed<'a> {
    #[serde(flatten)]
    solution: &'a Solution,
    /// What there is to say about it.
    warnings: &'a [Remark],
    #[serde(flatten)]
    taken: Taken,
    /// Parts of the time of solving (s).
    #[serde(skip_serializing_if = "Option::is_none")]
    stage_times: Option<StageTimes>,
    #[serde(skip_serializing_if = "Option::is_none")]
    continuation: Option<continuation::Points<'a>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    samples: Option<&'a Samples>,
    #[serde(skip_serializing_if = "Option::is_none")]
    sensitivities: Option<&'a [CostDerivative]>,
}

/// What solving took.
#[derive(Clone, Copy, serde::Serialize)]
struct Taken {
    /// Time of solving (s).
    solve_time: f64,
    /// CPU time of all threads (s).
    #[serde(skip_serializing_if = "Option::is_none")]
    solve_cpu_time: Option<f64>,
}

impl Taken {
    /// Since a time and a CPU time.
    fn since(started: Instant, cpu_before: Option<f64>) -> Self {
        let solve_cpu_time = cpu_time().zip(cpu_before).map(|(now, before)| now - before);
        Self { solve_time: started.elapsed().as_secs_f64(), solve_cpu_time }
    }

    /// The least of both.
    fn least(self, other: Self) -> Self {
        let both = self.solve_cpu_time.zip(other.solve_cpu_time);
        Self {
            solve_time: self.solve_time.min(other.solve_time),
            solve_cpu_time: both.map(|(one, other)| one.min(other)),
        }
    }
}

/// Solves the problem as often as asked for, or until a signal. The first solution, and the least times with
/// the parts of the least one.
fn solve_repeatedly(
    task: &Task,
    arguments: &Arguments,
    interrupt: &Interrupt,
) -> Result<(Solution, Taken), Box<dyn Error>> {
    let timed = || -> Result<(Solution, Taken), Box<dyn Error>> {
        let (started, cpu_before) = (Instant::now(), cpu_time());
        let solution = solve(task, arguments.times, interrupt)?;
        Ok((solution, Taken::since(started, cpu_before)))
    };
    let (mut first, mut least) = timed()?;
    for _ in 1..arguments.repeat.map_or(1, NonZeroUsize::get) {
        let (solution, taken) = timed()?;
        if interrupt.is_requested() {
            break;
        }
        if taken.solve_time < least.solve_time {
            first.stage_times = solution.stage_times;
        }
        least = least.least(taken);
    }
    Ok((first, least))
}

/// Solves the problem, with a progress line. A signal stops the search, which keeps the best iterate.
fn solve(task: &Task, takes_times: bool, interrupt: &Interrupt) -> Result<Solution, Box<dyn Error>> {
    let line = progress::Line::new(&task.problem.robot)?;
    let mut solver = Solver::new(&task.problem, task.options.clone())?;
    if let Some(start) = &task.start_from {
        solver = solver.with_start(start)?;
    }
    if takes_times {
        solver = solver.with_stage_times();
    }
    let solver = solver.on_iteration(|iteration| {
        line.show_iteration(iteration);
        interrupt.control_flow()
    });
    let solution = solver.solve();
    line.clear();
    Ok(solution)
}
