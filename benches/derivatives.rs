//! Times of F, F_x and y'F_xx by every method, as ratios to F: `cargo bench -p costate-benches --bench
//! derivatives`. With `COSTATE_WRITE=1` in the environment the table is also written to `docs/times.md`.
//!
//! Inside the timed region: one call on a built workspace, from q, p, u (y) to the filled arrays; one state,
//! one core.
#![allow(missing_docs, clippy::unwrap_used, reason = "a bench may stop on what a library may not")]

use costate::derivative::{Hessian, Jacobian, NestedHessian, PhaseVelocity};
use costate::hamiltonian::{DualPass, FullHessian, Hamiltonian, HamiltonianSecondOrder};
use costate::robot::Robot;
use criterion::{BenchmarkGroup, Criterion, measurement::WallTime};
use std::hint::black_box;
use std::path::PathBuf;
use std::time::Duration;

const ROBOTS: [&str; 3] = ["ur5.urdf", "panda.urdf", "biped.toml"];

fn main() {
    let mut criterion = Criterion::default()
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_millis(1500))
        .without_plots()
        .output_directory(&figures())
        .configure_from_args();
    for file in ROBOTS {
        let robot = Robot::from_file(format!("{}/../robots/{file}", env!("CARGO_MANIFEST_DIR"))).unwrap();
        let mut group = criterion.benchmark_group(robot.name());
        measure(&robot, &mut group);
        group.finish();
    }
    criterion.final_summary();
    report();
}

/// One method: its name in the table and the file name of its samples.
const ROUTES: [(&str, &str); 17] = [
    ("F", "f"),
    ("F, F_x: analytic", "f_x analytic"),
    ("F, F_x: dual, 1 at once", "f_x dual 1"),
    ("F, F_x: dual, 2 at once", "f_x dual 2"),
    ("F, F_x: dual, 4 at once", "f_x dual 4"),
    ("F, F_x: dual, 6 at once", "f_x dual 6"),
    ("F, F_x: dual, 8 at once", "f_x dual 8"),
    ("F, F_x: dual, 12 at once", "f_x dual 12"),
    ("F, F_x: central differences of F", "f_x central differences"),
    ("F, y'F_x: adjoint product", "y_f_x adjoint"),
    ("y'F_xx d: product with a vector", "y_f_xx product"),
    ("F, F_x, y'F_xx: 2n+1 rule", "y_f_xx rule"),
    ("F, F_x, y'F_xx: one dual pass through analytic F_x", "y_f_xx dual pass"),
    ("F_x, all of F_xx: packed tensor", "f_xx packed"),
    ("y'F_xx: central differences of analytic F_x", "y_f_xx central differences"),
    ("y'F_xx: dual in dual numbers through F", "y_f_xx dual"),
    ("F, F_x, y'F_xx: hyper-dual numbers through F", "y_f_xx hyperdual"),
];

fn measure(robot: &Robot, group: &mut BenchmarkGroup<'_, WallTime>) {
    let n = robot.dof();
    let q: Vec<f64> = (0..n).map(|i| 0.3 + 0.37 * i as f64).collect();
    let v: Vec<f64> = (0..n).map(|i| 0.9 - 0.21 * i as f64).collect();
    let u = vec![0.5; n];
    let y: Vec<f64> = (0..2 * n).map(|i| 1.0 - 0.13 * i as f64).collect();
    let mut hamiltonian = Hamiltonian::<f64>::new(robot);
    let p = hamiltonian.momentum(&q, &v).unwrap().to_vec();
    let x = [q.clone(), p.clone()].concat();
    let function = || PhaseVelocity::new(robot).under(&u);
    group.bench_function("f", |b| {
        b.iter(|| hamiltonian.evaluate(black_box(&q), black_box(&p), &u).unwrap()[0]);
    });
    group.bench_function("f_x analytic", |b| {
        b.iter(|| hamiltonian.linearise(black_box(&q), black_box(&p), &u).unwrap().f()[0]);
    });
    chunks::<1>(function(), &x, group);
    chunks::<2>(function(), &x, group);
    chunks::<4>(function(), &x, group);
    chunks::<6>(function(), &x, group);
    chunks::<8>(function(), &x, group);
    chunks::<12>(function(), &x, group);
    let mut work = x.clone();
    let mut jacobian = vec![0.0; 4 * n * n];
    group.bench_function("f_x central differences", |b| {
        b.iter(|| {
            let mut f = |x: &[f64], sign: f64, column: &mut [f64]| {
                let f = hamiltonian.evaluate(&x[..n], &x[n..], &u).unwrap();
                column.iter_mut().zip(f).for_each(|(c, f)| *c += sign * f);
            };
            differences(&mut work, black_box(&x), &mut jacobian, &mut f);
            jacobian[0]
        });
    });
    let mut second = HamiltonianSecondOrder::<f64>::new(robot);
    group.bench_function("y_f_x adjoint", |b| {
        b.iter(|| second.first().adjoint(black_box(&q), &p, &u, &y).unwrap().y_f_x[0]);
    });
    group.bench_function("y_f_xx product", |b| {
        b.iter(|| second.hessian_product(black_box(&q), &p, &y, &x).unwrap()[0]);
    });
    group.bench_function("y_f_xx rule", |b| {
        b.iter(|| second.contract(black_box(&q), &p, &u, &y).unwrap().matrix()[(0, 0)]);
    });
    let mut dual_pass = DualPass::<f64>::new(robot);
    group.bench_function("y_f_xx dual pass", |b| {
        b.iter(|| dual_pass.contract(black_box(&q), &p, &u, &y).unwrap().matrix()[(0, 0)]);
    });
    let mut full = FullHessian::<f64>::new(robot);
    group.bench_function("f_xx packed", |b| {
        b.iter(|| full.hessian_tensor(black_box(&q), &p).unwrap().packed()[0])
    });
    group.bench_function("y_f_xx central differences", |b| {
        b.iter(|| {
            let mut y_f_x = |x: &[f64], sign: f64, column: &mut [f64]| {
                let linear = hamiltonian.linearise(&x[..n], &x[n..], &u).unwrap();
                for (row, y) in linear.matrix().iter_rows().zip(&y) {
                    column.iter_mut().zip(row).for_each(|(c, f)| *c += sign * y * f);
                }
            };
            differences(&mut work, black_box(&x), &mut jacobian, &mut y_f_x);
            jacobian[0]
        });
    });
    let mut nested = NestedHessian::new(function());
    group.bench_function("y_f_xx dual", |b| b.iter(|| nested.contract(black_box(&x), &y).unwrap()[(0, 0)]));
    let mut hyperdual = Hessian::new(function());
    group.bench_function("y_f_xx hyperdual", |b| {
        b.iter(|| hyperdual.contract(black_box(&x), &y).unwrap()[(0, 0)])
    });
}

