//! Solves random motions of all kinds with default options, and judges each that is called converged without
//! the solver's own code: its cost by adaptive quadrature, the cost on a finer mesh, limits between points.
//!
//! Every motion is one line of the results. The command runs those that are missing there, then prints the
//! table; it can be stopped at any time and goes on where it was. Problems of wrong answers are kept as
//! files for `costate optimize`.

mod apart;
mod clearance;
mod cost;
mod draw;
mod finer;
mod folder;
mod judge;
mod kinds;
mod limits;
mod moving;
mod quadrature;
mod record;
mod references;
mod robots;
mod table;
mod text;

use folder::FOLDER;
use record::{Record, Results};
use std::error::Error;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

const HELP: &str = "\
costate-random-motions [--count N] [--seed N] [--only KIND] [--threads N] [--time-limit S]
                       [--results FILE] [--problems FOLDER] [--keep] [--write] [--judge FILE]

  --count N          motions, numbers 0 to N - 1 (1000)
  --seed N           of the random numbers (1)
  --from N           first number (0)
  --only KIND        only those of this kind among them
  --threads N        motions at a time (1)
  --time-limit S     of each solve, in s (30)
  --results FILE     in place of target/random_motions/results.jsonl
  --problems FOLDER  where problems of wrong answers are kept (target/random_motions)
  --keep             keeps all problems
  --write            puts the table into benches/random_motions/README.md
  --judge FILE       judges this problem file alone and prints its line
";

struct Arguments {
    count: usize,
    from: usize,
    seed: u64,
    only: Option<String>,
    threads: usize,
    limit: Duration,
    results: PathBuf,
    problems: PathBuf,
    keep: bool,
    write: bool,
    judge: Option<PathBuf>,
}

fn arguments() -> Result<Option<Arguments>, String> {
    let folder = Path::new(FOLDER).join("../../target/random_motions");
    let mut found = Arguments {
        count: 1000,
        from: 0,
        seed: 1,
        only: None,
        threads: 1,
        limit: Duration::from_secs(30),
        results: folder.join("results.jsonl"),
        problems: folder,
        keep: false,
        write: false,
        judge: None,
    };
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        let mut value = || arguments.next().ok_or(format!("{argument} needs a value; see --help"));
        let bad = |error: &dyn std::fmt::Display| format!("{argument}: {error}");
        match argument.as_str() {
            "--count" => found.count = value()?.parse().map_err(|error| bad(&error))?,
            "--from" => found.from = value()?.parse().map_err(|error| bad(&error))?,
            "--seed" => found.seed = value()?.parse().map_err(|error| bad(&error))?,
            "--threads" => found.threads = value()?.parse().map_err(|error| bad(&error))?,
            "--time-limit" => {
                let seconds = value()?.parse().map_err(|error| bad(&error))?;
                found.limit = Duration::try_from_secs_f64(seconds).map_err(|error| bad(&error))?;
            }
            "--only" => found.only = Some(value()?),
            "--results" => found.results = value()?.into(),
            "--problems" => found.problems = value()?.into(),
            "--judge" => found.judge = Some(value()?.into()),
            "--keep" => found.keep = true,
            "--write" => found.write = true,
            "--help" => return Ok(None),
            other => return Err(format!("unknown argument {other}; see --help")),
        }
    }
    if let Some(only) = &found.only
        && !kinds::KINDS.iter().any(|kind| kind.name == only)
    {
        let names: Vec<&str> = kinds::KINDS.iter().map(|kind| kind.name).collect();
        return Err(format!("--only {only}: the kinds are {}", names.join(", ")));
    }
    Ok(Some(found))
}

fn main() -> Result<(), Box<dyn Error>> {
    let Some(arguments) = arguments()? else {
        print!("{HELP}");
        return Ok(());
    };
    if let Some(path) = &arguments.judge {
        let print = |record: &Record| match serde_json::to_string(record) {
            Ok(line) => println!("{line}"),
            Err(error) => eprintln!("{error}"),
        };
        print(&judge::judge(path, arguments.limit, print));
        return Ok(());
    }
    std::fs::create_dir_all(&arguments.problems)?;
    let results = Results::open(&arguments.results)?;
    let missing: Vec<usize> = (arguments.from..arguments.count)
        .filter(|&number| !results.hold(arguments.seed, number))
        .filter(|&number| {
            let name = kinds::of(arguments.seed, number).name;
            arguments.only.as_ref().is_none_or(|only| only == name)
        })
        .collect();
    let results = Mutex::new(results);
    let next = AtomicUsize::new(0);
    let failed: Mutex<Option<String>> = Mutex::new(None);
    std::thread::scope(|scope| {
        for _ in 0..arguments.threads.max(1) {
            scope.spawn(|| {
                while let Some(&number) = missing.get(next.fetch_add(1, Ordering::Relaxed)) {
                    if let Err(error) = one(&arguments, number, &results) {
                        failed.lock().unwrap_or_else(std::sync::PoisonError::into_inner).replace(error);
                        return;
                    }
                }
            });
        }
    });
    if let Some(error) = failed.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner) {
        return Err(error.into());
    }
    let results = results.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
    let shown: Vec<_> =
        results.records.iter().filter(|record| record.seed == arguments.seed).cloned().collect();
    let text = table::table(&shown);
    println!("{text}\n{}", table::faults(&shown));
    if arguments.write {
        put(&Path::new(FOLDER).join("README.md"), &text)?;
    }
    Ok(())
}

const BEGIN: &str = "<!-- tables: begin, written by costate-random-motions --write -->";
const END: &str = "<!-- tables: end -->";

/// Puts the table between the marks of a document.
fn put(path: &Path, table: &str) -> Result<(), String> {
    let named = |error: std::io::Error| format!("{}: {error}", path.display());
    let old = std::fs::read_to_string(path).map_err(named)?;
    let (before, rest) = old.split_once(BEGIN).ok_or(format!("{}: no line {BEGIN}", path.display()))?;
    let (_, after) = rest.split_once(END).ok_or(format!("{}: no line {END}", path.display()))?;
    std::fs::write(path, format!("{before}{BEGIN}\n\n{table}\n{END}{after}")).map_err(named)
}

/// Draws, solves and judges one motion.
fn one(arguments: &Arguments, number: usize, results: &Mutex<Results>) -> Result<(), String> {
    let seed = arguments.seed;
    let kind = kinds::of(seed, number);
    let name = format!("{}-{seed}-{number}", kind.name);
    let case = kinds::draw(seed, number, &name)?;
    let files = case.write(&arguments.problems, &name).map_err(|error| error.to_string())?;
    let mut record = apart::judge(&files[0], arguments.limit)?;
    record.seed = seed;
    record.number = number;
    record.kind = kind.name.into();
    record.parts.clone_from(&case.parts);
    if let Some(known) = case.known {
        judge::compare(&mut record, known);
    }
    if record.faults.is_empty() && !arguments.keep {
        for file in files
            .iter()
            .filter(|file| file.file_name().is_some_and(|own| own.to_string_lossy().starts_with(&name)))
        {
            let _ = std::fs::remove_file(file);
        }
    }
    eprintln!(
        "{name} {:?}: {} {:.0} ms, judged {:.0} ms {}",
        record.parts,
        record.status,
        record.milliseconds,
        record.judge_milliseconds,
        record.faults.join(", ")
    );
    let mut results = results.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    results.add(record).map_err(|error| error.to_string())
}
