//! Where the time of an optimal motion goes, and how it grows with joints and nodes.
//!
//! `cargo run --release -p costate-motions` prints the tables; with `--write` they go to `BENCHMARKS.md` and
//! the plots to `docs/`.

mod action;
mod arms;
mod clock;
mod fit;
mod forms;
mod measure;
mod numerics;
mod plot;
mod problems;
#[path = "../../routes/src/robots.rs"]
#[expect(dead_code, reason = "its files and numbers of joints are those of other tables")]
mod robots;
mod scaling;
mod stages;
mod tables;

use problems::{Failure, ROOT};
use std::path::{Path, PathBuf};

const HELP: &str = "\
costate-motions [--action | --forms] [--write] [--short]
costate-motions arms [--seeds 1,2,3] [--starts 16] [--tolerance T] [--keep FOLDER]

  arms      random tasks of real arms at default options beside the best of several starts; downloads their files
  --action  the table of the action form alone
  --forms   the table of forms of the direct method alone
  --write   puts the tables into BENCHMARKS.md and the plots into docs/
  --short   few chains, short meshes, few repeats
";

fn main() -> Result<(), Failure> {
    let (mut write, mut short, mut only) = (false, false, None);
    if std::env::args().nth(1).is_some_and(|argument| argument == "arms") {
        return arms::run(std::env::args().skip(2));
    }
    for argument in std::env::args().skip(1) {
        match argument.as_str() {
            "--write" => write = true,
            "--short" => short = true,
            "--action" | "--forms" => only = Some(argument),
            "--help" => {
                print!("{HELP}");
                return Ok(());
            }
            other => return Err(format!("unknown argument {other}; see --help").into()),
        }
    }
    if let Some(only) = only {
        let (name, text) = match only.as_str() {
            "--forms" => ("motions forms", forms::table(short)?),
            _ => ("motions action", action::table(short)?),
        };
        println!("{text}");
        return if write { Ok(tables::put(&benchmarks(), name, &text)?) } else { Ok(()) };
    }
    let (joints, of_joints) = scaling::joints(short)?;
    let (nodes, of_nodes) = scaling::nodes(short)?;
    let texts = [
        ("motions stages", stages::table(short)?),
        ("motions joints", joints),
        ("motions nodes", nodes),
        ("motions action", action::table(short)?),
        ("motions forms", forms::table(short)?),
    ];
    for (name, text) in &texts {
        println!("\n{name}\n\n{text}");
    }
    if write {
        for (name, text) in &texts {
            tables::put(&benchmarks(), name, text)?;
        }
        for (file, plot) in [("motions_joints", of_joints), ("motions_nodes", of_nodes)] {
            std::fs::write(format!("{ROOT}/docs/{file}.svg"), plot.svg())?;
        }
    }
    Ok(())
}

/// The page with the tables.
fn benchmarks() -> PathBuf {
    Path::new(ROOT).join("BENCHMARKS.md")
}
