//! `--continue PARAMETER=FROM:TO`: solutions as a parameter of the problem changes.

use super::report::numbers::short;
use super::summary::spaced;
use super::task::Task;
use crate::report::Table;
use costate_control::{Branch, BranchEnd, BranchPoint, Continuation, Parameter, TurningPoint};
use serde::Serialize;
use std::io::Write;
use std::str::FromStr;

/// A parameter and the values between which it goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Way {
    parameter: Parameter,
    from: f64,
    to: f64,
}

impl FromStr for Way {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let form = || "give PARAMETER=FROM:TO, for example gravity=0:1".to_owned();
        let (name, values) = text.split_once('=').ok_or_else(form)?;
        let (from, to) = values.split_once(':').ok_or_else(form)?;
        let number =
            |text: &str| text.trim().parse::<f64>().map_err(|_| format!("'{text}' is no number; {}", form()));
        Ok(Self { parameter: name.trim().parse()?, from: number(from)?, to: number(to)? })
    }
}

/// Follows the branch; the task becomes the problem of its last point.
pub fn follow(task: &mut Task, way: Way) -> Result<Branch, String> {
    let Way { parameter, from, to } = way;
    let continuation = Continuation::new(&task.problem, parameter, from, to, task.options.clone());
    let mut continuation = continuation.map_err(|error| format!("--continue: {error}"))?;
    if let Some(start) = &task.start_from {
        continuation = continuation.with_start(start).map_err(|error| format!("start_from.file: {error}"))?;
    }
    let branch = continuation.follow();
    let last = branch.points.last().map_or(from, |point| point.parameter);
    task.problem = parameter.apply(&task.problem, last).map_err(|error| error.to_string())?;
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

/// The table of the points, turning points at their places.
pub fn print(branch: &Branch, out: &mut impl Write) -> std::io::Result<()> {
    let name = spaced(branch.parameter.name());
    let header = [name.as_str(), "cost", "penalties", "final time s", "H*", "Newton steps"];
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
    let end = match branch.end {
        BranchEnd::Reached => "the value asked for was reached",
        BranchEnd::TurnedBack => "the branch turned back to where it began, on another solution",
        BranchEnd::TooManyPoints => "more points than allowed",
        BranchEnd::NotStarted => "the problem was not solved where the way begins",
        _ => "no step was small enough",
    };
    writeln!(out, "{table}\n  {end}\n")
}

#[cfg(test)]
mod tests {
    use super::Way;
    use costate_control::Parameter;

    #[test]
    fn a_way_is_a_name_and_two_numbers() {
        let way = "final_time=1.5:3".parse::<Way>().unwrap();
        assert_eq!(way, Way { parameter: Parameter::FinalTime, from: 1.5, to: 3.0 });
        for (text, told) in [
            ("gravity", "FROM:TO"),
            ("gravity=1", "FROM:TO"),
            ("gravity=a:1", "'a'"),
            ("mass=0:1", "armature"),
        ] {
            let message = text.parse::<Way>().unwrap_err();
            assert!(message.contains(told), "{message}");
        }
    }
}
