//! Kernel one in body frames (the library) and in one common frame: agreement, operations, time.
//!
//! `cargo bench -p costate-benches --bench frames` prints the table, `cargo bench -p costate-benches --bench
//! frames -- --write` also puts it into `docs/frames.md`.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, missing_docs)]

mod common_frame;
mod constants;

use common_frame::CommonFrame;
use costate::hamiltonian::Hamiltonian;
use costate::kernels::KernelOne;
use costate::robot::Tree;
use costate::scalar::{Count, Operations, Scalar, count};
use costate_test_support::robots;
use fastrand::Rng;
use num_dual::{Dual64, HyperDual64};
use std::fmt::Write;
use std::hint::black_box;
use std::time::Instant;

const STATES: usize = 16;
const BATCHES: usize = 60;
const BATCH_SECONDS: f64 = 1e-3;
/// Of each pair of columns the second is common frame / body frames: above 1 body frames win.
const HEADER: &str = "\
| robot | n | pairs | mul, body / common | ratio | add, body / common | ratio | f64 (ns) | ratio | Dual64 (ns) | ratio \
| HyperDual64 (ns) | ratio | F, F_x: f64, body (ns) |
|---|---|---|---|---|---|---|---|---|---|---|---|---|---|";
const BEGIN: &str = "<!-- table: begin -->";
const END: &str = "<!-- table: end -->";

type States<S> = Vec<(Vec<S>, Vec<S>)>;

fn states<S: Scalar>(n: usize, mut lift: impl FnMut(f64) -> S) -> States<S> {
    let mut rng = Rng::with_seed(7);
    let mut numbers = |size: f64| (0..n).map(|_| lift(size * (rng.f64() - 0.5))).collect();
    (0..STATES).map(|_| (numbers(6.0), numbers(4.0))).collect()
}

fn body_frames<S: Scalar>(kernel: &mut KernelOne<S>, tree: &Tree, q: &[S], v: &[S]) {
    kernel.set_position(tree, q).unwrap();
    kernel.set_velocity(tree, v).unwrap();
    kernel.second_order(tree);
}

/// Both versions give the same numbers: 1e-12 of the largest entry of each array.
fn check<S: Scalar, const LANES: usize>(
    name: &str,
    tree: &Tree,
    lift: impl Fn(f64) -> S,
    parts: impl Fn(S) -> Vec<f64>,
) {
    let (mut body, mut common) = (KernelOne::new(tree), CommonFrame::<S, LANES>::new(tree));
    for (q, v) in states(tree.dof(), lift) {
        body_frames(&mut body, tree, &q, &v);
        common.evaluate(tree, &q, &v);
        let pairs = [
            ("M", body.mass_matrix().as_slice(), common.mass_matrix.as_slice()),
            ("p", body.momentum(), common.momentum.as_slice()),
            ("L_q", body.l_q(), common.gradient.as_slice()),
            ("P", body.l_vq().as_slice(), common.coupling.as_slice()),
            ("L_qq", body.l_qq().as_slice(), common.stiffness.as_slice()),
        ];
        for (what, body, common) in pairs {
            let [body, common] = [body, common].map(|a| a.iter().map(|&x| parts(x)).collect::<Vec<_>>());
            for part in 0..body[0].len() {
                let size = body.iter().fold(0.0_f64, |size, b| size.max(b[part].abs()));
                let apart = body
                    .iter()
                    .zip(&common)
                    .fold(0.0_f64, |worst, (b, c)| worst.max((b[part] - c[part]).abs()));
                assert!(
                    apart <= 1e-12 * size,
                    "{name}: {what}, part {part}, differs by {:.1e}",
                    apart / size
                );
            }
        }
    }
}

/// Operations of one evaluation: body frames, common frame.
fn operations(tree: &Tree) -> [Operations; 2] {
    let state = &states(tree.dof(), Count::variable)[0];
    let (mut body, mut common) = (KernelOne::new(tree), CommonFrame::<_, 1>::new(tree));
    let (_, in_body_frames) = count(|| body_frames(&mut body, tree, &state.0, &state.1));
    let (_, in_common_frame) = count(|| common.evaluate(tree, &state.0, &state.1));
    [in_body_frames, in_common_frame]
}

/// One evaluation of the state of that number.
type Run<'a> = Box<dyn FnMut(usize) + 'a>;

/// Nanoseconds a call, the median over batches; the batches of all functions take turns.
fn interleaved(runs: &mut [Run]) -> Vec<f64> {
    let batch = |run: &mut Run, calls: usize| {
        let start = Instant::now();
        (0..calls).for_each(|call| run(call % STATES));
        start.elapsed().as_secs_f64() / calls as f64
    };
    let warm_up = |run: &mut Run| (0..3).map(|_| batch(run, 20 * STATES)).fold(f64::MAX, f64::min);
    let calls: Vec<usize> =
        runs.iter_mut().map(|run| (BATCH_SECONDS / warm_up(run)).ceil() as usize).collect();
    let mut times = vec![Vec::with_capacity(BATCHES); runs.len()];
    for _ in 0..BATCHES {
        for ((run, times), &calls) in runs.iter_mut().zip(&mut times).zip(&calls) {
            times.push(batch(run, calls));
        }
    }
    times.iter_mut().for_each(|times| times.sort_by(f64::total_cmp));
    times.iter().map(|times| 1e9 * times[BATCHES / 2]).collect()
}

