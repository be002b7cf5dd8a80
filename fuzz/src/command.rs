//! Inputs for the command line: `costate eval`, and all commands on malformed files.

use crate::files::project;
use crate::kind::Kind;
use crate::source::{Inputs, Source};
use crate::table::{Outcome, Report};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// How long a command may take before it is stopped.
const PATIENCE: Duration = Duration::from_secs(60);

/// Lines for one process of `costate eval`.
const LINES: usize = 40;

/// Robots and options that lines are evaluated with, in turn.
const EVALUATIONS: [&[&str]; 8] = [
    &["robots/two_link.toml"],
    &["robots/two_link.toml", "--coordinates", "lagrangian"],
    &["robots/two_link.toml", "--route", "dual"],
    &["robots/cart_pole.toml", "--route", "hyperdual"],
    &["robots/cart_pole.toml"],
    &["robots/cart_pole.toml", "--route", "tensors"],
    &["robots/cart_pole.toml", "--coordinates", "lagrangian", "--route", "dual"],
    &["robots/two_link.toml", "--coordinates", "lagrangian", "--route", "hyperdual"],
];

/// Commands that read a file of that kind; FILE is the file.
const COMMANDS: [(Kind, &[&str]); 10] = [
    (Kind::Urdf, &["info", "FILE"]),
    (Kind::Toml, &["info", "FILE", "--json"]),
    (Kind::Urdf, &["check", "FILE", "--samples", "1"]),
    (Kind::Toml, &["check", "FILE", "--samples", "1"]),
    (Kind::Toml, &["count", "FILE"]),
    (Kind::Urdf, &["codegen", "FILE", "--quantity", "f"]),
    (Kind::Problem, &["optimize", "FILE", "--time-limit", "1"]),
    (Kind::Problem, &["optimize", "FILE", "--json", "--time-limit", "1"]),
    (Kind::Problem, &["optimize", "FILE", "--strict", "--time-limit", "1"]),
    // A problem whose `[start_from]` is the file.
    (Kind::Solution, &["optimize", "START", "--time-limit", "1"]),
];

/// The command line, built if need be.
///
/// # Errors
/// If it cannot be built.
pub fn binary() -> Result<PathBuf, String> {
    let mut build = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    // As tests and the main command build it, so that nothing is compiled twice. Tests of commands need it.
    if cfg!(debug_assertions) {
        build.args(["test", "--locked", "--quiet", "--no-run", "--test", "commands"]);
    } else {
        build.args(["build", "--locked", "--quiet", "--release", "--bin", "costate"]);
    }
    build.current_dir(project());
    let status = build.status().map_err(|error| format!("cargo: {error}"))?;
    let own = std::env::current_exe().map_err(|error| error.to_string())?;
    let binary = own.with_file_name(format!("costate{}", std::env::consts::EXE_SUFFIX));
    if status.success() && binary.exists() {
        Ok(binary)
    } else {
        Err("the command line was not built".into())
    }
}

/// Lines `0..count` for `costate eval`, many at once.
pub fn evaluate(binary: &Path, source: Source, count: usize, report: &mut Report) -> std::io::Result<()> {
    let inputs = Inputs::new(Kind::Eval, source);
    // Large inputs and those of the corpus one by one, each with every evaluation; others in groups.
    let (size, repeats) = if matches!(source, Source::Mutated { .. }) { (LINES, 1) } else { (1, 2) };
    for (group, first) in (0..count).step_by(size).enumerate() {
        for repeat in 0..repeats {
            let end = (first + size).min(count);
            let mut text: Vec<u8> =
                (first..end).flat_map(|index| [inputs.input(index), vec![b'\n']].concat()).collect();
            let arguments = EVALUATIONS[(group + repeat) % EVALUATIONS.len()];
            let mut done = Process::run(binary, &[&["eval"], arguments].concat(), &text)?;
            if done.outcome.is_slow() {
                done.outcome.time = done
                    .outcome
                    .time
                    .min(Process::run(binary, &[&["eval"], arguments].concat(), &text)?.outcome.time);
            }
            let refused = done
                .out
                .lines()
                .filter(|line| line.starts_with("{\"line\":") || line.starts_with("{\"error\":"))
                .count();
            let accepted = done.out.lines().count() - refused;
            let fault = done.outcome.fault.take();
            let of_lines = |k: usize| Outcome { accepted: k < accepted, ..done.outcome.copy() };
            for index in first..end {
                report.add(Kind::Eval.name(), &of_lines(index - first), || (inputs.name(index), Vec::new()));
            }
            if let Some(fault) = fault {
                let name = format!("{} and the {} lines after it", inputs.name(first), end - first - 1);
                report.violate(Kind::Eval.name(), &format!("{name}: {fault}"), &std::mem::take(&mut text));
            }
        }
    }
    Ok(())
}

