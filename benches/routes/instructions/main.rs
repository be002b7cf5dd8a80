//! Instructions of one call, counted by callgrind: they do not depend on what else the machine does.
//!
//! `cargo bench -p costate-routes --bench instructions` prints the table, with `COSTATE_WRITE=1` in the
//! environment it also goes to `docs/instructions.md`. It needs valgrind and gungraun-runner, and says so
//! where they are not installed. `cargo test -p costate-routes --bench instructions` only calls everything
//! once.
#![allow(missing_docs, clippy::unwrap_used, reason = "a bench may stop on what a library may not")]

mod counted;
mod page;
mod selected;

use costate_routes::cases::Case;
use costate_routes::routes::Failure;
use selected::counted;
use std::process::{Command, Stdio};

/// Set for the process that hands over to the runner.
const COUNTING: &str = "COSTATE_COUNTING";

/// Counts depend on the instructions that there are: those that every processor of the architecture has.
const BASELINE: bool = !cfg!(any(target_feature = "avx", target_feature = "fma"));

fn main() -> Result<(), Failure> {
    let arguments: Vec<String> = std::env::args().collect();
    let has = |wanted: &str| arguments.iter().any(|argument| argument == wanted);
    if has("--gungraun-run") || std::env::var_os(COUNTING).is_some() {
        counted::hand_over();
        return Ok(());
    }
    let cases = Case::files()?;
    if !has("--bench") {
        return call_once(&cases);
    }
    let Some(valgrind) = version("valgrind") else {
        println!("instructions are not counted: valgrind is not installed");
        return Ok(());
    };
    if version("gungraun-runner").is_none() {
        println!("instructions are not counted: cargo install gungraun-runner --version {RUNNER}");
        return Ok(());
    }
    let status = Command::new(&arguments[0])
        .args(&arguments[1..])
        .env(COUNTING, "1")
        .env("GUNGRAUN_HOME", page::home())
        .status()?;
    if !status.success() {
        return Err(format!("the runner stopped with {status}").into());
    }
    let table = page::table(&cases, &valgrind)?;
    println!("\n{table}");
    if std::env::var_os("COSTATE_WRITE").is_some() {
        if !BASELINE {
            return Err(
                "docs/instructions.md is for the baseline of the architecture: leave out -C target-cpu"
                    .into(),
            );
        }
        page::write(&table)?;
    }
    Ok(())
}

/// The runner must be of the version of the library.
const RUNNER: &str = "0.20.0";

/// What a program says of itself, if there is one.
fn version(program: &str) -> Option<String> {
    let said = Command::new(program).arg("--version").stderr(Stdio::null()).output().ok()?;
    said.status.success().then(|| String::from_utf8_lossy(&said.stdout).trim().to_owned())
}

fn call_once(cases: &[Case]) -> Result<(), Failure> {
    for case in cases {
        let mut list = counted(case, |_| true)?;
        for (_, candidate) in &mut list {
            (candidate.work)(None)?;
        }
        println!("{}: {} methods run", case.title, list.len());
    }
    Ok(())
}
