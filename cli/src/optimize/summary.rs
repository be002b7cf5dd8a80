//! A solution as text: heading, figures, why it is none, tables.

use crate::report::{Table, title};
use costate::robot::escape_hidden;
use costate_control::{Problem, Severity, Solution};
use costate_report::figures::figures;
use costate_report::numbers::short;
use costate_report::text::{
    ITERATION_HEADER, criterion, iteration_row, sentence, start_header, start_row, status,
};
use std::io::Write;

/// Heading, figures, why it is not a solution, and all starts.
pub fn print(
    problem: &Problem,
    solution: &Solution,
    seconds: f64,
    out: &mut impl Write,
) -> std::io::Result<()> {
    let ended = &solution.motion.status;
    writeln!(out, "{}: {}\n", title(&problem.robot), criterion(problem, solution))?;
    let mut table = Table::new(&["status", &status(ended)], 2).wrapping();
    for (name, value) in figures(problem, solution) {
        table.row(vec![name.into(), value]);
    }
    table.row(vec!["time of solving".into(), format!("{} s", short(seconds, 3))]);
    let stages = solution.stage_times.as_ref();
    // Checks of the problem, the line of progress, memory. Threads count each for itself: then all stages
    // together take longer than the wall clock, and nothing is left.
    let rest = stages.map(|times| ("rest", (seconds - times.total()).max(0.0)));
    let all = stages.map_or(seconds, |times| times.total().max(seconds));
    for (stage, time) in stages.iter().flat_map(|times| times.named()).chain(rest) {
        let share = 100.0 * time / all;
        table.row(vec![format!("  {stage}"), format!("{} s, {share:.0} %", short(time, 3))]);
    }
    write!(out, "{table}")?;
    for remark in solution.remarks(problem) {
        let text = match remark.severity {
            // The first line is about the status.
            Severity::Error => sentence(&remark.text),
            severity => format!("{}: {}", sentence(severity.name()), remark.text),
        };
        writeln!(out, "\n  {}.", escape_hidden(&text))?;
    }
    if solution.starts.len() > 1 {
        let mut table = Table::new(&start_header(solution), 2);
        solution.starts.iter().enumerate().for_each(|(i, start)| table.row(start_row(i, start)));
        write!(out, "\n{table}")?;
    }
    Ok(())
}

/// The Newton steps.
pub fn print_iterations(solution: &Solution, out: &mut impl Write) -> std::io::Result<()> {
    let mut table = Table::new(&ITERATION_HEADER, 1);
    solution.motion.iterations.iter().for_each(|iteration| table.row(iteration_row(iteration)));
    write!(out, "\n{table}")
}
