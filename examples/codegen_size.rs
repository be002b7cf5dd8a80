//! Size of generated code and the time of its compilation: `cargo run -p costate-examples --example
//! codegen_size`; with `-- --write` the table is written into `docs/codegen.md`.
//!
//! Needs `rustc` and `cc`. A compilation that takes longer than a minute is stopped and marked with `>` in
//! the table.
#![allow(
    missing_docs,
    clippy::unwrap_used,
    clippy::panic,
    reason = "an example may stop on what a library may not"
)]

use costate::codegen::{
    COptions, Coordinates, Program, ProgramOptions, Quantity, RustOptions, robot_program,
};
use costate::robot::{JointSpec, LinkInertia, Placement, Robot};
use nalgebra::Matrix3;
use std::fmt::Write;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

const PATIENCE: Duration = Duration::from_secs(60);

/// A chain in general directions, the same every time.
fn chain(n: usize) -> Robot {
    let mut random = fastrand::Rng::with_seed(7);
    let mut numbers = |size: f64| -> [f64; 3] { std::array::from_fn(|_| size * (2.0 * random.f64() - 1.0)) };
    let mut builder = Robot::builder(format!("chain of {n}"));
    for i in 0..n {
        let link = LinkInertia::about_com(2.0, numbers(0.2), Matrix3::identity() * 0.1);
        let joint = JointSpec::revolute(format!("j{i}"))
            .placed(Placement::from_xyz_rpy(numbers(0.5), numbers(1.5)))
            .axis([0.2, -0.4, 0.7])
            .carrying(link);
        builder = builder.joint(if i == 0 { joint } else { joint.on(format!("j{}", i - 1)) });
    }
    builder.build().unwrap()
}

/// Seconds that a command takes, and the size of the file it makes (kB).
fn timed(command: &mut Command, made: &Path) -> [String; 2] {
    let start = Instant::now();
    // A group of its own: `cc` starts further processes, which are to end with it.
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(command, 0);
    let mut child =
        command.stderr(Stdio::null()).spawn().unwrap_or_else(|error| panic!("{command:?}: {error}"));
    loop {
        if let Some(status) = child.try_wait().unwrap() {
            assert!(status.success(), "{command:?}");
            let size = std::fs::metadata(made).unwrap().len() as f64 / 1000.0;
            return [format!("{:.1}", start.elapsed().as_secs_f64()), format!("{size:.0}")];
        }
        if start.elapsed() > PATIENCE {
            let group = format!("-{}", child.id());
            let ended = Command::new("kill").args(["-KILL", "--", &group]).status();
            if !ended.is_ok_and(|status| status.success()) {
                child.kill().unwrap();
            }
            child.wait().unwrap();
            return [format!("> {}", PATIENCE.as_secs()), "".into()];
        }
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// The Rust source of a program with a function that calls it on f64.
fn for_f64(program: &Program, source: &str) -> String {
    let arguments = program.arguments().iter().map(|a| (&a.name, format!("&[f64; {}]", a.entries)));
    let results = program.results().iter().map(|r| (&r.name, format!("&mut [f64; {}]", r.entries.len())));
    let (names, types): (Vec<_>, Vec<_>) = arguments.chain(results).unzip();
    let parameters: Vec<String> =
        names.iter().zip(types).map(|(name, kind)| format!("{name}: {kind}")).collect();
    let names: Vec<&str> = names.into_iter().map(String::as_str).collect();
    let (call, names) = (program.name(), names.join(", "));
    format!(
        "#![crate_type = \"lib\"]\n{source}\npub fn run({}) {{ {call}({names}) }}\n",
        parameters.join(", ")
    )
}

fn row(robot: &Robot, quantity: Quantity, folder: &Path) -> String {
    let start = Instant::now();
    let program =
        robot_program(robot, quantity, Coordinates::Hamiltonian, &ProgramOptions::default()).unwrap();
    let recording = start.elapsed().as_secs_f64() * 1e3;
    let limit = usize::MAX;
    let rust = program.to_rust(&RustOptions::default().with_limit(limit)).unwrap();
    let (source, object) = (folder.join("code.rs"), folder.join("code.o"));
    std::fs::write(&source, for_f64(&program, &rust)).unwrap();
    let mut rustc = Command::new("rustc");
    rustc.args(["--edition=2024", "--emit=obj", "-Copt-level=3", "-Ctarget-cpu=native", "-o"]);
    let [rust_time, rust_size] = timed(rustc.arg(&object).arg(&source), &object);
    let source = folder.join("code.c");
    std::fs::write(&source, program.to_c(&COptions::default().with_limit(limit)).unwrap()).unwrap();
    let mut cc = Command::new("cc");
    cc.args(["-std=c99", "-O3", "-march=native", "-c", "-o"]);
    let [c_time, c_size] = timed(cc.arg(&object).arg(&source), &object);
    let (name, n, quantity, steps) = (robot.name(), robot.dof(), quantity.name(), program.steps());
    let kilobytes = rust.len() as f64 / 1000.0;
    format!(
        "| {name} | {n} | {quantity} | {steps} | {recording:.1} | {kilobytes:.0} | {rust_time} | {rust_size} | {c_time} | {c_size} |"
    )
}

fn main() {
    let folder = std::env::temp_dir().join(format!("costate-codegen-size-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/.."));
    let file = |name: &str| Robot::from_file(root.join("robots").join(name)).unwrap();
    let robots = [file("ur5.urdf"), file("panda.urdf"), chain(12), chain(32)];
    let mut table = String::from(
        "| robot | n | quantity | steps | recorded (ms) | Rust text (kB) | rustc (s) | object (kB) | cc (s) | object (kB) |\n\
         |---|---|---|---|---|---|---|---|---|---|\n",
    );
    for robot in &robots {
        for quantity in [Quantity::F, Quantity::FX, Quantity::YFXX] {
            let row = row(robot, quantity, &folder);
            println!("{row}");
            writeln!(table, "{row}").unwrap();
        }
    }
    std::fs::remove_dir_all(&folder).unwrap();
    if std::env::args().any(|argument| argument == "--write") {
        let page = root.join("docs/codegen.md");
        let text = std::fs::read_to_string(&page).unwrap();
        let (begin, end) = ("<!-- sizes: begin -->\n", "<!-- sizes: end -->");
        let (head, tail) = (text.find(begin).unwrap() + begin.len(), text.find(end).unwrap());
        std::fs::write(page, format!("{}{table}{}", &text[..head], &text[tail..])).unwrap();
    }
}
