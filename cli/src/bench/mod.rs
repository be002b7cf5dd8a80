//! `costate bench`: times of each quantity by each route, on this machine.

mod clock;
mod routes;

use crate::report::{Table, joints};
use crate::{Outcome, RobotArguments};
use clock::{Spread, measure};
use costate::robot::Robot;
use routes::{Candidate, State, candidates};
use serde_json::json;
use std::io::Write;
use std::process::ExitCode;

#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    robot: RobotArguments,
    /// Batches of which the median is taken
    #[arg(long, default_value_t = 31, value_parser = clap::value_parser!(u32).range(3..=10_000))]
    batches: u32,
    /// Seed of the random state
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Print one JSON object and nothing else
    #[arg(long)]
    json: bool,
}

/// One line of the table.
struct Row {
    quantity: &'static str,
    route: &'static str,
    time: Spread,
    /// Greatest difference from the figures of the first route to the quantity, relative to its greatest entry.
    error: f64,
}

pub fn run(arguments: &Arguments) -> Outcome {
    let robot = arguments.robot.load_and_warn()?;
    let state = State::random(&robot, arguments.seed)?;
    let mut candidates = candidates(&robot, &state);
    let mut errors = Vec::new();
    let mut judge: Vec<f64> = Vec::new();
    let mut judged = "";
    for candidate in &mut candidates {
        let mut figures = Vec::new();
        (candidate.work)(Some(&mut figures))?;
        if candidate.quantity != judged {
            (judge, judged) = (figures.clone(), candidate.quantity);
        }
        errors.push(difference(&figures, &judge));
    }
    let mut out = std::io::stdout().lock();
    let times = measure(&mut candidates, arguments.batches as usize)?;
    let rows = candidates.iter().zip(times).zip(errors).map(|((candidate, time), error)| {
        let Candidate { quantity, route, .. } = candidate;
        Row { quantity, route, time, error }
    });
    let rows: Vec<Row> = rows.collect();
    if arguments.json {
        writeln!(out, "{}", as_json(&robot, arguments, &rows))?;
    } else {
        print(&robot, arguments, &rows, &mut out)?;
    }
    Ok(ExitCode::SUCCESS)
}

/// `max |a - b| / max |b|`; not a number where one of them holds one.
fn difference(a: &[f64], b: &[f64]) -> f64 {
    let scale = b.iter().fold(0.0, |most: f64, b| most.max(b.abs()));
    let worst = a
        .iter()
        .zip(b)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, |most: f64, error| if error.is_nan() || error > most { error } else { most });
    if scale > 0.0 { worst / scale } else { worst }
}

/// Instructions that the program was compiled for.
fn instructions() -> &'static str {
    if cfg!(target_feature = "avx512f") {
        "AVX-512"
    } else if cfg!(all(target_feature = "avx2", target_feature = "fma")) {
        "AVX2 and FMA"
    } else {
        "the target's baseline (RUSTFLAGS=\"-C target-cpu=native\" compiles for this processor)"
    }
}

fn as_json(robot: &Robot, arguments: &Arguments, rows: &[Row]) -> serde_json::Value {
    let row = |row: &Row| {
        json!({
            "quantity": row.quantity, "route": row.route, "median_ns": row.time.median,
            "q25_ns": row.time.q25, "q75_ns": row.time.q75, "relative_error": row.error,
        })
    };
    json!({
        "robot": robot.name(),
        "n": robot.len(),
        "batches": arguments.batches,
        "instructions": instructions(),
        "rows": rows.iter().map(row).collect::<Vec<_>>(),
    })
}

fn print(robot: &Robot, arguments: &Arguments, rows: &[Row], out: &mut impl Write) -> std::io::Result<()> {
    writeln!(
        out,
        "{}, {}: one state, one thread, f64; medians of {} batches, all routes in turn;\ncompiled for {}\n",
        robot.name(),
        joints(robot),
        arguments.batches,
        instructions()
    )?;
    let header = ["quantity", "route", "ns", "quartiles", "/ F", "relative error"];
    let mut table = Table::new(&header, 2);
    let f = rows.first().map_or(f64::NAN, |row| row.time.median);
    let mut above = "";
    for row in rows {
        let first = row.quantity != above;
        above = row.quantity;
        table.row(vec![
            if first { row.quantity.into() } else { String::new() },
            row.route.into(),
            format!("{:.0}", row.time.median),
            format!("{:.0} .. {:.0}", row.time.q25, row.time.q75),
            format!("{:.2}", row.time.median / f),
            if first { String::new() } else { format!("{:.0e}", row.error) },
        ]);
    }
    writeln!(out, "{table}")?;
    writeln!(out, "  Timed: one call on a built workspace, from q, p, u (and y) to the filled arrays.")?;
    writeln!(out, "  Relative error: max |a - b| / max |b|, b by the first route to the same quantity.")
}

#[cfg(test)]
mod tests {
    use super::difference;

    #[test]
    fn a_difference_is_relative_and_never_hides_what_is_no_number() {
        assert_eq!(difference(&[1.0, 4.0], &[1.0, 2.0]), 1.0);
        assert_eq!(difference(&[0.0], &[0.0]), 0.0);
        assert!(difference(&[f64::NAN, 1.0], &[1.0, 1.0]).is_nan());
    }
}
