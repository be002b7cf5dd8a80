//! Time of machine code against the generic code, and what it costs to make it.
//!
//! `cargo run --release -p costate-jit --example speed` prints the table, with `-- --write` it also puts it into
//! docs/jit.md: under "any processor" or, with `RUSTFLAGS="-C target-cpu=native"`, under "this processor".
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    missing_docs,
    reason = "an example may stop on what a library may not"
)]

#[path = "../../benches/frames/robots.rs"]
mod robots;

use costate::codegen::{Coordinates, Options, Quantity, robot_program};
use costate::hamiltonian::Hamiltonian;
use costate::robot::Robot;
use costate_jit::{Compiled, Evaluator};
use std::fmt::Write;
use std::hint::black_box;
use std::time::Instant;

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/..");
const QUANTITIES: [Quantity; 4] = [Quantity::F, Quantity::FX, Quantity::YFX, Quantity::YFXX];
const BATCHES: usize = 61;

/// Robot files, and chains with axes and inertias in general directions.
fn all() -> Vec<(&'static str, Robot)> {
    let file = |name: &str| Robot::from_file(format!("{ROOT}/robots/{name}")).expect("a robot file");
    vec![
        ("UR5", file("ur5.urdf")),
        ("PUMA 560", file("puma560.toml")),
        ("Panda", file("panda.urdf")),
        ("biped", file("biped.toml")),
        ("general chain", robots::random("chain", 12, 1)),
        ("general chain", robots::random("chain", 24, 1)),
    ]
}

/// Whether the generic code of this build has fused operations, as machine code always has.
const SECTION: &str = if cfg!(target_feature = "fma") { "this processor" } else { "any processor" };

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

/// Medians of the times of a call of each (ns): batches of about 50 us, in turns.
fn times<const N: usize>(mut calls: [&mut dyn FnMut(); N]) -> [f64; N] {
    let mut batches = [const { Vec::new() }; N];
    let mut counts = [1_usize; N];
    for round in 0..=BATCHES {
        for ((call, batches), count) in calls.iter_mut().zip(&mut batches).zip(&mut counts) {
            let start = Instant::now();
            (0..*count).for_each(|_| call());
            let each = start.elapsed().as_secs_f64() * 1e9 / *count as f64;
            if round == 0 {
                *count = (50_000.0 / each).clamp(1.0, 5000.0) as usize;
            } else {
                batches.push(each);
            }
        }
    }
    batches.map(median)
}

/// Median time of making something (ms).
fn making<T>(make: impl Fn() -> T) -> f64 {
    let time = || {
        let start = Instant::now();
        black_box(make());
        start.elapsed().as_secs_f64() * 1e3
    };
    median((0..11).map(|_| time()).collect())
}

/// One line of the table.
fn line(name: &str, robot: &Robot, quantity: Quantity) -> String {
    let record = || robot_program(robot, quantity, Coordinates::Hamiltonian, &Options::default()).unwrap();
    let program = record();
    let compiled =
        Compiled::<f64>::with_limit(&program, usize::MAX).expect("machine code for this processor");
    let mut fallback = Evaluator::with_limit(robot, quantity, Coordinates::Hamiltonian, 0).unwrap();
    let n = robot.len();
    let q: Vec<f64> = (0..n).map(|i| 0.3 + 0.37 * i as f64).collect();
    let v: Vec<f64> = (0..n).map(|i| 0.9 - 0.21 * i as f64).collect();
    let p = Hamiltonian::<f64>::new(robot).momentum(&q, &v).unwrap().to_vec();
    let y: Vec<f64> = (0..2 * n).map(|i| 1.0 - 0.13 * i as f64).collect();
    let inputs = [q, p, vec![0.5; n], y].concat()[..program.inputs()].to_vec();
    let (mut outputs, mut expected) = (vec![0.0; program.outputs()], vec![0.0; program.outputs()]);
    let lanes = Compiled::<[f64; 4]>::with_limit(&program, usize::MAX).expect("the same");
    let four: Vec<[f64; 4]> =
        inputs.iter().map(|&input| [input, 0.9 * input, 0.8 * input, 0.7 * input]).collect();
    let mut four_outputs = vec![[0.0; 4]; program.outputs()];
    let [generic, jit, all_lanes] = times([
        &mut || fallback.evaluate(black_box(&inputs), black_box(&mut expected)).unwrap(),
        &mut || compiled.call(black_box(&inputs), black_box(&mut outputs)).unwrap(),
        &mut || lanes.call(black_box(&four), black_box(&mut four_outputs)).unwrap(),
    ]);
    let size = expected.iter().fold(0.0_f64, |size, value| size.max(value.abs()));
    let error = outputs.iter().zip(&expected).fold(0.0_f64, |worst, (a, b)| worst.max((a - b).abs())) / size;
    let (recording, compiling) =
        (making(record), making(|| Compiled::<f64>::with_limit(&program, usize::MAX)));
    let (name, quantity, ratio) = (format!("{name}, n = {n}"), quantity.name(), generic / jit);
    let (each, gain) = (all_lanes / 4.0, 4.0 * jit / all_lanes);
    format!(
        "| {name} | {quantity} | {} | {} | {recording:.2} | {compiling:.2} | {generic:.0} | {jit:.0} | {ratio:.1} | {each:.0} | {gain:.1} | {error:.0e} |",
        program.steps(),
        compiled.code_len(),
    )
}

/// Puts the table between the marks of its section in docs/jit.md.
fn write_down(table: &str) {
    let path = format!("{ROOT}/docs/jit.md");
    let page = std::fs::read_to_string(&path).expect("docs/jit.md");
    let (begin, end) = (format!("<!-- {SECTION}: begin -->\n"), format!("<!-- {SECTION}: end -->"));
    let (before, rest) = page.split_once(&begin).expect("the mark before the table");
    let (_, after) = rest.split_once(&end).expect("the mark after the table");
    std::fs::write(path, format!("{before}{begin}{table}{end}{after}")).expect("docs/jit.md can be written");
}

fn main() {
    let mut table = String::from(
        "| robot | quantity | steps | bytes | record (ms) | compile (ms) | generic (ns) | jit (ns) | ratio | lanes (ns) | ratio | difference |\n\
         |---|---|---|---|---|---|---|---|---|---|---|---|\n",
    );
    for (name, robot) in all() {
        for quantity in QUANTITIES {
            writeln!(table, "{}", line(name, &robot, quantity)).expect("a string grows");
        }
    }
    println!("generic code compiled for {SECTION}\n\n{table}");
    if std::env::args().any(|argument| argument == "--write") {
        write_down(&table);
    }
}