/// Runs `count` commands on mutated files.
pub fn commands(binary: &Path, seed: u64, count: usize, report: &mut Report) -> std::io::Result<()> {
    let folder = std::env::temp_dir().join(format!("costate-fuzz-{}", std::process::id()));
    std::fs::create_dir_all(&folder)?;
    let source = Source::Mutated { seed: seed ^ 0xc0de };
    let start = folder.join("start.toml");
    let problem = std::fs::read(project().join("examples/problems/pendulum_swing_up.toml"))?;
    let start_from = format!("\n[start_from]\nfile = \"input.{}\"\n", Kind::Solution.extension());
    std::fs::write(&start, [with_absolute_paths(&problem), start_from.into_bytes()].concat())?;
    let start = start.display().to_string();
    let all = Kind::ALL.map(|kind| (kind, Inputs::new(kind, source)));
    for index in 0..count {
        let (kind, words) = COMMANDS[index % COMMANDS.len()];
        let Some((_, inputs)) = all.iter().find(|(of, _)| *of == kind) else { continue };
        let input = with_absolute_paths(&inputs.input(index));
        let file = folder.join(format!("input.{}", kind.extension()));
        std::fs::write(&file, &input)?;
        let file = file.display().to_string();
        let path = |word: &&'static str| match *word {
            "FILE" => file.as_str(),
            "START" => start.as_str(),
            word => word,
        };
        let words: Vec<&str> = words.iter().map(path).collect();
        let mut done = Process::run(binary, &words, b"")?;
        if done.outcome.is_slow() {
            done.outcome.time = done.outcome.time.min(Process::run(binary, &words, b"")?.outcome.time);
        }
        report.add("command", &done.outcome, || (words.join(" "), input));
    }
    std::fs::remove_dir_all(&folder)
}

/// The robots of example problems, from any folder.
fn with_absolute_paths(text: &[u8]) -> Vec<u8> {
    let Ok(text) = std::str::from_utf8(text) else { return text.to_vec() };
    text.replace("../../robots", &project().join("robots").display().to_string()).into_bytes()
}

/// A process that has ended.
struct Process {
    outcome: Outcome,
    out: String,
}

impl Process {
    fn run(binary: &Path, arguments: &[&str], input: &[u8]) -> std::io::Result<Self> {
        let clock = Instant::now();
        let mut child = Command::new(binary)
            .args(arguments)
            .current_dir(project())
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()?;
        let (stdin, input) = (child.stdin.take(), input.to_vec());
        std::thread::spawn(move || {
            // A command that does not read its input closes the pipe.
            stdin.map(|mut stdin| stdin.write_all(&input).ok());
        });
        let (out, errors) = (reader(child.stdout.take()), reader(child.stderr.take()));
        let mut bytes = 0;
        let status = loop {
            bytes = bytes.max(resident(&child));
            if let Some(status) = child.try_wait()? {
                break Some(status);
            }
            if clock.elapsed() > PATIENCE {
                child.kill()?;
                child.wait()?;
                break None;
            }
            std::thread::sleep(Duration::from_micros(500));
        };
        let time = clock.elapsed();
        let (out, errors) = (out.join().unwrap_or_default(), errors.join().unwrap_or_default());
        let code = status.and_then(|status| status.code());
        let panicked = errors.contains("panicked at") || !matches!(code, Some(0..=3));
        let last = errors.lines().rev().find(|line| !line.trim().is_empty()).unwrap_or_default();
        let message: String = last.chars().take(300).collect();
        let fault =
            panicked.then(|| format!("exit status {code:?} of costate {}: {message}", arguments.join(" ")));
        let outcome = Outcome { accepted: code == Some(0), panicked, bytes, time, fault };
        Ok(Self { outcome, out })
    }
}

fn reader(stream: Option<impl Read + Send + 'static>) -> std::thread::JoinHandle<String> {
    std::thread::spawn(move || {
        let mut bytes = Vec::new();
        // What was read before an error counts.
        stream.map(|mut stream| stream.read_to_end(&mut bytes).ok());
        String::from_utf8_lossy(&bytes).into_owned()
    })
}

/// The most memory that the process had so far (bytes); 0 where the system does not say.
fn resident(child: &Child) -> usize {
    let status = std::fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kilobytes =
        line.and_then(|line| line.trim().split(' ').next()).and_then(|number| number.parse::<usize>().ok());
    kilobytes.unwrap_or(0) * 1024
}