fn chunks<const C: usize>(function: PhaseVelocity, x: &[f64], group: &mut BenchmarkGroup<'_, WallTime>) {
    let mut jacobian = Jacobian::<_, C>::chunked(function);
    group.bench_function(format!("f_x dual {C}"), |b| {
        b.iter(|| jacobian.linearise(black_box(x)).unwrap().value[0]);
    });
}

/// Adds `sign g(x)` to a column.
type Accumulate<'a> = &'a mut dyn FnMut(&[f64], f64, &mut [f64]);

/// Central differences: column j is `(g(x + h e_j) - g(x - h e_j)) / 2h`, step 1e-6.
fn differences(work: &mut [f64], x: &[f64], columns: &mut [f64], g: Accumulate<'_>) {
    let h = 1e-6;
    for (j, column) in columns.chunks_mut(x.len()).enumerate() {
        column.fill(0.0);
        work.copy_from_slice(x);
        work[j] = x[j] + h;
        g(work, 0.5 / h, column);
        work[j] = x[j] - h;
        g(work, -0.5 / h, column);
    }
}

/// The directory of criterion's samples, beside this program: `TARGET/release/deps/derivatives-...`.
fn figures() -> PathBuf {
    let program = std::env::current_exe().unwrap();
    program.ancestors().nth(3).unwrap().join("criterion")
}

/// The table from criterion's medians.
fn report() {
    let figures = figures();
    let median = |robot: &str, route: &str| -> Option<f64> {
        let path = figures.join(robot).join(route).join("new/estimates.json");
        let estimates: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(path).ok()?).ok()?;
        estimates["median"]["point_estimate"].as_f64()
    };
    let cpu = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = cpu.lines().find_map(|line| line.strip_prefix("model name")?.split_once(':'));
    let model = model.map_or("unknown", |(_, name)| name.trim());
    let flags =
        if cfg!(target_feature = "avx2") { "AVX2 and above" } else { "baseline instructions of the target" };
    let names = ROBOTS.map(|file| file.split('.').next().unwrap_or(file));
    let mut table = format!("CPU {model}; one core, f64, {flags}, {LTO}; medians, ns and (ratio to F)\n\n");
    table += &format!("| quantity: method | {} |\n|---|---|---|---|\n", names.join(" | "));
    for (title, route) in ROUTES {
        let cell = |robot: &str| match (median(robot, route), median(robot, "f")) {
            (Some(time), Some(f)) => format!("{time:.0} ({:.1})", time / f),
            _ => "-".into(),
        };
        table += &format!("| {title} | {} |\n", names.map(cell).join(" | "));
    }
    println!("\n{table}");
    if std::env::var_os("COSTATE_WRITE").is_some() {
        let page = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/times.md");
        let text = std::fs::read_to_string(page).unwrap();
        let (before, rest) = text.split_once(BEGIN).unwrap();
        let (_, after) = rest.split_once(END).unwrap();
        std::fs::write(page, format!("{before}{BEGIN}\n{table}{END}{after}")).unwrap();
    }
}

/// The optimisation of this build as far as known, and the place of its table in the document.
const LTO: &str =
    if option_env!("CARGO_PROFILE_BENCH_LTO").is_some() { "16 units per crate" } else { "fat LTO" };
const BEGIN: &str = if option_env!("CARGO_PROFILE_BENCH_LTO").is_some() {
    "<!-- plain: begin -->"
} else {
    "<!-- table: begin -->"
};
const END: &str = if option_env!("CARGO_PROFILE_BENCH_LTO").is_some() {
    "<!-- plain: end -->"
} else {
    "<!-- table: end -->"
};
