//! Times of machine code and of the generic code, and of recording and compiling.
//!
//! `cargo run --release -p costate-examples --example speed` prints the tables; with `-- --write` it also
//! writes them into docs/jit.md: under "any processor" or, with `RUSTFLAGS="-C target-cpu=native"`, under
//! "this processor".
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    missing_docs,
    reason = "an example may stop on what a library may not"
)]

use costate::codegen::{Coordinates, ProgramOptions, Quantity, robot_program};
use costate::hamiltonian::Hamiltonian;
use costate::robot::Robot;
use costate_jit::{Backend, Compiled, JitError, JitQuantity};
use costate_test_support::robots;
use std::fmt::Write;
use std::hint::black_box;
use std::time::Instant;

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/..");
const QUANTITIES: [Quantity; 4] = [Quantity::F, Quantity::FX, Quantity::YFX, Quantity::YFXX];
const BATCHES: usize = 61;

/// Robot files, and chains with axes and inertias in general directions.
fn all() -> Vec<(&'static str, Robot)> {
    let file = |name: &str| Robot::from_file(format!("{ROOT}/robots/{name}")).expect("a robot file");
    [
        ("UR5", file("ur5.urdf")),
        ("PUMA 560", file("puma560.toml")),
        ("Panda", file("panda.urdf")),
        ("biped", file("biped.toml")),
        ("humanoid", file("humanoid32.urdf")),
        ("humanoid with hands", file("humanoid50.urdf")),
    ]
    .into_iter()
    .chain([12, 16, 20, 24, 32].map(|n| ("general chain", robots::random("chain", n, 1))))
    .collect()
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

/// One line of the table; none for a program that cannot be compiled whatever the limit.
fn line(name: &str, robot: &Robot, quantity: Quantity) -> Option<String> {
    let record =
        || robot_program(robot, quantity, Coordinates::Hamiltonian, &ProgramOptions::default()).unwrap();
    let program = record();
    let compiled = match Compiled::<f64>::with_limit(&program, usize::MAX) {
        Err(error @ JitError::TooWide { .. }) => {
            println!("{name}, n = {}, {}: {error}", robot.dof(), quantity.name());
            return None;
        }
        compiled => compiled.expect("machine code for this processor"),
    };
    let mut fallback = JitQuantity::with_limit(robot, quantity, Coordinates::Hamiltonian, 0).unwrap();
    let n = robot.dof();
    let q: Vec<f64> = (0..n).map(|i| 0.3 + 0.37 * i as f64).collect();
    let v: Vec<f64> = (0..n).map(|i| 0.9 - 0.21 * i as f64).collect();
    let p = Hamiltonian::<f64>::new(robot).momentum(&q, &v).unwrap().to_vec();
    let y: Vec<f64> = (0..2 * n).map(|i| 1.0 - 0.13 * i as f64).collect();
    let inputs = [q, p, vec![0.5; n], y].concat()[..program.inputs()].to_vec();
    let mut machine = JitQuantity::with_limit(robot, quantity, Coordinates::Hamiltonian, usize::MAX).unwrap();
    let [mut outputs, mut checked, mut expected] = [(); 3].map(|()| vec![0.0; program.outputs()]);
    // Four states need four times the room of one.
    let lanes = match Compiled::<[f64; 4]>::with_limit(&program, usize::MAX) {
        Err(JitError::TooWide { .. }) => None,
        lanes => Some(lanes.expect("machine code for this processor")),
    };
    let four: Vec<[f64; 4]> =
        inputs.iter().map(|&input| [input, 0.9 * input, 0.8 * input, 0.7 * input]).collect();
    let mut four_outputs = vec![[0.0; 4]; program.outputs()];
    let [generic, jit, checking, all_lanes] = times([
        &mut || fallback.evaluate(black_box(&inputs), black_box(&mut expected)).unwrap(),
        &mut || compiled.call(black_box(&inputs), black_box(&mut outputs)).unwrap(),
        &mut || machine.evaluate(black_box(&inputs), black_box(&mut checked)).unwrap(),
        &mut || {
            if let Some(lanes) = &lanes {
                lanes.call(black_box(&four), black_box(&mut four_outputs)).unwrap();
            }
        },
    ]);
    let size = expected.iter().fold(0.0_f64, |size, value| size.max(value.abs()));
    let error = outputs.iter().zip(&expected).fold(0.0_f64, |worst, (a, b)| worst.max((a - b).abs())) / size;
    let (recording, compiling) =
        (making(record), making(|| Compiled::<f64>::with_limit(&program, usize::MAX)));
    let (name, quantity, ratio) = (format!("{name}, n = {n}"), quantity.name(), generic / jit);
    let with_checks = generic / checking;
    let of_lanes = match lanes {
        Some(_) => {
            let each = all_lanes / 4.0;
            format!("{each:.0} | {:.1} | {:.1}", jit / each, generic / each)
        }
        None => "too wide | - | -".to_owned(),
    };
    Some(format!(
        "| {name} | {quantity} | {} | {} | {recording:.2} | {compiling:.2} | {generic:.0} | {jit:.0} | {ratio:.1} | {checking:.0} | {with_checks:.1} | {of_lanes} | {error:.0e} |",
        program.steps(),
        compiled.code_len(),
    ))
}

/// The time until a quantity is refused as too long.
fn refusals() -> String {
    let mut table = String::from(
        "| robot | quantity | steps | given up after (ms) |\n\
         |---|---|---|---|\n",
    );
    for n in [24, 48, 100] {
        let robot = robots::random("chain", n, 1);
        for quantity in QUANTITIES {
            let start = Instant::now();
            let evaluator = JitQuantity::new(&robot, quantity, Coordinates::Hamiltonian).unwrap();
            let time = start.elapsed().as_secs_f64() * 1e3;
            let steps = match evaluator.backend() {
                Backend::Generic { reason: JitError::TooLong { steps, .. } } => steps.to_string(),
                Backend::Generic { reason: JitError::GivenUp { .. } | JitError::LargeRobot { .. } } => {
                    "not known".into()
                }
                _ => continue,
            };
            writeln!(table, "| general chain, n = {n} | {} | {steps} | {time:.0} |", quantity.name())
                .expect("a string grows");
        }
    }
    table
}

/// Puts a table between the marks of its section in docs/jit.md.
fn write_down(section: &str, table: &str) {
    let path = format!("{ROOT}/docs/jit.md");
    let page = std::fs::read_to_string(&path).expect("docs/jit.md");
    let (begin, end) = (format!("<!-- {section}: begin -->\n"), format!("<!-- {section}: end -->"));
    let (before, rest) = page.split_once(&begin).expect("the mark before the table");
    let (_, after) = rest.split_once(&end).expect("the mark after the table");
    std::fs::write(path, format!("{before}{begin}{table}{end}{after}")).expect("docs/jit.md can be written");
}

fn main() {
    let mut table = String::from(
        "| robot | quantity | steps | bytes | record (ms) | compile (ms) | generic (ns) | jit (ns) | generic / jit | checked (ns) | generic / checked | lanes (ns) | jit / lanes | generic / lanes | difference |\n\
         |---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n",
    );
    for (name, robot) in all() {
        for quantity in QUANTITIES {
            if let Some(line) = line(name, &robot, quantity) {
                writeln!(table, "{line}").expect("a string grows");
            }
        }
    }
    let refusals = refusals();
    println!("generic code compiled for {SECTION}\n\n{table}\n{refusals}");
    if std::env::args().any(|argument| argument == "--write") {
        write_down(SECTION, &table);
        write_down("refusals", &refusals);
    }
}
