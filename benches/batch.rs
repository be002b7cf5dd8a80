//! Throughput of batches in nodes per second, by number and threads:
//! `cargo bench -p costate-benches --bench batch`. With `COSTATE_WRITE=1` in the environment the tables
//! are also written to `docs/batch.md`: those for the instruction set that the bench is compiled for.
//!
//! Inside the timed region: one call for all nodes, from node-major arrays to node-major arrays.
#![allow(missing_docs, clippy::unwrap_used, reason = "a bench may stop on what a library may not")]

use costate::batch::{Batch, FirstOrderArrays, Model, NodeArray, NodeFunction, Packed, SecondOrderArrays};
use costate::dynamics::Dynamics;
use costate::hamiltonian::{Hamiltonian, HamiltonianSecondOrder};
use costate::robot::Robot;
use costate::scalar::{F64x4, F64x8};
use criterion::{BenchmarkGroup, Criterion, measurement::WallTime};
use std::hint::black_box;
use std::path::PathBuf;
use std::time::Duration;

const ROBOTS: [&str; 3] = ["ur5.urdf", "panda.urdf", "biped.toml"];

/// Nodes of one call: typical for collocation, and few enough for the level-2 cache.
const NODES: usize = 128;

/// Nodes of one call on two threads.
const MANY: usize = 1024;

fn main() {
    let mut criterion = Criterion::default()
        .warm_up_time(Duration::from_millis(200))
        .measurement_time(Duration::from_millis(1000))
        .without_plots()
        .output_directory(&figures())
        .configure_from_args();
    for file in ROBOTS {
        let robot = Robot::from_file(format!("{}/../robots/{file}", env!("CARGO_MANIFEST_DIR"))).unwrap();
        let mut group = criterion.benchmark_group(format!("{} {INSTRUCTIONS}", robot.name()));
        models(&robot, &mut group);
        group.finish();
    }
    let mut group = criterion.benchmark_group(format!("parts {INSTRUCTIONS}"));
    parts(&mut group);
    group.finish();
    criterion.final_summary();
    report();
}

/// States, controls and costates of many nodes.
struct Nodes {
    x: Vec<f64>,
    u: Vec<f64>,
    y: Vec<f64>,
    f: Vec<f64>,
    f_x: Vec<f64>,
    y_f_xx: Vec<f64>,
}

impl Nodes {
    fn new(robot: &Robot, nodes: usize) -> Self {
        let n = robot.dof();
        let mut hamiltonian = Hamiltonian::<f64>::new(robot);
        let wave = |i: usize, phase: f64| (1.7 * i as f64 + phase).sin();
        let mut x = Vec::new();
        for k in 0..nodes {
            let q: Vec<f64> = (0..n).map(|i| wave(k * n + i, 0.3)).collect();
            let v: Vec<f64> = (0..n).map(|i| wave(k * n + i, 0.9)).collect();
            x.extend(&q);
            x.extend(hamiltonian.momentum(&q, &v).unwrap());
        }
        let fill = |length: usize| (0..nodes * length).map(|i| wave(i, 0.1)).collect::<Vec<_>>();
        let zeros = |length: usize| vec![0.0; nodes * length];
        let square = 4 * n * n;
        Self { x, u: fill(n), y: fill(2 * n), f: zeros(2 * n), f_x: zeros(square), y_f_xx: zeros(square) }
    }
}

fn models(robot: &Robot, group: &mut BenchmarkGroup<'_, WallTime>) {
    one_by_one(robot, group);
    on_one_thread::<f64>("f64", robot, group);
    on_one_thread::<F64x4>("f64x4", robot, group);
    on_one_thread::<F64x8>("f64x8", robot, group);
    for threads in [1, 2] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let mut batch =
            pool.install(|| Batch::<F64x4, _>::parallel(|| Model(HamiltonianSecondOrder::new(robot))));
        let mut nodes = Nodes::new(robot, MANY);
        for (_, quantity) in QUANTITIES {
            group.bench_function(format!("f64x4 {threads} threads {quantity}"), |b| {
                b.iter(|| pool.install(|| call(quantity, &mut batch, &mut nodes)));
            });
        }
    }
}

