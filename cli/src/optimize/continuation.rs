//! `--continue PARAMETER=FROM:TO`: the solution while a parameter of the problem changes.

use super::progress::Line;
use super::task::Task;
use crate::interrupt::Interrupt;
use crate::report::{Table, counted};
use costate_control::{
    Branch, BranchEnd, BranchPoint, Continuation, Parameter, Status, TurningPoint, UnknownParameter,
};
use costate_report::numbers::short;
use costate_report::text::spaced;
use serde::Serialize;
use std::error::Error;
use std::io::Write;
use std::str::FromStr;
use std::sync::atomic::{AtomicUsize, Ordering};

/// A parameter, its first value and its last.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParameterRange {
    parameter: Parameter,
    from: f64,
    to: f64,
}

impl FromStr for ParameterRange {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let form = || "give PARAMETER=FROM:TO, for example gravity=0:1".to_owned();
        let (name, values) = text.split_once('=').ok_or_else(form)?;
        let (from, to) = values.split_once(':').ok_or_else(form)?;
        let number = |text: &str| {
            text.trim().parse::<f64>().map_err(|_| format!("'{text}' is not a number; {}", form()))
        };
        let parameter = name.trim().parse().map_err(|error: UnknownParameter| error.to_string())?;
        Ok(Self { parameter, from: number(from)?, to: number(to)? })
    }
}

/// Follows the branch; the task becomes the problem of its last point. A signal stops at the last point.
pub fn follow(
    task: &mut Task,
    range: ParameterRange,
    interrupt: &Interrupt,
) -> Result<Branch, Box<dyn Error>> {
    let ParameterRange { parameter, from, to } = range;
    let continuation = Continuation::new(&task.problem, parameter, from, to, task.options.clone());
    let mut continuation = continuation.map_err(|error| format!("--continue: {error}"))?;
    if let Some(start) = &task.start_from {
        continuation = continuation.with_start(start)?;
    }
    let line = Line::new(&task.problem.robot)?;
    let count = AtomicUsize::new(0);
    let continuation = continuation
        .on_iteration(|iteration| {
            // Until the first point, the steps show how far the solve is.
            if count.load(Ordering::Relaxed) == 0 {
                line.show_iteration(iteration);
            }
            interrupt.control_flow()
        })
        .on_point(|point| {
            let number = 1 + count.fetch_add(1, Ordering::Relaxed);
            line.show_point(number, parameter, point);
            interrupt.control_flow()
        });
    let branch = continuation.follow();
    line.clear();
    let last = branch.points.last().map_or(from, |point| point.parameter);
    task.problem = parameter.apply(&task.problem, last)?;
    Ok(branch)
}

/// A branch as JSON.
#[derive(Serialize)]
pub struct Points<'a> {
    parameter: Parameter,
    end: &'a BranchEnd,
    points: &'a [BranchPoint],
    turning_points: &'a [TurningPoint],
}

impl<'a> Points<'a> {
    pub fn new(branch: &'a Branch) -> Self {
        let Branch { parameter, points, turning_points, end, .. } = branch;
        Self { parameter: *parameter, end, points, turning_points }
    }
}

/// The table of the points, with the turning points between them.
pub fn print(branch: &Branch, out: &mut impl Write) -> std::io::Result<()> {
    let name = spaced(branch.parameter.name());
    let header = [name.as_str(), "cost", "penalties", "final time (s)", "H* (cost/s)", "Newton steps"];
    let mut table = Table::new(&header, 0);
    for (i, point) in branch.points.iter().enumerate() {
        for turn in branch.turning_points.iter().filter(|turn| turn.after == i) {
            let turn_row = [turn.parameter, turn.cost].map(|x| short(x, 9));
            let mut row = turn_row.to_vec();
            row.extend(["".into(), short(turn.final_time, 7), "turning point".into(), "".into()]);
            table.row(row);
        }
        table.row(vec![
            short(point.parameter, 9),
            short(point.cost, 9),
            short(point.penalty_cost, 6),
            short(point.final_time, 7),
            short(point.hamiltonian, 7),
            point.newton_steps.to_string(),
        ]);
    }
    let points = counted(branch.points.len(), "point");
    let end = match (branch.end.clone(), &branch.solution.motion.status) {
        (BranchEnd::Reached, _) => "the last value was reached",
        (BranchEnd::TurnedBack, _) => "the branch turned back to the first value, with another solution",
        (BranchEnd::TooManyPoints, _) => "stopped at the largest number of points",
        (BranchEnd::NotStarted, Status::TimeLimit) => "stopped by the time limit before the first point",
        (BranchEnd::NotStarted, Status::Cancelled) => "interrupted before the first point",
        (BranchEnd::NotStarted, _) => "the problem was not solved at the first value",
        (BranchEnd::Interrupted, Status::TimeLimit) => "stopped by the time limit",
        (BranchEnd::Interrupted, _) => "interrupted",
        _ => "stopped: no step was small enough",
    };
    if branch.points.is_empty() {
        return writeln!(out, "  {points}: {end}\n");
    }
    writeln!(out, "{table}\n  {points}: {end}\n")
}

#[cfg(test)]
mod tests {
    use super::ParameterRange;
    use costate_control::Parameter;

    #[test]
    fn a_range_is_a_parameter_and_two_numbers() {
        let range = "final_time=1.5:3".parse::<ParameterRange>().unwrap();
        assert_eq!(range, ParameterRange { parameter: Parameter::FinalTime, from: 1.5, to: 3.0 });
        for (text, part) in [
            ("gravity", "FROM:TO"),
            ("gravity=1", "FROM:TO"),
            ("gravity=a:1", "'a'"),
            ("mass=0:1", "armature"),
        ] {
            let message = text.parse::<ParameterRange>().unwrap_err();
            assert!(message.contains(part), "{message}");
        }
    }
}
