//! The same problem with each kind of second derivatives, and what the numbers say.

use crate::curvature::Curvature;
use crate::problem::Problem;
use crate::solver::{Options, Row, Solution, Status, solve};
use costate::dynamics::Cost;
use costate::step::Step;
use std::fmt::Write;
use std::time::{Duration, Instant};

/// Runs of each kind, in turns; the fastest counts.
const RUNS: usize = 5;
/// Costs that differ by more than this part belong to different solutions.
const SAME: f64 = 1e-7;

/// One problem solved by one kind.
pub struct Run {
    pub curvature: Curvature,
    pub solution: Solution,
    pub time: Duration,
}

impl Run {
    fn solved(&self) -> bool {
        self.solution.status == Status::Solved
    }
}

/// One problem solved by every kind, the exact one first.
pub struct Comparison {
    pub name: String,
    pub runs: Vec<Run>,
}

impl Comparison {
    pub fn of<M: Step<f64>, L: Cost<f64>, F: Cost<f64>>(name: &str, mut problem: Problem<M, L, F>) -> Self {
        let guess = problem.straight_line(&vec![0.0; problem.controls()]);
        let mut runs: Vec<Run> = Vec::new();
        for round in 0..RUNS {
            for (i, curvature) in Curvature::ALL.into_iter().enumerate() {
                let start = Instant::now();
                let solution = solve(&mut problem, &guess, &Options::new(curvature));
                let time = start.elapsed();
                if round == 0 {
                    runs.push(Run { curvature, solution, time });
                } else {
                    runs[i].time = runs[i].time.min(time);
                }
            }
        }
        Self { name: name.into(), runs }
    }

    /// The iterations of the exact Hessian and of Gauss-Newton.
    pub fn logs(&self) -> String {
        let mut text = String::new();
        for run in &self.runs[..2] {
            let _ = writeln!(text, "\n{}, {}: {:?}", self.name, run.curvature.name(), run.solution.status);
            text += &iterations(&run.solution.log);
        }
        text
    }

    /// Lines of the summary.
    pub fn lines(&self) -> String {
        let mut text = String::new();
        for run in &self.runs {
            let log = &run.solution.log;
            let status = match run.solution.status {
                Status::Solved => "",
                Status::Infeasible { .. } => "infeasible",
                Status::Stalled => "stalled",
                Status::IterationLimit => "not solved",
                Status::NotEvaluated(_) => "not evaluated",
            };
            let line = format!(
                "{:<36}{:<13}{:5}{:13.8}{:9.1e}{:9.1e}{:9.1}{:9.2}  {status}",
                if run.curvature == Curvature::Exact { &self.name } else { "" },
                run.curvature.name(),
                run.solution.iterations(),
                run.solution.cost,
                log.last().map_or(f64::NAN, |row| row.error()),
                last_ratio(log).unwrap_or(f64::NAN),
                1e3 * run.time.as_secs_f64(),
                run.time.as_secs_f64() / self.runs[0].time.as_secs_f64(),
            );
            let _ = writeln!(text, "{}", line.trim_end());
        }
        text
    }

    /// What the exact Hessian gained or lost against another kind.
    fn verdict(&self, other: &Run) -> String {
        let exact = &self.runs[0];
        let (ours, theirs) = (exact.solution.iterations(), other.solution.iterations());
        let ratio = other.time.as_secs_f64() / exact.time.as_secs_f64();
        match (exact.solved(), other.solved()) {
            (true, false) => format!("only the exact Hessian solved it, in {ours} iterations"),
            (false, true) => format!("only {} solved it, in {theirs} iterations", other.curvature.name()),
            (false, false) => "neither solved it".into(),
            (true, true) => {
                let faster = if ratio >= 1.0 {
                    format!("{ratio:.2} times faster")
                } else {
                    format!("{:.2} times slower", 1.0 / ratio)
                };
                let cost = (other.solution.cost - exact.solution.cost) / exact.solution.cost;
                let same = match cost {
                    _ if cost.abs() < SAME => "",
                    _ if cost > 0.0 => "; the exact Hessian found a better solution",
                    _ => "; the exact Hessian found a worse solution",
                };
                format!("{ours} iterations for {theirs}, {faster}{same}")
            }
        }
    }
}

/// The table of all problems.
pub fn summary(all: &[Comparison]) -> String {
    let mut text = format!(
        "{:<36}{:<13}{:>5}{:>13}{:>9}{:>9}{:>9}{:>9}\n",
        "problem", "Hessian", "iter", "cost", "error", "last", "ms", "to exact"
    );
    text += &"-".repeat(103);
    text.push('\n');
    all.iter().for_each(|comparison| text += &comparison.lines());
    text + "\nerror: largest violation of the conditions of optimality. last: what the last step left of it.\n\
            ms: fastest of several runs in turns.\n"
}

/// The verdict, from the numbers alone.
pub fn verdict(all: &[Comparison]) -> String {
    let mut text = String::new();
    for i in 1..Curvature::ALL.len() {
        let name = all[0].runs[i].curvature.name();
        let _ = writeln!(text, "Exact Hessian against {name}:");
        let (mut fewer, mut faster, mut both, mut alone) = (0, 0, 0, 0);
        for comparison in all {
            let (exact, other) = (&comparison.runs[0], &comparison.runs[i]);
            let _ = writeln!(text, "  {}: {}", comparison.name, comparison.verdict(other));
            match (exact.solved(), other.solved()) {
                (true, true) => {
                    both += 1;
                    fewer += usize::from(exact.solution.iterations() < other.solution.iterations());
                    faster += usize::from(exact.time < other.time);
                }
                (true, false) => alone += 1,
                _ => {}
            }
        }
        let _ = writeln!(
            text,
            "  Of {} problems: both solved {both}, the exact Hessian in fewer iterations {fewer} times, in less time {faster} \
             times; it alone solved {alone}.",
            all.len()
        );
    }
    text
}

/// Rows of a long log that are shown at its start and at its end.
const SHOWN: usize = 8;

/// The log, one row an iteration; a long one without its middle.
pub fn iterations(log: &[Row]) -> String {
    let mut text = String::from("   k  cost            defects    dual  compl.      mu  part   added\n");
    let last = log.len().saturating_sub(1);
    for (k, row) in log.iter().enumerate() {
        if log.len() > 3 * SHOWN && (SHOWN..=last - SHOWN).contains(&k) {
            if k == SHOWN {
                let _ = writeln!(text, "      ... {} rows left out", log.len() - 2 * SHOWN);
            }
            continue;
        }
        let _ = write!(text, "{k:4}");
        match row.is_restoration {
            true => text += &" ".repeat(49),
            false => {
                let _ = write!(text, "  {:<13.8}  {:8.1e}", row.cost, row.violation);
                let _ = write!(text, "{:8.1e}{:8.1e}{:8.1e}", row.dual, row.complementarity, row.mu);
            }
        }
        if k > 0 {
            let what = if row.is_restoration { "  restoration" } else { "" };
            let _ = write!(text, "{:6.2}{:8.1e}{what}", row.part, row.added);
        }
        text.push('\n');
    }
    text
}

/// What the last step left of the error.
pub fn last_ratio(log: &[Row]) -> Option<f64> {
    let [.., before, after] = log else { return None };
    let ratio = after.error() / before.error();
    (after.part > 0.0 && ratio.is_finite()).then_some(ratio)
}