/// Single calls of a model in f64, results copied to node-major arrays.
fn one_by_one(robot: &Robot, group: &mut BenchmarkGroup<'_, WallTime>) {
    let (n, mut model) = (robot.dof(), HamiltonianSecondOrder::<f64>::new(robot));
    let Nodes { x, u, y, mut f, mut f_x, mut y_f_xx } = Nodes::new(robot, NODES);
    let copy = |rows: &mut dyn Iterator<Item = &[f64]>, into: &mut [f64]| {
        into.chunks_exact_mut(2 * n).zip(rows).for_each(|(into, row)| into.copy_from_slice(row));
    };
    group.bench_function("alone f", |b| {
        b.iter(|| {
            let states = black_box(&x).chunks_exact(2 * n).zip(u.chunks_exact(n));
            for ((x, u), f) in states.zip(f.chunks_exact_mut(2 * n)) {
                f.copy_from_slice(model.evaluate(x, u).unwrap());
            }
        });
    });
    group.bench_function("alone f_x", |b| {
        b.iter(|| {
            let states = black_box(&x).chunks_exact(2 * n).zip(u.chunks_exact(n));
            let results = f.chunks_exact_mut(2 * n).zip(f_x.chunks_exact_mut(4 * n * n));
            for ((x, u), (f, f_x)) in states.zip(results) {
                let first = model.linearise(x, u).unwrap();
                f.copy_from_slice(first.f);
                copy(&mut first.f_x.iter_rows(), f_x);
            }
        });
    });
    group.bench_function("alone y_f_xx", |b| {
        b.iter(|| {
            let states = black_box(&x).chunks_exact(2 * n).zip(u.chunks_exact(n)).zip(y.chunks_exact(2 * n));
            let results = f.chunks_exact_mut(2 * n).zip(f_x.chunks_exact_mut(4 * n * n));
            let results = results.zip(y_f_xx.chunks_exact_mut(4 * n * n));
            for (((x, u), y), ((f, f_x), y_f_xx)) in states.zip(results) {
                let second = Dynamics::contract(&mut model, x, u, y).unwrap();
                f.copy_from_slice(second.first.f);
                copy(&mut second.first.f_x.iter_rows(), f_x);
                copy(&mut second.xx.iter_rows(), y_f_xx);
            }
        });
    });
}

fn on_one_thread<S: Packed<Lane = f64>>(name: &str, robot: &Robot, group: &mut BenchmarkGroup<'_, WallTime>) {
    let mut batch = Batch::<S, _>::new(Model(HamiltonianSecondOrder::new(robot)));
    let mut nodes = Nodes::new(robot, NODES);
    for (_, quantity) in QUANTITIES {
        group.bench_function(format!("{name} {quantity}"), |b| {
            b.iter(|| call(quantity, &mut batch, &mut nodes));
        });
    }
}

/// One quantity at all nodes.
fn call<S: Packed<Lane = f64>>(
    quantity: &str,
    batch: &mut Batch<S, Model<HamiltonianSecondOrder<S>>>,
    nodes: &mut Nodes,
) {
    let Nodes { x, u, y, f, f_x, y_f_xx } = nodes;
    let x = black_box(x);
    let failures = match quantity {
        "f" => batch.evaluate(x, u, f),
        "f_x" => batch.linearise(x, u, FirstOrderArrays { f, f_x, ..Default::default() }),
        _ => {
            let first = FirstOrderArrays { f, f_x, ..Default::default() };
            batch.contract([x, u, y], first, SecondOrderArrays { xx: y_f_xx, ..Default::default() })
        }
    };
    assert!(failures.unwrap().is_empty());
}

/// Sines and cosines, and packing of node-major arrays into lanes and back.
fn parts(group: &mut BenchmarkGroup<'_, WallTime>) {
    let angles: Vec<f64> = (0..NODES).map(|i| 3.0 * (1.7 * i as f64).sin()).collect();
    sin_cos::<f64>("f64", &angles, group);
    sin_cos::<F64x4>("f64x4", &angles, group);
    sin_cos::<F64x8>("f64x8", &angles, group);
    copies::<f64>("f64", group);
    copies::<F64x4>("f64x4", group);
    copies::<F64x8>("f64x8", group);
}

fn sin_cos<S: Packed<Lane = f64>>(name: &str, angles: &[f64], group: &mut BenchmarkGroup<'_, WallTime>) {
    let mut lanes = vec![S::zero(); angles.len() / S::LANES];
    for (lanes, angles) in lanes.iter_mut().zip(angles.chunks(S::LANES)) {
        S::gather(angles, 1, std::slice::from_mut(lanes));
    }
    let mut results = vec![(S::zero(), S::zero()); lanes.len()];
    group.bench_function(format!("{name} sin_cos"), |b| {
        b.iter(|| {
            for (result, &angle) in results.iter_mut().zip(black_box(&lanes)) {
                *result = angle.sin_cos();
            }
            black_box(&mut results);
        });
    });
}

/// A batch that computes nothing, with as many inputs and outputs as F, F_x and y'F_xx of six joints.
fn copies<S: Packed<Lane = f64>>(name: &str, group: &mut BenchmarkGroup<'_, WallTime>) {
    let nothing = |input: &[S], output: &mut [S]| output[0] = input[0];
    let (inputs, outputs) = (
        [NodeArray::new("x", 12), NodeArray::new("u", 6), NodeArray::new("y", 12)],
        [NodeArray::new("f", 12), NodeArray::new("f_x", 144), NodeArray::new("xx", 144)],
    );
    let mut batch = Batch::<S, _>::new(NodeFunction::new(&inputs, &outputs, nothing));
    let [x, u, y] = inputs.map(|array| vec![0.5; NODES * array.length]);
    let [mut f, mut f_x, mut xx] = outputs.map(|array| vec![0.0; NODES * array.length]);
    group.bench_function(format!("{name} copies"), |b| {
        b.iter(|| {
            let failed = batch.run((), NODES, [black_box(&x), &u, &y], [&mut f, &mut f_x, &mut xx]);
            assert!(failed.unwrap().is_empty());
        });
    });
}

