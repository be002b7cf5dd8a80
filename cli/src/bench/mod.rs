//! `costate bench`: times of each quantity by each route, on this machine.

mod batches;
mod clock;
#[cfg(feature = "jit")]
mod machine;
mod routes;

use crate::report::{Table, joints};
use crate::{Outcome, RobotArguments};
use clock::{Spread, measure};
use costate::robot::Robot;
use routes::{Candidate, Failure, State, candidates};
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
    /// How many states one call computes; the time is that of one of them.
    states: usize,
    time: Spread,
    /// Greatest difference from the figures of the first route to the quantity, relative to its greatest entry.
    error: f64,
}

pub fn run(arguments: &Arguments) -> Outcome {
    let robot = arguments.robot.load_and_warn()?;
    let state = State::random(&robot, arguments.seed)?;
    let (mut candidates, notes) = all(&robot, &state)?;
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
        let Candidate { quantity, route, .. } = *candidate;
        let states = states(route);
        Row { quantity, route, states, time: time.divided_by(states), error }
    });
    let rows: Vec<Row> = rows.collect();
    if arguments.json {
        writeln!(out, "{}", as_json(&robot, arguments, &rows, &notes))?;
    } else {
        print(&robot, arguments, &rows, &notes, &mut out)?;
    }
    Ok(ExitCode::SUCCESS)
}

/// Machine code for vectors of four numbers.
const FOUR: &str = "machine code, 4 states at once";
/// Batches on one thread.
const LANES_4: &str = "batch over F64x4";
const LANES_8: &str = "batch over F64x8";
/// Batches over lanes as wide as pay on this processor, and over all threads.
const THREADS: &str = "batch over lanes and threads";

/// How many states one call of a route computes.
fn states(route: &str) -> usize {
    match route {
        FOUR => 4,
        LANES_4 | LANES_8 => 16,
        THREADS => 512,
        _ => 1,
    }
}

/// All that is timed, quantity by quantity, and which routes are not there, and why.
fn all<'a>(robot: &Robot, state: &'a State) -> Result<(Vec<Candidate<'a>>, Vec<String>), Failure> {
    let (mut list, mut notes) = (candidates(robot, state), Vec::new());
    #[cfg(feature = "jit")]
    machine::candidates(robot, state, &mut list, &mut notes)?;
    #[cfg(not(feature = "jit"))]
    notes.push("No machine code: built without the feature jit.".into());
    batches::candidates(robot, state, &mut list, &mut notes);
    let quantities: Vec<_> = list.iter().map(|candidate| candidate.quantity).collect();
    list.sort_by_key(|candidate| quantities.iter().position(|quantity| *quantity == candidate.quantity));
    Ok((list, notes))
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
        "{}, {}: time of one state in f64, on one thread unless said; medians of {} batches, all routes in turn;\ncompiled for {}\n",
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
    writeln!(out, "  Relative error: max |a - b| / max |b|, b by the first route to the same quantity.")?;
    writeln!(
        out,
        "  Several states in one call: its time by their number. Batches: from and to node-major arrays."
    )?;
    writeln!(
        out,
        "  Machine code for one state checks what the generic code checks, that for 4 states nothing."
    )?;
    notes.iter().try_for_each(|note| writeln!(out, "  {note}"))
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
