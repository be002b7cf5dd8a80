//! Time and accuracy of every method for F, F_x and y'F_xx, from 2 to 48 joints.
//!
//! `cargo bench -p costate-routes --bench scaling` measures and prints the tables; with `COSTATE_WRITE=1` in
//! the environment they also go to `docs/scaling.md`, and the plots beside it. `cargo test -p costate-routes
//! --bench scaling` only checks, on robots of up to 12 joints, that all methods agree. Arguments of criterion
//! make a run short: `-- --warm-up-time 0.01 --measurement-time 0.05`.
//!
//! The methods are those of `costate bench` (one list, so that both time the same calls) and a few more.
//! Criterion times them here, since it keeps the figures and tells what changed since the last run; `costate
//! bench` has a clock of its own, which takes all methods for one robot in turn, and is the one to ask where
//! two of them are close.
#![allow(missing_docs, clippy::unwrap_used, reason = "a bench may stop on what a library may not")]

mod accuracy;
mod page;
mod plot;

use costate_routes::cases::Case;
use costate_routes::routes::{Candidate, Failure};
use costate_routes::{FIRST, FUNCTION, candidates, states};
use criterion::{BenchmarkId, Criterion, SamplingMode};
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// Batches of calls longer than [`LONG`].
const FEW: usize = 10;
const LONG: Duration = Duration::from_millis(100);

fn main() -> Result<(), Failure> {
    let timing = std::env::args().any(|argument| argument == "--bench");
    let cases = Case::list(timing)?;
    let mut rows = Vec::new();
    let mut criterion = Criterion::default()
        .warm_up_time(Duration::from_millis(60))
        .measurement_time(Duration::from_millis(300))
        .nresamples(1001)
        .without_plots()
        .output_directory(&figures())
        .configure_from_args();
    for case in &cases {
        let mut list = candidates(case)?;
        let errors = accuracy::check(case, &mut list)?;
        if timing {
            measure(case, &mut list, &mut criterion)?;
        }
        rows.extend(list.iter().zip(errors).map(|(candidate, error)| page::Row {
            case: case.title.clone(),
            quantity: candidate.quantity,
            route: candidate.route,
            error,
            time: time(case, candidate),
        }));
    }
    if !timing {
        println!("all {} methods agree on {} robots", rows.len(), cases.len());
        return Ok(());
    }
    criterion.final_summary();
    let page = page::tables(&cases, &rows)?;
    println!("\n{page}");
    if std::env::var_os("COSTATE_WRITE").is_some() {
        page::write(&page)?;
        plot::draw(&cases, &rows)?;
    }
    Ok(())
}

/// Criterion over all methods for one robot, one group each.
fn measure(case: &Case, list: &mut [Candidate<'_>], criterion: &mut Criterion) -> Result<(), Failure> {
    let mut group = criterion.benchmark_group(group(case));
    group.sampling_mode(SamplingMode::Flat);
    for candidate in list {
        let start = Instant::now();
        (candidate.work)(None)?;
        group.sample_size(if start.elapsed() > LONG { FEW } else { page::BATCHES });
        group.bench_function(BenchmarkId::from_parameter(name(candidate)), |b| {
            b.iter(|| (candidate.work)(None).unwrap());
        });
    }
    group.finish();
    Ok(())
}

/// Times are kept apart by the instructions that the program is compiled for.
fn group(case: &Case) -> String {
    format!("{} {}", case.title, page::INSTRUCTIONS)
}

/// Letters, digits and spaces alone: it becomes the name of a folder.
fn name(candidate: &Candidate<'_>) -> String {
    let quantity = match candidate.quantity {
        FUNCTION => "f",
        FIRST => "f_x",
        _ => "y_f_xx",
    };
    let route: String = candidate.route.chars().filter(|c| c.is_alphanumeric() || *c == ' ').collect();
    format!("{quantity} {route}")
}

/// Median time of one state (ns) and the batches behind it, from what criterion has kept.
fn time(case: &Case, candidate: &Candidate<'_>) -> Option<page::Time> {
    let path = figures().join(group(case)).join(name(candidate)).join("new/sample.json");
    let samples: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(path).ok()?).ok()?;
    let numbers = |key: &str| samples[key].as_array().into_iter().flatten().filter_map(|x| x.as_f64());
    let mut each: Vec<f64> =
        numbers("times").zip(numbers("iters")).map(|(time, calls)| time / calls).collect();
    each.sort_by(f64::total_cmp);
    let median = each.get(each.len() / 2)? / states(candidate.route) as f64;
    Some(page::Time { median, batches: each.len() })
}

/// Where criterion keeps its figures: beside the build of this program, `TARGET/release/deps/scaling-...`.
fn figures() -> PathBuf {
    let program = std::env::current_exe().unwrap_or_default();
    program.ancestors().nth(3).map(|target| target.join("criterion")).unwrap_or_default()
}