/// A row of the table: title, name of the samples, nodes of a call.
const ROWS: [(&str, &str, usize); 6] = [
    ("one call a node, `f64`", "alone", NODES),
    ("batch, `f64`", "f64", NODES),
    ("batch, `F64x4`", "f64x4", NODES),
    ("batch, `F64x8`", "f64x8", NODES),
    ("batch, `F64x4`, 1 thread of a pool", "f64x4 1 threads", MANY),
    ("batch, `F64x4`, 2 threads", "f64x4 2 threads", MANY),
];

const QUANTITIES: [(&str, &str); 3] = [("F", "f"), ("F, F_x", "f_x"), ("F, F_x, y'F_xx", "y_f_xx")];

/// The directory of criterion's samples, beside this program: `TARGET/release/deps/batch-...`.
fn figures() -> PathBuf {
    let program = std::env::current_exe().unwrap();
    program.ancestors().nth(3).unwrap().join("criterion")
}

/// The tables from criterion's samples: the minimum of each hundred, which is least disturbed by other
/// processes.
fn report() {
    let figures = figures();
    let least = |group: &str, route: &str| -> Option<f64> {
        let path = figures.join(format!("{group} {INSTRUCTIONS}")).join(route).join("new/sample.json");
        let samples: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(path).ok()?).ok()?;
        let numbers = |key: &str| samples[key].as_array().into_iter().flatten().filter_map(|x| x.as_f64());
        numbers("times").zip(numbers("iters")).map(|(time, calls)| time / calls).min_by(f64::total_cmp)
    };
    let cpu = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = cpu.lines().find_map(|line| line.strip_prefix("model name")?.split_once(':'));
    let model = model.map_or("unknown", |(_, name)| name.trim());
    let names = ROBOTS.map(|file| file.split('.').next().unwrap_or(file));
    let mut table = format!(
        "CPU {model}, {INSTRUCTIONS}; least of 100 samples, ns a node and (times as many nodes a second)\n"
    );
    for (title, quantity) in QUANTITIES {
        table += &format!("\n| {title} | {} |\n|---|---|---|---|\n", names.join(" | "));
        for (title, route, nodes) in ROWS {
            let base = if nodes == MANY { ("f64x4 1 threads", MANY) } else { ("alone", NODES) };
            let of = |robot: &str, (route, nodes): (&str, usize)| {
                least(robot, &format!("{route} {quantity}")).map(|time| time / nodes as f64)
            };
            let cell = |robot: &str| match (of(robot, (route, nodes)), of(robot, base)) {
                (Some(time), Some(base)) => format!("{time:.0} ({:.2})", base / time),
                _ => "-".into(),
            };
            table += &format!("| {title} | {} |\n", names.map(cell).join(" | "));
        }
    }
    table += "\n| ns a node | `f64` | `F64x4` | `F64x8` |\n|---|---|---|---|\n";
    for (title, part) in
        [("sine and cosine of one angle", "sin_cos"), ("30 entries in, 300 out, checked", "copies")]
    {
        let cell = |number: &str| {
            least("parts", &format!("{number} {part}"))
                .map_or("-".into(), |t| format!("{:.1}", t / NODES as f64))
        };
        table += &format!("| {title} | {} |\n", ["f64", "f64x4", "f64x8"].map(cell).join(" | "));
    }
    println!("\n{table}");
    if std::env::var_os("COSTATE_WRITE").is_some() {
        let page = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/batch.md");
        let text = std::fs::read_to_string(page).unwrap();
        let (before, rest) = text.split_once(BEGIN).unwrap();
        let (_, after) = rest.split_once(END).unwrap();
        std::fs::write(page, format!("{before}{BEGIN}\n{table}{END}{after}")).unwrap();
    }
}

/// The compile target, and the place of its tables in the document.
const INSTRUCTIONS: &str = if cfg!(target_feature = "avx512f") {
    "AVX-512"
} else if cfg!(target_feature = "avx2") {
    "AVX2"
} else {
    "baseline instructions of the target"
};
const BEGIN: &str =
    if cfg!(target_feature = "avx2") { "<!-- native: begin -->" } else { "<!-- table: begin -->" };
const END: &str = if cfg!(target_feature = "avx2") { "<!-- native: end -->" } else { "<!-- table: end -->" };