fn run_body<'a, S: Scalar>(tree: &'a Tree, states: &'a States<S>) -> Run<'a> {
    let mut kernel = KernelOne::new(tree);
    Box::new(move |k| {
        let (q, v) = black_box(&states[k]);
        body_frames(&mut kernel, tree, q, v);
        black_box(&kernel);
    })
}

fn run_common<'a, S: Scalar, const LANES: usize>(tree: &'a Tree, states: &'a States<S>) -> Run<'a> {
    let mut kernel = CommonFrame::<S, LANES>::new(tree);
    Box::new(move |k| {
        let (q, v) = black_box(&states[k]);
        kernel.evaluate(tree, q, v);
        black_box(&kernel);
    })
}

fn run_jacobian<'a>(tree: &'a Tree, states: &'a States<f64>) -> Run<'a> {
    let mut hamiltonian = Hamiltonian::from_tree(tree.clone());
    let u = vec![0.0; tree.dof()];
    Box::new(move |k| {
        let (q, p) = black_box(&states[k]);
        black_box(hamiltonian.linearise(q, p, &u).unwrap());
    })
}

/// Times of one evaluation with dual numbers: body frames, common frame.
fn dual_times<S: Scalar>(tree: &Tree, lift: impl FnMut(f64) -> S) -> [f64; 2] {
    let states = states(tree.dof(), lift);
    let times = interleaved(&mut [run_body(tree, &states), run_common::<S, 1>(tree, &states)]);
    [times[0], times[1]]
}

/// One line of the table.
fn line(name: &str, tree: &Tree) -> String {
    let [body, common] = operations(tree);
    let states = states(tree.dof(), |x| x);
    let plain = interleaved(&mut [
        run_body(tree, &states),
        run_common::<_, 1>(tree, &states),
        run_common::<_, 2>(tree, &states),
        run_common::<_, 4>(tree, &states),
        run_jacobian(tree, &states),
    ]);
    let best = plain[1..4].iter().copied().fold(f64::MAX, f64::min);
    let mut line = format!("| {name} | {} | {} ", tree.dof(), tree.pairs());
    for [body, common] in [[body.mul, common.mul], [body.add, common.add]] {
        write!(line, "| {body} / {common} | {:.2} ", common as f64 / body as f64).unwrap();
    }
    for [body, common] in [[plain[0], best], dual_times(tree, dual), dual_times(tree, hyper_dual)] {
        write!(line, "| {body:.0} / {common:.0} | {:.2} ", common / body).unwrap();
    }
    write!(line, "| {:.0} |", plain[4]).unwrap();
    line
}

fn dual(x: f64) -> Dual64 {
    Dual64::new(x, (9.0 * x).sin())
}

fn hyper_dual(x: f64) -> HyperDual64 {
    HyperDual64::new(x, (9.0 * x).sin(), (7.0 * x).cos(), 0.0)
}

/// Processor, instruction set and profile.
fn conditions() -> String {
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model =
        info.lines().find(|line| line.starts_with("model name")).and_then(|line| line.split(": ").nth(1));
    let features = [
        ("sse2", cfg!(target_feature = "sse2")),
        ("avx2", cfg!(target_feature = "avx2")),
        ("fma", cfg!(target_feature = "fma")),
        ("avx512f", cfg!(target_feature = "avx512f")),
        ("neon", cfg!(target_feature = "neon")),
    ];
    let features: Vec<&str> = features.iter().filter(|(_, on)| *on).map(|(name, _)| *name).collect();
    let profile = if cfg!(debug_assertions) {
        "with debug assertions: not for timing"
    } else {
        "bench (optimised as a whole program)"
    };
    format!(
        "Processor {}, target {} with {}, profile {profile}, one core, medians of {BATCHES} batches of {:.0} ms.",
        model.unwrap_or("unknown"),
        std::env::consts::ARCH,
        features.join(", "),
        1e3 * BATCH_SECONDS,
    )
}

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let asked = |what: &str| arguments.iter().any(|argument| argument == what);
    let robots: Vec<(String, Tree)> =
        robots::all().iter().map(|(name, robot)| (name.clone(), Tree::from(robot))).collect();
    for (name, tree) in &robots {
        check::<f64, 1>(name, tree, |x| x, |x| vec![x]);
        check::<f64, 2>(name, tree, |x| x, |x| vec![x]);
        check::<f64, 4>(name, tree, |x| x, |x| vec![x]);
        check::<_, 1>(name, tree, dual, |x| vec![x.re, x.eps]);
        check::<_, 1>(name, tree, hyper_dual, |x| vec![x.re, x.eps1, x.eps2, x.eps1eps2]);
    }
    println!("both versions agree on {} robots", robots.len());
    if !asked("--bench") {
        return;
    }
    let mut table = format!("{BEGIN}\n{}\n\n{HEADER}\n", conditions());
    for (name, tree) in &robots {
        writeln!(table, "{}", line(name, tree)).unwrap();
    }
    println!("{table}");
    if asked("--write") {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/frames.md");
        let page = std::fs::read_to_string(path).unwrap();
        let (before, rest) = page.split_once(BEGIN).expect("a marker where the table begins");
        let (_, after) = rest.split_once(END).expect("a marker where the table ends");
        std::fs::write(path, format!("{before}{table}{END}{after}")).unwrap();
    }
}
