//! Twelve tasks of four real arms at default options, each beside the best of several starts.

mod robots;
mod tasks;

use crate::problems::Failure;
use crate::tables::{duration, markdown};
use costate::robot::LoadOptions;
use costate_control::{ProblemFile, Solution, Solver, SolverOptions};
use robots::ARMS;
use std::path::PathBuf;
use std::time::Instant;

/// Tasks of each arm.
const TASKS: usize = 3;
/// A cost that is larger than that of the best start by more than this part of it is a loss.
const LOSS: f64 = 1e-3;

/// What is asked for on the command line.
struct Arguments {
    seeds: Vec<u64>,
    /// Starts of the search that the default is compared with; 0 for none.
    starts: usize,
    tolerance: Option<f64>,
    /// Where the tasks are kept as problem files.
    keep: Option<PathBuf>,
    /// Only tasks whose name contains this.
    only: String,
}

/// A task solved at default options and from several starts.
struct Row {
    seed: u64,
    name: String,
    solution: Solution,
    seconds: f64,
    /// The best cost of the starts, how many of these were solved, and the time that they took.
    best: f64,
    solved: usize,
    seconds_of_starts: f64,
}

/// Runs the tasks and prints the tables.
pub fn run(arguments: impl Iterator<Item = String>) -> Result<(), Failure> {
    let Arguments { seeds, starts, tolerance, keep, only } = read(arguments)?;
    let folder = robots::folder()?;
    let options = match tolerance {
        None => SolverOptions::default(),
        Some(tolerance) => SolverOptions::default().with_tolerance(tolerance),
    };
    let mut rows = Vec::new();
    for seed in seeds {
        for (arm, number) in ARMS.iter().flat_map(|arm| (0..TASKS).map(move |number| (arm, number))) {
            let task = tasks::draw(arm, &folder, number, seed)?;
            if !task.name.contains(&only) {
                continue;
            }
            if let Some(folder) = &keep {
                std::fs::create_dir_all(folder)?;
                let file = format!("{}_{seed}.toml", task.name.replace(' ', "_"));
                std::fs::write(folder.join(file), &task.text)?;
            }
            let problem = ProblemFile::from_text(&task.text, "", LoadOptions::default())?.problem;
            let clock = Instant::now();
            let solution = Solver::new(&problem, options.clone())?.solve();
            let seconds = clock.elapsed().as_secs_f64();
            let mut row = Row {
                seed,
                name: task.name,
                solution,
                seconds,
                best: f64::NAN,
                solved: 0,
                seconds_of_starts: f64::NAN,
            };
            if starts > 0 {
                let clock = Instant::now();
                let all = Solver::new(&problem, options.clone().with_starts(starts))?.solve();
                row.seconds_of_starts = clock.elapsed().as_secs_f64();
                let solved = all.starts.iter().filter(|start| start.status.is_solved());
                (row.best, row.solved) = solved
                    .fold((f64::INFINITY, 0), |(best, count), start| (best.min(start.total), count + 1));
            }
            eprintln!(
                "{seed} {}: {} {:.4} in {seconds:.2} s, best {:.4} in {:.1} s",
                row.name,
                row.solution.motion.status.name(),
                row.solution.motion.total(),
                row.best,
                row.seconds_of_starts
            );
            rows.push(row);
        }
    }
    println!("{}", table(&mut rows));
    println!("{}", statistics(&rows));
    Ok(())
}

