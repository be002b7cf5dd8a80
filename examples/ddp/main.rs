//! Differential dynamic programming with exact second derivatives, compared with iLQR, its Gauss-Newton
//! variant.
//!
//! `cargo run --release -p costate-examples --example ddp` solves six tasks by both methods, prints the
//! iterations side by side, and summarises the effect of exact second derivatives; `-- --write` writes the
//! same into `docs/ddp.md`.
//!
//! - `solver.rs`: the algorithm; `sweep.rs`: its recursion; `trajectory.rs`: roll-outs; `box_qp.rs`: bounds;
//!   `problem.rs`: its input and output. These five files use the traits `Step` and `Cost` only, and no
//!   robots.
//! - `problems.rs`, `reach.rs`: the tasks.
//! - `compare.rs`, `table.rs`, `verdict.rs`: the printed report.

mod box_qp;
mod compare;
mod problem;
mod problems;
mod reach;
mod roll_out;
mod solver;
mod sweep;
mod table;
#[cfg(test)]
mod tests;
mod trajectory;
mod verdict;

use compare::Comparison;
use std::error::Error;
use std::path::Path;

const BEGIN: &str = "<!-- output: begin (written by the example) -->";
const END: &str = "<!-- output: end -->";

fn main() -> Result<(), Box<dyn Error>> {
    let comparisons = [
        Comparison::of(problems::large_motion()?)?,
        Comparison::of(problems::large_motion_with_bounds()?)?,
        Comparison::of(problems::swing_up()?)?,
        Comparison::of(problems::ur5_with_momenta()?)?,
        Comparison::of(problems::ur5_with_velocities()?)?,
        Comparison::of(problems::panda_with_momenta()?)?,
    ];
    let mut report = String::new();
    for (k, comparison) in comparisons.iter().enumerate() {
        let heading = format!("{}. {}", k + 1, comparison.title);
        let rule = "=".repeat(heading.len());
        let (table, verdict) = (table::side_by_side(comparison), verdict::of_task(comparison));
        report += &format!("{heading}\n{rule}\n{}\n\n{table}\n{verdict}\n", comparison.about);
    }
    report += &format!("Columns\n=======\n{}\n\n", table::LEGEND);
    report += &format!("Verdict\n=======\n{}", verdict::of_all(&comparisons));
    print!("{report}");
    println!("\nTimes in this run until the end of each search, exact DDP and iLQR (ms):");
    for Comparison { title, exact, twin, .. } in &comparisons {
        let [exact, twin] =
            [exact, twin].map(|solution| 1e3 * solution.log.last().map_or(0.0, |line| line.seconds));
        println!("{title:37} {exact:8.1} {twin:8.1}");
    }
    if std::env::args().any(|argument| argument == "--write") {
        write(&report)?;
    }
    Ok(())
}

/// Writes the report between the markers of `docs/ddp.md`.
fn write(report: &str) -> Result<(), Box<dyn Error>> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/ddp.md");
    let old = std::fs::read_to_string(&path)?;
    let (before, rest) = old.split_once(BEGIN).ok_or("docs/ddp.md has lost its marker of the beginning")?;
    let (_, after) = rest.split_once(END).ok_or("docs/ddp.md has lost its marker of the end")?;
    Ok(std::fs::write(path, format!("{before}{BEGIN}\n```text\n{report}```\n{END}{after}"))?)
}
