//! `costate optimize`.

mod bounds;
mod feedback;
mod flying;
mod impossible;
mod input;
mod keys;
mod loops;
mod missing;
mod outputs;
mod pages;
mod problems;
mod refused;
mod solutions;
mod stopping;

use crate::child::{costate, root, stdout};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// A folder for the files of one test.
fn folder(test: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("optimize").join(test);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// The same, empty.
fn empty_folder(test: &str) -> PathBuf {
    let folder = folder(test);
    std::fs::remove_dir_all(&folder).unwrap();
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

fn robot(name: &str) -> String {
    root().join("robots").join(name).canonicalize().unwrap().to_str().unwrap().replace('\\', "/")
}

/// A complete problem for the two-link arm, one key per line.
fn two_link() -> String {
    format!(
        "robot = \"{}\"\n[start]\nq = [0.0, 0.0]\n[end]\nq = [1.0, 0.5]\n[time]\nfinal = 1.0\n[cost]\neffort = [1.0, 1.0]\n",
        robot("two_link.toml")
    )
}

/// Runs the command on a problem with this text.
fn optimize(test: &str, text: &str, more: &[&str]) -> std::process::Output {
    let file = folder(test).join("problem.toml");
    std::fs::write(&file, text).unwrap();
    costate(&[&["optimize", file.to_str().unwrap()], more].concat(), b"")
}

fn json(output: &std::process::Output) -> Value {
    serde_json::from_str(&stdout(output)).unwrap()
}

/// Names of the files of a folder, sorted.
fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().to_str().unwrap().to_owned()).collect();
    names.sort();
    names
}