fn read(mut arguments: impl Iterator<Item = String>) -> Result<Arguments, Failure> {
    let mut found =
        Arguments { seeds: vec![1, 2, 3], starts: 16, tolerance: None, keep: None, only: String::new() };
    while let Some(argument) = arguments.next() {
        let value = arguments.next().ok_or(format!("{argument} needs a value; see --help"))?;
        let wrong = |error: &dyn std::fmt::Display| format!("{argument} {value}: {error}");
        match argument.as_str() {
            "--seeds" => {
                let all = value.split(',').map(str::parse).collect::<Result<_, _>>();
                found.seeds = all.map_err(|error: std::num::ParseIntError| wrong(&error))?;
            }
            "--starts" => {
                found.starts = value.parse().map_err(|error: std::num::ParseIntError| wrong(&error))?
            }
            "--tolerance" => {
                let tolerance = value.parse().map_err(|error: std::num::ParseFloatError| wrong(&error))?;
                found.tolerance = Some(tolerance);
            }
            "--keep" => found.keep = Some(value.into()),
            "--only" => found.only = value,
            _ => return Err(format!("unknown argument {argument}; see --help").into()),
        }
    }
    Ok(found)
}

impl Row {
    /// The cost over that of the best start; infinite where there is no solution.
    fn ratio(&self) -> f64 {
        if self.solution.motion.status.is_solved() {
            self.solution.motion.total() / self.best
        } else {
            f64::INFINITY
        }
    }
}

/// All tasks, losses first.
fn table(rows: &mut [Row]) -> String {
    rows.sort_by(|a, b| b.ratio().total_cmp(&a.ratio()));
    let cells = |row: &Row| {
        let motion = &row.solution.motion;
        let (guess, looks) = row
            .solution
            .starts
            .first()
            .map_or((String::new(), 0), |start| (start.guess.to_string(), start.looks));
        vec![
            row.seed.to_string(),
            row.name.clone(),
            motion.status.name().to_owned(),
            format!("{:.5}", motion.final_time),
            format!("{:.5}", motion.total()),
            row.solution.cost_error().map_or_else(|| "-".into(), |error| format!("{error:.0e}")),
            row.solution.mesh_nodes().to_string(),
            duration(row.seconds),
            format!("{:.5}", row.best),
            format!("{}", row.solved),
            duration(row.seconds_of_starts),
            format!("{:.4}", row.ratio()),
            format!("{guess} of {looks}"),
        ]
    };
    let head = [
        "seed",
        "task",
        "status",
        "T (s)",
        "cost",
        "error",
        "nodes",
        "time",
        "best start",
        "solved starts",
        "their time",
        "ratio",
        "guess",
    ];
    markdown(&head, &rows.iter().map(cells).collect::<Vec<_>>())
}

/// Of each seed, and of all.
fn statistics(rows: &[Row]) -> String {
    let mut seeds: Vec<u64> = rows.iter().map(|row| row.seed).collect();
    seeds.sort_unstable();
    seeds.dedup();
    let of = |name: String, rows: &[&Row]| {
        let count = |is: &dyn Fn(&Row) -> bool| rows.iter().filter(|row| is(row)).count();
        let mut times: Vec<f64> = rows.iter().map(|row| row.seconds).collect();
        times.sort_by(f64::total_cmp);
        let worst = rows.iter().map(|row| row.ratio()).fold(0.0, f64::max);
        vec![
            name,
            format!("{} of {}", count(&|row| row.solution.motion.status.is_solved()), rows.len()),
            format!("{} of {}", count(&|row| row.ratio() <= 1.0 + LOSS), rows.len()),
            format!("{worst:.4}"),
            format!("{}", count(&|row| row.ratio() < 1.0 - LOSS)),
            duration(times[times.len() / 2]),
            duration(times.last().copied().unwrap_or(f64::NAN)),
        ]
    };
    let mut lines: Vec<_> = seeds
        .into_iter()
        .map(|seed| of(seed.to_string(), &rows.iter().filter(|row| row.seed == seed).collect::<Vec<_>>()))
        .collect();
    if !rows.is_empty() {
        lines.push(of("all".into(), &rows.iter().collect::<Vec<_>>()));
    }
    let head = [
        "seed",
        "converged",
        "within 1e-3 of the best start",
        "worst ratio",
        "better than all starts",
        "median time",
        "longest time",
    ];
    markdown(&head, &lines)
}
