//! A solution for people, on standard output.

use super::report::numbers::short;
use crate::report::{Table, joints};
use costate_control::{Certificate, Iteration, Motion, Problem, Solution};
use std::io::Write;

/// `minimum of T + 1/2 u'Ru, final time free`, by what the problem has.
pub fn criterion(problem: &Problem) -> String {
    let effort = problem.cost.effort.iter().any(|&r| r != 0.0);
    let time = match problem.cost.time {
        0.0 => None,
        1.0 => Some("T".to_owned()),
        weight => Some(format!("{} T", short(weight, 6))),
    };
    let terms = [time, effort.then(|| "\u{222b} \u{bd} \u{3a3} r\u{1d62} u\u{1d62}\u{b2} dt".to_owned())];
    let terms: Vec<_> = terms.into_iter().flatten().collect();
    let minimum = if terms.is_empty() { "0".into() } else { terms.join(" + ") };
    let time = if super::time_is_free(problem) { "final time free" } else { "final time fixed" };
    let bounds = if problem.bounds.is_some() { ", actuation bounded" } else { "" };
    let penalty = if problem.penalty.is_some() { ", with penalties" } else { "" };
    format!("minimum of {minimum}, {time}{bounds}{penalty}")
}

/// Name and value of each figure of a solution.
pub fn figures(problem: &Problem, solution: &Solution) -> Vec<(&'static str, String)> {
    let mut figures = vec![("cost", short(solution.motion.cost, 12))];
    if problem.penalty.is_some() {
        figures.push(("cost of penalties", short(solution.motion.penalty_cost, 6)));
    }
    if solution.motion.smoothing > 0.0 {
        figures.push(("smoothing left", small(solution.motion.smoothing)));
    }
    figures.extend([
        ("final time", format!("{} s", short(solution.motion.final_time, 10))),
        ("H*", short(solution.motion.hamiltonian, 10)),
        ("drift of H*", small(solution.motion.hamiltonian_drift)),
        ("end defect", small(solution.end_defect)),
        ("shooting defect", small(solution.motion.shooting_defect)),
        ("Newton iterations", solution.newton_iterations.to_string()),
        ("mesh nodes", solution.nodes().to_string()),
        ("conjugate time", conjugate(problem, &solution.motion)),
    ]);
    if !solution.motion.switches.is_empty() {
        figures.push(("switches", solution.motion.switches.len().to_string()));
    }
    figures
}

/// Jacobi fields compare motions that take the same time.
fn conjugate(problem: &Problem, motion: &Motion) -> String {
    match (motion.conjugate_time, motion.certificate) {
        (Some(time), _) => format!("{} s: not a minimum", short(time, 8)),
        (None, Certificate::LocalMinimum) if super::time_is_free(problem) => {
            "none: a local minimum in this time".into()
        }
        (None, Certificate::LocalMinimum) => "none: a local minimum".into(),
        _ => "not checked".into(),
    }
}

/// A name without underscores.
pub fn spaced(name: &str) -> String {
    name.replace('_', " ")
}

/// Two digits of what should be nothing.
fn small(x: f64) -> String {
    if x == 0.0 { "0".into() } else { format!("{x:.1e}") }
}

/// Header of the table of iterations.
pub const ITERATION_HEADER: [&str; 7] =
    ["phase", "nodes", "iteration", "residual", "step", "final time s", "cost"];

/// A row of the table of iterations.
pub fn iteration_row(iteration: &Iteration) -> Vec<String> {
    vec![
        iteration.phase.to_string(),
        iteration.nodes.to_string(),
        iteration.number.to_string(),
        small(iteration.residual),
        short(iteration.step, 3),
        short(iteration.final_time, 7),
        short(iteration.cost, 9),
    ]
}

/// The solution, its figures and the other starts.
pub fn print(
    problem: &Problem,
    solution: &Solution,
    seconds: f64,
    out: &mut impl Write,
) -> std::io::Result<()> {
    let robot = &problem.robot;
    writeln!(out, "{}, {}: {}\n", robot.name(), joints(robot), criterion(problem))?;
    let mut table = Table::new(&["status", &spaced(solution.motion.status.name())], 2);
    for (name, value) in figures(problem, solution) {
        table.row(vec![name.into(), value]);
    }
    table.row(vec!["time of solving".into(), format!("{} s", short(seconds, 3))]);
    write!(out, "{table}")?;
    if !solution.motion.status.is_solved() {
        writeln!(out, "\n  Not a solution but the best iterate: {}.", solution.motion.status)?;
    }
    if solution.starts.len() > 1 {
        writeln!(out)?;
        let mut table = Table::new(&["start", "status", "cost and penalties"], 2);
        for (number, start) in solution.starts.iter().enumerate() {
            let status = start.status.name();
            table.row(vec![(number + 1).to_string(), status.into(), short(start.total, 12)]);
        }
        write!(out, "{table}")?;
    }
    Ok(())
}

/// The Newton steps.
pub fn print_iterations(solution: &Solution, out: &mut impl Write) -> std::io::Result<()> {
    let mut table = Table::new(&ITERATION_HEADER, 1);
    solution.motion.iterations.iter().for_each(|iteration| table.row(iteration_row(iteration)));
    write!(out, "\n{table}")
}
