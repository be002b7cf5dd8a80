//! Does the exact Hessian make searches for optimal motions more robust? The study behind
//! `docs/robustness.md`.
//!
//! Every search of the study is one line of `results.jsonl`. The command runs those that are missing there,
//! then shows the tables; it can be stopped at any time and goes on where it was.

mod counted;
mod judge;
mod page;
mod problems;
mod record;
mod run;
mod statistics;
mod tables;

use record::{Results, study};
use std::error::Error;
use std::path::{Path, PathBuf};

const HELP: &str = "\
costate-robustness [--write] [--limit N] [--results FILE]

  --write          puts the tables into docs/robustness.md
  --limit N        runs at most N of the missing searches
  --results FILE   in place of benches/robustness/results.jsonl
";

/// Where the crate lies.
const FOLDER: &str = env!("CARGO_MANIFEST_DIR");

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let (mut write, mut limit) = (false, usize::MAX);
    let mut file = PathBuf::from(FOLDER).join("results.jsonl");
    while let Some(argument) = arguments.next() {
        let mut value = || arguments.next().ok_or(format!("{argument} needs a value; see --help"));
        match argument.as_str() {
            "--write" => write = true,
            "--limit" => limit = value()?.parse().map_err(|error| format!("--limit: {error}"))?,
            "--results" => file = value()?.into(),
            "--help" => {
                print!("{HELP}");
                return Ok(());
            }
            other => return Err(format!("unknown argument {other}; see --help").into()),
        }
    }
    let mut results = Results::open(&file)?;
    let missing: Vec<_> = study().filter(|search| !results.holds(search)).take(limit).collect();
    for (number, search) in missing.iter().enumerate() {
        let record = run::run(search)?;
        eprintln!("{}/{} {} {:.0} ms", number + 1, missing.len(), search, record.milliseconds);
        results.add(record)?;
    }
    let text = tables::tables(&results.records)?;
    if write {
        page::put(&Path::new(FOLDER).join("../../docs/robustness.md"), &text)?;
    } else {
        println!("{text}");
    }
    Ok(())
}
