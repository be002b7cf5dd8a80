//! `costate bench`: the time of each quantity by each method on this machine.

mod batches;
mod clock;
#[cfg(feature = "jit")]
mod machine;
mod names;
mod routes;

use crate::arguments::RobotArguments;
use crate::interrupt::Interrupt;
use crate::report::{Table, title};
use crate::{Outcome, terminal};
use clock::{Spread, measure};
use costate::robot::Robot;
use names::states;
use routes::{Candidate, Failure, State, candidates};
use serde_json::json;
use std::io::Write;
use std::process::ExitCode;

#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    robot: RobotArguments,
    /// Batches of calls to time; the median is reported
    #[arg(long, value_name = "N", default_value_t = 31, value_parser = clap::value_parser!(u32).range(3..=10_000))]
    batches: u32,
    /// Seed of the random state
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// Print one JSON object instead of a table
    #[arg(long)]
    json: bool,
}

/// One line of the table.
struct Row {
    quantity: &'static str,
    route: &'static str,
    /// States computed by one call; the time is per state.
    states: usize,
    time: Spread,
    /// Largest difference from the first method for the quantity, relative to its largest entry.
    error: f64,
}

pub fn run(arguments: &Arguments) -> Outcome {
    let robot = arguments.robot.load_tree_and_warn()?;
    let interrupt = Interrupt::listen()?;
    let state = State::random(&robot, arguments.seed)?;
    let (mut candidates, notes) = all(&robot, &state)?;
    let mut errors = Vec::new();
    let mut judge: Vec<f64> = Vec::new();
    let mut judged = "";
    for candidate in &mut candidates {
        interrupt.check()?;
        let mut figures = Vec::new();
        (candidate.work)(Some(&mut figures))?;
        if candidate.quantity != judged {
            (judge, judged) = (figures.clone(), candidate.quantity);
        }
        errors.push(difference(&figures, &judge));
    }
    let batches = arguments.batches as usize;
    let bar = terminal::progress_bar((candidates.len() * (batches + 1)) as u64, "batches");
    let times = measure(&mut candidates, batches, &bar, &interrupt);
    bar.finish_and_clear();
    let times = times?;
    let rows = candidates.iter().zip(times).zip(errors).map(|((candidate, time), error)| {
        let Candidate { quantity, route, .. } = *candidate;
        let states = states(route);
        Row { quantity, route, states, time: time.divided_by(states), error }
    });
    let rows: Vec<Row> = rows.collect();
    if arguments.json {
        writeln!(std::io::stdout().lock(), "{}", as_json(&robot, arguments, &rows, &notes))?;
    } else {
        print(&robot, arguments, &rows, &notes, &mut terminal::stdout())?;
    }
    Ok(ExitCode::SUCCESS)
}

/// All candidates, grouped by quantity, and notes on missing methods.
fn all<'a>(robot: &Robot, state: &'a State) -> Result<(Vec<Candidate<'a>>, Vec<String>), Failure> {
    let mut notes = Vec::new();
    let mut list = candidates(robot, state, &mut notes)?;
    #[cfg(feature = "jit")]
    machine::candidates(robot, state, &mut list, &mut notes)?;
    #[cfg(not(feature = "jit"))]
    notes.push("No machine code: built without the feature jit.".into());
    if robot.free_joints().is_empty() {
        batches::candidates(robot, state, &mut list, &mut notes);
    }
    let quantities: Vec<_> = list.iter().map(|candidate| candidate.quantity).collect();
    list.sort_by_key(|candidate| quantities.iter().position(|quantity| *quantity == candidate.quantity));
    Ok((list, notes))
}

/// `max |a - b| / max |b|`; NaN if a or b contains NaN.
fn difference(a: &[f64], b: &[f64]) -> f64 {
    let scale = b.iter().fold(0.0, |most: f64, b| most.max(b.abs()));
    let worst = a
        .iter()
        .zip(b)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, |most: f64, error| if error.is_nan() || error > most { error } else { most });
    if scale > 0.0 { worst / scale } else { worst }
}

/// Vector instructions for which this program was compiled.
fn instructions() -> &'static str {
    if cfg!(target_feature = "avx512f") {
        "AVX-512"
    } else if cfg!(all(target_feature = "avx2", target_feature = "fma")) {
        "AVX2 and FMA"
    } else {
        "the target's baseline (RUSTFLAGS=\"-C target-cpu=native\" compiles for this processor)"
    }
}

fn as_json(robot: &Robot, arguments: &Arguments, rows: &[Row], notes: &[String]) -> serde_json::Value {
    let row = |row: &Row| {
        json!({
            "quantity": row.quantity, "route": row.route, "states": row.states, "median_ns": row.time.median,
            "q25_ns": row.time.q25, "q75_ns": row.time.q75, "relative_error": row.error,
        })
    };
    json!({
        "robot": robot.name(),
        "n": robot.dof(),
        "batches": arguments.batches,
        "instructions": instructions(),
        "rows": rows.iter().map(row).collect::<Vec<_>>(),
        "notes": notes,
    })
}

fn print(
    robot: &Robot,
    arguments: &Arguments,
    rows: &[Row],
    notes: &[String],
    out: &mut impl Write,
) -> std::io::Result<()> {
    writeln!(
        out,
        "{}: time per state in f64, on one thread unless stated; medians of {} batches, methods alternating;\ncompiled for {}\n",
        title(robot),
        arguments.batches,
        instructions()
    )?;
    let header = ["quantity", "method", "ns", "quartiles", "/ F", "relative error"];
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
    writeln!(
        out,
        "  Timed: one call with an existing workspace, from q, p, u (and y) to the filled arrays."
    )?;
    writeln!(
        out,
        "  Relative error: max |a - b| / max |b|, where b is the result of the first method for the same quantity."
    )?;
    writeln!(
        out,
        "  If one call computes several states, its time is divided by their number. Batches use node-major arrays."
    )?;
    writeln!(
        out,
        "  Machine code for one state makes the same checks as the generic code; for 4 states it makes none."
    )?;
    notes.iter().try_for_each(|note| writeln!(out, "  {note}"))
}

#[cfg(test)]
mod tests {
    use super::difference;

    #[test]
    fn a_difference_is_relative_and_keeps_nan() {
        assert_eq!(difference(&[1.0, 4.0], &[1.0, 2.0]), 1.0);
        assert_eq!(difference(&[0.0], &[0.0]), 0.0);
        assert!(difference(&[f64::NAN, 1.0], &[1.0, 1.0]).is_nan());
    }
}
