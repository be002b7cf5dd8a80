//! The same programs by costate-jit, cranelift, symjit and the C compiler: time to compile, time of a call.
//!
//! In this folder, `cargo run --release` prints the table; with `-- --write` it also puts it into
//! docs/jit.md.

mod c;
mod candidate;
mod cranelift;
mod symjit;

use candidate::Candidate;
use costate::codegen::{Coordinates, Program, ProgramOptions, Quantity, robot_program};
use costate::robot::Robot;
use costate_jit::Compiled;
use std::fmt::Write;
use std::hint::black_box;
use std::time::Instant;

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");
const BATCHES: usize = 41;

fn ours(program: &Program) -> Candidate {
    let compiled = Compiled::new(program).unwrap();
    Candidate::new(compiled.code_len(), move |x, y| compiled.call(x, y).unwrap())
}

/// A name and what compiles.
type Compiler = (&'static str, fn(&Program) -> Candidate);

const COMPILERS: [Compiler; 6] = [
    ("costate-jit", ours),
    ("cranelift, backtracking", |program| cranelift::compile(program, "none", "backtracking")),
    ("cranelift, optimising", |program| cranelift::compile(program, "speed", "backtracking")),
    ("cranelift, single pass", |program| cranelift::compile(program, "none", "single_pass")),
    ("symjit", symjit::compile),
    ("cc -O3", c::compile),
];

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

/// A line for each compiler.
fn lines(table: &mut String, name: &str, program: &Program) {
    let inputs: Vec<f64> = (0..program.inputs()).map(|k| (0.3 + 0.7 * k as f64).sin()).collect();
    let mut expected = vec![0.0; program.outputs()];
    program.evaluate(&inputs, &mut expected, &mut Vec::new()).unwrap();
    let size = expected.iter().fold(0.0_f64, |size, value| size.max(value.abs()));
    let mut outputs = expected.clone();
    let mut made = Vec::new();
    for (compiler, compile) in COMPILERS {
        let start = Instant::now();
        let mut candidate = compile(program);
        let milliseconds = start.elapsed().as_secs_f64() * 1e3;
        outputs.fill(f64::NAN);
        (candidate.call)(&inputs, &mut outputs);
        let close = outputs.iter().zip(&expected).all(|(a, b)| (a - b).abs() <= 1e-12 * size);
        assert!(close, "{compiler} is wrong on {name}");
        made.push((compiler, milliseconds, candidate, Vec::new()));
    }
    for _ in 0..BATCHES {
        for (_, _, candidate, times) in &mut made {
            let start = Instant::now();
            (0..100).for_each(|_| (candidate.call)(black_box(&inputs), black_box(&mut outputs)));
            times.push(start.elapsed().as_secs_f64() * 1e7);
        }
    }
    for (compiler, milliseconds, candidate, times) in made {
        let bytes = if candidate.bytes == 0 { String::new() } else { candidate.bytes.to_string() };
        let time = median(times);
        writeln!(table, "| {name} | {compiler} | {milliseconds:.1} | {bytes} | {time:.0} |").unwrap();
    }
}

fn main() {
    let mut table =
        String::from("| program | compiler | compile (ms) | bytes | call (ns) |\n|---|---|---|---|---|\n");
    for (name, file) in [("UR5", "ur5.urdf"), ("Panda", "panda.urdf"), ("biped", "biped.toml")] {
        let robot = Robot::from_file(format!("{ROOT}/robots/{file}")).unwrap();
        for quantity in [Quantity::FX, Quantity::YFXX] {
            let options = ProgramOptions::default();
            let program = robot_program(&robot, quantity, Coordinates::Hamiltonian, &options).unwrap();
            lines(&mut table, &format!("{name} {}", quantity.name()), &program);
        }
    }
    println!("{table}");
    if std::env::args().any(|argument| argument == "--write") {
        let path = format!("{ROOT}/docs/jit.md");
        let page = std::fs::read_to_string(&path).unwrap();
        let (begin, end) = ("<!-- compilers: begin -->\n", "<!-- compilers: end -->");
        let (before, rest) = page.split_once(begin).unwrap();
        let (_, after) = rest.split_once(end).unwrap();
        std::fs::write(path, format!("{before}{begin}{table}{end}{after}")).unwrap();
    }
}
